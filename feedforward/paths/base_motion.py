"""What a base does for all time, and what that adds to a path: waves, recordings, a deck.

    base = BaseMotion(waves=(Wave(3, amplitude=1.0, period=8.0),))
    base.added(derivatives, times)          # the path's derivatives with those of the base
    base.later(2.0)                         # the same motion, 2 s on

A recording goes through a spline of degree 2n+1 with n the order of the path, chosen as that of a
sampled path (see `recordings`) but for its ends, which need not be at rest.  It repeats: over the
last `fade` its end blends into its beginning, with n continuous derivatives.  Asked before its
start, it answers as there.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...models.errors import PathError
from ...models.rig.sea import Record, Wave
from ...models.types import Array
from ..checks import check_order
from ..series.products import factorials, product
from .csv_points import table_of
from .deck import Deck
from .fitting import fit
from .profiles import RestToRest

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

HIGHEST_ORDER = 10
"""Of a recording, as of a sampled path."""


@dataclass(frozen=True)
class Recorded:
    """A recording as a smooth function of all time."""

    columns: tuple[int, ...]
    """Of the path that it is added to."""
    times: tuple[float, ...]
    """[s]; the first is at 0."""
    points: tuple[tuple[float, ...], ...]
    """A row for each time."""
    order: int
    """Number of continuous derivatives."""
    start: float
    """When the path starts [s]."""
    fade: float
    """How long the end takes to fade into the beginning [s]."""
    tolerance: float
    """How far a point may lie off."""

    @cached_property
    def _hash(self) -> int:
        return hash((self.columns, self.times, self.points, self.order, self.start, self.fade))

    def __hash__(self) -> int:
        """Computed once: a recording has thousands of numbers."""
        return self._hash

    def __repr__(self) -> str:
        """Without the points."""
        return f"Recorded({len(self.points)} points in columns {self.columns}, fade={self.fade:g})"

    @property
    def period(self) -> float:
        """After which it repeats [s]."""
        return self.times[-1] - self.fade

    @cached_property
    def _scale(self) -> float:
        """Mean spacing of the points [s], the spline's unit of time."""
        return self.times[-1] / (len(self.times) - 1)

    @cached_property
    def splines(self) -> "tuple[BSpline, ...]":
        """For each column, which has noise of its own."""
        times, points = np.array(self.times) / self._scale, np.array(self.points)
        return tuple(
            fit(times, column[:, None], self.order, self.tolerance, rest=False).spline
            for column in points.T
        )

    def derivatives(self, times: Array, order: int) -> Array:
        """Derivatives at any times (N,) of the path [s], shape (order+1, N, columns)."""
        times = np.maximum(times + self.start, 0.0)
        within = np.mod(times, self.period)
        result = self._along(within, order)
        seam = (within < self.fade) & (times >= self.period)
        if seam.any():
            near, scale = within[seam], factorials(order + 1)
            share = RestToRest(self.order).derivatives(near / self.fade, order)
            pace = scale * self.fade ** np.arange(order + 1.0)
            part = share / pace[:, None]
            end = self._along(near + self.period, order)
            rise = (result[:, seam] - end) / scale[:, None, None]
            result[:, seam] = end + product(part[..., None], rise) * scale[:, None, None]
        return result

    def _along(self, times: Array, order: int) -> Array:
        """Derivatives of the splines at times within the recording."""
        at, scale = times / self._scale, self._scale
        columns = [
            [spline(at, nu=k)[:, 0] / scale**k for k in range(order + 1)] for spline in self.splines
        ]
        return np.moveaxis(np.array(columns), 0, -1)


@dataclass(frozen=True)
class BaseMotion:
    """How a base moves for all time, in the columns of a path."""

    waves: tuple[Wave, ...] = ()
    """Sinusoids."""
    records: tuple[Recorded, ...] = ()
    """Recordings."""
    deck: Deck | None = None
    """What the base carries along, of a path that leads loads on it."""
    since: float = 0.0
    """How long it has moved so when the path starts [s]."""

    def __bool__(self) -> bool:
        """Whether there is any."""
        return bool(self.waves or self.records or self.deck)

    @property
    def columns(self) -> tuple[tuple[str, int], ...]:
        """Every column that moves, and what moves it."""
        waves = [("a wave", wave.column) for wave in self.waves]
        records = [("a record", c) for record in self.records for c in record.columns]
        return (*waves, *records)

    def later(self, time: float) -> "BaseMotion":
        """The same, some time [s] later."""
        return replace(self, since=self.since + time)

    def added(self, values: Array, times: Array, *, back: bool = False) -> Array:
        """Derivatives (order+1, N, columns) of a path with the base's at times (N,) [s].

        With `back` those of the path alone from those with the base's.
        """
        values = values.copy()
        if back and self.deck is not None:
            values = self._carried(values, back=True)
        self._move(values, times + self.since, -1.0 if back else 1.0)
        return values if back or self.deck is None else self._carried(values)

    def _carried(self, values: Array, *, back: bool = False) -> Array:
        assert self.deck is not None
        scale = factorials(len(values))[:, None, None]
        return np.asarray(self.deck.carried(values / scale, back=back) * scale)

    def _move(self, values: Array, times: Array, sign: float) -> None:
        """Add waves and recordings to derivatives, in place."""
        order = len(values) - 1
        for wave in self.waves:
            turn = 2.0 * np.pi / wave.period
            angle = turn * times + wave.phase
            for k in range(order + 1):
                growth = sign * wave.amplitude * turn**k
                values[k, :, wave.column] += growth * np.sin(angle + 0.5 * np.pi * k)
        for record in self.records:
            values[..., list(record.columns)] += sign * record.derivatives(times, order)


def recorded(record: Record, order: int) -> Recorded:
    """A recording from its file, as smooth as a path of some order.

    Raises
    ------
    PathError
        The file cannot be used, has another number of columns, is too short for its fade or has
        too few points, or they scatter by more than the tolerance.
    """
    check_order("order", order, highest=HIGHEST_ORDER)
    try:
        stamp = Path(record.samples).stat().st_mtime_ns
    except (OSError, ValueError):  # which reading says better
        stamp = 0
    return _read(record, order, stamp)


@lru_cache(maxsize=16)
def _read(record: Record, order: int, stamp: int) -> Recorded:
    """The same, once for a file that stays as it is."""
    times, points = table_of(record.samples, len(record.columns))
    duration, name = float(times[-1] - times[0]), record.samples
    if not duration > 2.0 * record.fade:
        raise PathError(
            f"{name} lasts {duration:g} s, a record must last longer than twice its fade of "
            f"{record.fade:g} s"
        )
    if len(times) < 2 * order + 2:
        raise PathError(
            f"{name} has {len(times)} samples, a record with {order} derivatives needs "
            f"{2 * order + 2}"
        )
    found = Recorded(
        record.columns, tuple((times - times[0]).tolist()), tuple(map(tuple, points.tolist())),
        order, record.start, record.fade, record.tolerance,
    )  # fmt: skip
    try:
        _ = found.splines
    except PathError as error:
        raise PathError(f"{name}: {error}") from None
    return found
