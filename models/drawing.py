"""How the parts of a crane are drawn: beam, portal, tower with jib, trolley, winch, load.

Every function adds geoms to a body, in that body's axes; the size `unit` is about a trolley's.
"""

from itertools import pairwise
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from .looks import Sizes
from .rig import Anchor, Rail

Array = NDArray[np.float64]
Ends = tuple[ArrayLike, ArrayLike]


class Painter:
    """Adds named geoms of the classes that `looks.prepare` made."""

    def __init__(self, scene: mujoco.MjSpec) -> None:
        self.scene = scene

    def rod(self, body: Any, name: str, look: str, ends: Ends, radius: float) -> None:
        """A round bar between two points."""
        self._between(body, name, look, mujoco.mjtGeom.mjGEOM_CAPSULE, ends, radius)

    def drum(self, body: Any, name: str, look: str, ends: Ends, radius: float) -> None:
        """A flat-ended cylinder between two points."""
        self._between(body, name, look, mujoco.mjtGeom.mjGEOM_CYLINDER, ends, radius)

    def box(
        self,
        body: Any,
        name: str,
        look: str,
        centre: ArrayLike,
        half: ArrayLike,
        axis: ArrayLike = (1, 0, 0),
    ) -> None:
        """A box with half sizes `half`, its own x axis along `axis`, its y axis level."""
        geom = body.add_geom(
            self.scene.find_default(look),
            name=name,
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=_list(centre),
            size=_list(half),
        )
        if not np.allclose(axis, (1, 0, 0)):
            geom.alt.type = mujoco.mjtOrientation.mjORIENTATION_XYAXES
            geom.alt.xyaxes = [*_list(axis), *_list(_across(axis))]

    def _between(
        self, body: Any, name: str, look: str, kind: Any, ends: Ends, radius: float
    ) -> None:
        body.add_geom(
            self.scene.find_default(look),
            name=name,
            type=kind,
            fromto=[*_list(ends[0]), *_list(ends[1])],
            size=_list((radius, 0, 0)),
        )


def beam(paint: Painter, body: Any, rail: Rail, ends: tuple[float, float], unit: float) -> None:
    """An I-beam just above the trolleys of a rail."""
    along, up = np.asarray(rail.direction), _up(rail.direction)
    middle = np.asarray(rail.origin) + 0.5 * sum(ends) * along
    half = 0.5 * (ends[1] - ends[0]) + 0.5 * unit
    for name, height, width, thick in (
        ("foot", 0.42, 0.30, 0.05),
        ("web", 0.82, 0.08, 0.38),
        ("head", 1.22, 0.30, 0.05),
    ):
        centre = middle + height * unit * up
        size = (half, width * unit, thick * unit)
        paint.box(body, f"{rail.name}.{name}", "structure", centre, size, along)


def fixed_rail(
    paint: Painter, body: Any, rail: Rail, ends: tuple[float, float], size: Sizes
) -> None:
    """A beam on two A-shaped stands."""
    beam(paint, body, rail, ends, size.unit)
    _stands(paint, body, rail, ends, size)


def portal(paint: Painter, body: Any, rail: Rail, ends: tuple[float, float], size: Sizes) -> None:
    """A travelling portal: a beam on stands with wheels."""
    beam(paint, body, rail, ends, size.unit)
    axle = 0.15 * size.unit * np.asarray(rail.direction)
    for index, foot in enumerate(_stands(paint, body, rail, ends, size)):
        centre = foot + np.array([0, 0, 0.3 * size.unit])
        wheel = (centre - axle, centre + axle)
        paint.drum(body, f"{rail.name}.wheel{index + 1}", "dark", wheel, 0.3 * size.unit)


