"""Reference paths through given points: a spline smooth enough for the rig.

    reference = sampled(times=(0, 1.5, 3), points=((0, -4), (2, -2), (5, -1)), order=4)
    reference = from_csv("path.csv")        # columns: time [s], then one for each output

A spline of degree 2n+1 with n vanishing derivatives at both ends joins to rest with n continuous
derivatives.  A few points it interpolates.  A recording of hundreds or thousands of points it must
not: the fourth derivative of a spline with a knot at every millisecond is nothing but rounding,
1e-16 m / (1e-3 s)^4.  So the knots are a subset of the samples, the spline is the least-squares one
on them, and of the subsets that leave no point further away than `tolerance` the one is taken whose
derivative n is known best, for the inputs need that (see `fitting`).  If no coarser subset leaves
the points within the tolerance, the spline goes through every point exactly, but a recording that
scatters by more than that is refused: give it the tolerance it needs.

However close the points are, their highest derivative is not: 1e-12 m in 0.01 s are 1e-4 m/s4.
`input_uncertainty` says what that costs, by solving for `rivals` of the path, too.

Limits: the path starts and ends at rest whatever the points say there, so a recording should
begin and end at rest.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike, fspath
from typing import TYPE_CHECKING

import numpy as np

from ...models.errors import PathError
from ...models.types import Array
from ...models.values import as_number
from ..checks import check_duration, check_order
from .csv_points import as_table, check_table, table_of
from .fitting import Fit, fit
from .reference import ReferencePath

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

HIGHEST_ORDER = 10
"""Of a sampled path: the conditioning of B-splines of degree 21 still leaves nine digits."""

RECORDED = 20
"""So many points and more may be samples of another path, which the spline misses."""


@dataclass(frozen=True)
class SampledPath(ReferencePath):
    """A smooth path from rest to rest along points, see the module's text.

    Raises
    ------
    PathError
        There are fewer than two points, something is not finite or beyond 1e12, times
        do not increase, the points' lengths differ, order or tolerance is out of range, or a
        hundred points and more scatter by more than the tolerance.
    """

    times: tuple[float, ...]
    """Times of the points [s]; the path's own time starts at the first."""
    points: tuple[tuple[float, ...], ...]
    """One row of coordinates for each time."""
    order: int = 4
    """Number of continuous derivatives, those at the joins to rest included."""
    tolerance: float = 1e-6
    """How far a point may lie off the path, in the unit of its column ([m], [rad])."""

    def __post_init__(self) -> None:
        check_order("order", self.order, highest=HIGHEST_ORDER)
        check_table(*as_table(self.times, self.points), lambda index: f"point {index}")
        check_duration(self.duration)
        if not 0 <= as_number(self.tolerance) < math.inf:
            raise PathError(f"tolerance is {self.tolerance!r}, it must be finite and >= 0")
        _ = self._spline

    @cached_property
    def _hash(self) -> int:
        return hash((self.times, self.points, self.order, self.tolerance))

    def __hash__(self) -> int:
        """Computed once: a recording has thousands of numbers."""
        return self._hash

    def __repr__(self) -> str:
        """Without the points."""
        return (
            f"SampledPath({len(self.points)} points of {self.size} columns, "
            f"duration={self.duration:g}, order={self.order}, tolerance={self.tolerance:g})"
        )

    @property
    def duration(self) -> float:
        """From the first point to the last [s]."""
        return self.times[-1] - self.times[0]

    @property
    def size(self) -> int:
        """Number of columns."""
        return len(self.points[0])

    @property
    def knots(self) -> int:
        """Number of polynomial pieces the path consists of."""
        return int(len(self._spline.t) - 2 * self._spline.k - 1)

    @property
    def deviation(self) -> float:
        """Largest distance of a coordinate of the points from the path."""
        values = self._spline(self._spline_times(np.array(self.times) - self.times[0]))
        return float(np.abs(values - np.array(self.points)).max())

    @property
    def rivals(self) -> tuple["Rival", ...]:
        """Paths that the points allow as well: one for the bias, then those with more noise.

        None for a few points, between which the path is what it is.
        """
        if len(self.points) < RECORDED:
            return ()
        return tuple(Rival(self, number) for number in range(1 + len(self._fit.noise)))

    @cached_property
    def _scale(self) -> float:
        """Mean spacing of the points [s], the spline's unit of time, for conditioning."""
        return self.duration / (len(self.times) - 1)

    @cached_property
    def _fit(self) -> Fit:
        times = self._spline_times(np.array(self.times) - self.times[0])
        points = np.array(self.points)
        try:
            return fit(times, points, self.order, self.tolerance)
        except PathError as error:
            scattered = error
        try:
            fit(times, points, self.order, self.tolerance, rest=False)
        except PathError:
            raise scattered from None
        raise PathError(self._in_motion(points))

    def _in_motion(self, points: Array) -> str:
        """Which column of a recording that is smooth is in motion at its start or end."""
        speeds = np.abs(np.diff(points, axis=0) / np.diff(self.times)[:, None])[[0, -1]]
        end, column = np.unravel_index(int(speeds.argmax()), speeds.shape)
        when, speed = ("starts", "ends")[int(end)], speeds[end, column]
        return (
            f"column {column} {when} at a speed of {speed:.3g} per second, a recording must start "
            "and end in rest; what a base does in a sea is said by `waves` or `records` of a move"
        )

    @property
    def _spline(self) -> "BSpline":
        return self._fit.spline

    def _spline_times(self, times: Array) -> Array:
        return times / self._scale

    def _derivatives(self, times: Array, order: int) -> Array:
        result = self._along(self._spline, times, order)
        result[0, times <= 0] = self.points[0]
        result[0, times >= self.duration] = self.points[-1]
        result[0, :, self._still], result[1:, :, self._still] = self._at_rest, 0.0
        return result

    @cached_property
    def _still(self) -> list[int]:
        """Columns that do not move: a spline's rounding would have them start moving."""
        return np.flatnonzero(np.ptp(np.array(self.points), axis=0) == 0.0).tolist()

    @property
    def _at_rest(self) -> Array:
        """Where they are, shape (columns, 1)."""
        return np.array(self.points[0])[self._still][:, None]

    def _along(self, spline: "BSpline", times: Array, order: int) -> Array:
        """Derivatives of a spline over the path's times, at rest outside."""
        result = np.zeros((order + 1, len(times), self.size))
        outside = (times < 0) | (times > self.duration)
        spline_times = self._spline_times(np.clip(times, 0.0, self.duration))
        for k in range(min(order, spline.k) + 1):
            result[k] = spline(spline_times, nu=k) / self._scale**k
            if k > 0:
                result[k, outside] = 0.0
        return result

    def _other(self, number: int, times: Array, order: int) -> Array:
        """Derivatives of the rival of a number."""
        derivatives = self._derivatives(times, order)
        if number:
            return derivatives + self._along(self._fit.noise[number - 1], times, order)
        away = self._along(self._fit.rival, times, order) - self._along(self._spline, times, order)
        return np.asarray(derivatives + self._fit.weight * away)


