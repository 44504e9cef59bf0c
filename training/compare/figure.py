"""The figure of a comparison: errors over time, and how they are spread over the scenarios."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .. import plots
from .contenders import BASE
from .runs import Comparison, Run

OTHERS = "#b0b0b0"
"""Colour of runs without one of their own."""


def draw(comparison: Comparison, path: Path) -> None:
    """Draw the distances of all runs and write them as PNG.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    runs, times = comparison.runs, comparison.runs[0].times
    drawn, (left, right) = plots.figure(10.0, 4.4, ncols=2, width_ratios=(1.55, 1.0))
    plots.heading(drawn, comparison.heading.replace("_", " "))
    shown = _shown(runs)
    palette = dict(zip((run.name for run in shown), plots.COLOURS, strict=False))
    colours = [palette.get(run.name, OTHERS) for run in runs]
    for run in shown:
        colour = palette[run.name]
        low, middle, high = 1e3 * np.percentile(run.distance, (10, 50, 90), axis=1)
        left.fill_between(times, low, high, color=colour, alpha=0.16, linewidth=0)
        left.plot(times, middle, color=colour, linewidth=1.8, label=run.name)
    left.set_yscale("log")
    # The start, at rest on the reference, would stretch the axis down to rounding errors.
    lowest = min(float(np.median(run.distance, axis=1)[len(times) // 20 :].min()) for run in shown)
    left.set_ylim(bottom=1e3 * max(lowest, 1e-7) / 4.0)
    left.axvline(comparison.arrival, color="#404040", linewidth=0.9, linestyle=(0, (4, 3)))
    left.annotate(
        "arrival", (comparison.arrival, 1.0), (4, -2), xycoords=("data", "axes fraction"),
        textcoords="offset points", va="top", color="#404040", fontsize=8,
    )  # fmt: skip
    left.set(xlabel="time [s]", xlim=(times[0], times[-1]), ylabel="distance from reference [mm]")
    many = len(comparison.scenarios) > 1
    spread = ": median, and 10 to 90 % of scenarios" if many else ""
    plots.title(left, f"{comparison.thing} error over time{spread}")
    _draw_spread(right, runs, colours)
    plots.title(right, "Each dot is a scenario; bar: middle half" if many else "Over move and hold")
    plots.save(drawn, path)


def _shown(runs: Sequence[Run]) -> Sequence[Run]:
    """The runs whose errors over time are told apart by colours: all, or the most telling ones."""
    most = len(plots.COLOURS)
    if len(runs) <= most:
        return runs
    by_error = sorted(runs, key=lambda run: float(run.metrics.rmse.mean()))
    ranked = [run for run in by_error if run.contender.learned]
    ranked += [run for run in runs if run.name == BASE]
    ranked += [run for run in by_error if run not in ranked]
    return [run for run in runs if run in ranked[:most]]


def _draw_spread(axes: Any, runs: Sequence[Run], colours: Sequence[str]) -> None:
    """Each scenario's tracking error as a dot, with quartiles, one row for a controller."""
    rng = np.random.default_rng(0)
    for row, (run, colour) in enumerate(zip(runs, colours, strict=True)):
        values = 1e3 * np.sqrt(np.square(run.distance).mean(axis=0))
        jitter = row + rng.uniform(-0.24, 0.24, len(values))
        if len(values) > 1:
            axes.plot(values, jitter, "o", color=colour, markersize=3, alpha=0.4, markeredgewidth=0)
        low, middle, high = np.percentile(values, (25, 50, 75))
        bar = {"linewidth": 5, "alpha": 0.9, "solid_capstyle": "round"}
        axes.plot((low, high), (row, row), color=colour, **bar)
        dot = {"markersize": 6.5, "markeredgecolor": colour, "markeredgewidth": 1.6}
        axes.plot(middle, row, "o", color="white", **dot)
    axes.set_xscale("log")
    axes.set_yticks(range(len(runs)), [run.name for run in runs])
    for tick, colour in zip(axes.get_yticklabels(), colours, strict=True):
        tick.set_color(colour)
        tick.set_fontweight("bold")
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False, axis="y")
    axes.invert_yaxis()
    axes.set(xlabel="tracking RMSE [mm]")
