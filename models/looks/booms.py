"""Inclined booms, which a description does not name: winches in line, with nothing to stand on.

Two or more winches in a row that is not level, in a frame without a rail, stand on a boom.  Its
foot is where their line meets the frame's axis, or else a little below the lowest of them.
"""

from dataclasses import dataclass

import numpy as np

from ..rig.frames import rises
from ..rig.rig import WORLD, Anchor, Rig
from ..types import Array

IN_LINE = 0.02
"""How far from their line winches may be, over its length."""

FOOT = 0.3
"""From the lowest winch down to the foot, over the distance of lowest and highest."""


@dataclass(frozen=True, eq=False)
class Boom:
    """A straight boom, in the axes of its frame [m]."""

    frame: str
    """Name of the frame that carries it; "world" if it is fixed."""
    anchors: tuple[str, ...]
    """Names of the anchors on it, from the lowest up."""
    foot: Array
    """Where it stands, shape (3,) [m]."""
    tip: Array
    """Where the highest anchor is, shape (3,) [m]."""


def find(rig: Rig) -> tuple[Boom, ...]:
    """The booms of a rig, one a frame at most."""
    winches = {rope.path[0] for rope in rig.ropes}
    with_rails = {rail.frame for rail in rig.rails}
    booms = []
    heads = {frame.parent for frame in rig.frames if rises(frame)}
    standing = [frame.name for frame in rig.frames if not rises(frame)]
    for frame in (WORLD, *(name for name in standing if name not in heads)):
        anchors = [a for a in rig.anchors if a.frame == frame and a.name in winches]
        anchors.sort(key=lambda anchor: anchor.position[2])
        places = np.array([anchor.position for anchor in anchors])
        if frame not in with_rails and _inclined(places):
            booms.append(_boom(rig, frame, anchors, places))
    return tuple(booms)


def _inclined(places: Array) -> bool:
    """Whether points (n, 3), the lowest first, lie on one line that is not level."""
    if len(places) < 2:
        return False
    step = places[-1] - places[0]
    away = np.linalg.norm(np.cross(places - places[0], step), axis=1)
    size = float(step @ step)
    return bool(step[2] ** 2 > 0.01 * size and away.max() <= IN_LINE * size)


def _boom(rig: Rig, frame: str, anchors: list[Anchor], places: Array) -> Boom:
    low, high = places[0], places[-1]
    step = high - low
    foot = low - FOOT * step
    turning = [part for part in rig.frames if part.name == frame and part.kind == "turning"]
    if turning and step[:2].any():
        nearest = low - (low[:2] @ step[:2]) / (step[:2] @ step[:2]) * step
        on_axis = np.linalg.norm(nearest[:2]) <= IN_LINE * np.linalg.norm(step)
        foot = nearest if on_axis and nearest[2] < low[2] else foot
    return Boom(frame, tuple(anchor.name for anchor in anchors), foot, high)
