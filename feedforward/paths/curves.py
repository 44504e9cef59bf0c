"""Reference paths along curves: a geometry in a path parameter, covered as a profile says.

    over(start=(0, -4), goal=(5, -4), rise=(0, 2), duration=4.0)        # a parabola over something
    along([(0, -4), (2, -1), (5, -3)], duration=4.0)                    # a curve through waypoints
    CurvedPath(Polynomial(((0, -4), (5, 0), (0, 3))), 4.0, RestToRest(6))    # any polynomial

Geometry and time are separate (K 3.3): a curve c(s), 0 <= s <= 1, says where the outputs go, and a
scalar profile s(t), which rises from 0 to 1 and rests at both ends, says when.  The derivatives of
c(s(t)) follow from the two Taylor series, one inserted in the other, so they are exact to any
order.  Such a path is as smooth as the rougher of its two parts.

Limits: between waypoints far apart a curve may swing out; `clearance` says what that means.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np
import scipy

from ...models.errors import PathError
from ...models.types import Array
from ..checks import check_duration, check_order, check_point
from ..series.products import compose, factorials
from .profiles import ALWAYS_SMOOTH, Profile, RestToRest, progress
from .reference import ReferencePath

if TYPE_CHECKING:
    from scipy.interpolate import BSpline


class Curve(Protocol):
    """A curve of the outputs over a path parameter s from 0 to 1."""

    @property
    def order(self) -> int:
        """Number of continuous derivatives by s."""

    @property
    def size(self) -> int:
        """Number of columns, one for each output."""

    def derivatives(self, s: Array, order: int) -> Array:
        """Derivatives d^k c / ds^k, k = 0 .. `order`, at s (N,).  Shape (order+1, N, size)."""

    def __hash__(self) -> int:
        """Of the curve's data."""


