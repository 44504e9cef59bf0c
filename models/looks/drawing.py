"""How the parts of a crane are drawn: beam, trolley, winch, pulley, load, platform.

Every function adds geoms to a body, in that body's axes; `Painter.unit` is about a trolley's size.
"""

from collections.abc import Sequence
from copy import copy
from itertools import combinations
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from ..rig.rig import Anchor, Rail
from ..types import Array
from .setting import Sizes

Ends = tuple[ArrayLike, ArrayLike]


class Painter:
    """Adds named geoms, of the classes that `setting.prepare` makes, at a scene's sizes."""

    def __init__(self, scene: mujoco.MjSpec, size: Sizes) -> None:
        self.scene = scene
        self.unit = size.unit
        """A length that suits the scene: about a trolley's [m]."""
        self.floor = size.floor
        """Height of the floor [m]."""

    def smaller(self, unit: float) -> "Painter":
        """One of the same scene at another unit, if that is less."""
        other = copy(self)
        other.unit = min(unit, self.unit)
        return other

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
            geom.alt.xyaxes = [*_list(axis), *_list(across_of(axis))]

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


def beam(paint: Painter, body: Any, rail: Rail, ends: tuple[float, float]) -> None:
    """An I-beam just above the trolleys of a rail."""
    unit, along, up = paint.unit, np.asarray(rail.direction), up_of(rail.direction)
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


def trolley(paint: Painter, body: Any, rail: Rail, name: str, winch: bool) -> None:
    """A carriage on four wheels under its beam, with a drum if a rope starts there."""
    unit, along = paint.unit, np.asarray(rail.direction)
    across, up = across_of(along), up_of(along)
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


def anchor(paint: Painter, body: Any, point: Anchor, winch: bool, sheave: bool, side: int) -> None:
    """A winch where a rope starts, a pulley where it passes, a plate where it ends.

    The winch stands on its bed if `side` is -1, and hangs from it if 1.
    """
    unit, centre = paint.unit, np.asarray(point.position)
    level = unit * np.array([0.0, 1.0, 0.0])
    if winch:
        bed = centre + np.array([0, 0, 0.5 * side * unit])
        half = (0.45 * unit, 0.6 * unit, 0.12 * unit)
        paint.box(body, f"{point.name}.bed", "machine", bed, half)
        ends = (centre - 0.45 * level, centre + 0.45 * level)
        paint.drum(body, f"{point.name}.drum", "steel", ends, 0.36 * unit)
        for label, way in (("left", -1), ("right", 1)):
            disc = (centre + 0.4 * way * level, centre + 0.5 * way * level)
            paint.drum(body, f"{point.name}.disc.{label}", "dark", disc, 0.48 * unit)
    elif sheave:
        ends = (centre - 0.12 * level, centre + 0.12 * level)
        paint.drum(body, f"{point.name}.sheave", "dark", ends, 0.3 * unit)
    else:
        paint.box(body, f"{point.name}.plate", "steel", centre, (0.15 * unit,) * 3)


def pulley(paint: Painter, body: Any, name: str) -> None:
    """A free pulley between two cheeks."""
    unit = paint.unit
    axle = ((0, -0.12 * unit, 0), (0, 0.12 * unit, 0))
    paint.drum(body, f"{name}.sheave", "dark", axle, 0.36 * unit)
    for side, way in (("left", -1), ("right", 1)):
        half = (0.2 * unit, 0.03 * unit, 0.45 * unit)
        paint.box(body, f"{name}.cheek.{side}", "structure", (0, 0.16 * way * unit, 0), half)


def platform(paint: Painter, body: Any, name: str, corners: Sequence[Anchor]) -> None:
    """A frame of tubes through the corners, with a round table in the middle."""
    places = [np.asarray(corner.position) for corner in corners]
    spans = [float(np.linalg.norm(place)) for place in places]
    tube = 0.1 * min([paint.unit, *(0.5 * span for span in spans if span > 0)])
    for (i, start), (j, end) in combinations(enumerate(places, start=1), 2):
        paint.rod(body, f"{name}.tube{i}.{j}", "structure", (start, end), tube)
    for i, place in enumerate(places, start=1):
        paint.rod(body, f"{name}.arm{i}", "steel", ((0, 0, 0), place), 0.7 * tube)
    radius = 0.35 * min(spans, default=paint.unit)
    table = ((0, 0, -tube), (0, 0, tube))
    paint.drum(body, f"{name}.table", "machine", table, radius)
    tool = ((0, 0, -tube), (0, 0, -0.6 * radius))
    paint.drum(body, f"{name}.tool", "cargo", tool, 0.4 * radius)


def eye(paint: Painter, body: Any, corner: Anchor) -> None:
    """Where a rope is tied to a platform."""
    half = (0.1 * min(paint.unit, float(np.linalg.norm(corner.position)) or paint.unit),) * 3
    paint.box(body, f"{corner.name}.eye", "dark", corner.position, half)


def cargo(paint: Painter, body: Any, name: str) -> None:
    """A crate on four slings; the rope's end, where the mass is, is their apex."""
    unit = paint.unit
    paint.box(body, f"{name}.hook", "structure", (0, 0, 0), (0.13 * unit,) * 3)
    top, half = -0.9 * unit, 0.62 * unit
    paint.box(body, f"{name}.crate", "cargo", (0, 0, top - half), (half,) * 3)
    for index, (x, y) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        corner = np.array([x * half, y * half, top])
        paint.rod(body, f"{name}.sling{index + 1}", "dark", ((0, 0, 0), corner), 0.03 * unit)
        edge = (corner, corner - np.array([0, 0, 2 * half]))
        paint.rod(body, f"{name}.batten{index + 1}", "batten", edge, 0.07 * unit)


def ball(paint: Painter, body: Any, name: str) -> None:
    """A load that looks the same however its body, which leans with a boom, is turned."""
    unit = paint.unit
    paint.rod(body, f"{name}.ball", "cargo", ((0, 0, 0), (0, 0, 0.01 * unit)), 0.75 * unit)


def across_of(direction: ArrayLike) -> Array:
    """Level unit vector to the left of a direction."""
    left = np.cross([0.0, 0.0, 1.0], np.asarray(direction, float))
    length = float(np.linalg.norm(left))
    return left / length if length > 1e-6 else np.array([0.0, 1.0, 0.0])


def up_of(direction: ArrayLike) -> Array:
    """Unit vector above a direction, square to it."""
    return np.asarray(np.cross(np.asarray(direction, float), across_of(direction)))


def _list(values: ArrayLike) -> list[float]:
    """Rounded to a tenth of a millimetre."""
    return [round(float(value), 4) + 0.0 for value in np.asarray(values, float)]
