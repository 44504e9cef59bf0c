"""Y chapters 4 to 6: numerical solutions beside the exact one, and snapshots.

The exact solution is `feedforward.solve`.  Where the source's move is not smooth enough for it (the
Navy crane in space with a heavy pulley), derivatives at its joins are one-sided, as in `check`.
"""

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from rich.table import Table

from ...feedforward import Motion, analyse, from_move, solve
from ...feedforward.dae import integrate
from ...feedforward.paths.profiles import ThreePhase
from ...feedforward.planning.feasibility import AsSmooth
from ...models.types import Array
from .. import console, plots
from ..tables import table
from . import sheets, snapshots
from .entry import Sheet, entry
from .figures_y_captions import caption
from .figures_y_data import FIGURES, Case, Lines, Run, Snapshots
from .shown import quantity, sort_of, unit

SAMPLES = 2000
"""Intervals between the samples of the exact solution."""
FLAT = 1e-6
"""A quantity that spans less is drawn as a constant."""
NOTHING = 1e-9
"""A quantity that never exceeds this is zero but for rounding, and has no relative error."""
RUNS: tuple[dict[str, Any], ...] = (
    {"color": plots.COLOURS[4], "linewidth": 4.0},
    {"color": plots.COLOURS[1], "linewidth": 2.4},
    {"color": plots.COLOURS[5], "linewidth": 1.3},
)
"""Styles of numerical solutions: narrower ones on wider ones, so that coinciding curves show."""
ALONE = {"color": plots.COLOURS[4], "linewidth": 2.0}
"""Style of the only numerical solution."""
SORTS: dict[str, dict[str, Any]] = {
    "coordinates": {"color": plots.COLOURS[3], "linewidth": 1.3},
    "inputs": {"color": plots.COLOURS[2], "linewidth": 1.3},
    "multipliers": {"color": plots.COLOURS[5], "linewidth": 1.3},
}
"""Styles of the errors of one run."""


class Solution(NamedTuple):
    """A numerical solution, and the exact one at its steps."""

    run: Run
    motion: Motion
    truth: Motion

    def error(self, name: str) -> Array:
        """How far a quantity is from the exact one at each step, (N,)."""
        return np.abs(quantity(self.motion, name) - quantity(self.truth, name))


def draw(name: str, content: Lines | Snapshots) -> Sheet:
    """The figure of that name."""
    if isinstance(content, Snapshots):
        times = np.linspace(0.0, content.case.path.duration, snapshots.SAMPLES)
        return snapshots.draw(content, exact(content.case, times))
    return _lines(name, content)


for _name, _content in FIGURES.items():
    entry(_name, _content.title, caption(_name, _content))(partial(draw, _name, _content))


def exact(case: Case, times: Array) -> Motion:
    """The exact motion at times (N,), its path taken to be as smooth as the crane needs."""
    reference = from_move(case.path)
    needed = analyse(case.rig).reference_order
    if reference.order < needed:
        # Which it is not: its word is taken, or its jumps at the start would be found out.
        return solve(case.rig, AsSmooth(reference, needed), times, verify=False)
    return solve(case.rig, reference, times)


def _lines(figure_name: str, sheet: Lines) -> Sheet:
    """Curves over time, and how far the numerical ones are from the exact one."""
    truth = exact(sheet.case, np.linspace(0.0, sheet.case.path.duration, SAMPLES + 1))
    summary = table(
        f"{figure_name}: {sheet.title}", "run", "step [s]", "coordinates [m, rad]",
        "inputs [N, N m]", "over the largest", "steps",
    )  # fmt: skip
    solutions = [_solve(summary, sheet.case, run) for run in sheet.runs]
    data = {"time": truth.times} | {name: quantity(truth, name) for name in sheet.panels}
    for run, motion, _ in solutions:
        for name in sheet.panels:
            values = quantity(motion, name)
            data[f"{name}, {run.label}"] = np.interp(truth.times, motion.times, values)
    if len(solutions) == 1:
        figure, more = _with_one_error(sheet, truth, solutions[0])
    else:
        figure, more = _with_each_error(sheet, truth, solutions)
    return Sheet(summary, figure, data | more)


