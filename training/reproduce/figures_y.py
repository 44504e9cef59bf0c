"""Y chapters 4 to 6: numerical solutions beside the exact one, and snapshots.

The exact solution is `feedforward.solve`.  Where the source's move is not smooth enough for it (the
Navy crane in space with a heavy pulley), derivatives at its joins are one-sided, as in `check`.
"""

import time
from functools import partial
from typing import Any

import numpy as np
from rich.table import Table

from ...feedforward import Motion, analyse, driven_unit, equations_of, from_move, solve
from ...feedforward.dae import integrate
from ...feedforward.paths.profiles import ThreePhase
from ...feedforward.planning.feasibility import AsSmooth
from ...models.types import Array
from .. import console, plots
from ..tables import table
from . import sheets, snapshots
from .entry import Sheet, entry
from .figures_y_data import FIGURES, Case, Lines, Run, Snapshots

SAMPLES = 2000
"""Intervals between the samples of the exact solution."""
FLAT = 1e-6
"""A quantity that spans less is drawn as a constant."""


def draw(name: str, content: Lines | Snapshots) -> Sheet:
    """The figure of that name."""
    if isinstance(content, Snapshots):
        times = np.linspace(0.0, content.case.path.duration, snapshots.SAMPLES)
        return snapshots.draw(content, exact(content.case, times))
    return _lines(name, content)


for _name, _content in FIGURES.items():
    entry(_name, _content.title)(partial(draw, _name, _content))


def exact(case: Case, times: Array) -> Motion:
    """The exact motion at times (N,), its path taken to be as smooth as the crane needs."""
    reference = from_move(case.path)
    needed = analyse(case.rig).reference_order
    if reference.order < needed:
        return solve(case.rig, AsSmooth(reference, needed), times)
    return solve(case.rig, reference, times)


def _lines(figure_name: str, sheet: Lines) -> Sheet:
    """Curves over time, and how far the numerical ones are from the exact one."""
    truth = exact(sheet.case, np.linspace(0.0, sheet.case.path.duration, SAMPLES + 1))
    columns = 2 if len(sheet.panels) > 1 else 1
    rows = -(-len(sheet.panels) // columns)
    figure, axes = plots.figure(
        4.6 * columns, 1.9 * rows + 0.6, nrows=rows, ncols=columns, sharex=True, squeeze=False
    )
    summary = table(
        f"{figure_name}: {sheet.title}", "run", "step [s]", "coordinates [m, rad]",
        "inputs [N, N m]", "over the largest", "steps", "time [s]",
    )  # fmt: skip
    data = {"time": truth.times} | {name: _quantity(truth, name) for name in sheet.panels}
    for number, run in enumerate(sheet.runs):
        motion = _run(summary, sheet.case, run)
        style = {"color": plots.COLOURS[(4, 3, 5)[number % 3]], "linewidth": 1.5}
        for ax, name in zip(axes.flat, sheet.panels, strict=False):
            ax.plot(motion.times, _quantity(motion, name), label=run.label, **style)
            data[f"{name}, {run.label}"] = np.interp(
                truth.times, motion.times, _quantity(motion, name)
            )
    for ax, name in zip(axes.flat, sheet.panels, strict=False):
        ax.plot(truth.times, data[name], label="exact", **sheets.EXACT)
        plots.title(ax, name)
        ax.set_ylabel(_unit(truth, name))
    _finish(figure, axes, len(sheet.panels))
    return Sheet(summary, figure, data)


def _finish(figure: Any, axes: Any, used: int) -> None:
    """Legend, labels, and room around lines that do not move but for rounding."""
    axes.flat[0].legend(fontsize=8)
    for ax in axes.flat[:used]:
        low, high = ax.get_ylim()
        if high - low < FLAT:
            middle = 0.5 * (low + high)
            ax.set_ylim(middle - 0.5, middle + 0.5)
    for ax in axes.flat[used:]:
        ax.set_visible(False)
    for ax in axes.flat[max(0, used - axes.shape[1]) : used]:
        ax.tick_params(labelbottom=True)
        ax.set_xlabel("time [s]")
    figure.align_ylabels()


def _run(summary: Table, case: Case, run: Run) -> Motion:
    """Integrate, and add a row to the table: largest errors at the steps."""
    reference = from_move(case.path)
    begin = time.perf_counter()
    integration = integrate(case.rig, reference, step=run.step, formulation=run.formulation)
    seconds = time.perf_counter() - begin
    motion = integration.motion
    truth = exact(case, motion.times)
    columns = [(motion.column(name), truth.column(name)) for name in case.rig.coordinate_names]
    places = max(
        float(np.abs(motion.positions[:, i] - truth.positions[:, j]).max()) for i, j in columns
    )
    inputs = np.abs(motion.inputs - truth.inputs).max(axis=0)
    largest = np.abs(truth.inputs).max(axis=0)
    share = np.divide(inputs, largest, out=np.zeros_like(inputs), where=largest > 1e-9).max()
    summary.add_row(
        run.formulation, f"{run.step:g}", f"{places:.1e}", f"{inputs.max():.3g}",
        f"{share:.1%}", str(integration.counters.steps), f"{seconds:.2f}",
    )  # fmt: skip
    if integration.failure is not None:
        summary.add_row(console.warning(str(integration.failure)))
    return motion


def _quantity(motion: Motion, name: str) -> Array:
    """A coordinate, an input, or a multiplier, (N,)."""
    kind, _, what = name.partition(" ")
    if kind == "input":
        return motion.inputs[:, motion.rig.input_names.index(what)]
    if kind == "multiplier":
        return motion.multipliers[:, equations_of(motion.rig).constraint_names.index(what)]
    return motion.positions[:, motion.column(name)]


def _unit(motion: Motion, name: str) -> str:
    kind, _, what = name.partition(" ")
    if kind == "multiplier":
        return "[N/m]"
    if kind == "input":
        drive = motion.rig.drives[motion.rig.input_names.index(what)]
        return f"[{driven_unit(motion.rig, drive)}]"
    return "[rad]" if name.endswith((".angle", ".alpha", ".beta", ".gamma")) else "[m]"


@entry("Y4.6", "the three-phase profile")
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
        unit = "" if order == 0 else f"[1/s^{order}]"
        sheets.panel(ax, name, times, [row], unit)
        summary.add_row(f"{name} {unit}", f"{row.min():.4g}", f"{row.max():.4g}")
    axes[-1].set_xlabel("time [s]")
    return Sheet(summary, figure, {"time": times, **dict(zip(names, values, strict=True))})
