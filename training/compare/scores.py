"""What controllers are worth on each set of episodes, against the best classical one.

A controller is measured against the classical controller with the lowest mean error on unseen moves
among those that see no more than it does: a learned one that sees the load has to beat a classical
one that sees the load.  Differences are paired, episode by episode.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...models.types import Array
from .contenders import SENSORS, Contender
from .metrics import Estimate, estimates, relative_change
from .runs import Run

DECISIVE = "random"
"""The set that decides which classical controller is best; the first one where it is not driven."""
WORST = 0.05
"""Share of the episodes whose mean is that of the worst."""


@dataclass(frozen=True)
class Score:
    """A controller's worth on one set of N episodes."""

    rmse: Estimate
    """Root mean square distance from the reference, mean over the episodes [m]."""
    median: float
    """The same, median [m]."""
    worst: float
    """The same, mean of the worst 5 % of the episodes, one at least [m]."""
    settled: float
    """Share of the episodes after which the load has settled."""
    early_ends: int
    """Number of episodes that ended early."""
    hold: tuple[float, ...]
    """Root mean square distance in equal parts of the time after arrival, mean [m]."""
    drift: Estimate
    """The last of these over the first."""
    against: str
    """Name of the best classical controller that sees no more."""
    ratio: Estimate | None
    """Mean over that one's; None of itself."""
    worse: float | None
    """Share of the episodes with a larger error than that one's."""


Scores = Mapping[str, Mapping[str, Score]]
"""Every controller's score on every set, by the set's and the controller's name."""


def scores_of(sets: Mapping[str, Sequence[Run]]) -> Scores:
    """Scores of runs of the same controllers on each set, by its name."""
    deciding = sets.get(DECISIVE) or next(iter(sets.values()))
    rivals = {run.name: rival_of(run.contender, deciding) for run in deciding}
    return {name: _on_set(runs, rivals) for name, runs in sets.items()}


def rival_of(contender: Contender, runs: Sequence[Run]) -> str:
    """The classical controller with the lowest mean error among those that see no more."""
    seen = SENSORS.index(contender.sensors)
    fair = [
        run
        for run in runs
        if not run.contender.learned and SENSORS.index(run.contender.sensors) <= seen
    ]
    return min(fair, key=lambda run: float(run.metrics.rmse.mean())).name


def worst_mean(values: Array) -> float:
    """Mean of the largest 5 % of N values, one at least."""
    count = max(1, round(WORST * len(values)))
    return float(np.sort(values)[-count:].mean())


def _on_set(runs: Sequence[Run], rivals: Mapping[str, str]) -> dict[str, Score]:
    errors = {run.name: run.metrics.rmse for run in runs}
    means = estimates(list(errors.values()))
    return {
        run.name: _score(run, mean, rivals[run.name], errors[rivals[run.name]])
        for run, mean in zip(runs, means, strict=True)
    }


def _score(run: Run, mean: Estimate, against: str, rival: Array) -> Score:
    errors, hold = run.metrics.rmse, run.hold
    assert hold is not None
    itself = run.name == against
    return Score(
        rmse=mean,
        median=float(np.median(errors)),
        worst=worst_mean(errors),
        settled=float(run.metrics.settled.mean()),
        early_ends=int(run.metrics.failed.sum()),
        hold=tuple(hold.mean(axis=1).tolist()),
        drift=_over(hold[-1], hold[0]),
        against=against,
        ratio=None if itself else _over(errors, rival),
        worse=None if itself else float((errors > rival).mean()),
    )


def _over(values: Array, base: Array) -> Estimate:
    """Mean of values over that of others, with its paired interval."""
    change = relative_change(values, base)
    return Estimate(change.mean + 1.0, change.low + 1.0, change.high + 1.0)


def millimetres(value: float) -> str:
    """A length [m] in millimetres, with three digits at most."""
    value *= 1e3
    if value >= 100:
        return f"{value:.0f}"
    return f"{value:.1f}" if value >= 1 else f"{value:.2g}"
