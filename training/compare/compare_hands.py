"""`flatrig compare HAND`: controllers side by side over the same disturbed scenarios.

    flatrig compare two-finger-hand
    flatrig compare ball-on-plate --nominal

As for cranes, every controller drives all scenarios at once.  What counts is where the object ends:
how far from the plan's end, and turned by how much.  An object that is lost stays where it was.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.progress import track
from rich.text import Text

from ...envs import (
    PD,
    Feedforward,
    HandDisturbances,
    HandScenario,
    HandVectorEnv,
    PoseFeedback,
    hand_design,
)
from ...envs.hand.goals import DURATION
from ...envs.hand.observation import pose_error
from ...models import Hand, HandMove
from ...models.errors import OptionError
from ...models.files import write_text
from ...models.types import Array
from .. import options
from ..console import console, warning
from ..tables import table, write_csv
from .compare_cranes import BASE, EVALUATION_SEED, RESIDUAL
from .metrics import RESAMPLES, estimates
from .report import make_folder

CLOSED = "FF + PD + pose"
CONTROLLERS: dict[str, Callable[[Any], Any]] = {
    "PD, set point": lambda env: PD(env, track="set point"),
    "PD, moving": PD,
    "feedforward": Feedforward,
    BASE: lambda env: Feedforward(PD(env)),
    CLOSED: lambda env: PoseFeedback(Feedforward(PD(env))),
}
"""Name, and what wraps the environment."""
AWAY, TURNED = 1e-3, 0.5
"""Goals for the object's final pose [m], [degrees]."""
COLUMNS = {
    "away": ("off at the\nend [mm]", 1e3, 4),
    "turned": ("turned off\n[deg]", 180.0 / np.pi, 4),
    "rmse": ("tracking\nRMSE [mm]", 1e3, 3),
    "largest": ("largest\nerror [mm]", 1e3, 2),
    "effort": ("effort\n[% of limit]", 1e2, 1),
}
"""Metric: heading, factor of the unit shown, digits."""


@dataclass(frozen=True, eq=False)
class HandRun:
    """One controller's runs over N scenarios, one number for each."""

    name: str
    distance: Array
    """Of the object from its place in the plan over time [m], shape (T, N)."""
    away: Array
    """Distance from the plan's end at the end [m]."""
    turned: Array
    """Angle from it [rad]."""
    rmse: Array
    """Root mean square distance [m]."""
    largest: Array
    """[m]"""
    effort: Array
    """Root mean square input until the run ended, as a share of the limits."""
    reasons: list[str]
    """Why a run ended early, "" if it did not."""

    @property
    def reached(self) -> NDArray[np.bool_]:
        """Whether the object ended within the goals."""
        near = (self.away <= AWAY) & (np.degrees(self.turned) <= TURNED)
        return np.asarray(near & np.array([not why for why in self.reasons]))


def main(command: options.Compare) -> None:
    """Compare, print the table, and save tables and figure."""
    from .. import plots

    hand, move = command.hand_target()
    if command.scenarios < 1:
        raise OptionError(f"--scenarios is {command.scenarios}, it must be >= 1")
    if command.duration is None:
        move = replace(move, duration=DURATION)
    disturbances = HandDisturbances.standard(hand)
    scenarios = hand_design(disturbances, command.scenarios, EVALUATION_SEED)
    if command.nominal:
        scenarios = [HandScenario()]
    folder = Path(command.output or f"results/compare-{hand.name}")
    make_folder(folder)
    env = HandVectorEnv(hand, num_envs=len(scenarios), reference=move, sensors="full")
    runs = [
        drive(env, name, scenarios)
        for name in track(CONTROLLERS, "Driving", transient=True, console=console())
    ]
    write(folder, hand, runs, scenarios)
    times = env.task.period * np.arange(1.0, len(runs[0].distance) + 1.0)
    names, distances = [run.name for run in runs], [run.distance for run in runs]
    words = _heading(hand, scenarios).replace("_", " ")
    figure = folder / "figure.png"
    plots.comparison(words, names, times, move.duration, distances, figure, what="Object")
    show(hand, move, runs, scenarios)
    console().print(f"wrote {folder}/scenarios.csv, summary.json, figure.png", soft_wrap=True)
    console().print(f"residual: no policy is shipped for {hand.name}", style="dim")


