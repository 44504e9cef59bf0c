"""`flatrig compare`: controllers side by side over the same disturbed scenarios.

Every controller drives all scenarios at once, in one vector environment.  The scenarios are one
Latin hypercube from a seed that training never uses, so a difference between two controllers is
a difference between controllers, and intervals are of paired bootstrap resamples.
"""

from collections.abc import Mapping, Sequence
from math import ceil
from pathlib import Path

import numpy as np

from ... import feedforward
from ...envs.crane.disturbances import Scenario
from ...models import Move, Rig
from ...models.files import make_folder
from .. import options
from ..describe.feasible import INFEASIBLE, problems_of
from ..exits import DONE, refuse
from ..learned import check
from ..option_values import output_folder
from ..policy import Policy, shipped
from .check_options import check_one, how_of
from .contenders import SENSORS, Contender
from .crane_entry import CraneEntry, runner_of
from .driving import ONE_BY_ONE, How, drive_all
from .episode_sets import OWN, SETS, Episode, gather, sets_of
from .figure import draw
from .metrics import LASTING, SETTLED, Metrics
from .report import report
from .runs import INTERVALS, Column, Comparison, OnSet
from .trajectories import write_trajectories

OTHERS = 0.2
"""How many episodes other sets than that of the own move have by default, over its scenarios."""
COLUMNS = (
    Column("rmse", "tracking\nRMSE [mm]", 1e3, 1),
    Column("largest", "largest\n[mm]", 1e3, 0),
    Column("swing", "swing\nafter [mm]", 1e3, 1),
    Column("settling", "settling\ntime [s]", 1.0, 2),
    Column("effort", "effort\n[% of limit]", 1e2, 1),
    Column("tension", "lowest\ntension [N]", 1.0, 0),
)
UNITS = {
    "rmse": "m",
    "largest": "m",
    "swing": "m",
    "settling": "s",
    "effort": "share of the limits",
    "tension": "N",
    "settled": "share of the scenarios",
    "failed": "share of the scenarios",
    "turn": "rad",
}
"""Units of the metrics."""
TURN = Column("turn", "turned\nby [deg]", 180.0 / np.pi, 2)
"""One more where a platform has a reference for its orientation."""
NOTES = (
    f"Settled: stays within {1e3 * SETTLED:g} mm of the goal for the last {LASTING:g} s or longer, "
    "to the end; a load that does not counts with the whole time after arrival as settling time. "
    "After an early end the load counts as resting, and its swing not at all."
)


def main(command: options.Compare) -> int:
    """Compare, print the table, and save tables and figure."""
    rig, move = command.target()
    check_one(command)
    sets_of(command.sets)
    folder = output_folder(command.output, f"results/compare-{command.label()}")
    how = how_of(command, folder)
    policies = policies_for(rig, command.policy)
    if status := refuse(INFEASIBLE, problems_of(rig, move)):
        return status
    episodes, left_out = episodes_for(rig, move, command)
    make_folder(folder)
    keep = folder / "trajectories" if command.trajectories else None
    comparison = compare(rig, episodes, policies, keep, left_out, how)
    draw(comparison, folder / "figure.png")
    report(comparison, folder, command.json)
    return DONE


def episodes_for(
    rig: Rig, move: Move, command: options.Compare
) -> tuple[dict[str, list[Episode]], list[str]]:
    """The episodes that are asked for, by their sets, and why some sets are left out."""
    if command.nominal:
        return {OWN: [Episode(move, Scenario())]}, []
    return gather(rig, move, command.scenarios, number_of(command), command.sets)


def number_of(command: options.Compare) -> int:
    """Number of episodes in sets other than that with the own move."""
    return command.episodes or ceil(OTHERS * command.scenarios)


def compare(
    rig: Rig,
    episodes: Mapping[str, Sequence[Episode]],
    policies: Mapping[str, Policy],
    keep: Path | None = None,
    left_out: Sequence[str] = (),
    how: How = ONE_BY_ONE,
) -> Comparison:
    """Drive the episodes of all sets with every contender.

    Parameters
    ----------
    rig
        The crane.
    episodes
        Of each set by its name; the first one is told of in full.
    policies
        Policies of learned contenders by their sensors; those without one are left out.
    keep
        Folder for the trajectories of every contender; None keeps none.
    left_out
        Sets that the rig cannot make, and why.
    how
        Where contenders are driven.

    Raises
    ------
    OptionError
        The policy does not suit the environment.
    OutputError
        Trajectories cannot be written.
    """
    given = tuple((name, tuple(chosen)) for name, chosen in episodes.items())
    for sensors, policy in policies.items():
        check(policy.card, runner_of(rig, given, sensors).task)

    def entry_of(contender: Contender) -> CraneEntry:
        policy = policies[contender.sensors] if contender.learned else None
        return CraneEntry(rig, given, contender, policy, keep is not None)

    driven = drive_all("crane", entry_of, Metrics, how, policies)
    if keep is not None:
        write_trajectories(keep, driven.found)
    sets = {
        name: OnSet(SETS[name].title, chosen, [found.runs[name] for found in driven.found])
        for name, chosen in episodes.items()
    }
    first = next(iter(sets.values()))
    scenarios = [episode.scenario for episode in first.episodes]
    turned = np.isfinite(first.runs[0].metrics.turn).any()
    return Comparison(
        kind="rig",
        name=rig.name,
        thing="Load",
        units=UNITS,
        scenarios=scenarios,
        arrival=feedforward.from_move(first.episodes[0].move, rig).duration,
        runs=first.runs,
        absent=driven.absent,
        refused=driven.refused,
        columns=(*COLUMNS, TURN) if turned else COLUMNS,
        cells={
            "settled": lambda metrics: str(int(metrics.settled.sum())),
            "ended\nearly": lambda metrics: str(int(metrics.failed.sum())),
        },
        notes=NOTES + (f" {INTERVALS}" if len(scenarios) > 1 else ""),
        residual=_origins(rig, policies),
        relative=True,
        sets=sets,
        left_out=left_out,
    )


def policies_for(rig: Rig, file: str = "") -> dict[str, Policy]:
    """The policy of a file, or those that are shipped for a rig, by their sensors.

    Raises
    ------
    OptionError
        The file cannot be read, or is none.
    """
    if file:
        policy = Policy.load(file)
        return {policy.card.sensors: policy}
    found = {sensors: shipped(rig, sensors) for sensors in SENSORS}
    return {sensors: policy for sensors, policy in found.items() if policy is not None}


def _origins(rig: Rig, policies: Mapping[str, Policy]) -> str:
    """Where policies come from, in words."""
    if not policies:
        return f"no policy is shipped for {rig.name} with these numbers"
    return "; ".join(
        f"{sensors} by {policy.card.training.get('command')}"
        for sensors, policy in policies.items()
    )
