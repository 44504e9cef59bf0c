"""`flatrig compare HAND`: controllers side by side over the same disturbed scenarios.

    flatrig compare two-finger-hand
    flatrig compare ball-on-plate --nominal

As for cranes, every controller drives all scenarios at once.  What counts is where the object ends:
how far from the plan's end, and turned by how much; it has reached it if it stays that near for the
last second of the run, or longer.  An object that is lost stays where it was.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np
from rich.text import Text

from ...envs import HandDisturbances, HandScenario, HandVectorEnv, hand_design
from ...envs.hand.goals import DURATION
from ...envs.hand.observation import pose_error
from ...models import Hand, HandMove
from ...models.errors import OptionError, PathError
from ...models.files import make_folder
from ...models.types import Array
from .. import options
from ..console import warning
from ..describe.feasible import INFEASIBLE
from ..exits import DONE, refuse
from ..learned import check
from ..option_values import output_folder
from ..policy import Policy, shipped
from .check_options import check_one, how_of
from .contenders import EVALUATION_SEED, Contender
from .driving import ONE_BY_ONE, How, drive_all, periods
from .episode_sets import OWN
from .figure import draw
from .kept_runs import Driven, identity_of
from .metrics import LASTING, lasts
from .report import report
from .runs import INTERVALS, Column, Comparison, Run

AWAY, TURNED = 1e-3, 0.5
"""How near to the plan's end an object that has reached it stays [m], [degrees]."""
COLUMNS = (
    Column("away", "off at the\nend [mm]", 1e3, 4),
    Column("turned", "turned off\n[deg]", 180.0 / np.pi, 4),
    Column("rmse", "tracking\nRMSE [mm]", 1e3, 3),
    Column("largest", "largest\nerror [mm]", 1e3, 2),
    Column("effort", "effort\n[% of limit]", 1e2, 1),
)
UNITS = {
    "away": "m",
    "turned": "rad",
    "rmse": "m",
    "largest": "m",
    "effort": "share of the limits",
    "reached": "scenarios",
    "ended": "scenarios",
}
"""Units of the metrics."""
NOTES = (
    f"Reached: stays within {1e3 * AWAY:g} mm and {TURNED:g} degrees of the plan's end for the "
    f"last {LASTING:g} s, without an early end; after one the object counts as resting."
)


@dataclass(frozen=True, eq=False)
class HandMetrics:
    """One number for each of N scenarios."""

    away: Array
    """Distance of the object from the plan's end at the end [m]."""
    turned: Array
    """Angle of the object from the plan's end at the end [rad]."""
    rmse: Array
    """Root mean square distance of the object from its place in the plan [m]."""
    largest: Array
    """Largest distance [m]."""
    effort: Array
    """Root mean square input until the run ended, as a share of the limits."""
    ended: list[str]
    """Why the run ended early, "" if it did not."""
    reached: Array
    """1 where the object stays within `AWAY` and `TURNED` of the plan's end for the last `LASTING`
    or longer, else 0."""


def main(command: options.Compare) -> int:
    """Compare, print the table, and save tables and figure."""
    hand, move = command.hand_target()
    check_one(command)
    if command.sets or command.episodes or command.trajectories:
        raise OptionError("--sets, --episodes and --trajectories are for cranes")
    if command.duration is None:
        move = replace(move, duration=DURATION)
    disturbances = HandDisturbances.standard(hand)
    scenarios = hand_design(disturbances, command.scenarios, EVALUATION_SEED)
    if command.nominal:
        scenarios = [HandScenario()]
    folder = output_folder(command.output, f"results/compare-{hand.name}")
    how = how_of(command, folder)
    try:
        HandVectorEnv(hand, num_envs=1, reference=move)
    except PathError as error:
        return refuse(INFEASIBLE, [str(error)])
    policy = Policy.load(command.policy) if command.policy else shipped(hand)
    make_folder(folder)
    comparison = compare(hand, move, scenarios, policy, how)
    draw(comparison, folder / "figure.png")
    report(comparison, folder, command.json)
    return DONE