@dataclass(frozen=True)
class Polynomial:
    """c(s) = sum of coefficients[k] s^k.

    Raises
    ------
    PathError
        There are no coefficients, one is not finite, or their lengths differ.
    """

    coefficients: tuple[tuple[float, ...], ...]
    """For each power of s, from s^0 on, one number for each output."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "coefficients", _rows("coefficient", self.coefficients, 1))

    @property
    def order(self) -> int:
        """Every derivative is continuous."""
        return ALWAYS_SMOOTH

    @property
    def size(self) -> int:
        """Number of columns."""
        return len(self.coefficients[0])

    def derivatives(self, s: Array, order: int) -> Array:
        """See `Curve`.  Shape (order+1, N, size)."""
        terms = np.array(self.coefficients)
        result = np.zeros((order + 1, len(s), self.size))
        for k in range(min(order + 1, len(terms))):
            for coefficient in terms[::-1]:
                result[k] = result[k] * s[:, None] + coefficient
            terms = terms[1:] * np.arange(1.0, len(terms))[:, None]
        return result


@dataclass(frozen=True)
class Waypoints:
    """A curve through points: the spline of degree `smoothness` + 1 over their chord lengths.

    So few points as `smoothness` + 2 lie on one polynomial of the lowest degree.

    Raises
    ------
    PathError
        There are fewer than two points, one is not finite, their lengths differ, or
        two that follow each other are the same.
    """

    points: tuple[tuple[float, ...], ...]
    smoothness: int = 6
    """Number of continuous derivatives, from 0 to 10."""

    def __post_init__(self) -> None:
        check_order("smoothness", self.smoothness, highest=10)
        object.__setattr__(self, "points", _rows("waypoint", self.points, 2))
        chords = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        for i in np.flatnonzero(chords == 0)[:1]:
            raise PathError(f"waypoints {i} and {i + 1} are the same, {self.points[i]}")

    @property
    def order(self) -> int:
        """Number of continuous derivatives."""
        return self.smoothness if self._spline.k < len(self.points) - 1 else ALWAYS_SMOOTH

    @property
    def size(self) -> int:
        """Number of columns."""
        return len(self.points[0])

    @cached_property
    def _spline(self) -> "BSpline":
        points = np.array(self.points)
        chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
        s = np.concatenate(([0.0], np.cumsum(chords))) / chords.sum()
        s[-1] = 1.0
        degree = min(self.smoothness + 1, len(points) - 1)
        # Inner knots are averages of `degree` neighbouring parameters, which any degree allows.
        inner = [s[j : j + degree].mean() for j in range(1, len(points) - degree)]
        knots = np.concatenate((np.zeros(degree + 1), inner, np.ones(degree + 1)))
        return scipy.interpolate.make_interp_spline(s, points, k=degree, t=knots)

    def derivatives(self, s: Array, order: int) -> Array:
        """See `Curve`.  Shape (order+1, N, size)."""
        return np.array([self._spline(s, nu=k) for k in range(order + 1)])


@dataclass(frozen=True)
class CurvedPath(ReferencePath):
    """A `Reference` along a curve, from rest to rest as a profile says.

    Raises
    ------
    PathError
        The duration is not from 1e-6 s to 1e9 s.
    """

    curve: Curve
    duration: float
    """When the goal is reached [s]."""
    profile: Profile

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", check_duration(self.duration))

    @property
    def order(self) -> int:
        """Number of continuous derivatives: the profile's, or the curve's if it has fewer."""
        return min(self.profile.order, self.curve.order)

    @property
    def size(self) -> int:
        """Number of columns."""
        return self.curve.size

    def _derivatives(self, times: Array, order: int) -> Array:
        parameter = progress(self.profile, times, self.duration, order)
        parameter[0] = np.clip(parameter[0], 0.0, 1.0)
        parameter[0, times >= self.duration] = 1.0
        scale = factorials(order + 1)[:, None, None]
        curve = self.curve.derivatives(parameter[0], order) / scale
        return np.asarray(compose(curve, parameter) * scale)


def over(
    start: Sequence[float] | Array,
    goal: Sequence[float] | Array,
    rise: Sequence[float] | Array,
    duration: float,
    order: int = 4,
) -> CurvedPath:
    """A parabola from rest to rest over what stands in the straight line's way (K 3.3).

    Parameters
    ----------
    start
        Where it starts, shape (size,), in the rig's order of outputs.
    goal
        Where it ends, shape (size,).
    rise
        How far its middle lies from that of the straight line, one number for each output:
        (0, 0, 2) lifts a load in space by 2 m.
    duration
        [s], > 0.
    order
        Number of derivatives that vanish at both ends.

    Raises
    ------
    PathError
        A number is not finite, the three points differ in length, or the order is not
        a whole number from 0 to 100.
    """
    begin, end = check_point("start", start), check_point("goal", goal)
    bend = check_point("rise", rise)
    if not len(begin) == len(end) == len(bend):
        raise PathError(
            f"start has {len(begin)} coordinates, goal {len(end)} and rise {len(bend)}, "
            "they need one each for every output"
        )
    pairs = zip(begin, end, bend, strict=True)
    slope = tuple(b - a + 4.0 * up for a, b, up in pairs)
    curve = Polynomial((begin, slope, tuple(-4.0 * up for up in bend)))
    return CurvedPath(curve, duration, RestToRest(order))


def along(
    waypoints: Sequence[Sequence[float]] | Array, duration: float, order: int = 4
) -> CurvedPath:
    """A smooth curve through waypoints from rest to rest, without a stop on the way.

    Parameters
    ----------
    waypoints
        Shape (two or more, size), in the rig's order of outputs.
    duration
        [s], > 0.
    order
        Number of continuous derivatives, from 0 to 10.

    Raises
    ------
    PathError
        See `Waypoints` and `CurvedPath`.
    """
    rows = _rows("waypoint", waypoints, 2)
    return CurvedPath(Waypoints(rows, order), duration, RestToRest(order))


def _rows(name: str, rows: object, least: int) -> tuple[tuple[float, ...], ...]:
    """Points of one length each, `least` or more.

    Raises
    ------
    PathError
        They are something else.
    """
    try:
        points = tuple(check_point(f"{name} {i}", row) for i, row in enumerate(rows))  # type: ignore[arg-type, var-annotated]
    except TypeError:
        raise PathError(f"{name}s are {rows!r}, they must be rows of numbers") from None
    if len(points) < least:
        raise PathError(f"there is {len(points)} {name}, it takes {least} or more")
    for i, point in enumerate(points):
        if len(point) != len(points[0]):
            raise PathError(f"{name} {i} has {len(point)} numbers, {name} 0 has {len(points[0])}")
    return points
