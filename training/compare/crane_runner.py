"""Drives episodes of a crane, of whatever lengths, side by side with one controller after another.

    runner = EpisodeRunner(rig, episodes)
    record = runner.drive(lambda env: Feedforward(PD(env)))

All go on in one vector environment, in which an episode that is over stands still.  Each is, to the
last bit, what it would be alone.
"""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from ... import feedforward
from ...envs import CraneVectorEnv
from ...envs.crane.disturbances import Disturbances
from ...envs.crane.payloads import payloads
from ...envs.crane.plan import CranePlan, layout_of, make_plan
from ...models import Move, Rig
from ...models.types import Array
from .driving import periods
from .episode_sets import Episode
from .metrics import Record, between

TIMESTEP = 5e-3
"""Of the simulation [s]: tracking errors are those of 2 ms to five digits, at half the cost."""


class Contest(CraneVectorEnv):
    """Cranes whose episodes are not begun anew: each stands still once it is over."""

    def step(self, actions: Any) -> Any:
        """Hold inputs over one control period in those whose episodes go on."""
        task = self.task
        going = None
        if self.over.any():
            going = np.flatnonzero(~self.over).astype(np.int32)
        outcome = task.step(actions, going)
        info = task.info()
        return task.observation(), outcome.reward, outcome.terminated, outcome.truncated, info


class EpisodeRunner:
    """Drives the same episodes with one controller after the other; more options are the task's.

    Raises
    ------
    PathError, OptionError
        The rig cannot make a move.
    """

    def __init__(
        self,
        rig: Rig,
        episodes: Sequence[Episode],
        plans: Sequence[CranePlan] | None = None,
        **more: Any,
    ) -> None:
        self.episodes = list(episodes)
        options = {"timestep": TIMESTEP, "disturbances": Disturbances.standard(rig), **more}
        first = self.episodes[0].move
        self.env = Contest(rig, num_envs=len(self.episodes), reference=first, **options)
        self.task = self.env.task
        self.plans = plans_of(rig, self.episodes, self.task.period) if plans is None else plans
        self.lengths = np.array([plan.steps for plan in self.plans])
        """Control periods of each episode, shape (N,)."""

    def drive(self, wrap: Callable[[Any], Any]) -> Record:
        """Run all episodes to their ends; `wrap` puts the controller around the environment."""
        task, env = self.task, wrap(self.env)
        scenarios = [episode.scenario for episode in self.episodes]
        seeds = [episode.seed for episode in self.episodes]
        asked = {"scenarios": scenarios, "references": self.plans}
        steps = periods(env, asked, seeds)
        longest = int(self.lengths.max())
        seen = {
            name: np.empty((longest, *values.shape))
            for name, values in (("load", task.plant.outputs), ("input", task.plant.ctrl),
                                 ("tension", task.plant.tensions))
        }  # fmt: skip
        alive = np.empty((longest, len(self.episodes)), dtype=bool)
        for step in range(longest):
            alive[step], info = next(steps)
            for name, values in seen.items():
                values[step] = info[name]
            if self.env.over.all():  # all that is left has ended early
                for values in (alive, *seen.values()):
                    values[step + 1 :] = values[step]
                break
        times = task.period * np.arange(1.0, longest + 1)
        path = self._paths(longest)
        places, angles = carried(task.rig)
        load = seen["load"]
        return Record(
            times=times,
            arrival=np.array(
                [feedforward.from_move(e.move, task.rig).duration for e in self.episodes]
            ),
            load=load[..., places],
            reference=path[..., places],
            inputs=seen["input"] / task.limits,
            tensions=seen["tension"],
            alive=alive,
            turn=between(path[..., angles], load[..., angles]) if angles else None,
            lengths=self.lengths,
        )

    def _paths(self, longest: int) -> Array:
        """Where outputs ought to be at the ends of all periods, shape (T, N, outputs)."""
        outputs = layout_of(self.task.rig).columns["outputs"]
        steps = np.arange(1, longest + 1)
        return np.stack(
            [plan.rows[np.minimum(steps, plan.steps), outputs] for plan in self.plans], axis=1
        )


def plans_of(rig: Rig, episodes: Sequence[Episode], period: float) -> list[CranePlan]:
    """The plan of each episode; the same one where move and hold are the same."""

    @cache
    def plan(move: Move, hold: float) -> CranePlan:
        return make_plan(rig, feedforward.from_move(move, rig), period, hold)

    return [plan(episode.move, episode.hold) for episode in episodes]


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
