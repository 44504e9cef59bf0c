"""How a policy learns: it drives, and a teacher that knows the truth says what it should have done.

That is DAgger (Ross, Gordon and Bagnell 2011).  Every iteration has new moves, holds and plants:
on moves that it has seen before, a policy is soon better than on any other.  The teacher drives
half of the first episodes, so that the lessons hold good behaviour from the start.

The policy is fitted to what the teacher adds to the base controller.  What an error of an action
costs follows from the teacher's own Riccati recursion, which weighs the drives against each other
and makes errors count most where loads are hard to bring back.
"""

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any, NamedTuple

import numpy as np
import torch

from ...envs.crane.disturbances import Disturbances
from ...envs.crane.linear_plans import lineariser_for
from ...envs.crane.optimal_feedback import Weights
from ...models import Move, Rig, fingerprint
from ...models.types import Array, Mask
from ..gate import Gate
from ..learned import features_of
from ..policy import Card, Policy
from .crane_teacher import CraneTeacher
from .rollout import RESOLUTIONS, UNDISTURBED, Classroom, Episode, Seen, draw_episodes
from .settings import Settings
from .student import Lessons, School, Student, normalised


class Progress(NamedTuple):
    """What an iteration was like."""

    iteration: int
    """Its number, from 1."""
    lessons: int
    """Lessons so far."""
    loss: float
    """Mean loss of the actions."""
    heads: float
    """Mean loss of the heads."""
    rmse: float
    """Mean tracking error of its episodes [m]."""
    early: int
    """Its episodes that ended early."""


