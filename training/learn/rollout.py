"""Episodes from which a policy learns: many at once, each with a plan and a plant of its own."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ... import feedforward
from ...envs import CraneVectorEnv
from ...envs.controllers import PDLaw
from ...envs.crane.disturbances import Disturbances, Scenario
from ...envs.crane.mass_estimate import MassLaw
from ...envs.crane.plan import CranePlan, make_plan
from ...envs.crane.task import CraneTask
from ...envs.laws import laws_of
from ...models import Move, Rig
from ...models.types import Array, Mask
from ..compare.crane_runner import carried
from ..learned import base_controller
from ..random_moves import random_move
from .crane_teacher import CraneTeacher

TIMESTEP = 5e-3
"""Of the simulation in training [s]; judged is at the environments' own."""
UNDISTURBED = 6
"""Every so many-th plant is as described."""
RESOLUTIONS = (0.0, 1e-3)
"""Resolutions of encoders, in turn [m, rad]."""
WANDER, RESTLESS = 0.05, 0.3
"""Exploration is a random walk that forgets this share every period, and its step in units."""
UNITS = {"mass": 0.17, "wind": 0.015, "friction": 0.015, "offset": 0.03, "delay": 1.0}
"""What is one in each group of heads: about its standard deviation, forces over the weight."""
LOST = 1.0
"""Distance that counts from an early end on, at least [m]."""


class Episode(NamedTuple):
    """What an episode is about."""

    plan: CranePlan
    scenario: Scenario