def compare(
    hand: Hand,
    move: HandMove,
    scenarios: Sequence[HandScenario],
    policy: Policy | None = None,
    how: How = ONE_BY_ONE,
) -> Comparison:
    """Drive the scenarios with every contender for hands; the learned one needs a policy.

    Raises
    ------
    OptionError
        The policy does not suit the hand.
    """
    given = tuple(scenarios)
    policies = {} if policy is None else {policy.card.sensors: policy}
    if policy is not None:
        check(policy.card, _env(hand, move, len(given), "encoders").task)

    def entry_of(contender: Contender) -> HandEntry:
        learned = policies[contender.sensors] if contender.learned else None
        return HandEntry(hand, move, given, contender, learned)

    driven = drive_all("hand", entry_of, HandMetrics, how, policies)
    return Comparison(
        kind="hand",
        name=hand.name,
        thing="Object",
        units=UNITS,
        scenarios=scenarios,
        arrival=move.duration,
        runs=[found.runs[OWN] for found in driven.found],
        absent=driven.absent,
        refused=driven.refused,
        columns=COLUMNS,
        cells={"worst end\n[mm], [deg]": _worst, "reached": _reached, "ended\nearly": _endings},
        notes=f"Move: {move.duration:g} s.  {NOTES}"
        + (f"  {INTERVALS}" if len(scenarios) > 1 else ""),
        residual=(
            f"no policy is shipped for {hand.name} with these numbers"
            if policy is None
            else f"{policy.card.training.get('command')}"
        ),
        counts={
            "reached": lambda metrics: int(metrics.reached.sum()),
            "ended": lambda metrics: sum(map(bool, metrics.ended)),
        },
    )


@dataclass(frozen=True)
class HandEntry:
    """A contender and what it is to drive: what a process of a comparison works on."""

    hand: Hand
    move: HandMove
    scenarios: tuple[HandScenario, ...]
    contender: Contender
    policy: Policy | None = None
    """For a learned contender."""

    def drive(self) -> Driven:
        """Drive all scenarios.

        Raises
        ------
        OptionError
            The contender does not bear the hand.
        """
        contender = self.contender
        if self.policy is not None:
            contender = replace(contender, wrap=partial(contender.wrap, policy=self.policy))
        env = _env(self.hand, self.move, len(self.scenarios), contender.sensors)
        return Driven({OWN: drive(env, contender, self.scenarios, self.move.duration)})

    def identity(self) -> object:
        """Everything but the sources that its run depends on."""
        asked = self.hand, self.move, self.scenarios
        return asked, identity_of(self.contender, self.policy)


@lru_cache(maxsize=3)  # one for each set of sensors
def _env(hand: Hand, move: HandMove, number: int, sensors: str) -> HandVectorEnv:
    return HandVectorEnv(hand, num_envs=number, reference=move, sensors=sensors)


def drive(
    env: HandVectorEnv, contender: Contender, scenarios: Sequence[HandScenario], arrival: float
) -> Run:
    """Run all scenarios to their end with one contender; the plan arrives at `arrival` [s]."""
    task, num = env.task, len(scenarios)
    steps = periods(contender.wrap(env), {"scenarios": scenarios})
    reasons, pose = [""] * num, task.plant.outputs.copy()
    distance, near, effort, lasted = [], [], np.zeros(num), np.zeros(num)
    rows, place = task.plans[0].rows, task.rows.parts["outputs"].shape[1]
    planned = rows[:, 2 * len(task.limits) :][:, :place]
    end = np.tile(planned[-1], (num, 1))
    for row, (alive, info) in zip(planned[1:], steps, strict=False):  # the steps are endless
        for i in np.flatnonzero(~alive):
            reasons[i] = reasons[i] or task.reasons[info["reason"][i]]
        present = np.hstack((info["object"], info["rotation"].reshape(num, 9)))
        pose = np.where(alive[:, None], present, pose)
        squares = np.square(info["input"] / task.limits).mean(axis=1)
        effort, lasted = effort + np.where(alive, squares, 0.0), lasted + alive
        distance.append(np.linalg.norm(pose[:, :3] - row[:3], axis=1))
        away, turned = np.linalg.norm(pose_error(pose, end).reshape(num, 2, 3), axis=2).T
        near.append((away <= AWAY) & (np.degrees(turned) <= TURNED))
    over_time, times = np.array(distance), task.period * np.arange(1.0, len(distance) + 1.0)
    metrics = HandMetrics(
        away=away,
        turned=turned,
        rmse=np.sqrt(np.square(over_time).mean(axis=0)),
        largest=over_time.max(axis=0),
        effort=np.sqrt(effort / np.maximum(lasted, 1)),
        ended=reasons,
        reached=np.where(reasons, 0.0, lasts(times[:, None] - arrival, np.array(near))),
    )
    return Run(contender, times, over_time, metrics)


def _worst(metrics: HandMetrics) -> str:
    return f"{1e3 * metrics.away.max():.3f}\n{np.degrees(metrics.turned.max()):.3f}"


def _reached(metrics: HandMetrics) -> str:
    return f"{int(metrics.reached.sum())} of {len(metrics.ended)}"


def _endings(metrics: HandMetrics) -> str | Text:
    """How often the runs ended early for each reason."""
    reasons = [reason for reason in metrics.ended if reason]
    counts = "\n".join(f"{reasons.count(reason)} {reason}" for reason in sorted(set(reasons)))
    return warning(counts) if counts else "0"
