"""Booms that rise and fall, and what they stand on: a slewing head on a tower, or a column.

A frame that turns about a level axis is a boom from its axis to what it carries furthest out: a
lattice where a rope luffs it, a box girder where a torque does.  So is, as a girder, a frame that
slides on another one.
"""

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from ..rig.frames import rises
from ..rig.rig import Frame, Rig
from ..types import Array
from . import structures
from .drawing import Painter


@dataclass(frozen=True, eq=False)
class Rising:
    """A boom in the axes of its frame, from (0, 0, 0) to its tip."""

    frame: Frame
    """The frame that it is."""
    tip: Array
    """Where what it carries furthest out stands, shape (3,) [m]."""
    roped: bool
    """Whether a rope ends on it, and luffs it."""


def find(rig: Rig) -> tuple[Rising, ...]:
    """The booms of a rig that rise."""
    ends = {rope.path[-1] for rope in rig.ropes}
    found = []
    for frame in filter(rises, rig.frames):
        anchors = [anchor for anchor in rig.anchors if anchor.frame == frame.name]
        places = [np.array(anchor.position) for anchor in anchors]
        places += [np.array(other.origin) for other in rig.frames if other.parent == frame.name]
        places += [
            np.array(rail.origin) + rail.end * np.array(rail.direction)
            for rail in rig.rails
            if rail.frame == frame.name and np.isfinite(rail.end)
        ]
        tip = max(places, key=lambda place: float(place @ place), default=np.zeros(3))
        found.append(Rising(frame, tip, any(anchor.name in ends for anchor in anchors)))
    return tuple(found)


def boom(paint: Painter, body: Any, part: Rising) -> None:
    """A lattice or a girder with its hinge."""
    unit, name, length = paint.unit, part.frame.name, float(np.linalg.norm(part.tip))
    if part.frame.kind == "turning":
        half = 0.75 * unit * np.array(part.frame.axis)
        paint.drum(body, f"{name}.hinge", "steel", (-half, half), 0.3 * unit)
    if length < 0.5 * unit:
        return
    if part.roped:
        structures.lattice(paint, body, name, np.zeros(3), part.tip, np.zeros(3))
        return
    along = part.tip / length
    for label, start, end, thick in (("root", 0.0, 0.6, 0.38), ("head", 0.55, 1.0, 0.27)):
        size = (0.5 * (end - start) * length, 0.7 * thick * unit, thick * unit)
        paint.box(body, f"{name}.{label}", "structure", 0.5 * (start + end) * part.tip, size, along)


def head(paint: Painter, rig: Rig, body: Any, below: Any, frame: Frame, first: Rising) -> None:
    """What a boom stands on: the frame that turns, and the tower or column under it."""
    foot = np.array(first.frame.origin)
    centre = (float(frame.origin[0]), float(frame.origin[1]))
    height = frame.origin[2] + foot[2]
    if first.roped:
        structures.tower(paint, below, frame.name, height - structures.DECK * paint.unit, centre)
        structures.slewing_deck(paint, body, frame.name, np.array([0.0, 0.0, foot[2]]))
        _a_frame(paint, rig, body, frame, foot)
    else:
        _column(paint, body, below, frame, foot, centre)


def _a_frame(paint: Painter, rig: Rig, body: Any, frame: Frame, foot: Array) -> None:
    """Legs from the deck to every point high above it that ropes run to."""
    unit = paint.unit
    for anchor in rig.anchors:
        place = np.array(anchor.position)
        if anchor.frame != frame.name or place[2] < foot[2] + 1.5 * unit:
            continue
        for index, (x, y) in enumerate(product((0.6, -1.8), (-0.8, 0.8)), start=1):
            leg = (np.array([x * unit, y * unit, foot[2] - 0.3 * unit]), place)
            paint.rod(body, f"{anchor.name}.leg{index}", "structure", leg, 0.1 * unit)


def _column(
    paint: Painter, body: Any, below: Any, frame: Frame, foot: Array, centre: tuple[float, float]
) -> None:
    """A round pedestal with a column that turns on it, and a cab."""
    unit, top = paint.unit, frame.origin[2] + 0.4 * foot[2]
    pedestal = ((*centre, paint.floor), (*centre, top))
    paint.drum(below, f"{frame.name}.pedestal", "steel", pedestal, 0.75 * unit)
    low = np.array([0.0, 0.0, 0.4 * foot[2]])
    ring = (low, low + np.array([0.0, 0.0, 0.2 * unit]))
    paint.drum(body, f"{frame.name}.ring", "dark", ring, 0.95 * unit)
    high = np.array([0.0, 0.0, foot[2] + 0.45 * unit])
    paint.drum(body, f"{frame.name}.column", "structure", (low, high), 0.6 * unit)
    cab = 0.5 * (low + high) + np.array([0.35, -0.95, 0.1]) * unit
    paint.box(body, f"{frame.name}.cab", "machine", cab, (0.5 * unit, 0.4 * unit, 0.55 * unit))