def draw_episodes(
    rig: Rig,
    move: Move,
    num: int,
    rng: np.random.Generator,
    *,
    disturbances: Disturbances,
    period: float,
    holds: tuple[float, float],
) -> list[Episode]:
    """Random moves, plants, and holds [s] that episodes last after arrival."""
    episodes = []
    for k in range(num):
        reference = feedforward.from_move(random_move(rig, move, rng), rig)
        plan = make_plan(rig, reference, period, rng.uniform(*holds))
        drawn = disturbances.draw(rng)
        scenario = Scenario() if k % UNDISTURBED == 0 else drawn
        coarse = RESOLUTIONS[(k // 2) % len(RESOLUTIONS)]
        episodes.append(Episode(plan, replace(scenario, encoder_resolution=coarse)))
    return episodes


class Seen(NamedTuple):
    """What one rollout taught: T periods of n episodes, those marked that were still going on."""

    features: Array
    """Features, (T, n, features)."""
    wanted: Array
    """What the teacher would have added to the base controller, over the limits, (T, n, drives)."""
    truth: Array
    """What the heads ought to tell, (T, n, heads)."""
    weights: Array
    """What errors of the action cost, (T, n, drives, drives)."""
    going: Mask
    """Episodes that had not ended, (T, n)."""
    rmse: Array
    """Of the load over each episode [m], (n,)."""
    early: Mask
    """Episodes that ended early, (n,)."""


class Classroom:
    """Simulations of a crane with the base controller, and a teacher beside them.

    Parameters
    ----------
    rig, move
        The crane and a move of it.
    num
        Number of episodes side by side.
    sensors, rate, disturbances, nthread
        As those of the environments.
    """

    def __init__(
        self, rig: Rig, move: Move, num: int, *, sensors: str, disturbances: Disturbances,
        nthread: int, rate: float = 50.0,
    ) -> None:  # fmt: skip
        env = base_controller(
            CraneVectorEnv(
                rig, num_envs=num, reference=move, sensors=sensors, disturbances=disturbances,
                rate=rate, timestep=TIMESTEP, nthread=nthread,
            )
        )  # fmt: skip
        self.task: CraneTask = env.unwrapped.task
        self._laws = list(laws_of(env))
        self.mass = next(law for law in self._laws if isinstance(law, MassLaw))
        self._feedback = next(law for law in self._laws if isinstance(law, PDLaw))
        self.gains = self._feedback.gains
        """Gains of the PD below, each drive alone at home, over the limits."""
        self._places, _ = carried(rig)
        self.heads = head_names(rig, len(self._places))
        """What `Seen.truth` holds."""

    def run(
        self,
        episodes: Sequence[Episode],
        residual: Callable[[Mask], tuple[Array, Array]],
        teacher: CraneTeacher | None = None,
        *,
        seed: int,
        taught: float = 0.0,
        restless: Array | float = 0.0,
    ) -> Seen:
        """Run episodes to their ends, and note what a teacher would have done all along.

        Parameters
        ----------
        episodes
            One for each simulation.
        residual
            The pupil: features and what it adds to the base controller, over the limits; told
            which episodes are new.
        teacher
            A teacher of these episodes; without one nothing is noted but how they went.
        seed
            Of exploration and of the sensors' noise.
        taught
            Share of the episodes that the teacher drives.
        restless
            Steps of the exploration, over the limits, (drives,).
        """
        task, rng = self.task, np.random.default_rng(seed)
        self._begin(episodes, seed)
        led = (rng.random(task.num) < taught)[:, None]
        walk = np.zeros((task.num, len(task.limits)))
        going = np.ones(task.num, bool)
        score, notes = Score(task, self._places), []
        if teacher is not None:
            teacher.reset()
        while going.any():
            features, added = residual(task.steps == 0)
            walk += restless * rng.standard_normal(walk.shape) - WANDER * walk
            if teacher is not None:
                advice = teacher.advice()
                added = np.where(led, advice - self._base(), added) + walk
            total = added
            for law in self._laws[:-1]:
                total = law.apply(total)
            sent = self._laws[-1].apply(total)
            if teacher is not None:
                wanted = advice - (total - added)
                note = features, wanted, self._truth(teacher), teacher.weights
                notes.append((*(part.astype(np.float32) for part in note), going.copy()))
                teacher.sent(sent)
            ids = None if going.all() else np.flatnonzero(going).astype(np.int32)
            outcome = task.step(task.acting.of_actions(sent), ids)
            score.count(going, outcome.terminated)
            going &= ~(outcome.terminated | outcome.truncated)
        columns = zip(*notes, strict=True) if notes else [()] * 5
        features, wanted, truth, weights, marks = map(np.array, columns)
        return Seen(features, wanted, truth, weights, marks, score.rmse, score.early)

    def _begin(self, episodes: Sequence[Episode], seed: int) -> None:
        """Put every simulation at the start of its episode."""
        task = self.task
        generators = [np.random.default_rng((seed, i)) for i in range(task.num)]
        plans, scenarios = zip(*episodes, strict=True)
        task.reset(task.all, generators, scenarios, plans)

    def _truth(self, teacher: CraneTeacher) -> Array:
        """What a policy has to guess, in numbers of order one, (n, heads)."""
        return np.hstack([values / UNITS[name] for name, values in teacher.truth().items()])

    def _base(self) -> Array:
        """What the base controller is about to send, but for the next step of its estimate."""
        heavier = (self.mass.estimate - 1.0)[:, None] * self.mass.sensitivity
        planned = self.task.rows.parts["feedforward"]
        return np.asarray(planned + heavier + self._feedback.feedback())


def head_names(rig: Rig, places: int) -> tuple[str, ...]:
    """Names of what a policy has to guess of a rig with so many coordinates of the load."""
    winds = [f"wind {axis}" for axis in rig.axes[:-1]]
    offsets = [f"offset {axis}" for axis in range(places)]
    return ("mass", *winds, "winch friction", "trolley friction", *offsets, "delay")


class Score:
    """Root mean squares of the load's distance from its reference, over each episode."""

    def __init__(self, task: CraneTask, places: Sequence[int]) -> None:
        self._task, self._places = task, list(places)
        self._squares, self._periods = np.zeros(task.num), np.zeros(task.num)
        self.early = np.zeros(task.num, bool)

    def count(self, going: Mask, terminated: Mask) -> None:
        """Count a period; a load whose episode ends early counts as `LOST` to its end."""
        task = self._task
        apart = (task.plant.outputs - task.rows.parts["outputs"])[:, self._places]
        squares = np.square(apart).sum(axis=1)
        self._squares += np.where(going & ~terminated, squares, 0.0)
        self._periods += going
        ended = going & terminated
        left = task.rows.length - task.steps
        self._squares += np.where(ended, (left + 1) * np.maximum(squares, LOST**2), 0.0)
        self._periods += np.where(ended, left, 0)
        self.early |= ended

    @property
    def rmse(self) -> Array:
        """Of every simulation so far [m], (n,)."""
        return np.asarray(np.sqrt(self._squares / np.maximum(self._periods, 1)))
