"""The figures of `flatrig bench feedforward`: errors against wall time and number of steps.

A colour is a scheme.  Runs that failed stand as crosses on the upper edge, at the time or the
number of steps that they took before they ended.
"""

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from ...feedforward import dae
from .. import plots
from .exact_roads import COMPILED, EXACT, STEP_BY_STEP
from .trials import BY_NAME, Run

PALETTE = (
    "#202020", "#56b4e9", "#0072b2", "#009e73", "#e69f00", "#d55e00", "#cc79a7",
    "#8c8c8c", "#b8a200", "#7a3b9a", "#e0218a", "#5a7d2a", "#a0522d",
)  # fmt: skip
"""Colours of the schemes, then of the peers; from the first again where there are more."""
STARS = {STEP_BY_STEP: "#f0a0a0", EXACT: "#d00000", COMPILED: "#600000"}
"""Colours of the roads to the exact solution."""
LOWEST, HIGHEST = 1e-16, 1e2
"""Errors are drawn between these."""

Quantity = Literal["coordinates", "inputs"]
Cost = Literal["seconds", "steps"]
LABELS = {
    "coordinates": "error of coordinates [m, rad]",
    "inputs": "error of inputs, over the largest",
    "seconds": "wall time [s]",
    "steps": "steps",
}


def case(path: Path, runs: Sequence[Run], name: str) -> None:
    """All formulations of a rig, one in each row, and the peers.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    of_rig = [run for run in runs if run.case == name and run.scheme]
    groups = {
        f"{name}, index {own[0].index}": own
        for name in dae.FORMULATIONS
        if (own := [run for run in of_rig if run.formulation == name and not run.of_peer])
    }
    peers = [run for run in of_rig if run.of_peer]
    if peers:
        groups["peers, index 1 and ODE"] = peers
    exact = [run for run in of_rig if run.formulation == EXACT]
    rows = max(len(groups), 1)
    figure, axes = plots.figure(
        13.0, 2.0 + 2.3 * rows, nrows=rows, ncols=4, sharex="col", sharey=True, squeeze=False
    )
    plots.heading(figure, f"{name}: error against cost (star: exact solution; cross: failed)")
    panels: tuple[tuple[Quantity, Cost], ...] = (
        ("coordinates", "seconds"), ("inputs", "seconds"),
        ("coordinates", "steps"), ("inputs", "steps"),
    )  # fmt: skip
    for row, (heading, group) in zip(axes, groups.items(), strict=False):
        for ax, (quantity, cost) in zip(row, panels, strict=True):
            curves(ax, group, quantity, cost, dashed=group is peers)
            star(ax, exact, quantity, cost)
        plots.title(row[0], heading)
    for top, bottom, (quantity, cost) in zip(axes[0], axes[-1], panels, strict=True):
        top.set_title(LABELS[quantity], loc="right", fontsize=9, pad=24)
        bottom.set_xlabel(LABELS[cost])
    _legend(figure, {run.scheme for run in of_rig}, ncols=7)
    plots.save(figure, path)


def formulation(path: Path, runs: Sequence[Run], name: str, what: str) -> None:
    """The inputs of one rig against wall time: one formulation, the peers, the exact solution.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    of_rig = [run for run in runs if run.case == name and run.scheme]
    figure, ax = plots.figure(8.2, 4.6)
    curves(ax, [run for run in of_rig if run.formulation == what], "inputs", "seconds")
    curves(ax, [run for run in of_rig if run.of_peer], "inputs", "seconds", dashed=True)
    star(ax, [run for run in of_rig if run.formulation == EXACT], "inputs", "seconds")
    plots.title(ax, f"{name.replace('_', ' ')}: {what} (full lines), peers on index 1 (dashed)")
    ax.set(xlabel=LABELS["seconds"], ylabel=LABELS["inputs"])
    _legend(figure, {run.scheme for run in of_rig}, ncols=1, loc="outside right center")
    plots.save(figure, path)


def colours() -> dict[str, str]:
    """The colour of every scheme and peer."""
    return dict(zip((*dae.SCHEMES, *BY_NAME), itertools.cycle(PALETTE), strict=False))


def curves(
    ax: Any, runs: Sequence[Run], quantity: Quantity, cost: Cost, *, dashed: bool = False
) -> None:
    """Errors of one quantity against one cost; runs with a tolerance as open circles."""
    ax.set(xscale="log", yscale="log", ylim=(LOWEST, HIGHEST))
    for scheme, colour in colours().items():
        begun = [r for r in runs if r.scheme == scheme and not r.failure.startswith("not run")]
        for constant in (True, False):
            ended = [run for run in begun if bool(run.count) == constant and not run.failure]
            style = "--" if dashed else "-"
            ax.plot(
                [getattr(run, cost) for run in ended],
                [min(max(getattr(run, quantity), LOWEST), HIGHEST) for run in ended],
                linestyle=":" if not (constant or dashed) else style, marker="o", markersize=3.5,
                markerfacecolor=colour if constant else "white", color=colour, linewidth=1.2,
            )  # fmt: skip
        failed = [run for run in begun if run.failure]
        (crosses,) = ax.plot(
            [max(getattr(run, cost), 1e-4 if cost == "seconds" else 1) for run in failed],
            [HIGHEST] * len(failed), "x", color=colour, clip_on=False, markersize=5,
        )  # fmt: skip
        crosses.set_in_layout(False)


def star(ax: Any, exact: Sequence[Run], quantity: Quantity, cost: Cost) -> None:
    """The exact solution, by every road and at several numbers of instants."""
    for name, colour in STARS.items():
        solved = [run for run in exact if run.scheme == name and not run.failure]
        ax.plot(
            [getattr(run, cost) for run in solved],
            [max(getattr(run, quantity), LOWEST) for run in solved],
            "*", color=colour, markersize=9, zorder=5,
        )  # fmt: skip


def _legend(figure: Any, schemes: set[str], **options: Any) -> None:
    from matplotlib.lines import Line2D

    dot: dict[str, Any] = {"marker": "o", "markersize": 3.5}
    handles = [
        Line2D([], [], color=colour, label=name, linestyle="--" if name in BY_NAME else "-", **dot)
        for name, colour in colours().items()
        if name in schemes
    ]
    handles += [
        Line2D([], [], color=colour, marker="*", markersize=9, linestyle="", label=name)
        for name, colour in STARS.items()
        if name in schemes
    ]
    figure.legend(handles=handles, **{"loc": "outside lower center", "fontsize": 8} | options)
