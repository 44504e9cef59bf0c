"""How a crane with a wide trolley is drawn: carriage, girders, portal legs, and what hangs below.

A sliding frame that carries winches and no rail is such a trolley; it runs on two girders that
reach out to one side of their portal, as those of a ship-to-shore crane do.

Every function adds geoms to a body, in that body's axes; `Painter.unit` is about a trolley's size.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ..rig.rig import Anchor, Frame, Platform
from ..types import Array
from .drawing import Painter, across_of, up_of

LEGS = (0.06, 0.42)
"""Where the portal's legs stand along the girders, over their length; the rest reaches out."""
NARROWEST = 0.4
"""Least half width of a trolley over its size."""
STAY = 0.9
"""Where the forestays hold the girders, likewise."""


def carriage(paint: Painter, body: Any, frame: Frame, points: Sequence[Anchor]) -> None:
    """A frame of beams over the winches, on eight wheels, with a cab below it."""
    unit, axis = paint.unit, np.asarray(frame.axis)
    across = across_of(axis)
    places = np.array([point.position for point in points])
    along = np.ptp(places @ axis) / 2 + 0.25 * unit
    aside = _half_width(paint, places @ across)
    middle = 0.5 * (places.max(axis=0) + places.min(axis=0))
    deck = middle + 0.32 * unit * np.array([0, 0, 1.0])
    for label, way in (("left", 1), ("right", -1)):
        centre = deck + way * aside * across
        half = (along, 0.12 * unit, 0.1 * unit)
        paint.box(body, f"{frame.name}.beam.{label}", "machine", centre, half, axis)
        for index, place in enumerate((-0.9, -0.6, 0.6, 0.9)):
            hub = deck + place * along * axis + way * (aside + 0.3 * unit) * across
            axle = 0.1 * unit * across
            wheel = (hub - axle, hub + axle)
            paint.drum(body, f"{frame.name}.wheel.{label}{index + 1}", "dark", wheel, 0.14 * unit)
    for label, place in (("front", 0.8), ("back", -0.8)):
        centre = deck + place * along * axis
        half = (0.1 * unit, aside, 0.08 * unit)
        paint.box(body, f"{frame.name}.cross.{label}", "machine", centre, half, axis)
    cab = middle - (along + 0.5 * unit) * axis - 0.35 * unit * np.array([0, 0, 1.0])
    half = (0.4 * unit, 0.4 * unit, 0.4 * unit)
    paint.box(body, f"{frame.name}.cab", "cargo", cab, half, axis)
    hanger = (cab, deck - 0.8 * along * axis)
    paint.rod(body, f"{frame.name}.hanger", "machine", hanger, 0.08 * unit)


def _half_width(paint: Painter, places: Array) -> float:
    """Half the width of a trolley whose winches are at these places across it; all may be at 0."""
    return max(float(np.abs(places).max()), NARROWEST * paint.unit)


def girders(
    paint: Painter,
    body: Any,
    frame: Frame,
    points: Sequence[Anchor],
    way: tuple[float, float],
    width: float,
) -> None:
    """Two girders under a wide trolley, portal legs `width` apart on either side, and stays.

    The trolley goes from `way[0]` to `way[1]` along its axis [m].
    """
    unit, axis = paint.unit, np.asarray(frame.axis)
    across, up = across_of(axis), np.array([0.0, 0.0, 1.0])
    places = np.array([point.position for point in points])
    aside = _half_width(paint, places @ across) + 0.3 * unit
    reach = np.ptp(places @ axis) / 2 + unit
    start, end = way[0] - reach, way[1] + reach
    top = float(places[:, 2].max()) * up - 0.02 * unit * up
    for label, side in (("left", 1), ("right", -1)):
        centre = top + 0.5 * (start + end) * axis + side * aside * across
        half = (0.5 * (end - start), 0.12 * unit, 0.2 * unit)
        paint.box(body, f"{frame.name}.girder.{label}", "structure", centre, half, axis)
    for label, place in (("start", start), ("end", end)):
        tie = (top + place * axis - aside * across, top + place * axis + aside * across)
        paint.rod(body, f"{frame.name}.tie.{label}", "structure", tie, 0.14 * unit)
    legs = [start + share * (end - start) for share in LEGS]
    heads = [_leg_frame(paint, body, frame, top + x * axis, width, k) for k, x in enumerate(legs)]
    apex = heads[1] + 2.6 * unit * up
    for label, side in (("left", 1), ("right", -1)):
        foot = heads[1] + side * aside * across
        tip = apex + 0.3 * side * aside * across
        paint.rod(body, f"{frame.name}.apex.{label}", "structure", (foot, tip), 0.14 * unit)
        for name, x in (("forestay", start + STAY * (end - start)), ("backstay", legs[0])):
            tied = top + x * axis + side * aside * across + 0.2 * unit * up
            paint.rod(body, f"{frame.name}.{name}.{label}", "steel", (tip, tied), 0.05 * unit)
    house = top + 0.5 * sum(legs) * axis + 0.85 * unit * up
    half = (0.9 * unit, 0.9 * aside, 0.45 * unit)
    paint.box(body, f"{frame.name}.house", "steel", house, half, axis)


