"""The table and the files of a comparison, of cranes as of hands."""

from collections.abc import Iterator, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from rich.text import Text

from ...models.files import write_text
from ..as_json import json_text, show_json
from ..console import NARROW, console
from ..tables import table, write_csv
from .contenders import BASE
from .runs import Comparison, Run
from .set_report import sets_summary, show_sets

WIDE_ENOUGH = 110
"""Columns from which on the table has intervals; they are in the summary in any case."""
FIRST = 4
"""Number of columns of the table where there is room for no more."""


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
    wide = many and out.width >= WIDE_ENOUGH
    columns, cells = comparison.columns, comparison.cells
    if out.width < NARROW:
        columns = columns[:FIRST]
    rows = table(
        comparison.heading + ", mean" * many + " and 95 % interval" * wide,
        "controller", *(column.heading for column in columns), *cells,
    )  # fmt: skip
    rows.columns[0].no_wrap = True
    for run in comparison.runs:
        style = "bold" if run.contender.emphasis else ""
        row: list[str | Text] = [Text(run.name, style=style)]
        for column in columns:
            value = comparison.means[run.name][column.metric].scaled(column.factor)
            middle, interval = value.format(column.digits)
            row.append(Text.assemble(middle, "\n", (interval, "dim")) if wide else middle)
        rows.add_row(*row, *(cell(run.metrics) for cell in cells.values()))
    out.print(rows)
    if comparison.absent:
        names = " and ".join(contender.name for contender in comparison.absent)
        out.print(f"without a policy: {names}", style="dim", soft_wrap=True)
    for name, reason in comparison.refused.items():
        out.print(f"left out: {name}: {reason}", style="dim", soft_wrap=True)
    for run in comparison.runs:
        if many and comparison.relative and run.contender.learned:
            middle, interval = comparison.changes[run.name].scaled(100.0).format(1, sign="+")
            out.print(f"{run.name}: tracking error {middle} % against {BASE} {interval}")
    out.print(comparison.notes, style="dim", soft_wrap=True)
    if comparison.sets:
        show_sets(comparison)
    out.print(f"wrote {folder}/scenarios.csv, summary.json, figure.png", soft_wrap=True)
    out.print(f"residual: {comparison.residual}", style="dim", soft_wrap=True)


def write(comparison: Comparison, folder: Path) -> None:
    """Write scenarios.csv and summary.json.

    Raises
    ------
    OutputError
        A file cannot be written.
    """
    settings = [item.name for item in fields(comparison.scenarios[0])]
    metrics = [item.name for item in fields(comparison.runs[0].metrics)]
    asked = ("set", "start", "goal", "duration", "hold") if comparison.sets else ()
    rows = (
        (i, *(_setting(getattr(scenario, name)) for name in settings), *what, run.name,
         *(_finite(getattr(run.metrics, name)[i]) for name in metrics))
        for scenarios, runs in _groups(comparison)
        for run in runs
        for i, (scenario, *what) in enumerate(scenarios)
    )  # fmt: skip
    columns = ("scenario", *settings, *asked, "controller", *metrics)
    write_csv(folder / "scenarios.csv", columns, rows)
    write_text(folder / "summary.json", json_text(summary(comparison)))


def _groups(comparison: Comparison) -> Iterator[tuple[list[tuple[Any, ...]], Sequence[Run]]]:
    """Scenarios, of sets with what is asked in them, and the runs over these."""
    if not comparison.sets:
        yield [(scenario,) for scenario in comparison.scenarios], comparison.runs
    for name, on_set in comparison.sets.items():
        yield [
            (each.scenario, name, _setting(each.move.start), _setting(each.move.goal),
             each.move.duration, each.hold)
            for each in on_set.episodes
        ], on_set.runs  # fmt: skip


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
        "refused": comparison.refused,
        "residual": comparison.residual,
    }
    if comparison.relative:
        facts[f"change of rmse against {BASE}"] = comparison.changes
    if comparison.sets:
        facts |= sets_summary(comparison)
    return facts


def _setting(value: Any) -> Any:
    """A number of a scenario for CSV, or several in one cell."""
    return " ".join(map(repr, value)) if isinstance(value, tuple) else value


def _finite(value: Any) -> Any:
    """A metric for CSV, which knows no NaN; None where there is no number."""
    if isinstance(value, str):
        return value
    return float(value) if np.isfinite(value) else None
