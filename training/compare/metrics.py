"""What a run along a reference is worth: errors, swing, settling, effort, rope tension.

Arrays hold T control periods of N scenarios; a run that ended early is marked by `alive`, and its
load stays where it was while the reference moves on: giving up does not make a controller better.
Episodes may be shorter than others beside them, and what follows their ends does not count.

A load has settled if from some instant after arrival on it stays within `SETTLED` of the goal to
the end of the run, and if that is for `LASTING` or longer: a load that swings through the goal as
the run ends has not.  The settling time is from arrival to that instant.  It is the whole time
after arrival where the load has not settled, so that it is longer for every worse run.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ...models.types import Array, Mask

SETTLED = 0.05
"""How near to the goal a load that has settled stays [m]."""
LASTING = 1.0
"""How long it has to stay there until the end of the run, at the least [s]."""
ROUNDED = 1e-9
"""Sums of control periods are rounded by less than this [s]."""
RESAMPLES = 10_000
"""Number of bootstrap resamples."""
CONFIDENCE = 0.95
"""Share of the resamples that lies inside an interval."""


@dataclass(frozen=True, eq=False)
class Record:
    """What happened in N scenarios, at the end of each of T control periods."""

    times: Array
    """Ends of the control periods [s], shape (T,)."""
    arrival: Array
    """When the reference reaches its goal [s], shape (N,)."""
    load: Array
    """Position of the load [m], shape (T, N, p), z last."""
    reference: Array
    """Where the load should be [m], shape (T, N, p)."""
    inputs: Array
    """Inputs as shares of their limits, shape (T, N, inputs)."""
    tensions: Array
    """Tensions of the ropes [N], shape (T, N, ropes)."""
    alive: Mask
    """False from the period on in which the run ended early, shape (T, N)."""
    turn: Array | None = None
    """Angle by which a platform is turned away from its reference [rad], shape (T, N)."""
    lengths: NDArray[np.int64] | None = None
    """Control periods of each episode, shape (N,); all T if None."""

    @cached_property
    def last(self) -> NDArray[np.int64]:
        """Index of each episode's last period, whether a run came to it or not, shape (N,)."""
        full = np.full(self.alive.shape[1], len(self.times))
        return (full if self.lengths is None else self.lengths) - 1

    @cached_property
    def counted(self) -> Mask:
        """Which periods belong to their episode, shape (T, N)."""
        return np.asarray(np.arange(len(self.times))[:, None] <= self.last)

    @cached_property
    def distance(self) -> Array:
        """Distance of the load from its reference [m], (T, N).

        After an early end the load rests, and after its last period an episode stands still.
        """
        last = np.clip(self.alive.sum(axis=0) - 1, 0, self.last)
        rest = np.take_along_axis(self.load, last[None, :, None], axis=0)
        load = np.where(self.alive[..., None], self.load, rest)
        distance = np.linalg.norm(load - self.reference, axis=2)
        end = np.take_along_axis(distance, self.last[None], axis=0)
        return np.asarray(np.where(self.counted, distance, end))

    def of(self, chosen: slice) -> "Record":
        """Those of some episodes, up to the end of the longest."""
        lengths = self.last[chosen] + 1
        periods = slice(int(lengths.max()))
        return Record(
            self.times[periods], self.arrival[chosen], self.load[periods, chosen],
            self.reference[periods, chosen], self.inputs[periods, chosen],
            self.tensions[periods, chosen], self.alive[periods, chosen],
            None if self.turn is None else self.turn[periods, chosen], lengths,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Metrics:
    """One number for each of N scenarios."""

    rmse: Array
    """Root mean square distance of the load from its reference, over move and hold [m]."""
    largest: Array
    """Largest distance [m]."""
    swing: Array
    """Half of the load's horizontal travel, there and back, after arrival [m]; NaN for a run that
    ended before."""
    settling: Array
    """Time from arrival until the load stays within SETTLED of the goal [s]; all of the time after
    arrival if it has not settled."""
    effort: Array
    """Root mean square input, as a share of the limits."""
    tension: Array
    """Lowest tension of any rope [N]."""
    settled: Array
    """1 where the load stays within SETTLED of the goal for the last LASTING or longer, else 0."""
    failed: Array
    """1 where the run ended early, else 0."""
    turn: Array
    """Root mean square angle of a platform from its reference, while the run lasts [rad]; NaN for
    a load."""


def measure(record: Record) -> Metrics:
    """The metrics of N runs."""
    distance, alive, counted = record.distance, record.alive, record.counted
    ends = record.times[record.last]
    since = np.minimum(record.times[:, None], ends) - record.arrival
    after = counted & (since >= -ROUNDED)
    failed = ~np.take_along_axis(alive, record.last[None], axis=0)[0]
    near = distance <= SETTLED
    settled = ~failed & lasts(since, near)
    turn = np.full(alive.shape, np.nan) if record.turn is None else record.turn
    driven = alive & counted
    lowest = np.where(driven, record.tensions.min(axis=2), np.inf).min(axis=0)
    return Metrics(
        rmse=_rms(np.square(distance), counted),
        largest=distance.max(axis=0),
        swing=_swing(record.load[..., :-1], after & ~failed),
        settling=np.where(settled, entry(since, near), since[-1]),
        effort=_rms(np.square(record.inputs).mean(axis=2), driven),
        tension=np.where(np.isfinite(lowest), lowest, 0.0),
        settled=settled.astype(float),
        failed=failed.astype(float),
        turn=_rms(np.square(turn), driven),
    )


def over_hold(record: Record, parts: int) -> Array:
    """Root mean square distance in equal parts of the time after arrival [m], shape (parts, N)."""
    ends = record.times[record.last]
    share = (record.times[:, None] - record.arrival) / (ends - record.arrival)
    squares = np.square(record.distance)
    place = np.floor(parts * share - ROUNDED)
    chosen = record.counted & (share > ROUNDED)
    return np.array([_rms(squares, chosen & (place == part)) for part in range(parts)])


def _rms(squares: Array, chosen: Mask) -> Array:
    """Root of the mean of squares (T, N) over the chosen periods, 0 without any, shape (N,)."""
    total = np.where(chosen, squares, 0.0).sum(axis=0)
    return np.asarray(np.sqrt(total / np.maximum(chosen.sum(axis=0), 1)))


def between(angles: Array, others: Array) -> Array:
    """Angle of the rotation between Bryant angles (..., 3) and others [rad], shape (...)."""
    # Rx(alpha) Ry(beta) Rz(gamma), Y 6.56.
    first, second = (Rotation.from_euler("XYZ", np.reshape(a, (-1, 3))) for a in (angles, others))
    return np.asarray((first.inv() * second).magnitude().reshape(np.shape(angles)[:-1]))


def _swing(horizontal: Array, chosen: Mask) -> Array:
    """Half the diagonal of the box around the chosen positions (T, N, q) [m], shape (N,)."""
    mask = chosen[..., None]
    high = np.where(mask, horizontal, -np.inf).max(axis=0)
    low = np.where(mask, horizontal, np.inf).min(axis=0)
    travel = np.where(np.any(chosen, axis=0, keepdims=True).T, high - low, np.nan)
    return np.asarray(0.5 * np.linalg.norm(travel, axis=1))


def entry(since: Array, near: Mask) -> Array:
    """When a run comes near its goal and stays there to the end.

    Parameters
    ----------
    since
        Ends of T control periods since the reference's arrival [s], shape (T, N).
    near
        Whether the run is near its goal then, shape (T, N).

    Returns
    -------
    Array
        End of the first period, not before arrival, from which on all are near [s], shape (N,);
        infinite where the last one is not.
    """
    lasting = np.logical_and.accumulate(near[::-1])[::-1] & (since >= -ROUNDED)
    found = np.take_along_axis(since, lasting.argmax(axis=0)[None], axis=0)[0]
    return np.where(lasting[-1], np.maximum(found, 0.0), np.inf)


def lasts(since: Array, near: Mask) -> Mask:
    """Whether runs stay near their goals for the last `LASTING` or longer, as `entry`, (N,)."""
    return np.asarray(entry(since, near) <= since[-1] - LASTING + ROUNDED)


@dataclass(frozen=True)
class Estimate:
    """A mean with its confidence interval."""

    mean: float
    low: float
    high: float

    def scaled(self, factor: float) -> "Estimate":
        """The same in another unit, one of whose is 1 / `factor` of this one's."""
        return Estimate(factor * self.mean, factor * self.low, factor * self.high)

    def format(self, digits: int, sign: str = "-") -> tuple[str, str]:
        """Mean and interval as text; a plus sign stands before positive numbers if "+"."""
        if not np.isfinite(self.mean):
            return "-", ""
        low, high = (f"{value:{sign}.{digits}f}" for value in (self.low, self.high))
        return f"{self.mean:{sign}.{digits}f}", f"[{low}, {high}]"


def paired_means(values: Array, seed: int = 0, resamples: int = RESAMPLES) -> Array:
    """Bootstrap means of several controllers over the same scenarios.

    Parameters
    ----------
    values
        Shape (controllers, N), scenario by scenario the same; NaN where there is none.
    seed
        Seed of the resampling.
    resamples
        Number R of resamples.

    Returns
    -------
    Array
        Shape (R, controllers); each row is the means over one resample of the scenarios, the
        same for all controllers, so that differences and ratios of columns are paired.
    """
    finite = np.isfinite(values)
    weights = _weights(values.shape[1], seed, resamples)
    with np.errstate(invalid="ignore"):  # a resample without any value has no mean
        return np.asarray((weights @ np.where(finite, values, 0.0).T) / (weights @ finite.T))


@lru_cache(maxsize=4)
def _weights(count: int, seed: int, resamples: int) -> Array:
    """How often each of `count` scenarios stands in each resample, shape (resamples, count)."""
    rng = np.random.default_rng(seed)
    return rng.multinomial(count, np.full(count, 1.0 / count), size=resamples).astype(np.float64)


def relative_change(values: Array, base: Array, seed: int = 0) -> Estimate:
    """Mean of `values` over mean of `base`, minus 1, both (N,), with its paired interval."""
    means = paired_means(np.stack((values, base)), seed)
    ratio = float(values.mean() / base.mean()) if base.mean() else np.nan
    with np.errstate(divide="ignore", invalid="ignore"):
        return _interval(ratio - 1.0, means[:, 0] / means[:, 1] - 1.0)


def estimates(values: Sequence[Array], seed: int = 0) -> list[Estimate]:
    """The mean of each controller's values (N,), with intervals from one paired resampling."""
    means = paired_means(np.stack(values), seed)
    finite = [value[np.isfinite(value)] for value in values]
    return [
        _interval(float(value.mean()) if value.size else np.nan, column)
        for value, column in zip(finite, means.T, strict=True)
    ]


def _interval(value: float, resamples: Array) -> Estimate:
    tail = 50.0 * (1.0 - CONFIDENCE)
    finite = resamples[np.isfinite(resamples)]
    low, high = np.percentile(finite, (tail, 100.0 - tail)) if finite.size else (np.nan, np.nan)
    return Estimate(value, float(low), float(high))
