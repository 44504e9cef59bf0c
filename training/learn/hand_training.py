"""How a hand's policy learns: it drives, and a teacher says what it should have done (DAgger).

As a crane's, on new moves and plants in every iteration, but in a minute: episodes are short, what
encoders tell they tell at once, and it is linear.  How far an object hangs aside of its place is to
first order a weighted sum of how hard feedback pulls at every finger, whatever the pose.  So of the
network only the layer that skips the others is used, and it is found by ridge regression over all
iterations.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...envs import HandDisturbances, HandScenario, HandVectorEnv
from ...envs.controllers import PDLaw
from ...envs.hand.plan import HandPlan
from ...envs.laws import laws_of
from ...models import Hand, HandMove
from ...models.types import Array, Mask
from ..gate import Gate
from ..learned import base_controller, features_of
from ..network import CLIP, LAYERS, Network
from ..policy import Card, Policy, fingerprint_of
from ..random_hand_moves import random_hand_plan
from .hand_teacher import HandTeacher

TIME_CONSTANTS = (0.02, 0.1)
"""Of the features' filters [s]."""
UNDISTURBED = 6
"""Every so many-th plant is as described."""
TRUE = 0.8
"""Share of the plants whose encoders are right.  What a law makes of wrong ones it pays for with
right ones: of what is told to it, a corner of plates leaves 60 % where half of them are wrong."""
CLOSING = 0.2
"""Time in which fingers close on an object that lies aside, and nothing is learned [s]."""
EVERY = 10
"""Control periods from one lesson to the next, which would tell the same."""
RIDGE = 1e-5
"""Weight of the squared numbers of the network, over the number of lessons."""
REACH = 6.0
"""Largest action, in units: root mean squares of what the teacher wants."""
GATE = (0.1, 0.3, 10.0)
"""Evidence at which the residual begins and counts whole, and its time constant [s]."""
WANDER, RESTLESS = 1.0, 1e-4
"""Exploration moves all fingers at random: how fast it forgets [1/s], and its size [m]."""
PACE = 2.0
"""How much faster than in training moves may be before the residual begins to fade: what the law
corrects is statics, which knows of no speed."""
FRICTION = (0.8, 1.2)
"""Friction of contacts over the hand's, in training."""


def hand_disturbances(hand: Hand) -> HandDisturbances:
    """The standard ones, but friction may be 20 % less, too."""
    return replace(HandDisturbances.standard(hand), friction=FRICTION)


class Driven(NamedTuple):
    """How n episodes went, and what a teacher noted of their T periods."""

    ends: Array
    """Errors of the objects' poses at the end, (n, 6) [m, rad]."""
    rmse: Array
    """Root mean square distances [m], (n,)."""
    early: Mask
    """Episodes that ended early, (n,)."""
    features: Array
    """(T, n, features)."""
    wanted: Array
    """Residuals that the teacher wanted, over the limits, (T, n, drives)."""
    going: Mask
    """(T, n)."""


