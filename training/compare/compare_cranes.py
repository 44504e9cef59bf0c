"""`flatrig compare`: controllers side by side over the same disturbed scenarios.

Every controller drives all scenarios at once, in one vector environment.  The scenarios are one
Latin hypercube from a seed that training never uses, so a difference between two controllers is
a difference between controllers, and intervals are of paired bootstrap resamples.
"""

from collections.abc import Callable, Sequence
from functools import cache, partial
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from ... import feedforward
from ...envs import CraneVectorEnv
from ...envs.crane.disturbances import Disturbances, Scenario, design
from ...envs.crane.payloads import payloads
from ...models import Move, Rig
from ...models.files import make_folder
from .. import options
from ..describe.feasible import INFEASIBLE, problems_of
from ..exits import DONE, refuse
from ..learned import check
from ..policy import Policy, shipped
from .contenders import EVALUATION_SEED, Contender
from .driving import drive_all, periods
from .figure import draw
from .metrics import LASTING, SETTLED, Record, between, measure
from .report import INTERVALS, Column, Comparison, Run, report

HOLD = 4.0
"""How long a run goes on after arrival [s]."""
COLUMNS = (
    Column("rmse", "tracking\nRMSE [mm]", 1e3, 1),
    Column("largest", "largest\nerror [mm]", 1e3, 0),
    Column("swing", "swing after\narrival [mm]", 1e3, 1),
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


def environment(rig: Rig, move: Move, num: int, **more: Any) -> Any:
    """The vector environment in which controllers are trained and compared."""
    options: dict[str, Any] = {"disturbances": Disturbances.standard(rig), "hold": HOLD} | more
    return CraneVectorEnv(rig, num_envs=num, reference=move, **options)


def scenarios_for(rig: Rig, number: int, seed: int = EVALUATION_SEED) -> list[Scenario]:
    """Scenarios from the standard disturbances of a rig."""
    return design(Disturbances.standard(rig), number, seed)


class Runner:
    """Drives the same scenarios with one controller after the other."""

    def __init__(self, rig: Rig, move: Move, scenarios: Sequence[Scenario], **more: Any) -> None:
        self.scenarios = list(scenarios)
        self.env = environment(rig, move, len(self.scenarios), **more)
        self.task = self.env.unwrapped.task
        self.reference = feedforward.from_move(move)
        self.arrival = self.reference.duration
        self.steps = round((self.arrival + HOLD) / self.task.period)

    def drive(self, wrap: Callable[[Any], Any]) -> Record:
        """Run all scenarios to their end.

        Parameters
        ----------
        wrap
            Puts the controller around the environment.
        """
        task, num = self.task, len(self.scenarios)
        rows = [
            (alive, *(np.array(info[name]) for name in ("load", "input", "tension")))
            for alive, info in islice(periods(wrap(self.env), self.scenarios), self.steps)
        ]
        alive, outputs, inputs, tensions = map(np.array, zip(*rows, strict=True))
        times = task.period * np.arange(1, self.steps + 1)
        path = np.repeat(self.reference(times)[:, None], num, axis=1)
        places, angles = carried(task.rig)
        return Record(
            times=times,
            arrival=np.full(num, self.arrival),
            load=outputs[..., places],
            reference=path[..., places],
            inputs=inputs / task.limits,
            tensions=tensions,
            alive=alive,
            turn=between(path[..., angles], outputs[..., angles]) if angles else None,
        )


def carried(rig: Rig) -> tuple[list[int], list[int]]:
    """Outputs that say where the load or platform is, z last, and a platform's angles.

    All outputs stand for the place where none of them is a coordinate of what is carried.
    """
    names = list(rig.outputs)
    part = payloads(rig)[0]
    coordinates = [f"{part.name}.{axis}" for axis in rig.axes]
    places = [names.index(name) for name in coordinates if name in names]
    angles = [names.index(name) for name in getattr(part, "angles", ()) if name in names]
    return places or list(range(len(names))), angles if len(angles) == 3 else []


def main(command: options.Compare) -> int:
    """Compare, print the table, and save tables and figure."""
    rig, move = command.target()
    options.check_number("--scenarios", command.scenarios, lowest=1, open_end=False)
    folder = Path(command.output or f"results/compare-{command.label()}")
    policy = Policy.load(command.policy) if command.policy else shipped(rig)
    if status := refuse(INFEASIBLE, problems_of(rig, move)):
        return status
    scenarios = [Scenario()] if command.nominal else scenarios_for(rig, command.scenarios)
    make_folder(folder)
    if policy is None:
        origin = f"no policy is shipped for {rig.name} with these numbers"
    else:
        origin = command.policy or f"shipped with flatrig, {policy.card.training.get('command')}"
    comparison = compare(rig, move, scenarios, policy, origin)
    draw(comparison, folder / "figure.png")
    report(comparison, folder, command.json)
    return DONE


def compare(
    rig: Rig, move: Move, scenarios: Sequence[Scenario], policy: Policy | None, origin: str = ""
) -> Comparison:
    """Drive the scenarios with every contender.

    Parameters
    ----------
    rig, move
        The crane and its move.
    scenarios
        How each plant differs from the rig.
    policy
        Policy of the learned contenders, which are left out without one.
    origin
        Where the policy comes from, in words.

    Raises
    ------
    OptionError
        The policy does not suit the environment.
    """
    runner = cache(lambda sensors: Runner(rig, move, scenarios, sensors=sensors))
    if policy is not None:
        check(policy.card, runner(policy.card.sensors).task)

    def drive(entry: Contender) -> Run:
        if policy is not None and entry.learned:
            record = runner(policy.card.sensors).drive(partial(entry.wrap, policy=policy))
        else:
            record = runner(entry.sensors).drive(entry.wrap)
        return Run(entry, record.times, record.distance, measure(record))

    runs, absent = drive_all("crane", drive, learned=policy is not None)
    turned = np.isfinite(runs[0].metrics.turn).any()
    return Comparison(
        kind="rig",
        name=rig.name,
        thing="Load",
        units=UNITS,
        scenarios=scenarios,
        arrival=feedforward.from_move(move).duration,
        runs=runs,
        absent=absent,
        columns=(*COLUMNS, TURN) if turned else COLUMNS,
        cells={
            "settled": lambda metrics: str(int(metrics.settled.sum())),
            "ended\nearly": lambda metrics: str(int(metrics.failed.sum())),
        },
        notes=NOTES + (f" {INTERVALS}" if len(scenarios) > 1 else ""),
        residual=origin,
        relative=True,
    )
