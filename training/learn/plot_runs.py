"""How training went, drawn: error on judged moves and loss over iterations.

    flatrig plot runs/overhead_crane-sway-seed0 runs/overhead_crane-sway-seed1 -o curves.png

Runs that differ in nothing but the seed are one curve: its mean, with a band from the least to the
most of them.
"""

import csv
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...models.errors import OptionError, did_you_mean
from ...models.reading import read_json, read_text
from ...models.types import Array
from .. import options, plots
from ..console import console
from ..option_values import output_file
from .run_folder import TABLES

UNTOLD = ("seed", "seeds", "output", "resume", "threads", "tensorboard", "every")
"""Options that do not make a run another one, but a repetition of it."""
PANELS = (
    ("evaluation.csv", "rmse", 1e3, "mean error, judged moves [mm]"),
    ("evaluation.csv", "worst", 1e3, "worst 5 %, judged moves [mm]"),
    ("progress.csv", "loss", 1.0, "loss of the fit"),
)
"""What is drawn: its file and column, the factor to its unit, its words."""


@dataclass(frozen=True)
class Run:
    """One result folder of `flatrig train`."""

    name: str
    kind: str
    """The same for runs that differ in their seed alone."""
    tables: Mapping[str, Mapping[str, Array]]
    """Columns of each file by name, each of shape (rows,)."""

    def series(self, file: str, column: str) -> tuple[Array, Array]:
        """A column over the iterations; without rows where the run has none such."""
        table = self.tables[file]
        if not {"iteration", column} <= set(table):
            return np.zeros(0), np.zeros(0)
        return table["iteration"], table[column]


def main(command: options.Plot) -> None:
    """Read the runs and write the figure.

    Raises
    ------
    OptionError
        A folder holds no run, or one without rows, or the output is no picture.
    OutputError
        The figure cannot be written.
    """
    if not command.runs:
        raise OptionError(
            "name one or several folders of runs, such as runs/overhead_crane-sway-seed0"
        )
    path = output_file(command.output or "results", "runs.png")
    plots.check_picture(path)
    runs = [read_run(Path(folder)) for folder in command.runs]
    draw(runs, path)
    console().print(f"wrote {path}", soft_wrap=True)


def read_run(folder: Path) -> Run:
    """A result folder.

    Raises
    ------
    OptionError
        It holds no run, or one without rows.
    """
    if not (folder / "config.json").exists():
        raise OptionError(f"{folder} holds no run: there is no config.json{_near(folder)}")
    config = read_json(folder / "config.json", OptionError)
    tables = {name: _columns(folder / name) for name in TABLES}
    if not tables["progress.csv"]:
        raise OptionError(f"{folder} holds a run without a single iteration")
    name = folder.resolve().name
    return Run(name.removesuffix(f"-seed{_seed(config)}"), _kind(config), tables)


def draw(runs: list[Run], path: str | Path) -> None:
    """Draw a panel for each of `PANELS` that a run has, and write it."""
    kinds: dict[str, list[Run]] = {}
    for run in runs:
        kinds.setdefault(run.kind, []).append(run)
    panels = [panel for panel in PANELS if any(len(run.series(*panel[:2])[0]) for run in runs)]
    drawn, axes = plots.figure(3.6 * len(panels), 3.4, ncols=len(panels), squeeze=False)
    for ax, (file, column, factor, words) in zip(axes[0], panels, strict=True):
        for number, alike in enumerate(kinds.values()):
            colour = plots.COLOURS[1 + number % (len(plots.COLOURS) - 1)]
            label = alike[0].name + (f" ({len(alike)} seeds)" if len(alike) > 1 else "")
            steps, least, mean, most = together([run.series(file, column) for run in alike])
            ax.plot(steps, factor * mean, color=colour, label=label, marker=".")
            ax.fill_between(steps, factor * least, factor * most, color=colour, alpha=0.2)
            before = alike[0].series(file, f"{column}_base")[1]
            if len(before):
                told = "without a residual" if number == 0 else None
                ax.axhline(
                    factor * before[0], color=colour, linestyle=":", linewidth=1.0, label=told
                )
        plots.title(ax, words)
        ax.set_xlabel("iteration")
        ax.set_ylim(bottom=0.0)
    plots.legend_below(drawn, axes[0, 0])
    plots.save(drawn, path)


def together(series: list[tuple[Array, Array]]) -> tuple[Array, Array, Array, Array]:
    """Iterations that all of some series cover, and least, mean and most there, (steps,) each."""
    series = [one for one in series if len(one[0])]
    if not series:
        return (np.zeros(0),) * 4
    first, last = max(x[0] for x, _ in series), min(x[-1] for x, _ in series)
    steps = np.unique(np.concatenate([x for x, _ in series]))
    steps = steps[(steps >= first) & (steps <= last)]
    values = np.array([np.interp(steps, x, y) for x, y in series])
    return steps, values.min(axis=0), values.mean(axis=0), values.max(axis=0)


def _columns(path: Path) -> dict[str, Array]:
    """Columns of numbers of a table; none where there is no file."""
    if not path.exists():
        return {}
    rows = list(csv.DictReader(io.StringIO(read_text(path, OptionError))))
    columns: dict[str, Array] = {}
    for name in rows[0] if rows else ():
        try:
            columns[name] = np.array([float(row[name]) for row in rows])
        except (TypeError, ValueError):
            continue  # words, such as which encoders
    return columns


def _seed(config: Mapping[str, Any]) -> Any:
    return config.get("seed", config.get("options", {}).get("seed"))


def _kind(config: Mapping[str, Any]) -> str:
    """All that a run was, but its seed and how it was made."""
    asked = {k: v for k, v in config.get("options", {}).items() if k not in UNTOLD}
    kept = {k: v for k, v in config.items() if k not in ("command", "seed", "versions", "machine")}
    return json.dumps(kept | {"options": asked}, sort_keys=True)


def _near(folder: Path) -> str:
    """A suggestion among the folders beside it."""
    beside = folder.parent
    known = [path.name for path in beside.iterdir() if path.is_dir()] if beside.is_dir() else []
    return did_you_mean(folder.name, known)