def _stands(
    paint: Painter, body: Any, rail: Rail, ends: tuple[float, float], size: Sizes
) -> list[Array]:
    """Two A-shaped stands from the floor to the ends of a beam; returns their feet."""
    along, across, unit = np.asarray(rail.direction), _across(rail.direction), size.unit
    feet = []
    for side, end in (("start", ends[0] - 0.3 * unit), ("end", ends[1] + 0.3 * unit)):
        head = np.asarray(rail.origin) + end * along + 0.8 * unit * _up(rail.direction)
        crossing = []
        for leg, way in (("left", -1), ("right", 1)):
            foot = np.array([*head[:2], size.floor]) + 1.6 * way * unit * across
            top = head + 0.25 * way * unit * across
            paint.rod(body, f"{rail.name}.{side}.{leg}", "structure", (foot, top), 0.16 * unit)
            plate = (0.4 * unit, 0.4 * unit, 0.08 * unit)
            paint.box(body, f"{rail.name}.{side}.{leg}.foot", "concrete", foot, plate)
            feet.append(foot)
            crossing.append(foot + 0.4 * (top - foot))
        bar = (crossing[0], crossing[1])
        paint.rod(body, f"{rail.name}.{side}.bar", "structure", bar, 0.10 * unit)
    return feet


def tower(paint: Painter, body: Any, name: str, size: Sizes) -> None:
    """A lattice tower under a turning frame."""
    unit, half = size.unit, 0.55 * size.unit
    top = 0.5 * unit
    plate = (1.6 * unit, 1.6 * unit, 0.25 * unit)
    paint.box(body, f"{name}.base", "concrete", (0, 0, size.floor + 0.25 * unit), plate)
    corners = half * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
    levels = np.linspace(size.floor, top, max(3, round((top - size.floor) / (2.2 * half))) + 1)
    for index, corner in enumerate(corners):
        post = ((*corner, size.floor), (*corner, top))
        paint.rod(body, f"{name}.post{index + 1}", "structure", post, 0.10 * unit)
        following = corners[(index + 1) % 4]
        for level, (low, high) in enumerate(pairwise(levels)):
            ends = (corner, following) if (level + index) % 2 else (following, corner)
            brace = ((*ends[0], low), (*ends[1], high))
            label = f"{name}.brace{index + 1}.{level + 1}"
            paint.rod(body, label, "structure", brace, 0.05 * unit)
    ring = ((0, 0, top), (0, 0, top + 0.25 * unit))
    paint.drum(body, f"{name}.ring", "steel", ring, 0.85 * unit)


def jib(paint: Painter, body: Any, rail: Rail, ends: tuple[float, float], size: Sizes) -> None:
    """The turning top of a tower crane: jib, tie rods, cab and counterweight."""
    unit, along = size.unit, np.asarray(rail.direction)
    across, up = _across(along), _up(along)
    tail = -0.4 * ends[1]
    beam(paint, body, rail, (tail, ends[1]), unit)
    apex = 3.6 * unit * up
    deck = 1.27 * unit * up
    for label, end in (("front", 0.8 * ends[1]), ("back", tail)):
        tie = (apex, end * along + deck)
        paint.rod(body, f"{rail.name}.{label}.tie", "steel", tie, 0.05 * unit)
    for index, (way, side) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        leg = (apex, 0.5 * unit * (way * along + side * across) + deck)
        paint.rod(body, f"{rail.name}.head{index + 1}", "structure", leg, 0.08 * unit)
    weight = (tail + 0.4 * unit) * along + 0.55 * unit * up
    half = (0.7 * unit, 0.55 * unit, 0.75 * unit)
    paint.box(body, f"{rail.name}.counterweight", "concrete", weight, half, along)
    cab = 0.9 * unit * along - 0.8 * unit * across + 0.5 * unit * up
    half = (0.5 * unit, 0.4 * unit, 0.55 * unit)
    paint.box(body, f"{rail.name}.cab", "machine", cab, half, along)


