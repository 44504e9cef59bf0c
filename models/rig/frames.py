"""Frames that stand on frames: in which order, where they are at home, and their inertia.

A frame's own axes are those of its parent, turned about the frame's axis.  On the way outwards from
a point in a frame, each turning frame turns it, and each frame adds its own origin.
"""

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from ..errors import RigError
from ..types import Array
from ..values import Vector
from .parts import WORLD, Frame

UPRIGHT: Vector = (0.0, 0.0, 1.0)
"""The axis of frames that turn as a crane's tower does."""


LEVEL = 0.9
"""Part of a turning frame's axis along z beyond which it is a tower, not a boom."""


def rises(frame: Frame) -> bool:
    """Whether a frame is a boom, which lifts what it carries: not a tower, a bridge or a portal."""
    if frame.kind == "turning":
        return abs(frame.axis[2]) < LEVEL
    return frame.parent != WORLD


def parents_first(rig: str, frames: Sequence[Frame]) -> tuple[Frame, ...]:
    """The frames, each after its parent, and otherwise in their order.

    Raises
    ------
    RigError
        Some carry one another.
    """
    left, names, done = list(frames), {frame.name for frame in frames}, {WORLD}
    order: list[Frame] = []
    while left:
        ready = next((f for f in left if f.parent in done or f.parent not in names), None)
        if ready is None:
            raise RigError(f"rig {rig}: {_cycle(left)}; one of them must stand in the world")
        order.append(ready)
        left.remove(ready)
        done.add(ready.name)
    return tuple(order)


def _cycle(frames: Sequence[Frame]) -> str:
    """Frames that carry one another, in words."""
    parent = {frame.name: frame.parent for frame in frames}
    round_trip = [frames[0].name]
    while round_trip[-1] not in round_trip[:-1]:
        round_trip.append(parent[round_trip[-1]])
    names = round_trip[round_trip.index(round_trip[-1]) :]
    return "frame " + ", which stands on ".join(names)


def carriers(frames: Sequence[Frame], frame: Frame | None) -> Iterator[Frame]:
    """A frame and all that carry it, outwards; nothing for the world."""
    by_name = {other.name: other for other in frames}
    while frame is not None:
        yield frame
        frame = by_name.get(frame.parent)


def turned(vector: Vector, axis: Vector, angle: float) -> Vector:
    """A vector turned about an axis."""
    cos, sin = math.cos(angle), math.sin(angle)
    x, y, z = vector
    if axis == UPRIGHT:
        return (cos * x - sin * y, sin * x + cos * y, z)
    a, b, c = axis
    along = (1.0 - cos) * (a * x + b * y + c * z)
    return (
        cos * x + sin * (b * z - c * y) + along * a,
        cos * y + sin * (c * x - a * z) + along * b,
        cos * z + sin * (a * y - b * x) + along * c,
    )


def outwards(
    frames: Sequence[Frame], frame: Frame | None, value: Callable[[Frame], float], point: Vector
) -> Vector:
    """World position [m] of a point in a frame's own axes, where each frame has a `value`."""
    x, y, z = point
    for carrier in carriers(frames, frame):
        if carrier.kind == "turning":
            x, y, z = turned((x, y, z), carrier.axis, value(carrier))
        else:
            a, b, c = (value(carrier) * part for part in carrier.axis)
            x, y, z = x + a, y + b, z + c
        a, b, c = carrier.origin
        x, y, z = x + a, y + b, z + c
    return (x, y, z)


def inwards(
    frames: Sequence[Frame], frame: Frame | None, value: Callable[[Frame], float], point: Vector
) -> Vector:
    """Position in a frame's own axes of a point in the world: the inverse of `outwards`."""
    x, y, z = point
    for carrier in reversed(list(carriers(frames, frame))):
        a, b, c = carrier.origin
        x, y, z = x - a, y - b, z - c
        if carrier.kind == "turning":
            x, y, z = turned((x, y, z), carrier.axis, -value(carrier))
        else:
            a, b, c = (value(carrier) * part for part in carrier.axis)
            x, y, z = x - a, y - b, z - c
    return (x, y, z)


def tensor(inertia: float | tuple[float, ...]) -> Array:
    """Moments and products of inertia as a matrix (3, 3); zero for a number about an axis."""
    if isinstance(inertia, float):
        return np.zeros((3, 3))
    xx, yy, zz, *products = inertia
    xy, xz, yz = products or (0.0, 0.0, 0.0)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def second_moments(inertia: Array) -> Array:
    """Integrals of x x, x y, ... over the mass (3, 3) of which a tensor (3, 3) is made."""
    return np.asarray(0.5 * np.trace(inertia) * np.eye(3) - inertia)


def about_axis(frame: Frame) -> float:
    """Moment of inertia of a turning frame about its axis, for its coordinate alone [kg m2]."""
    axis, centre = np.array(frame.axis), np.array(frame.centre)
    away = centre - axis * (axis @ centre)
    own = axis @ tensor(frame.inertia) @ axis
    return float(own + frame.mass * (away @ away)) + frame.along