class Training:
    """A policy in the making.

    Parameters
    ----------
    rig, move
        The crane, and a move of it, in whose box moves are drawn.
    sensors
        "encoders", "sway" or "full".
    seed
        Of the network, the exploration, moves and plants.
    settings
        All other numbers.
    nthread
        Threads of the simulation.
    """

    def __init__(
        self, rig: Rig, move: Move, *, sensors: str = "encoders", seed: int = 0,
        settings: Settings | None = None, nthread: int = 2,
    ) -> None:  # fmt: skip
        torch.set_num_threads(nthread)
        torch.manual_seed(seed)
        self.rig, self.move, self.sensors, self.seed = rig, move, sensors, seed
        self.nthread = nthread
        self.settings = settings or Settings.of(sensors)
        self.disturbances = replace(Disturbances.standard(rig), delay=self.settings.delays)
        self.room = Classroom(
            rig, move, self.settings.episodes, sensors=sensors, disturbances=self.disturbances,
            nthread=nthread,
        )  # fmt: skip
        self.iteration = 0
        self.lessons = Lessons(seed)
        self.units = np.zeros(len(rig.drives))
        self.box: tuple[tuple[float, ...], tuple[float, ...]] = tuple(move.start), tuple(move.goal)
        self._drives = len(rig.drives)
        self._lineariser = lineariser_for(self.room.task, nthread=nthread)

    def step(self) -> Progress:
        """One iteration: drive, listen, learn."""
        settings, k = self.settings, self.iteration
        rng = np.random.default_rng((self.seed, k))
        episodes = draw_episodes(
            self.rig, self.move, settings.episodes, rng, disturbances=self.disturbances,
            period=self.room.task.period, holds=settings.holds,
        )  # fmt: skip
        self._see_moves(episodes)
        teacher = self.teacher(self.room, episodes)
        taught = settings.taught[k] if k < len(settings.taught) else 0.0
        seen = self.room.run(
            episodes, self._act, teacher, seed=int(rng.integers(2**31)), taught=taught,
            restless=settings.restless * self.units,
        )  # fmt: skip
        if k == 0:
            self._see_efforts(seen)
            self._make_network()
        self._take_in(seen, rng)
        self.iteration += 1
        share = 1.0 - 0.3 * min(1.0, k / 8)
        loss, aside = self.school.fit(
            self.lessons, settings.updates * (2 if k == 0 else 1), share, 0.7 * share
        )
        return Progress(
            self.iteration, len(self.lessons), loss, aside, float(seen.rmse.mean()),
            int(seen.early.sum()),
        )  # fmt: skip

    def teacher(self, room: Classroom, episodes: Sequence[Episode]) -> CraneTeacher:
        """A teacher of episodes in a room."""
        plans, scenarios = zip(*episodes, strict=True)
        suited = Weights.of(self.rig, room.task.scales)
        weights = replace(suited, change=self.settings.change)
        return CraneTeacher(
            room.task, plans, scenarios, lineariser=self._lineariser, delay=self.settings.delay,
            weights=weights,
        )  # fmt: skip

    def finish(self) -> tuple[float, float]:
        """Fit the network to all lessons with a rate that falls to nothing."""
        return self.school.fit(self.lessons, self.settings.last_updates, 0.7, 0.01)

    def policy(self, **training: object) -> Policy:
        """The policy as it stands; `training` goes into its card."""
        task, settings = self.room.task, self.settings
        card = Card(
            plant=self.rig.name, fingerprint=fingerprint(self.rig), sensors=self.sensors,
            rate=1.0 / task.period, feature_names=self._features.names,
            action_names=task.acting.names, time_constants=settings.time_constants,
            gains=tuple(self.room.gains.tolist()), units=tuple(self.units.tolist()),
            reach=settings.reach,
            usual=tuple(self.usual.tolist()), gate=settings.gate,
            speeds=tuple(self.speeds.tolist()), box=self.box, heads=self.room.heads,
            training=dict(training),
        )  # fmt: skip
        return Policy(card, self.student.export(self.mean, self.scale))

    def subject(self) -> dict[str, object]:
        """What the policy is trained on, for its card."""
        return {
            "moves": "random_move: ends in the box, half of them on its edges",
            "holds": self.settings.holds,
            "encoder_resolutions": RESOLUTIONS,
            "undisturbed_plants": f"every {UNDISTURBED}th",
            "disturbances": asdict(self.disturbances),
        }

    def _see_moves(self, episodes: Sequence[Episode]) -> None:
        """How fast drives move at first, and where loads go, in the moves of training."""
        drives, outputs = self._drives, self.room.task.rows.parts["outputs"].shape[1]
        rows = np.concatenate([episode.plan.rows for episode in episodes])
        # Moves are drawn in the box of the given one; what curves out of it is seen here.
        places = np.vstack((*self.box, rows[:, 2 * drives :][:, :outputs]))
        self.box = tuple(places.min(axis=0).tolist()), tuple(places.max(axis=0).tolist())
        if self.iteration == 0:
            self.speeds = np.maximum(np.abs(rows[:, drives : 2 * drives]).max(axis=0), 1e-3)
            self._look()

    def _act(self, fresh: Mask) -> tuple[Array, Array]:
        """Features, and what the student behind its gate adds, nothing before the first fit."""
        seen = self._features.look(fresh)
        if self.iteration == 0:
            return seen, np.zeros((len(seen), self._drives))
        share = self.gate.open(self.room.task.encoders.errors[:, : self._drives], fresh)
        with torch.no_grad():
            x = torch.from_numpy(normalised(seen, self.mean, self.scale))
            action = self.student(x)[0].numpy().astype(float)
        reach = self.settings.reach
        return seen, share * self.units * np.clip(action, -reach, reach)

    def restore(self, iteration: int, found: dict[str, Any]) -> None:
        """Go on from an iteration with what was found out before it."""
        for name, value in found.items():
            setattr(self, name, value)
        self.iteration = iteration
        self._look()
        self._make_network()

    def _see_efforts(self, seen: Seen) -> None:
        """Choose units and normalisation after the first episodes."""
        wanted, features = (part[seen.going].astype(float) for part in (seen.wanted, seen.features))
        size = np.sqrt(np.square(wanted).mean(axis=0))
        self.units = np.maximum(size, self.settings.least_unit)
        # The drives' position errors are the first features.
        self.usual = np.sqrt(np.square(features[:, : self._drives]).mean(axis=0))
        self.mean, spread = features.mean(axis=0), features.std(axis=0)
        self.scale = np.where(spread > 1e-9, spread, 1.0)
        weights = seen.weights[seen.going] * self.units[:, None] * self.units
        self.weight = float(np.trace(weights.mean(axis=0)) / self._drives)

    def _look(self) -> None:
        """Make the features."""
        time_constants = self.settings.time_constants
        self._features = features_of(self.room.task, self.room.mass, self.speeds, time_constants)

    def _make_network(self) -> None:
        """Gate and network, and what fits it."""
        task, settings = self.room.task, self.settings
        self.gate = Gate(self.usual, *settings.gate, task.period)
        count, heads = len(self._features.names), len(self.room.heads)
        self.student = Student(count, self._drives, heads, settings.width)
        self.school = School(self.student, settings.batch, settings.rate)

    def _take_in(self, seen: Seen, rng: np.random.Generator) -> None:
        """Turn a share of what was seen into lessons."""
        picked = seen.going & (rng.random(seen.going.shape) < self.settings.kept)
        reach = self.settings.reach
        self.lessons.add(
            normalised(seen.features[picked], self.mean, self.scale),
            np.clip(seen.wanted[picked] / self.units, -reach, reach),
            seen.truth[picked],
            self._roots(seen.weights[picked].astype(float)),
        )

    def _roots(self, weights: Array) -> Array:
        """Transposed Cholesky factors of weights in units, of bounded contrast."""
        scaled = weights * self.units[:, None] * self.units / self.weight
        roots = np.linalg.cholesky(scaled + 1e-3 * np.eye(self._drives)).swapaxes(1, 2)
        size = np.sqrt(np.square(roots).sum(axis=(1, 2), keepdims=True) / self._drives)
        return np.asarray(roots / size * np.clip(size, *self.settings.contrast))