def _leg_frame(
    paint: Painter, body: Any, frame: Frame, head: Array, width: float, index: int
) -> Array:
    """Two legs with a head beam, a lower one and wheels; the middle of the head beam."""
    unit, axis = paint.unit, np.asarray(frame.axis)
    across, up = across_of(axis), np.array([0.0, 0.0, 1.0])
    name = f"{frame.name}.legs{index + 1}"
    middle = head + 0.42 * unit * up
    ends = [middle + side * width * across for side in (1, -1)]
    paint.rod(body, f"{name}.head", "structure", (ends[0], ends[1]), 0.2 * unit)
    feet = [np.array([*end[:2], paint.floor + 0.35 * unit]) for end in ends]
    for label, end, foot in zip(("left", "right"), ends, feet, strict=True):
        paint.rod(body, f"{name}.{label}", "structure", (foot, end), 0.22 * unit)
        truck = foot - 0.15 * unit * up
        half = (0.25 * unit, 0.9 * unit, 0.2 * unit)
        paint.box(body, f"{name}.truck.{label}", "machine", truck, half, axis)
    sill = [foot + 0.25 * (end - foot) for foot, end in zip(feet, ends, strict=True)]
    paint.rod(body, f"{name}.sill", "structure", (sill[0], sill[1]), 0.14 * unit)
    return middle


def box_of(part: Platform) -> Array:
    """Edges (3,) [m] of the homogeneous box with a platform's mass and moments."""
    x, y, z = part.inertia
    squares = 6.0 / part.mass * np.array([y + z - x, x + z - y, x + y - z])
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)))


def carried_box(paint: Painter, body: Any, part: Platform, corners: Sequence[Anchor]) -> None:
    """A corrugated box below a beam that hangs on the ropes' blocks."""
    edges, name = box_of(part), part.name
    unit = min(paint.unit, 0.5 * float(edges.max()))
    long = int(edges[:2].argmax())
    axis = np.eye(3)[long]
    across = np.eye(3)[1 - long]
    high = 0.2 * edges[2]
    top = 0.5 * edges[2]
    half = 0.5 * np.array([edges[long], edges[1 - long], edges[2] - high])
    centre = np.array([0, 0, -0.5 * high])
    paint.box(body, f"{name}.box", "cargo", centre, half, axis)
    ribs = max(4, round(edges[long] / (0.35 * unit)))
    for index, place in enumerate(np.linspace(-0.96, 0.96, ribs)):
        for label, side in (("left", 1), ("right", -1)):
            rib = centre + place * half[0] * axis + side * half[1] * across
            size = (0.1 * half[0] / ribs * 3, 0.02 * unit, 0.97 * half[2])
            paint.box(body, f"{name}.rib{index + 1}.{label}", "batten", rib, size, axis)
    beam = np.array([0, 0, top - 0.5 * high])
    size = (half[0], 0.55 * half[1], 0.5 * high)
    paint.box(body, f"{name}.spreader", "structure", beam, size, axis)
    for index, corner in enumerate(corners):
        place = np.asarray(corner.position)
        post = (place * np.array([1, 1, 0]) + np.array([0, 0, top]), place)
        paint.rod(body, f"{name}.post{index + 1}", "structure", post, 0.08 * unit)
        axle = 0.12 * unit * across_of(across)
        sheave = (place - axle, place + axle)
        paint.drum(body, f"{name}.sheave{index + 1}", "dark", sheave, 0.22 * unit)


def hook_block(paint: Painter, body: Any, name: str) -> None:
    """A block with a sheave between cheeks, and the hook below it."""
    unit = paint.unit
    axle = ((0, -0.1 * unit, 0.2 * unit), (0, 0.1 * unit, 0.2 * unit))
    paint.drum(body, f"{name}.sheave", "dark", axle, 0.26 * unit)
    for side, way in (("left", -1), ("right", 1)):
        half = (0.22 * unit, 0.03 * unit, 0.32 * unit)
        centre = (0, 0.13 * way * unit, 0.15 * unit)
        paint.box(body, f"{name}.cheek.{side}", "structure", centre, half)
    bend = ((0.0, -0.1), (0.14, -0.26), (0.1, -0.44), (-0.1, -0.44), (-0.16, -0.3))
    ring = [(unit * x, 0.0, unit * z) for x, z in bend]
    for index, (start, end) in enumerate(pairwise(ring)):
        paint.rod(body, f"{name}.hook{index + 1}", "steel", (start, end), 0.06 * unit)


def beam(paint: Painter, body: Any, name: str, reach: Array) -> None:
    """A girder of two flanges and a web from the body's origin to `reach`, a lug at either end."""
    unit, length = paint.unit, float(np.linalg.norm(reach))
    along = reach / length
    up = up_of(along)
    high = min(0.28 * unit, 0.1 * length)
    sizes = {"web": (0.0, 0.03 * unit, high), "top": (high, 0.14 * unit, 0.03 * unit)}
    sizes["bottom"] = (-high, *sizes["top"][1:])
    for label, (above, wide, thick) in sizes.items():
        half = (0.5 * length, wide, thick)
        paint.box(body, f"{name}.{label}", "structure", 0.5 * reach + above * up, half, along)
    for label, place in (("first", 0.0 * reach), ("second", reach)):
        half = (0.12 * unit, 0.05 * unit, 1.4 * high)
        paint.box(body, f"{name}.lug.{label}", "dark", place, half, along)


def slung_cargo(paint: Painter, body: Any, name: str, reach: Array) -> None:
    """A crate on four slings from the body's origin; its centre is at `reach`."""
    unit = paint.unit
    half = min(0.62 * unit, 0.3 * float(np.linalg.norm(reach)))
    paint.box(body, f"{name}.crate", "cargo", reach, (half,) * 3)
    for index, (x, y) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        corner = reach + half * np.array([x, y, 1.0])
        paint.rod(body, f"{name}.sling{index + 1}", "dark", ((0, 0, 0), corner), 0.03 * unit)
        edge = (corner, corner - np.array([0, 0, 2 * half]))
        paint.rod(body, f"{name}.batten{index + 1}", "batten", edge, 0.07 * unit)
