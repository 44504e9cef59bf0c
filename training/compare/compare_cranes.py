"""`flatrig compare`: controllers side by side over the same disturbed scenarios.

Every controller drives all scenarios at once, in one vector environment.  The scenarios are one
Latin hypercube from a seed that training never uses, so a difference between two controllers is
a difference between controllers, and intervals are of paired bootstrap resamples.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.progress import track

from ... import feedforward
from ...envs import PD, CraneVectorEnv, Feedforward, Residual
from ...envs.crane.disturbances import Disturbances, Scenario, design
from ...envs.crane.payloads import payloads
from ...models import Move, Rig
from ...models.errors import OptionError
from ...models.types import Array
from .. import options
from ..console import console
from ..policy import Policy, shipped
from .metrics import Metrics, Record, between, measure

EVALUATION_SEED = 2016_2001
"""Of the scenarios on which controllers are compared."""
HOLD = 4.0
"""How long a run goes on after arrival [s]."""

RESIDUAL = "FF + PD + residual"
BASE = "FF + PD"
CONTROLLERS: dict[str, Callable[[Any], Any]] = {
    "PD, set point": lambda env: PD(env, track="set point"),
    "PD, moving": lambda env: PD(env, track="moving"),
    "feedforward": Feedforward,
    BASE: lambda env: Feedforward(PD(env)),
}
"""Controllers without a learned part: name, and what wraps the environment."""


@dataclass(frozen=True, eq=False)
class Run:
    """One controller's runs over all scenarios."""

    name: str
    record: Record
    metrics: Metrics


def environment(rig: Rig, move: Move, num: int, **more: Any) -> Any:
    """The vector environment in which controllers are trained and compared."""
    given: dict[str, Any] = {"disturbances": Disturbances.standard(rig), "hold": HOLD} | more
    return CraneVectorEnv(rig, num_envs=num, reference=move, **given)


def with_residual(env: Any, fraction: float) -> Any:
    """The environment whose action is a residual on feedforward and PD."""
    return Residual(Feedforward(PD(env)), fraction=fraction)


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

    def drive(self, wrap: Callable[[Any], Any], policy: Policy | None = None) -> Record:
        """Run all scenarios to their end.

        Parameters
        ----------
        wrap
            Puts the controller around the environment.
        policy
            Of the action that is left free, zero without one.

        Raises
        ------
        OptionError
            The policy does not suit the environment.
        """
        task, num = self.task, len(self.scenarios)
        if policy is not None:
            policy.check(task)
            memory = policy.start(num)
        env = wrap(self.env)
        observation, _ = env.reset(seed=0, options={"scenarios": self.scenarios})
        action = np.zeros((num, len(task.action_names)))
        alive = np.ones(num, dtype=bool)
        rows: dict[str, list[Array]] = {"load": [], "input": [], "tension": []}
        living = []
        for _ in range(self.steps):
            if policy is not None:
                action = policy(observation, memory)
            observation, _, terminated, _, info = env.step(action)
            alive = alive & ~terminated
            living.append(alive)
            for name, row in rows.items():
                row.append(np.array(info[name]))
        times = task.period * np.arange(1, self.steps + 1)
        path = np.repeat(self.reference(times)[:, None], num, axis=1)
        outputs, (places, angles) = np.array(rows["load"]), carried(task.rig)
        return Record(
            times=times,
            arrival=np.full(num, self.arrival),
            load=outputs[..., places],
            reference=path[..., places],
            inputs=np.array(rows["input"]) / task.limits,
            tensions=np.array(rows["tension"]),
            alive=np.array(living),
            turn=between(path[..., angles], outputs[..., angles]) if angles else None,
        )

    def residual(self, policy: Policy | None, fraction: float = 1.0) -> Metrics:
        """Metrics of a residual policy on feedforward + PD, of these alone without one."""
        return measure(self.drive(lambda env: with_residual(env, fraction), policy))


def carried(rig: Rig) -> tuple[list[int], list[int]]:
    """Outputs that say where the load or platform is, z last, and a platform's angles.

    All outputs stand for the place where none of them is a coordinate of what is carried.
    """
    names = list(rig.outputs)
    part = payloads(rig)[0]
    wanted = [f"{part.name}.{axis}" for axis in rig.axes]
    places = [names.index(name) for name in wanted if name in names]
    angles = [names.index(name) for name in getattr(part, "angles", ()) if name in names]
    return places or list(range(len(names))), angles if len(angles) == 3 else []


def main(command: options.Compare) -> None:
    """Compare, print the table, and save tables and figure."""
    from .report import make_folder, show, write

    rig, move = command.target()
    if command.scenarios < 1:
        raise OptionError(f"--scenarios is {command.scenarios}, it must be >= 1")
    folder = Path(command.output or f"results/compare-{command.label()}")
    policy = Policy.load(command.policy) if command.policy else shipped(rig.name)
    scenarios = [Scenario()] if command.nominal else scenarios_for(rig, command.scenarios)
    make_folder(folder)
    runs = compare(rig, move, scenarios, policy)
    write(folder, rig, runs, scenarios)
    show(rig, runs, scenarios, folder, policy)
    if policy is not None:
        origin = command.policy or f"shipped with flatrig, {policy.card.training.get('command')}"
        console().print(f"residual: {origin}", style="dim", soft_wrap=True)
    else:
        console().print(f"residual: no policy is shipped for {rig.name}", style="dim")


def compare(
    rig: Rig, move: Move, scenarios: Sequence[Scenario], policy: Policy | None
) -> list[Run]:
    """Drive the scenarios with every controller, with the residual last if there is a policy."""
    sensors = policy.card.sensors if policy else "encoders"
    runner = Runner(rig, move, scenarios, sensors=sensors)
    if policy is not None:
        policy.check(runner.task)
    wraps = dict(CONTROLLERS)
    if policy is not None:
        fraction = policy.card.fraction
        wraps[RESIDUAL] = lambda env: with_residual(env, fraction)
    runs = []
    for name in track(wraps, "Driving", transient=True, console=console()):
        record = runner.drive(wraps[name], policy if name == RESIDUAL else None)
        runs.append(Run(name, record, measure(record)))
    return runs
