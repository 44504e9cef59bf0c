"""The table and the files of a comparison, of cranes as of hands."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from rich.text import Text

from ...models.files import write_text
from ...models.types import Array
from ..as_json import json_text, show_json
from ..console import console
from ..tables import table, write_csv
from .contenders import BASE, Contender
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

    @property
    def name(self) -> str:
        """The contender's name."""
        return self.contender.name


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


def report(comparison: Comparison, folder: Path, as_json: bool = False) -> None:
    """Write the files, and print the table or, as JSON, the summary.

    Raises
    ------
    OutputError
        A file cannot be written.
    """
    write(comparison, folder)
    if as_json:
        show_json(summary(comparison))
    else:
        show(comparison, folder)


def show(comparison: Comparison, folder: Path) -> None:
    """Print the table, what its words mean, and where the files are."""
    many, out = len(comparison.scenarios) > 1, console()
    columns, cells = comparison.columns, comparison.cells
    rows = table(
        comparison.heading + (", mean and 95 % interval" if many else ""),
        "controller", *(column.heading for column in columns), *cells,
    )  # fmt: skip
    for run in comparison.runs:
        style = "bold" if run.contender.emphasis else ""
        row: list[str | Text] = [Text(run.name, style=style)]
        for column in columns:
            value = comparison.means[run.name][column.metric].scaled(column.factor)
            middle, interval = value.format(column.digits)
            row.append(Text.assemble(middle, "\n", (interval, "dim")) if many else middle)
        rows.add_row(*row, *(cell(run.metrics) for cell in cells.values()))
    for contender in comparison.absent:
        rows.add_row(contender.name, Text("no policy\nshipped", style="dim"))
    out.print(rows)
    for run in comparison.runs:
        if many and comparison.relative and run.contender.learned:
            middle, interval = comparison.changes[run.name].scaled(100.0).format(1, sign="+")
            out.print(f"{run.name}: tracking error {middle} % against {BASE} {interval}")
    out.print(comparison.notes, style="dim", soft_wrap=True)
    out.print(f"wrote {folder}/scenarios.csv, summary.json, figure.png", soft_wrap=True)
    out.print(f"residual: {comparison.residual}", style="dim", soft_wrap=True)


def write(comparison: Comparison, folder: Path) -> None:
    """Write scenarios.csv and summary.json.

    Raises
    ------
    OutputError
        A file cannot be written.
    """
    runs, scenarios = comparison.runs, comparison.scenarios
    settings = [item.name for item in fields(scenarios[0])]
    metrics = [item.name for item in fields(runs[0].metrics)]
    rows = (
        (i, *(_setting(getattr(scenario, name)) for name in settings), run.name,
         *(_finite(getattr(run.metrics, name)[i]) for name in metrics))
        for run in runs
        for i, scenario in enumerate(scenarios)
    )  # fmt: skip
    write_csv(folder / "scenarios.csv", ("scenario", *settings, "controller", *metrics), rows)
    write_text(folder / "summary.json", json_text(summary(comparison)))


def summary(comparison: Comparison) -> dict[str, Any]:
    """Mean and interval of every metric of every contender, with units."""
    runs = comparison.runs
    facts: dict[str, Any] = {
        comparison.kind: comparison.name,
        "scenarios": len(comparison.scenarios),
        "arrival_s": comparison.arrival,
        "units": comparison.units,
        "controllers": {
            run.name: comparison.means[run.name]
            | {name: count(run.metrics) for name, count in comparison.counts.items()}
            for run in runs
        },
        "absent": [contender.name for contender in comparison.absent],
        "residual": comparison.residual,
    }
    if comparison.relative:
        facts[f"change of rmse against {BASE}"] = comparison.changes
    return facts


def _setting(value: Any) -> Any:
    """A number of a scenario for CSV, or several in one cell."""
    return " ".join(map(repr, value)) if isinstance(value, tuple) else value


def _finite(value: Any) -> Any:
    """A metric for CSV, which knows no NaN; None where there is no number."""
    if isinstance(value, str):
        return value
    return float(value) if np.isfinite(value) else None
