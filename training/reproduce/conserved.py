"""What integrators keep of the free rotary crane: energy, angular momentum, order, conditioning.

    flatrig reproduce integrators

The crane of Y 2.4 is let go, its trolley at 1.5 m, and runs for 1 s, by directors with each of our
schemes and as the catalogue's model in MuJoCo.  The error is the load's place at the end, against
the index-1 form at a tolerance of 1e-12.  The order of our schemes is that over the first 0.1 s,
where every step is short for the motion; MuJoCo's is taken from its two coarsest steps.
"""

from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from rich.table import Table

from ...feedforward.integrators import SCHEMES, Condition, Scheme, integrate, integrate_index_one
from ...feedforward.integrators import table as condition_table
from ...feedforward.multibody import System, assemble, rotary_crane
from ...models.mjcf import rig_model as mjcf
from ...models.mjcf.rig_state import points
from ...models.mjcf.simulate import run as simulate
from ...models.types import Array
from .. import plots
from ..simulate.drift import DURATION, drift, free_motion
from ..tables import table
from .entry import Sheet, entry
from .work_precision import LOOKS

COUNTS = (50, 100, 200, 400)
"""Steps of the runs over 1 s."""
SHOWN = 100
"""Steps of the runs in the table."""
ORDER_COUNTS, ORDER_DURATION = (20, 40), 0.1
"""Steps and duration [s] of the runs from which orders are taken: short, so that the error at the
end is that of the scheme and not of the motion's growth."""
PLACE = 1.5
"""Place of the trolley at the start (Y 2.90) [m]."""
CONDITION_STEPS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)
"""Steps at which iteration matrices are conditioned [s]."""
MUJOCO = {"RK4": "RK4", "Euler": "EULER", "implicit": "IMPLICIT"}
"""The other two integrators step as Euler does, where nothing damps."""
PANELS = {
    "Energy in 1 s": "largest change [J]",
    "Angular momentum in 1 s": "largest change, relative",
    "Place of the load after 1 s": "error [m]",
    "Iteration matrix; dotted: scaled": "condition number",
}
"""Headings of the panels, and what they show."""
ENERGY = 410.12
"""Size of the energy at the start [J], the tower's top being at zero."""


class Departure(NamedTuple):
    """How far a run departs from what it should conserve, and from where it should end."""

    method: str
    """Name of the scheme, or of MuJoCo's integrator."""
    step: float
    """Time step [s]."""
    energy: float
    """Largest departure of the energy from that at the start [J]."""
    momentum: float
    """Largest departure of the angular momentum about the vertical, over that at the start."""
    error: float
    """Distance of the load from its exact place at the end [m]."""


@entry(
    "integrators",
    "what integrators keep of the free crane",
    "The crane of Y2.7 let go, trolley at 1.5 m, for 1 s, by every scheme and by MuJoCo's. Y shows "
    "two of them at one step each.",
)
def integrators() -> Sheet:
    """Departures, errors and condition numbers over the step."""
    runs, conditions = [*measure(), *in_mujoco()], _conditions()
    measured = orders(runs) | orders(measure(ORDER_COUNTS, duration=ORDER_DURATION))
    summary = _table(runs, conditions, measured)
    return Sheet(summary, _draw(runs, conditions), _columns(runs))


def measure(
    counts: Sequence[int] = COUNTS, schemes: Sequence[Scheme] = SCHEMES, duration: float = DURATION
) -> list[Departure]:
    """Runs of our schemes with each number of steps; those that fail are left out."""
    system, start = assemble(rotary_crane(place=PLACE))
    goal = _goal(duration)
    runs = []
    for scheme in schemes:
        for count in counts:
            run = integrate(scheme, system, start.q, start.v, duration=duration, steps=count)
            if run.failure is None:
                states = list(zip(run.q, run.v, strict=True))
                energy = np.array([system.energy(*state) for state in states])
                moment = np.array([system.angular_momentum(*state)[2] for state in states])
                error = float(np.linalg.norm(_load(system, run.q[-1]) - goal))
                change = float(np.abs(energy - energy[0]).max())
                lost = float(np.abs(moment / moment[0] - 1).max())
                runs.append(Departure(scheme.name, duration / count, change, lost, error))
    return runs


def in_mujoco(counts: Sequence[int] = COUNTS) -> list[Departure]:
    """Runs of MuJoCo's integrators."""
    return [_mujoco(name, count) for name in MUJOCO for count in counts]


