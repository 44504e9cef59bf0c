"""Reference paths through given points: a spline smooth enough for the rig.

    reference = sampled(times=(0, 1.5, 3), points=((0, -4), (2, -2), (5, -1)), order=4)
    reference = from_csv("path.csv")        # columns: time [s], then one for each output

A spline of degree 2n+1 with n vanishing derivatives at both ends joins to rest with n continuous
derivatives.  A few points it interpolates.  A recording of hundreds or thousands of points it must
not: the fourth derivative of a spline with a knot at every millisecond is nothing but rounding,
1e-16 m / (1e-3 s)^4.  So the knots are a subset of the samples, the spline is the least-squares one
on them, and the coarsest subset is taken that leaves no point further away than `tolerance`; finer
ones only as long as each doubling brings the points several times closer, that is down to the
data's own noise.  If nothing coarser will do, the spline goes through every point exactly, but a
recording that scatters by more than `tolerance` is refused: give it the tolerance it needs.

Limits: the path starts and ends at rest whatever the points say there, so a recording should
begin and end at rest.
"""

import csv
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike, fspath
from pathlib import Path

import numpy as np
from scipy.interpolate import BSpline

from ...models.errors import PathError
from ...models.types import Array
from ...models.values import as_number
from ..checks import LARGEST, check_duration, check_order, check_times
from .reference import ReferencePath
from .splines import fit

HIGHEST_ORDER = 10
"""Of a sampled path: the conditioning of B-splines of degree 21 still leaves nine digits."""


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
        _check_table(*_table(self.times, self.points), lambda index: f"point {index}")
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

    @cached_property
    def _scale(self) -> float:
        """Mean spacing of the points [s], the spline's unit of time, for conditioning."""
        return self.duration / (len(self.times) - 1)

    @cached_property
    def _spline(self) -> BSpline:
        times = self._spline_times(np.array(self.times) - self.times[0])
        return fit(times, np.array(self.points), self.order, self.tolerance)

    def _spline_times(self, times: Array) -> Array:
        return times / self._scale

    def _derivatives(self, times: Array, order: int) -> Array:
        result = np.zeros((order + 1, len(times), self.size))
        outside = (times < 0) | (times > self.duration)
        spline_times = self._spline_times(np.clip(times, 0.0, self.duration))
        for k in range(min(order, self._spline.k) + 1):
            result[k] = self._spline(spline_times, nu=k) / self._scale**k
            if k > 0:
                result[k, outside] = 0.0
        result[0, times <= 0] = self.points[0]
        result[0, times >= self.duration] = self.points[-1]
        return result


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
    row, table = _table(times, points)
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
    name = fspath(path)
    lines, rows = _read(name)
    if len(rows) < 2:
        raise PathError(f"{name} has {len(rows)} point(s), a path needs 2 or more")
    width = len(rows[0])
    if width < 2 or (size is not None and width != size + 1):
        needed = "at least one output" if size is None else f"{size} outputs"
        raise PathError(f"{name} has {width} columns, it needs a time and {needed}")
    for line, row in zip(lines, rows, strict=True):
        if len(row) != width:
            raise PathError(f"{name} line {line} has {len(row)} columns, the first has {width}")
    table = np.array(rows)
    times, points = table[:, 0], table[:, 1:]
    _check_table(times, points, lambda index: f"{name} line {lines[index]}")
    return sampled(times, points, order, tolerance)


def _read(name: str) -> tuple[list[int], list[list[float]]]:
    """Line numbers and rows of numbers, without header and empty lines."""
    lines: list[int] = []
    rows: list[list[float]] = []
    try:
        with Path(name).open(newline="", encoding="utf-8-sig") as file:
            reader = csv.reader(file)
            header_allowed = True
            for row in reader:
                cells = [cell.strip() for cell in row]
                if not any(cells):
                    continue
                numbers = [_parse(cell) for cell in cells]
                first, header_allowed = header_allowed, False
                if first and all(number is None for number in numbers):
                    continue
                for column, (cell, number) in enumerate(zip(cells, numbers, strict=True), 1):
                    if number is None:
                        raise PathError(
                            f"{name} line {reader.line_num}, column {column} is {cell!r}, "
                            "it must be a number"
                        )
                lines.append(reader.line_num)
                rows.append([number for number in numbers if number is not None])
    except OSError as error:
        raise PathError(f"cannot read {name}: {error.strerror or error}") from None
    except (UnicodeDecodeError, csv.Error):
        raise PathError(f"{name} is not a CSV file, its lines must be numbers and commas") from None
    return lines, rows


def _parse(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None


def _table(times: object, points: object) -> tuple[Array, Array]:
    """Times (N,) and points (N, size) as arrays of these shapes."""
    row = check_times(times)
    try:
        table = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        raise PathError("points must be numbers, of shape (N, size)") from None
    if table.ndim != 2 or table.shape[0] != len(row) or table.shape[1] == 0:
        raise PathError(
            f"points have shape {table.shape}, for {len(row)} times they need shape "
            f"({len(row)}, number of outputs)"
        )
    return row, table


def _check_table(times: Array, points: Array, label: Callable[[int], str]) -> None:
    """Two rows or more, no number infinite or absurdly large, times increasing.

    `label` names a row.
    """
    if len(times) < 2:
        raise PathError(f"the path has {len(times)} point(s), it needs 2 or more")
    table = np.column_stack([times, points])
    for index, column in np.argwhere(~(np.abs(table) <= LARGEST))[:1]:
        value = table[index, column]
        rule = f"within +-{LARGEST:g}" if math.isfinite(value) else "finite"
        raise PathError(f"{label(index)}, column {column + 1} is {value:g}, it must be {rule}")
    for index in np.flatnonzero(np.diff(times) <= 0)[:1] + 1:
        raise PathError(
            f"{label(index)}: time {times[index]:g} s follows {times[index - 1]:g} s, "
            "times must increase"
        )
