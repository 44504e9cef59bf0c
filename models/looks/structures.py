"""How the structures of a crane are drawn: stands, bridge, runways, tower, jib, boom, mast.

Every function adds geoms to a body, in that body's axes; `Painter.unit` is about a trolley's size.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..rig.rig import Anchor, Frame, Rail
from ..types import Array
from .booms import Boom
from .drawing import Painter, across_of, beam, up_of

RING, LANTERN, DECK = 0.5, 0.9, 0.8
"""Where a tower ends above its frame's origin, and how far below if winches stand in its head, or
below the foot of a boom, in units."""
TRUCK = 1.0
"""From the end of a bridge's rails or winches to its truck, in units."""


def fixed_rail(paint: Painter, body: Any, rail: Rail, ends: tuple[float, float]) -> None:
    """A beam on two A-shaped stands."""
    beam(paint, body, rail, ends)
    _stands(paint, body, rail, ends)


def portal(paint: Painter, body: Any, rail: Rail, ends: tuple[float, float]) -> None:
    """A travelling portal: a beam on stands with wheels."""
    beam(paint, body, rail, ends)
    axle = 0.15 * paint.unit * np.asarray(rail.direction)
    for index, foot in enumerate(_stands(paint, body, rail, ends)):
        centre = foot + np.array([0, 0, 0.3 * paint.unit])
        wheel = (centre - axle, centre + axle)
        paint.drum(body, f"{rail.name}.wheel{index + 1}", "dark", wheel, 0.3 * paint.unit)


def _stands(paint: Painter, body: Any, rail: Rail, ends: tuple[float, float]) -> list[Array]:
    """Two A-shaped stands from the floor to the ends of a beam; returns their feet."""
    along, across, unit = np.asarray(rail.direction), across_of(rail.direction), paint.unit
    feet = []
    for side, end in (("start", ends[0] - 0.3 * unit), ("end", ends[1] + 0.3 * unit)):
        head = np.asarray(rail.origin) + end * along + 0.8 * unit * up_of(rail.direction)
        crossing = []
        for leg, way in (("left", -1), ("right", 1)):
            foot = np.array([*head[:2], paint.floor]) + 1.6 * way * unit * across
            top = head + 0.25 * way * unit * across
            paint.rod(body, f"{rail.name}.{side}.{leg}", "structure", (foot, top), 0.16 * unit)
            plate = (0.4 * unit, 0.4 * unit, 0.08 * unit)
            paint.box(body, f"{rail.name}.{side}.{leg}.foot", "concrete", foot, plate)
            feet.append(foot)
            crossing.append(foot + 0.4 * (top - foot))
        bar = (crossing[0], crossing[1])
        paint.rod(body, f"{rail.name}.{side}.bar", "structure", bar, 0.10 * unit)
    return feet


def tower(
    paint: Painter,
    body: Any,
    name: str,
    top: float,
    centre: tuple[float, float] = (0.0, 0.0),
) -> None:
    """A lattice tower under a turning frame or a boom, up to the height `top`."""
    unit, half = paint.unit, 0.55 * paint.unit
    plate = (1.6 * unit, 1.6 * unit, 0.25 * unit)
    paint.box(body, f"{name}.base", "concrete", (*centre, paint.floor + 0.25 * unit), plate)
    corners = np.array(centre) + half * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
    levels = np.linspace(paint.floor, top, max(3, round((top - paint.floor) / (2.2 * half))) + 1)
    for index, corner in enumerate(corners):
        post = ((*corner, paint.floor), (*corner, top))
        paint.rod(body, f"{name}.post{index + 1}", "structure", post, 0.10 * unit)
        following = corners[(index + 1) % 4]
        for level, (low, high) in enumerate(pairwise(levels)):
            ends = (corner, following) if (level + index) % 2 else (following, corner)
            brace = ((*ends[0], low), (*ends[1], high))
            label = f"{name}.brace{index + 1}.{level + 1}"
            paint.rod(body, label, "structure", brace, 0.05 * unit)
    ring = ((*centre, top), (*centre, top + 0.25 * unit))
    paint.drum(body, f"{name}.ring", "steel", ring, 0.85 * unit)