class HandRoom:
    """Simulations of a hand with feedforward and PD, and a teacher beside them."""

    def __init__(self, hand: Hand, move: HandMove, num: int, *, nthread: int) -> None:
        env = base_controller(
            HandVectorEnv(hand, num_envs=num, reference=move, nthread=nthread, hold=1.0)
        )
        self.task = env.unwrapped.task
        self._laws = list(laws_of(env))
        servo = next(law for law in self._laws if isinstance(law, PDLaw))
        self.gains = servo.gains
        """Of the PD, over the limits, (2 drives,)."""
        self._teacher = HandTeacher(self.task, servo)

    def plans(self, move: HandMove, rng: np.random.Generator) -> list[HandPlan]:
        """One of a random move for each simulation."""
        return [random_hand_plan(self.task, move, rng) for _ in range(self.task.num)]

    def scenarios(self, rng: np.random.Generator, true: float = TRUE) -> list[HandScenario]:
        """Plants, some of them as described, and a share of them with true encoders."""
        ranges = hand_disturbances(self.task.hand)
        drawn = [ranges.draw(rng) for _ in range(self.task.num)]
        exact = rng.permutation(self.task.num) < true * self.task.num
        return [
            replace(scenario, offset=0.0 if exact[k] else scenario.offset)
            if k % UNDISTURBED
            else HandScenario()
            for k, scenario in enumerate(drawn)
        ]

    def run(
        self,
        plans: list[HandPlan],
        scenarios: list[HandScenario],
        residual: Callable[[Mask], tuple[Array, Array]],
        *,
        noted: bool = False,
        rng: np.random.Generator | None = None,
    ) -> Driven:
        """Run episodes to their ends.

        Parameters
        ----------
        plans, scenarios
            One for each simulation.
        residual
            Features and what is added over the limits, told which episodes are new.
        noted
            Whether to note what the teacher wants.
        rng
            Of exploration; none without.
        """
        task, num = self.task, self.task.num
        task.reset(task.all, [np.random.default_rng(0)] * num, scenarios, plans)
        going, early = np.ones(num, bool), np.zeros(num, bool)
        ends, squares, walk = np.zeros((num, 6)), np.zeros(num), np.zeros((num, 3))
        decay, notes = np.exp(-WANDER * task.period), []
        kick = RESTLESS * np.sqrt(1.0 - decay**2)
        while going.any():
            fresh = task.steps == 0
            features, added = residual(fresh)
            if noted:
                wanted = self._teacher.advice()
                notes.append((*(part.astype(np.float32) for part in (features, wanted)), going))
            if rng is not None:
                walk = decay * walk + kick * rng.standard_normal(walk.shape)
                added = added + self._teacher.carried(walk)
            self._teacher.sent(added, fresh)
            total = added
            for law in self._laws:
                total = law.apply(total)
            ids = None if going.all() else np.flatnonzero(going).astype(np.int32)
            outcome = task.step(total, ids)
            errors = task.pose_errors()
            ends = np.where(going[:, None], errors, ends)
            squares += np.where(going, np.square(errors[:, :3]).sum(axis=1), 0.0)
            early |= going & outcome.terminated
            going = going & ~(outcome.terminated | outcome.truncated)
        columns = map(np.array, zip(*notes, strict=True)) if notes else [np.zeros(0)] * 3
        return Driven(ends, np.sqrt(squares / task.steps), early, *columns)


