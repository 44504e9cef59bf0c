"""What stands around a crane: spheres and boxes, and how far points and ropes are from them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import PathError, RigError, did_you_mean
from ..types import Array
from ..values import as_number, plain_name, reals, shown

GOLDEN = 0.5 * (3.0 - 5.0**0.5)
"""Where the golden section cuts, so that each cut leaves 0.618 of an interval."""
SECTIONS = 60
"""Golden sections of a rope span, which leave a 1e-12 of it."""


@dataclass(frozen=True)
class Sphere:
    """A ball that nothing may touch.

    Raises
    ------
    PathError
        The centre is not three finite numbers, or the radius not >= 0.
    """

    name: str
    centre: tuple[float, float, float]
    """Centre (x, y, z) in the world [m]."""
    radius: float
    """Radius [m]."""

    def __post_init__(self) -> None:
        _check_name(self.name)
        object.__setattr__(self, "centre", _three(f"centre of {self.name}", self.centre))
        check_radius(f"radius of {self.name}", self.radius)

    def distance(self, points: Array) -> Array:
        """From points (..., 3) to the surface [m], negative inside; shape (...)."""
        return np.asarray(np.linalg.norm(points - self.centre, axis=-1) - self.radius)

    def segment_distance(self, begin: Array, end: Array) -> Array:
        """Smallest distance of the segments from `begin` to `end` (N, 3), shape (N,)."""
        along = end - begin
        # A span may have no length: then its share of way is 0, not 0 / 0.
        square = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
        share = ((np.array(self.centre) - begin) * along).sum(axis=1) / square
        return self.distance(begin + np.clip(share, 0.0, 1.0)[:, None] * along)


@dataclass(frozen=True)
class Box:
    """A box along the axes that nothing may touch.

    Raises
    ------
    PathError
        A corner is not three finite numbers, or `low` is not below `high`.
    """

    name: str
    low: tuple[float, float, float]
    """The corner of the smallest coordinates [m]."""
    high: tuple[float, float, float]
    """The corner of the largest [m]."""

    def __post_init__(self) -> None:
        _check_name(self.name)
        for end in ("low", "high"):
            object.__setattr__(self, end, _three(f"{end} of {self.name}", getattr(self, end)))
        if any(a > b for a, b in zip(self.low, self.high, strict=True)):
            raise PathError(
                f"low of {self.name} is {self.low}, it must not be above high, {self.high}"
            )

    def distance(self, points: Array) -> Array:
        """From points (..., 3) to the surface [m], negative inside; shape (...)."""
        beyond = np.maximum(np.array(self.low) - points, points - self.high)
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
        return np.asarray(outside + np.minimum(beyond.max(axis=-1), 0.0))

    def segment_distance(self, begin: Array, end: Array) -> Array:
        """Smallest distance of the segments from `begin` to `end` (N, 3), shape (N,).

        The distance from a convex body is convex along a segment: golden sections find the least.
        """

        def at(share: Array) -> Array:
            return self.distance(begin + share[:, None] * (end - begin))

        left, right = np.zeros(len(begin)), np.ones(len(begin))
        for _ in range(SECTIONS):
            width = right - left
            first, second = left + GOLDEN * width, right - GOLDEN * width
            nearer = at(first) < at(second)
            left, right = np.where(nearer, left, first), np.where(nearer, second, right)
        return np.minimum(at(0.5 * (left + right)), np.minimum(at(left * 0.0), at(left * 0.0 + 1)))


Obstacle = Sphere | Box
OBSTACLES: tuple[type[Obstacle], ...] = (Sphere, Box)


def obstacle_of(entry: Mapping[str, Any]) -> Obstacle:
    """The obstacle that a table of TOML describes: a sphere by its centre, a box by its corners.

    Raises
    ------
    PathError
        It describes neither, or with wrong numbers.
    """
    kind = Sphere if {"centre", "radius"} & set(entry) else Box
    known = kind.__dataclass_fields__
    label = f"obstacle {shown(entry['name'])}" if "name" in entry else "an obstacle"
    for key in entry:
        if key not in known:
            raise PathError(f"{label} has no {key!r}{did_you_mean(key, known)}")
    missing = [name for name in known if name not in entry]
    if missing:
        raise PathError(
            f"{label} needs {' and '.join(missing)}; a sphere has name, centre and radius, a box "
            "name, low and high"
        )
    return kind(**entry)


def _check_name(name: object) -> None:
    try:
        plain_name("the name of an obstacle", name)
    except RigError as error:
        raise PathError(str(error)) from None


def _three(name: str, point: Any) -> tuple[float, float, float]:
    """A point in space.

    Raises
    ------
    PathError
        It is something else.
    """
    values = reals(name, point, error=PathError)
    if values.shape != (3,) or not np.isfinite(values).all():
        raise PathError(f"{name} is {shown(point)}, it must be three numbers (x, y, z) [m]")
    x, y, z = values.tolist()
    return x, y, z


def check_radius(name: str, radius: object) -> None:
    """Refuse what is no finite number >= 0.

    Raises
    ------
    PathError
        With the value.
    """
    if not 0 <= as_number(radius) < math.inf:
        raise PathError(f"{name} is {shown(radius)}, it must be a finite number >= 0 [m]")