def jib(paint: Painter, body: Any, rail: Rail, ends: tuple[float, float]) -> None:
    """The turning top of a tower crane: jib, tie rods, cab and counterweight."""
    unit, along = paint.unit, np.asarray(rail.direction)
    across, up = across_of(along), up_of(along)
    foot = np.array([0.0, 0.0, rail.origin[2]])
    tail = min(-0.4 * ends[1], ends[0] - 1.3 * unit)
    beam(paint, body, rail, (tail, ends[1]))
    apex = foot + 3.6 * unit * up
    deck = foot + 1.27 * unit * up
    for label, end in (("front", 0.8 * ends[1]), ("back", tail)):
        tie = (apex, end * along + deck)
        paint.rod(body, f"{rail.name}.{label}.tie", "steel", tie, 0.05 * unit)
    for index, (way, side) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        leg = (apex, 0.5 * unit * (way * along + side * across) + deck)
        paint.rod(body, f"{rail.name}.head{index + 1}", "structure", leg, 0.08 * unit)
    weight = foot + (tail + 0.4 * unit) * along + 0.55 * unit * up
    half = (0.7 * unit, 0.55 * unit, 0.75 * unit)
    paint.box(body, f"{rail.name}.counterweight", "concrete", weight, half, along)
    cab = foot + 0.9 * unit * along - 0.8 * unit * across + 0.5 * unit * up
    half = (0.5 * unit, 0.4 * unit, 0.55 * unit)
    paint.box(body, f"{rail.name}.cab", "machine", cab, half, along)


def lantern(paint: Painter, body: Any, name: str) -> None:
    """An open head between tower and jib, with room for a winch."""
    unit = paint.unit
    for index, (x, y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        post = ((0.7 * x * unit, 0.7 * y * unit, z * unit) for z in (0.25 - LANTERN, 0.5))
        low, high = post
        paint.rod(body, f"{name}.lantern{index + 1}", "structure", (low, high), 0.09 * unit)


def bridge(
    paint: Painter, body: Any, rails: Sequence[Rail], ends: tuple[float, float], frame: Frame
) -> None:
    """Beams on two end trucks with wheels, which run along the frame's axis."""
    unit, axis = paint.unit, np.asarray(frame.axis)
    for rail in rails:
        start, end = (value - float(np.dot(rail.origin, rail.direction)) for value in ends)
        beam(paint, body, rail, (start - TRUCK * unit, end + TRUCK * unit))
    for label, low, high in _trucks(rails, ends, axis, unit):
        middle, half = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low)) + 1.1 * unit
        centre = middle + np.array([0, 0, 0.42 * unit])
        size_of = (half, 0.3 * unit, 0.34 * unit)
        paint.box(body, f"{frame.name}.truck.{label}", "machine", centre, size_of, axis)
        for index, way in enumerate((-1, 1)):
            hub = middle + way * (half - 0.5 * unit) * axis
            axle = 0.2 * unit * across_of(axis)
            wheel = (hub - axle, hub + axle)
            paint.drum(body, f"{frame.name}.wheel.{label}{index + 1}", "dark", wheel, 0.3 * unit)


def runways(
    paint: Painter,
    body: Any,
    rails: Sequence[Rail],
    ends: tuple[float, float],
    frame: Frame,
    way: tuple[float, float],
) -> None:
    """Two fixed beams on columns, under the trucks of a bridge, along `way`."""
    unit, axis = paint.unit, np.asarray(frame.axis)
    beyond = 1.5 * unit
    for label, low, high in _trucks(rails, ends, axis, unit):
        name = f"{frame.name}.runway.{label}"
        start = low + (way[0] - beyond) * axis - np.array([0, 0, 0.44 * unit])
        end = high + (way[1] + beyond) * axis - np.array([0, 0, 0.44 * unit])
        half = (0.5 * float(np.linalg.norm(end - start)), 0.22 * unit, 0.14 * unit)
        paint.box(body, name, "steel", 0.5 * (start + end), half, axis)
        for index, share in enumerate((0.03, 0.5, 0.97)):
            head = start + share * (end - start)
            foot = np.array([*head[:2], paint.floor])
            column = (foot, head)
            paint.rod(body, f"{name}.column{index + 1}", "steel", column, 0.16 * unit)
            plate = (0.4 * unit, 0.4 * unit, 0.08 * unit)
            paint.box(body, f"{name}.foot{index + 1}", "concrete", foot, plate)


def _trucks(
    rails: Sequence[Rail], ends: tuple[float, float], axis: Array, unit: float
) -> list[tuple[str, Array, Array]]:
    """Both trucks: label and the outermost places of beams on them, at the trolleys' height."""
    along = np.asarray(rails[0].direction)
    origins = np.array([rail.origin for rail in rails])
    height = np.array([0, 0, origins[0, 2]])
    offsets = origins @ axis
    trucks = []
    for label, place in (("start", ends[0] - TRUCK * unit), ("end", ends[1] + TRUCK * unit)):
        base = height + place * along
        trucks.append((label, base + offsets.min() * axis, base + offsets.max() * axis))
    return trucks