@dataclass(frozen=True)
class Rival(ReferencePath):
    """A path that is as good as a sampled one, see `SampledPath.rivals`."""

    path: SampledPath
    number: int

    @property
    def order(self) -> int:
        """Number of continuous derivatives."""
        return self.path.order

    @property
    def duration(self) -> float:
        """As of the path [s]."""
        return self.path.duration

    @property
    def size(self) -> int:
        """Number of columns."""
        return self.path.size

    def _derivatives(self, times: Array, order: int) -> Array:
        return self.path._other(self.number, times, order)


def sampled(
    times: Sequence[float] | Array,
    points: Sequence[Sequence[float]] | Array,
    order: int = 4,
    tolerance: float = 1e-6,
) -> SampledPath:
    """A smooth path from rest to rest along points.

    Parameters
    ----------
    times
        Shape (N,) [s], increasing; the path's time starts at the first.
    points
        Shape (N, size), columns in the rig's order of outputs.
    order
        Number of continuous derivatives, 0 to 10; the spline's degree is 2 `order` + 1.
    tolerance
        How far a point may lie off the path, in its column's unit; 0: by rounding.

    Raises
    ------
    PathError
        See `SampledPath`.
    """
    row, table = as_table(times, points)
    return SampledPath(tuple(row.tolist()), tuple(map(tuple, table.tolist())), order, tolerance)


def from_csv(
    path: str | PathLike[str], order: int = 4, *, size: int | None = None, tolerance: float = 1e-6
) -> SampledPath:
    """The path along the points of a CSV file.

    Parameters
    ----------
    path
        Of a file with comma-separated columns: time [s], then one for each output.  A first
        line without any number is a header.  Empty lines are skipped.
    order
        Number of continuous derivatives.
    size
        Number of outputs that the file must have, if that is known.
    tolerance
        How far a point may lie off the path, in its column's unit.

    Raises
    ------
    PathError
        The file cannot be read, or a row or column of it cannot be used; the message
        names line and column.
    """
    if not isinstance(path, str | PathLike):
        raise PathError(f"the file is {path!r}, it must be a path, such as 'path.csv'")
    times, points = table_of(fspath(path), size)
    return sampled(times, points, order, tolerance)
