"""The table, the files and the figure of a comparison."""

import json
import os
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.text import Text

from ...envs.crane.disturbances import Scenario
from ...models import Rig
from ...models.files import OutputError, write_text
from ..console import console
from ..policy import Policy
from ..tables import table, write_csv
from .metrics import NAMES, RESAMPLES, SETTLED, Estimate, estimates, relative_change

if TYPE_CHECKING:
    from .compare_cranes import Run

COLUMNS = {
    "rmse": ("tracking\nRMSE [mm]", 1e3, 1),
    "largest": ("largest\nerror [mm]", 1e3, 0),
    "swing": ("swing after\narrival [mm]", 1e3, 1),
    "settling": ("settling\ntime [s]", 1.0, 2),
    "effort": ("effort\n[% of limit]", 1e2, 1),
    "tension": ("lowest\ntension [N]", 1.0, 0),
}
"""Metric: heading, factor of the unit shown, digits."""
TURN = {"turn": ("turned\nby [deg]", 180.0 / np.pi, 2)}
"""The same where a platform has a reference for its orientation."""


def make_folder(folder: Path) -> None:
    """Make a result folder, or say at once that it cannot be written.

    Raises
    ------
    OutputError
        It cannot.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot write {folder}: {error.strerror}") from None
    if not os.access(folder, os.W_OK):
        raise OutputError(f"cannot write {folder}: Permission denied")


def summary(runs: Sequence["Run"]) -> dict[str, dict[str, Estimate]]:
    """Mean and interval of every metric of every controller."""
    found: dict[str, dict[str, Estimate]] = {run.name: {} for run in runs}
    for name in NAMES:
        values = estimates([getattr(run.metrics, name) for run in runs])
        for run, value in zip(runs, values, strict=True):
            found[run.name][name] = value
    return found


def changes(runs: Sequence["Run"], base: str) -> dict[str, Estimate]:
    """Relative change of the tracking error against the controller `base`."""
    reference = next(run for run in runs if run.name == base)
    return {
        run.name: relative_change(run.metrics.rmse, reference.metrics.rmse)
        for run in runs
        if run is not reference
    }


def heading(rig: Rig, scenarios: Sequence[Scenario]) -> str:
    """Of a table or figure."""
    if list(scenarios) == [Scenario()]:
        return f"{rig.name}: undisturbed"
    plural = "s" if len(scenarios) > 1 else ""
    return f"{rig.name}: {len(scenarios)} disturbed scenario{plural}"


def show(
    rig: Rig,
    runs: Sequence["Run"],
    scenarios: Sequence[Scenario],
    folder: Path,
    policy: Policy | None,
) -> None:
    """Print the table."""
    from .compare_cranes import BASE, RESIDUAL

    many = len(scenarios) > 1
    columns = dict(COLUMNS)
    if np.isfinite(runs[0].metrics.turn).any():
        columns |= TURN
    shown = table(
        heading(rig, scenarios) + (", mean and 95 % interval" if many else ""),
        "controller", *(name for name, _, _ in columns.values()), "settled", "ended\nearly",
    )  # fmt: skip
    means, relative = summary(runs), changes(runs, BASE)
    for run in runs:
        cells: list[Text | str] = [Text(run.name, style="bold" if run.name == RESIDUAL else "")]
        for name, (_, factor, digits) in columns.items():
            value = means[run.name][name]
            scaled = Estimate(factor * value.mean, factor * value.low, factor * value.high)
            middle, interval = scaled.format(digits)
            cells.append(Text(middle))
            if many:
                cells[-1] = Text.assemble(middle, "\n", (interval, "dim"))
        cells += [str(int(run.metrics.settled.sum())), str(int(run.metrics.failed.sum()))]
        shown.add_row(*cells)
    out = console()
    if policy is None:
        shown.add_row(RESIDUAL, Text("no policy\nshipped", style="dim"))
    out.print(shown)
    for name, change in relative.items():
        if many and name == RESIDUAL:
            middle, interval = _percent(change)
            out.print(f"{name}: tracking error {middle} against {BASE} {interval}")
    notes = [
        f"Settled: stays within {1e3 * SETTLED:g} mm of the goal; one that does not counts with "
        "the whole time after arrival.",
        "After an early end the load counts as resting, and its swing not at all.",
    ]
    if many:
        notes.append(f"Intervals: paired bootstrap, {RESAMPLES} resamples.")
    out.print(" ".join(notes), style="dim", soft_wrap=True)
    out.print(f"wrote {folder}/scenarios.csv, summary.json, figure.png", soft_wrap=True)


def _percent(change: Estimate) -> tuple[str, str]:
    low, high = 100 * change.low, 100 * change.high
    return f"{100 * change.mean:+.1f} %", f"[{low:+.1f}, {high:+.1f}]"


def _finite(value: float) -> float | None:
    """For CSV and JSON; None where there is no number."""
    return float(value) if np.isfinite(value) else None


def _plain(value: Estimate) -> dict[str, float | None]:
    """For JSON, which knows no NaN."""
    return {key: _finite(number) for key, number in asdict(value).items()}


def write(folder: Path, rig: Rig, runs: Sequence["Run"], scenarios: Sequence[Scenario]) -> None:
    """Write scenarios.csv, summary.json and figure.png.

    Raises
    ------
    OutputError
        A file cannot be written.
    """
    from .. import plots
    from .compare_cranes import BASE

    settings = [item.name for item in fields(Scenario)]
    rows = (
        (i, *(getattr(scenario, name) for name in settings), run.name,
         *(_finite(getattr(run.metrics, name)[i]) for name in NAMES))
        for run in runs
        for i, scenario in enumerate(scenarios)
    )  # fmt: skip
    write_csv(folder / "scenarios.csv", ("scenario", *settings, "controller", *NAMES), rows)
    relative = changes(runs, BASE)
    facts = {
        "rig": rig.name,
        "scenarios": len(scenarios),
        "units": "m, rad, s, N, shares of the limits",
        "controllers": {
            name: {metric: _plain(value) for metric, value in values.items()}
            for name, values in summary(runs).items()
        },
        f"change of rmse against {BASE}": {k: _plain(v) for k, v in relative.items()},
    }
    write_text(folder / "summary.json", json.dumps(facts, indent=2) + "\n")
    record = runs[0].record
    plots.comparison(
        heading(rig, scenarios).replace("_", " "),
        [run.name for run in runs],
        record.times,
        float(np.min(record.arrival)),
        [run.record.distance for run in runs],
        folder / "figure.png",
    )