def boom(paint: Painter, body: Any, part: Boom) -> None:
    """A lattice boom on a round deck, with machine house, gantry and pendants."""
    unit, name, lift = paint.unit, part.frame, _lift(part, paint.unit)
    lattice(paint, body, name, part.foot, part.tip, lift)
    out = np.array([*(part.tip - part.foot)[:2], 0.0])
    out = out / np.linalg.norm(out) if out.any() else np.array([1.0, 0.0, 0.0])
    across = across_of(out)
    deck = slewing_deck(paint, body, name, part.foot, out)
    apex = deck - 1.2 * unit * out + np.array([0, 0, 4.0 * unit])
    for way, side in ((1, "left"), (-1, "right")):
        high = apex + 0.3 * way * unit * across
        for label, back in (("front", -0.1), ("back", -2.0)):
            leg = (deck + back * unit * out + 0.8 * way * unit * across, high)
            paint.rod(body, f"{name}.gantry.{label}.{side}", "structure", leg, 0.08 * unit)
        pendant = (high, part.tip + 0.15 * way * unit * across + 1.3 * lift)
        paint.rod(body, f"{name}.pendant.{side}", "steel", pendant, 0.04 * unit)


def slewing_deck(
    paint: Painter, body: Any, name: str, foot: Array, out: ArrayLike = (1.0, 0.0, 0.0)
) -> Array:
    """A round deck under a boom's foot, with machine house, counterweight and cab; its middle."""
    unit, out, across = paint.unit, np.asarray(out), across_of(out)
    deck = foot - np.array([0, 0, 0.35 * unit])
    ring = (deck - np.array([0, 0, 0.2 * unit]), deck)
    paint.drum(body, f"{name}.deck", "steel", ring, 1.7 * unit)
    house = deck - 1.1 * unit * out + np.array([0, 0, 0.7 * unit])
    paint.box(body, f"{name}.house", "machine", house, (0.9 * unit, 1.0 * unit, 0.7 * unit), out)
    weight = deck - 2.3 * unit * out + np.array([0, 0, 0.5 * unit])
    half = (0.4 * unit, 1.0 * unit, 0.5 * unit)
    paint.box(body, f"{name}.counterweight", "concrete", weight, half, out)
    cab = deck + 0.5 * unit * out - 1.1 * unit * across + np.array([0, 0, 0.5 * unit])
    paint.box(body, f"{name}.cab", "cargo", cab, (0.45 * unit, 0.35 * unit, 0.5 * unit), out)
    return np.asarray(deck)


def _lift(part: Boom, unit: float) -> Array:
    """From the line of the winches to the middle of the boom above it."""
    along = (part.tip - part.foot) / np.linalg.norm(part.tip - part.foot)
    return np.asarray(0.85 * unit * up_of(along))


def lattice(paint: Painter, body: Any, name: str, foot: Array, tip: Array, lift: Array) -> None:
    """Four chords that meet at foot and tip, with diagonals; its middle lies off them by `lift`."""
    unit = paint.unit
    along = tip - foot
    length = float(np.linalg.norm(along))
    along = along / length
    across, up = across_of(along), up_of(along)
    bays = max(2, round(0.8 * length / (1.1 * unit)))
    stations = [
        (foot + 0.45 * lift, 0.15),
        *((foot + s * length * along + lift, 0.4) for s in np.linspace(0.1, 0.92, bays + 1)),
        (tip + 0.3 * unit * along + lift, 0.15),
    ]
    corners = [(1, 1), (1, -1), (-1, -1), (-1, 1)]
    rings = [
        [centre + half * unit * (x * across + y * up) for x, y in corners]
        for centre, half in stations
    ]
    for k, bay in enumerate(pairwise(rings)):
        for i in range(4):
            chord = (bay[0][i], bay[1][i])
            paint.rod(body, f"{name}.chord{i + 1}.{k + 1}", "structure", chord, 0.07 * unit)
            if 0 < k <= bays:
                brace = (bay[0][i], bay[1][(i + 1) % 4])
                paint.rod(body, f"{name}.brace{i + 1}.{k}", "structure", brace, 0.035 * unit)


def mast(paint: Painter, body: Any, point: Anchor) -> None:
    """A post from the floor to a winch or pulley that stands alone."""
    x, y, z = point.position
    post = ((x, y, paint.floor), (x, y, z - 0.62 * paint.unit))
    paint.rod(body, f"{point.name}.mast", "structure", post, 0.16 * paint.unit)