def drive(env: HandVectorEnv, name: str, scenarios: Sequence[HandScenario]) -> HandRun:
    """Run all scenarios to their end with one controller."""
    task, num = env.task, len(scenarios)
    wrapped = CONTROLLERS[name](env)
    wrapped.reset(seed=0, options={"scenarios": list(scenarios)})
    zero, reasons, alive = np.zeros((num, len(task.limits))), [""] * num, np.ones(num, dtype=bool)
    last = task.plant.outputs.copy()
    distance, effort, lived = [], np.zeros(num), np.zeros(num)
    rows, place = task.plans[0].rows, task.rows.parts["outputs"].shape[1]
    planned = rows[:, 2 * len(task.limits) :][:, :place]
    for row in planned[1:]:
        _, _, terminated, _, info = wrapped.step(zero)
        lost = alive & terminated
        for i in np.flatnonzero(lost):
            reasons[i] = info["reason"][i]
        alive &= ~terminated
        now = np.hstack((info["object"], info["rotation"].reshape(num, 9)))
        last = np.where(alive[:, None], now, last)
        used = np.square(info["input"] / task.limits).mean(axis=1)
        effort, lived = effort + np.where(alive, used, 0.0), lived + alive
        distance.append(np.linalg.norm(last[:, :3] - row[:3], axis=1))
    off, over_time = pose_error(last, np.tile(planned[-1], (num, 1))), np.array(distance)
    return HandRun(
        name,
        over_time,
        away=over_time[-1],
        turned=np.linalg.norm(off[:, 3:], axis=1),
        rmse=np.sqrt(np.square(over_time).mean(axis=0)),
        largest=over_time.max(axis=0),
        effort=np.sqrt(effort / np.maximum(lived, 1)),
        reasons=reasons,
    )


def _heading(hand: Hand, scenarios: Sequence[HandScenario]) -> str:
    if list(scenarios) == [HandScenario()]:
        return f"{hand.name}: undisturbed"
    plural = "s" if len(scenarios) > 1 else ""
    return f"{hand.name}: {len(scenarios)} disturbed scenario{plural}"


def show(
    hand: Hand, move: HandMove, runs: Sequence[HandRun], scenarios: Sequence[HandScenario]
) -> None:
    """Print the table."""
    many = len(scenarios) > 1
    shown = table(
        _heading(hand, scenarios) + (", mean and 95 % interval" if many else ""),
        "controller", *(name for name, _, _ in COLUMNS.values()),
        "worst end\n[mm], [deg]", "reached", "ended\nearly",
    )  # fmt: skip
    found = {name: estimates([getattr(run, name) for run in runs]) for name in COLUMNS}
    for i, run in enumerate(runs):
        cells: list[Text | str] = [Text(run.name, style="bold" if run.name == CLOSED else "")]
        for name, (_, factor, digits) in COLUMNS.items():
            value = found[name][i]
            scaled = replace(
                value, mean=factor * value.mean, low=factor * value.low, high=factor * value.high
            )
            middle, interval = scaled.format(digits)
            cells.append(Text.assemble(middle, "\n", (interval, "dim")) if many else middle)
        worst = f"{1e3 * run.away.max():.3f}\n{np.degrees(run.turned.max()):.3f}"
        lost = [why for why in run.reasons if why]
        ends = "\n".join(f"{lost.count(why)} {why}" for why in sorted(set(lost)))
        good = int(run.reached.sum())
        cells += [worst, f"{good} of {len(scenarios)}", warning(ends) if ends else "0"]
        shown.add_row(*cells)
    shown.add_row(RESIDUAL, Text("no policy\nshipped", style="dim"))
    console().print(shown)
    console().print(
        f"Move: {move.duration:g} s.  Reached: ends within {1e3 * AWAY:g} mm and {TURNED:g} "
        "degrees of the plan's end, without an early end; after one the object counts as resting."
        + (f"  Intervals: paired bootstrap, {RESAMPLES} resamples." if many else ""),
        style="dim", soft_wrap=True,
    )  # fmt: skip


def write(
    folder: Path, hand: Hand, runs: Sequence[HandRun], scenarios: Sequence[HandScenario]
) -> None:
    """Write scenarios.csv and summary.json.

    Raises
    ------
    OutputError
        A file cannot be written.
    """
    settings = [item.name for item in fields(HandScenario)]
    rows = (
        (i, *(_flat(getattr(scenario, name)) for name in settings), run.name,
         *(getattr(run, name)[i] for name in COLUMNS), run.reasons[i])
        for run in runs
        for i, scenario in enumerate(scenarios)
    )  # fmt: skip
    columns = ("scenario", *settings, "controller", *COLUMNS, "ended")
    write_csv(folder / "scenarios.csv", columns, rows)
    found = {name: estimates([getattr(run, name) for run in runs]) for name in COLUMNS}
    facts = {
        "hand": hand.name,
        "scenarios": len(scenarios),
        "units": "m, rad, shares of the limits",
        "controllers": {
            run.name: {name: asdict(found[name][i]) for name in COLUMNS}
            | {"reached": int(run.reached.sum()), "ended": sum(map(bool, run.reasons))}
            for i, run in enumerate(runs)
        },
    }
    write_text(folder / "summary.json", json.dumps(facts, indent=2) + "\n")


def _flat(value: Any) -> str:
    return " ".join(map(repr, value)) if isinstance(value, tuple) else repr(value)