def trolley(paint: Painter, body: Any, rail: Rail, name: str, winch: bool, size: Sizes) -> None:
    """A carriage on four wheels under its beam, with a drum if a rope starts there."""
    unit, along = size.unit, np.asarray(rail.direction)
    across, up = _across(along), _up(along)
    half = (0.65 * unit, 0.42 * unit, 0.12 * unit)
    paint.box(body, f"{name}.carriage", "machine", 0.05 * unit * up, half, along)
    for index, (way, side) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        centre = unit * (0.42 * way * along + 0.30 * side * across + 0.26 * up)
        axle = 0.09 * unit * across
        wheel = (centre - axle, centre + axle)
        paint.drum(body, f"{name}.wheel{index + 1}", "dark", wheel, 0.16 * unit)
    axle = (0.36 if winch else 0.12) * unit * across
    label, look = ("drum", "steel") if winch else ("sheave", "dark")
    drop = -0.16 * unit * up
    paint.drum(body, f"{name}.{label}", look, (drop - axle, drop + axle), 0.22 * unit)


def anchor(
    paint: Painter, body: Any, point: Anchor, winch: bool, sheave: bool, size: Sizes
) -> None:
    """A winch where a rope starts, a pulley where it passes, a plate where it ends."""
    unit, centre = size.unit, np.asarray(point.position)
    level = unit * np.array([0.0, 1.0, 0.0])
    if winch:
        bed = centre - np.array([0, 0, 0.5 * unit])
        half = (0.45 * unit, 0.6 * unit, 0.12 * unit)
        paint.box(body, f"{point.name}.bed", "machine", bed, half)
        ends = (centre - 0.45 * level, centre + 0.45 * level)
        paint.drum(body, f"{point.name}.drum", "steel", ends, 0.36 * unit)
        for side, way in (("left", -1), ("right", 1)):
            disc = (centre + 0.4 * way * level, centre + 0.5 * way * level)
            paint.drum(body, f"{point.name}.disc.{side}", "dark", disc, 0.48 * unit)
    elif sheave:
        ends = (centre - 0.12 * level, centre + 0.12 * level)
        paint.drum(body, f"{point.name}.sheave", "dark", ends, 0.3 * unit)
    else:
        paint.box(body, f"{point.name}.plate", "steel", centre, (0.15 * unit,) * 3)


def pulley(paint: Painter, body: Any, name: str, size: Sizes) -> None:
    """A free pulley between two cheeks."""
    unit = size.unit
    axle = ((0, -0.12 * unit, 0), (0, 0.12 * unit, 0))
    paint.drum(body, f"{name}.sheave", "dark", axle, 0.36 * unit)
    for side, way in (("left", -1), ("right", 1)):
        half = (0.2 * unit, 0.03 * unit, 0.45 * unit)
        paint.box(body, f"{name}.cheek.{side}", "structure", (0, 0.16 * way * unit, 0), half)


def cargo(paint: Painter, body: Any, name: str, size: Sizes) -> None:
    """A crate on four slings; the rope's end, where the mass is, is their apex."""
    unit = size.unit
    paint.box(body, f"{name}.hook", "structure", (0, 0, 0), (0.13 * unit,) * 3)
    top, half = -0.9 * unit, 0.62 * unit
    paint.box(body, f"{name}.crate", "cargo", (0, 0, top - half), (half,) * 3)
    for index, (x, y) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        corner = np.array([x * half, y * half, top])
        paint.rod(body, f"{name}.sling{index + 1}", "dark", ((0, 0, 0), corner), 0.03 * unit)
        edge = (corner, corner - np.array([0, 0, 2 * half]))
        paint.rod(body, f"{name}.batten{index + 1}", "batten", edge, 0.07 * unit)


def _across(direction: ArrayLike) -> Array:
    """Level unit vector to the left of a direction."""
    left = np.cross([0.0, 0.0, 1.0], np.asarray(direction, float))
    length = float(np.linalg.norm(left))
    return left / length if length > 1e-6 else np.array([0.0, 1.0, 0.0])


def _up(direction: ArrayLike) -> Array:
    """Unit vector above a direction, square to it."""
    return np.asarray(np.cross(np.asarray(direction, float), _across(direction)))


def _list(values: ArrayLike) -> list[float]:
    """Rounded to a tenth of a millimetre."""
    return [round(float(value), 4) + 0.0 for value in np.asarray(values, float)]