def _with_one_error(
    sheet: Lines, truth: Motion, solution: Solution
) -> tuple[Any, dict[str, Array]]:
    """A panel for each quantity, and one for their errors over the largest values."""
    count = len(sheet.panels) + 1
    rows = -(-count // 2)
    figure, axes = plots.figure(
        9.2, 1.55 * rows + 1.0, nrows=rows, ncols=2, sharex=True, squeeze=False
    )
    for ax, name in zip(axes.flat, sheet.panels, strict=False):
        _values(ax, sheet, name, truth, [solution])
    panel, shares = axes.flat[count - 1], _shares(sheet, truth, solution)
    styles = [{"label": f"error of {sort}", **SORTS[sort]} for sort in shares]
    steps = solution.motion.times
    sheets.errors(panel, [steps] * len(shares), [*shares.values()], 1.0, styles)
    plots.title(panel, "largest error over the largest value")
    sheets.time_axes(axes, count)
    plots.legend_below(figure, axes.flat[0], panel)
    data = {f"error of {sort}": np.interp(truth.times, steps, s) for sort, s in shares.items()}
    return figure, data


def _shares(sheet: Lines, truth: Motion, solution: Solution) -> dict[str, Array]:
    """For each sort of quantity the largest error over the quantity's largest value, (N,)."""
    shares: dict[str, Array] = {}
    for name in sheet.panels:
        largest = float(np.abs(quantity(truth, name)).max())
        if largest > NOTHING:
            share, sort = solution.error(name) / largest, sort_of(name)
            shares[sort] = np.maximum(share, shares.get(sort, 0.0))
    return shares


def _with_each_error(
    sheet: Lines, truth: Motion, solutions: Sequence[Solution]
) -> tuple[Any, dict[str, Array]]:
    """Beside each quantity how far each solution is from the exact one."""
    rows = len(sheet.panels)
    figure, axes = plots.figure(
        9.2, 1.55 * rows + 1.0, nrows=rows, ncols=2, sharex=True, squeeze=False
    )
    data: dict[str, Array] = {}
    for (ax, beside), name in zip(axes, sheet.panels, strict=True):
        _values(ax, sheet, name, truth, solutions)
        steps = [solution.motion.times for solution in solutions]
        errors = [solution.error(name) for solution in solutions]
        largest = float(np.abs(quantity(truth, name)).max())
        sheets.errors(beside, steps, errors, largest, RUNS)
        plots.title(beside, f"error of ${sheet.panels[name]}$")
        beside.set_ylabel(f"[{unit(truth, name)}]")
        for solution, error in zip(solutions, errors, strict=True):
            label = f"error of {name}, {solution.run.label}"
            data[label] = np.interp(truth.times, solution.motion.times, error)
    sheets.time_axes(axes, 2 * rows)
    plots.legend_below(figure, axes.flat[0])
    return figure, data


def _values(ax: Any, sheet: Lines, name: str, truth: Motion, solutions: Sequence[Solution]) -> None:
    """A quantity's curves, with room around one that does not move but for rounding."""
    styles = RUNS if len(solutions) > 1 else (ALONE,)
    for (run, motion, _), style in zip(solutions, styles, strict=False):
        ax.plot(motion.times, quantity(motion, name), label=run.label, **style)
    ax.plot(truth.times, quantity(truth, name), label="exact", **sheets.EXACT)
    plots.title(ax, f"${sheet.panels[name]}$   {name}")
    ax.set_ylabel(f"[{unit(truth, name)}]")
    low, high = ax.get_ylim()
    if high - low < FLAT:
        middle = 0.5 * (low + high)
        ax.set_ylim(middle - 0.5, middle + 0.5)


def _solve(summary: Table, case: Case, run: Run) -> Solution:
    """Integrate, and add a row to the table: largest errors at the steps."""
    reference = from_move(case.path)
    integration = integrate(case.rig, reference, step=run.step, formulation=run.formulation)
    motion = integration.motion
    solution = Solution(run, motion, exact(case, motion.times))
    places = max(float(solution.error(name).max()) for name in case.rig.coordinate_names)
    inputs = np.abs(motion.inputs - solution.truth.inputs).max(axis=0)
    largest = np.abs(solution.truth.inputs).max(axis=0)
    share = np.divide(inputs, largest, out=np.zeros_like(inputs), where=largest > NOTHING).max()
    summary.add_row(
        run.formulation, f"{run.step:g}", f"{places:.1e}", f"{inputs.max():.3g}",
        f"{share:.1%}", str(integration.counters.steps),
    )  # fmt: skip
    if integration.failure is not None:
        summary.add_row(console.warning(str(integration.failure)))
    return solution


@entry(
    "Y4.6",
    "the three-phase profile",
    "No machine: the reference function of the rotary crane's and later moves, 20 s with blends "
    "of 5 s, and its derivatives. The printed coefficients 14/2 and 7/2 (Y 4.126, 4.128, 5.100) "
    "do not join the phases; 14 and 7 do, and the third phase has the opposite sign. Four "
    "derivatives are continuous.",
)
def reference_function() -> Sheet:
    """Y 4.6: the three-phase profile and its derivatives, with the coefficients that join."""
    duration, blend = 20.0, 5.0
    times = np.linspace(0.0, duration, SAMPLES + 1)
    values = ThreePhase(blend / duration, 4).derivatives(times / duration, 4)
    values = values / (duration ** np.arange(5.0))[:, None]
    names = [f"c{order * chr(39)}(t)" for order in range(5)]
    figure, axes = plots.figure(6.0, 7.0, nrows=5, sharex=True)
    summary = table("Y4.6: the three-phase profile", "", "lowest", "highest")
    for order, (ax, name, row) in enumerate(zip(axes, names, values, strict=True)):
        label = ("", "[1/s]", "[1/s²]", "[1/s³]", "[1/s⁴]")[order]
        sheets.panel(ax, name, times, [row], label)
        summary.add_row(f"{name} {label}", f"{row.min():.4g}", f"{row.max():.4g}")
    axes[-1].set_xlabel("time [s]")
    figure.align_ylabels()
    return Sheet(summary, figure, {"time": times, **dict(zip(names, values, strict=True))})