def orders(runs: Sequence[Departure]) -> dict[str, float]:
    """Measured order of each method, from its two coarsest steps."""
    measured = {}
    for name in dict.fromkeys(run.method for run in runs):
        coarse, fine = [run for run in runs if run.method == name][:2]
        measured[name] = float(np.log(coarse.error / fine.error) / np.log(coarse.step / fine.step))
    return measured


@cache
def _goal(duration: float) -> Array:
    """Where the load is then, shape (3,) [m]."""
    system, start = assemble(rotary_crane(place=PLACE))
    run = integrate_index_one(system, start.q, start.v, (0.0, duration))
    return _load(system, run.q[-1])


def _load(system: System, q: Array) -> Array:
    return q[[system.index(f"load.{axis}") for axis in "xyz"]]


def _mujoco(integrator: str, count: int) -> Departure:
    free = free_motion("rotary_crane")
    kind = MUJOCO[integrator]
    model = mjcf.compile(free.rig, timestep=1 / count, integrator=kind, visuals=False)
    start = mjcf.joint_state(free.rig, model, free.coordinates, free.rates)
    end = simulate(model, *start, np.zeros((count, model.nu)))
    place = points(free.rig, end.qpos[-1], end.qvel[-1])["load"][0]
    away, error = drift(model, free), float(np.linalg.norm(place - _goal(DURATION)))
    return Departure(f"MuJoCo {integrator}", 1 / count, away.energy, away.momentum, error)


def _conditions() -> list[Condition]:
    """Condition of the iteration matrices at the start."""
    system, start = assemble(rotary_crane(place=PLACE))
    return condition_table(system, start.q, start.v, CONDITION_STEPS)


def _draw(runs: Sequence[Departure], conditions: Sequence[Condition]) -> Any:
    figure, axes = plots.figure(8.8, 6.0, nrows=2, ncols=2)
    for name, (colour, mark) in LOOKS.items():
        rows = [run for run in runs if run.method == name]
        if not rows:
            continue
        marked: dict[str, Any] = {"color": colour, "marker": mark, "markersize": 4}
        marked |= {"label": name, "linewidth": 1.3}
        steps = [1e3 * run.step for run in rows]
        axes[0, 0].plot(steps, [run.energy for run in rows], **marked)
        axes[0, 1].plot(steps, [run.momentum for run in rows], **marked)
        axes[1, 0].plot(steps, [run.error for run in rows], **marked)
        matrices = [row for row in conditions if row.scheme == name]
        widths, printed = [row.step for row in matrices], [row.printed for row in matrices]
        axes[1, 1].plot(widths, printed, **marked)
        axes[1, 1].plot(widths, [row.scaled for row in matrices], color=colour, linestyle=":")
    for ax, (heading, label) in zip(axes.flat, PANELS.items(), strict=True):
        plots.title(ax, heading)
        ax.set(xlabel="step [ms]", ylabel=label, xscale="log", yscale="log")
    axes[1, 1].set_xlabel("step [s]")
    for ax in axes.flat[:3]:
        ax.set_xticks([1e3 / count for count in COUNTS], [f"{1e3 / count:g}" for count in COUNTS])
        ax.minorticks_off()
    plots.legend_below(figure, axes[0, 0])
    return figure


def _columns(runs: Sequence[Departure]) -> dict[str, list[str]]:
    return {
        "method": [run.method for run in runs],
        "step [s]": [f"{run.step:g}" for run in runs],
        "change of energy [J]": [f"{run.energy:.3e}" for run in runs],
        "relative change of momentum": [f"{run.momentum:.3e}" for run in runs],
        "error [m]": [f"{run.error:.3e}" for run in runs],
    }


def _table(
    runs: Sequence[Departure], conditions: Sequence[Condition], order: dict[str, float]
) -> Table:
    """At the step that is shown, with the orders, and condition numbers at that step."""
    summary = table(
        f"Free rotary crane, 1 s at steps of {1 / SHOWN:g} s",
        "method", "energy [J]", "over its size", "L_z, relative", "load [m]", "order", "unknowns",
        "condition", "scaled",
    )  # fmt: skip
    matrices = {row.scheme: row for row in conditions if row.step == 1 / SHOWN}
    for run in (run for run in runs if run.step == 1 / SHOWN):
        row = matrices.get(run.method)
        matrix = [str(row.unknowns), f"{row.printed:.0e}", f"{row.scaled:.0e}"] if row else [""] * 3
        summary.add_row(
            run.method, f"{run.energy:.1e}", f"{run.energy / ENERGY:.1e}", f"{run.momentum:.1e}",
            f"{run.error:.1e}", f"{order[run.method]:.2f}", *matrix,
        )  # fmt: skip
    return summary
