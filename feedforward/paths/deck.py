"""Places on a deck: where loads are in the world that are led along with a base that moves.

A place on deck is that in the world with all frames of the base at 0.  Where they are not, each
turns or shifts what stands on it, the last one first:

    p  ->  pivot + R(angle) (p - pivot)     or     p + axis * position

Angles, positions and places are Taylor series, and so is the result: the product of given series.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...models.errors import PathError, did_you_mean
from ...models.rig.frames import carriers
from ...models.rig.rig import Frame, Rig
from ...models.types import Array
from ...models.values import Vector
from ..series.products import apply
from ..series.rotation import about_axis

Point = tuple[tuple[int, int], ...]
"""Columns of a place with their axes, 0 to 2."""


class Shift(NamedTuple):
    """What one frame of a base does to everything on it."""

    column: int
    """Of its coordinate."""
    axis: Vector
    pivot: Vector | None
    """A point on the axis of a frame that turns [m]; None of one that slides."""


@dataclass(frozen=True)
class Deck:
    """A base that carries the places of some columns along."""

    shifts: tuple[Shift, ...]
    """Of its frames, from the world up."""
    points: tuple[Point, ...]
    """What is carried."""

    def carried(self, taylor: Array, *, back: bool = False) -> Array:
        """Taylor coefficients (orders, N, columns) in the world of those on deck, or `back`."""
        result = taylor.copy()
        for point in self.points:
            place = np.zeros((*taylor.shape[:2], 3))
            for column, axis in point:
                place[..., axis] = taylor[..., column]
            for shift in self.shifts if back else reversed(self.shifts):
                place = _shifted(place, shift, taylor[..., shift.column] * (-1.0 if back else 1.0))
            for column, axis in point:
                result[..., column] = place[..., axis]
        return result


def _shifted(place: Array, shift: Shift, value: Array) -> Array:
    """Places (orders, N, 3) after a frame has turned or slid by a value (orders, N)."""
    if shift.pivot is None:
        return np.asarray(place + value[..., None] * np.array(shift.axis))
    place[0] -= shift.pivot
    turned = apply(about_axis(np.array(shift.axis), value), place)
    turned[0] += shift.pivot
    return turned


def deck_of(rig: Rig, name: str) -> Deck:
    """The deck that a frame is for a rig's loads.

    Raises
    ------
    PathError
        There is no such frame, or its motion is not given; or no load's place is prescribed, or
        one of which only a part is, or what stands in the way is prescribed of something else.
    """
    given = [frame.name for frame in rig.frames if frame.given]
    frame = next((frame for frame in rig.frames if frame.name == name), None)
    if frame is None or not frame.given:
        known = did_you_mean(name, given) if given else ", and it has none"
        raise PathError(
            f"move: frame is {name!r}, it must be one of {rig.name} whose motion is given{known}"
        )
    chain = list(carriers(rig.frames, frame))[::-1]
    points = tuple(point for mass in rig.masses if (point := _point(rig, mass.name)))
    _refuse_others(rig, name, points)
    return Deck(tuple(_shifts(rig, chain)), points)


def _shifts(rig: Rig, chain: list[Frame]) -> list[Shift]:
    """Of a base's frames, from the world up."""
    shifts, pivot = [], np.zeros(3)
    for frame in chain:
        pivot = pivot + frame.origin
        turns = frame.kind == "turning"
        place: Vector = (float(pivot[0]), float(pivot[1]), float(pivot[2]))
        column = rig.outputs.index(frame.coordinate)
        shifts.append(Shift(column, frame.axis, place if turns else None))
    return shifts


def _point(rig: Rig, mass: str) -> Point:
    """Columns of a mass's place."""
    names = [f"{mass}.{axis}" for axis in "xyz"]
    return tuple((rig.outputs.index(n), i) for i, n in enumerate(names) if n in rig.outputs)


def _refuse_others(rig: Rig, frame: str, points: tuple[Point, ...]) -> None:
    """Refuse places of which a part only is prescribed, and angles in the world."""
    if not points:
        raise PathError(f"move: frame is {frame!r}, but no load's place is an output")
    for point in points:
        if len(point) < rig.dimensions:
            name = rig.outputs[point[0][0]]
            mass = name.rpartition(".")[0]
            needed = ", ".join(f"{mass}.{axis}" for axis in rig.axes)
            raise PathError(
                f"move: frame is {frame!r}, but a part of a place cannot be on it: {name} is an "
                f"output, all of {needed} must be"
            )
    for platform in rig.platforms:
        if set(rig.angles_of(platform)) & set(rig.outputs):
            raise PathError(
                f"move: frame is {frame!r}, but platform {platform.name} keeps its angles in the "
                "world; lead its place there, too"
            )
