"""What the runs of a comparison are: contenders over the same scenarios, on one set or several."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any

import numpy as np
from rich.text import Text

from ...models.types import Array
from .contenders import BASE, Contender
from .episode_sets import Episode
from .metrics import RESAMPLES, Estimate, estimates, relative_change

INTERVALS = f"Intervals: paired bootstrap, {RESAMPLES} resamples."


@dataclass(frozen=True)
class Column:
    """A column of the table with the mean of a metric and its interval."""

    metric: str
    """Field of the metrics."""
    heading: str
    """Heading with the unit."""
    factor: float
    """That unit's number in one of the metric's own."""
    digits: int
    """Digits after the point."""


@dataclass(frozen=True, eq=False)
class Run:
    """One contender's runs over N scenarios."""

    contender: Contender
    times: Array
    """Ends of the control periods [s], shape (T,)."""
    distance: Array
    """Distance of the load or object from its reference over time [m], shape (T, N)."""
    metrics: Any
    """A dataclass whose fields hold a number, or text, for each scenario, shape (N,)."""
    hold: Array | None = None
    """Root mean square distance in equal parts of the time after arrival [m], shape (parts, N)."""

    @property
    def name(self) -> str:
        """The contender's name."""
        return self.contender.name


@dataclass(frozen=True, eq=False)
class OnSet:
    """Contenders' runs on one set of episodes."""

    title: str
    """What the set asks."""
    episodes: Sequence[Episode]
    runs: Sequence[Run]


@dataclass(frozen=True, eq=False)
class Comparison:
    """Contenders' runs over the same scenarios, and how to report them."""

    kind: str
    """"rig" or "hand"."""
    name: str
    """Name of the rig or hand."""
    thing: str
    """What is to follow its reference: "Load" or "Object"."""
    units: Mapping[str, str]
    """Units of the metrics."""
    scenarios: Sequence[Any]
    """The N scenarios."""
    arrival: float
    """When the reference reaches its goal [s]."""
    runs: Sequence[Run]
    """One for each contender that could run."""
    absent: Sequence[Contender]
    """Contenders without the policy that they need."""
    refused: Mapping[str, str]
    """Names of contenders that do not bear the rig or hand, and why."""
    columns: Sequence[Column]
    """Columns of the table with an interval."""
    cells: Mapping[str, Callable[[Any], str | Text]]
    """More columns: heading, and the cell from a run's metrics."""
    notes: str
    """What the table's words mean."""
    residual: str
    """Where the policy comes from."""
    counts: Mapping[str, Callable[[Any], int]] = field(default_factory=dict)
    """More entries of the summary: name, and the number from a run's metrics."""
    relative: bool = False
    """Whether the tracking error of every run is set against that of `BASE`."""
    sets: Mapping[str, OnSet] = field(default_factory=dict)
    """All sets of episodes by name, of cranes; the first one has the runs above."""
    left_out: Sequence[str] = ()
    """Sets that the rig cannot make, and why."""

    @property
    def heading(self) -> str:
        """Heading of table and figure."""
        number = len(self.scenarios)
        if list(self.scenarios) == [type(self.scenarios[0])()]:
            return f"{self.name}: undisturbed"
        return f"{self.name}: {number} disturbed scenario{'s' if number > 1 else ''}"

    @cached_property
    def means(self) -> dict[str, dict[str, Estimate]]:
        """Mean and interval of every metric that is a number, of every contender by its name."""
        means: dict[str, dict[str, Estimate]] = {run.name: {} for run in self.runs}
        for item in fields(self.runs[0].metrics):
            values = [getattr(run.metrics, item.name) for run in self.runs]
            if isinstance(values[0], np.ndarray):
                for run, value in zip(self.runs, estimates(values), strict=True):
                    means[run.name][item.name] = value
        return means

    @cached_property
    def changes(self) -> dict[str, Estimate]:
        """Relative change of the tracking error against `BASE`, of every other contender."""
        base = next(run for run in self.runs if run.name == BASE)
        return {
            run.name: relative_change(run.metrics.rmse, base.metrics.rmse)
            for run in self.runs
            if run is not base
        }