class HandTraining:
    """A policy for a hand in the making.

    Parameters
    ----------
    hand, move
        The hand, and a move like which others are drawn.
    seed
        Of moves, plants and exploration.
    episodes
        Of an iteration, side by side.
    nthread
        Threads of the simulation.
    """

    def __init__(
        self, hand: Hand, move: HandMove, *, seed: int, episodes: int, nthread: int
    ) -> None:
        self.hand, self.move, self.seed, self.iteration = hand, move, seed, 0
        self.room = HandRoom(hand, move, episodes, nthread=nthread)
        self._features = features_of(self.room.task, None, np.zeros(0), TIME_CONSTANTS)
        self._drives, width = len(self.room.task.limits), len(self._features.names)
        self._squares = np.zeros((width + 1, width + 1))
        self._products = np.zeros((width + 1, self._drives))
        self._linear = np.zeros((width + 1, self._drives))
        self._rows: list[Array] = []

    def step(self) -> dict[str, float]:
        """One iteration: drive, listen, learn."""
        rng = np.random.default_rng((self.seed, self.iteration))
        plans, scenarios = self.room.plans(self.move, rng), self.room.scenarios(rng)
        self._rows += [plan.rows for plan in plans]
        driven = self.room.run(plans, scenarios, self._act, noted=True, rng=rng)
        if self.iteration == 0:
            self._see(driven)
        loss = self._learn(driven)
        self.iteration += 1
        return {
            "iteration": self.iteration,
            "lessons": float(self._squares[-1, -1]),
            "loss": loss,
            "place": float(np.linalg.norm(driven.ends[:, :3], axis=1).mean()),
            "early": float(driven.early.sum()),
        }

    def policy(self, **training: object) -> Policy:
        """The policy as it stands; `training` goes into its card."""
        rows, drives, task = np.concatenate(self._rows), self._drives, self.room.task
        places, near = rows[:, 2 * drives :][:, :3], self.hand.held.radius
        # Round objects look the same however they are turned: no turn is outside of the box.
        low, high = (places.min(axis=0) - near).tolist(), (places.max(axis=0) + near).tolist()
        speeds = PACE * np.maximum(np.abs(rows[:, drives : 2 * drives]).max(axis=0), 1e-3)
        card = Card(
            plant=self.hand.name, fingerprint=fingerprint_of(self.hand), sensors="encoders",
            rate=1.0 / task.period, feature_names=self._features.names,
            action_names=task.acting.names, time_constants=TIME_CONSTANTS,
            gains=tuple(self.room.gains.tolist()), units=tuple(self.units.tolist()),
            reach=REACH, usual=tuple(self.usual.tolist()),
            gate=GATE, speeds=tuple(speeds.tolist()),
            box=((*low, *[-1.0] * 9), (*high, *[1.0] * 9)),
            training=dict(training),
        )  # fmt: skip
        return Policy(card, self._network())

    def _network(self) -> Network:
        """The linear law as a network whose hidden layers are one neuron that says nothing."""
        width, drives = len(self._features.names), self._drives
        shapes = {
            "first": (1, width), "second": (1, 1), "heads": (0, 1), "mixed": (1, 1),
            "action": (drives, 1),
        }  # fmt: skip
        weights = {name: np.zeros(shape) for name, shape in shapes.items()}
        weights["skip"] = self._linear[:-1].T
        biases = {name: np.zeros(len(weights[name])) for name in LAYERS}
        biases["skip"] = self._linear[-1]
        return Network(weights, biases, self.mean, self.scale)

    def _act(self, fresh: Mask) -> tuple[Array, Array]:
        """Features, and what the pupil behind its gate adds, nothing before the first lesson."""
        seen = self._features.look(fresh)
        if self.iteration == 0:
            return seen, np.zeros((len(seen), self._drives))
        share = self._gate.open(self.room.task.encoders.errors[:, : self._drives], fresh)
        return seen, share * self.units * np.clip(self._network()(seen)[0], -REACH, REACH)

    def _see(self, driven: Driven) -> None:
        """Choose units, normalisation and gate after the first episodes."""
        wanted, features = _lessons(driven, self.room.task.period)
        # A drive that the teacher never moves, as those that turn tips, has a unit of next to none.
        self.units = np.maximum(np.sqrt(np.square(wanted).mean(axis=0)), 1e-9)
        errors = features[:, : self._drives]
        self.usual = np.maximum(np.sqrt(np.square(errors).mean(axis=0)), 1e-9)
        self.mean, spread = features.mean(axis=0), features.std(axis=0)
        self.scale = np.where(spread > 1e-12, spread, 1.0)
        self._gate = Gate(self.usual, *GATE, self.room.task.period)

    def _learn(self, driven: Driven) -> float:
        """Fit the law to all lessons so far; returns what is left of the new ones' variance."""
        wanted, features = _lessons(driven, self.room.task.period)
        wanted = np.clip(wanted / self.units, -REACH, REACH)
        seen = np.clip((features - self.mean) / self.scale, -CLIP, CLIP)
        seen = np.hstack((seen, np.ones((len(seen), 1))))
        self._squares += seen.T @ seen
        self._products += seen.T @ wanted
        ridge = RIDGE * self._squares[-1, -1] * np.eye(len(self._squares))
        self._linear = np.linalg.solve(self._squares + ridge, self._products)
        return float(np.square(wanted - seen @ self._linear).mean())


def _lessons(driven: Driven, period: float) -> tuple[Array, Array]:
    """What was wanted and what was seen, in some periods, (N, drives) and (N, features)."""
    which = slice(round(CLOSING / period), None, EVERY)
    going = driven.going[which]
    return driven.wanted[which][going].astype(float), driven.features[which][going].astype(float)
