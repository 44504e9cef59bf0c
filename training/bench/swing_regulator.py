"""A regulator for a crane with one trolley, about what the wind holds: as cranebench's crane is.

Horizontally the load hangs s beside the trolley at x, on a rope of length l.  With the trolley's
acceleration a as input and small angles the load's mass drops out,

    d2x = a,        d2s = -omega^2 (s - w) - a,        omega^2 = gravity / l,

where w is how far aside a steady wind holds the load.  `SwingRegulator` drives the deviations from
the exact motion to x = 0, s = w, and there is nothing to be gained beyond: no trolley that stays
where it is can hold the load nearer.  It minimises

    sum of s^2 + (PLACE x)^2 + (EFFORT a)^2,

so the trolley may give way to a gust.  The acceleration becomes a force by the trolley's mass, less
what the rope pulls more than planned.

`SwingObserver` is the Kalman filter of (s, ds, w), w a random walk, from the trolley's measured
acceleration and readings of s.  Without a sensor on the load s follows from what the drives feel:
the force that the trolley's acceleration leaves over is the rope's horizontal pull P, the one that
the winch's leaves over its tension T, and s = l P / T.  This asks for commanded forces that really
act, and for a trolley that hardly rubs.  With a sensor the difference between what it sees and what
the drives feel is friction that nobody told of, and is made up for.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from ...envs.controllers import PDLaw
from ...envs.crane.riccati import Stage, recursion, stationary
from ...envs.laws import Law
from ...models import Rig, Trolley
from ...models.types import Array

PLACE = 0.05
"""How much the trolley's being off counts, over the load's hanging aside."""
EFFORT = 0.1
"""So far aside counts as much as an acceleration of the trolley of 1 m/s2 [s2]."""
GUSTS = 0.02
"""Random walk of where the wind holds the load, standard deviation [m / sqrt(s)]."""
NOISE = 3e-3
"""Standard deviation of a reading of s [m], as of flatrig's sensors "sway"."""
SLOW = 0.2
"""Time constant of the difference between what sensors see and drives feel [s]."""


class Numbers(NamedTuple):
    """What the regulator knows of the crane."""

    trolley: float
    """Mass of the trolley [kg]."""
    winch: float
    """What the winch's inertia weighs along the rope [kg]."""
    radius: float
    """Radius of the drum [m]."""
    gravity: float
    """[m/s2]."""
    viscous: tuple[float, float]
    """Of the trolley and, along the rope, of the winch [N s/m]."""


def numbers_of(rig: Rig, viscous: tuple[float, float]) -> Numbers:
    """Those of a planar crane with a trolley and a rope from a winch in it to the load."""
    trolley = next(part for part in rig.masses if isinstance(part, Trolley))
    (rope,) = rig.ropes
    winch = rope.winch_inertia / rope.drum_radius**2
    return Numbers(trolley.mass, winch, rope.drum_radius, rig.gravity, viscous)


def swinging(lengths: Array, gravity: float, period: float) -> tuple[Array, Array, Array]:
    """How (s, ds) go on over a period with a held acceleration and a steady wind.

    Parameters
    ----------
    lengths
        Of n ropes [m], shape (n,).
    gravity
        [m/s2].
    period
        [s].

    Returns
    -------
    tuple[Array, Array, Array]
        Transition (n, 2, 2), and what a (n, 2, 1) and w (n, 2, 1) add.
    """
    omega = np.sqrt(gravity / lengths)
    cos, sin = np.cos(omega * period), np.sin(omega * period)
    transition = np.stack((cos, sin / omega, -omega * sin, cos), axis=1).reshape(-1, 2, 2)
    pushed = np.stack(((cos - 1.0) / omega**2, -sin / omega), axis=1)[..., None]
    blown = np.stack((1.0 - cos, omega * sin), axis=1)[..., None]
    return transition, pushed, blown


class SwingObserver:
    """Estimates of s, ds and w for n cranes, shape (n, 3), from readings of s."""

    def __init__(self, lengths: Array, gravity: float, period: float) -> None:
        num = len(lengths)
        hanging, pushed, blown = swinging(lengths, gravity, period)
        self._transition = np.tile(np.eye(3), (num, 1, 1))
        self._transition[:, :2, :2], self._transition[:, :2, 2:] = hanging, blown
        self._pushed = np.concatenate((pushed[..., 0], np.zeros((num, 1))), axis=1)
        self._gain = self._kalman(GUSTS**2 * period)
        self.estimate = np.zeros((num, 3))

    def _kalman(self, variance: float) -> Array:
        """Gains in the long run, by the regulator of the transposed system, shape (n, 3)."""
        shape = self._transition.shape
        noise, reading = np.zeros(shape), np.zeros((shape[0], 3, 1))
        noise[:, 2, 2], reading[:, 0] = variance, 1.0
        accuracy = np.full((shape[0], 1, 1), NOISE**2)
        dual = _undisturbed(self._transition.swapaxes(1, 2), reading, noise, accuracy)
        covariance = stationary(dual).state
        return np.asarray(covariance[:, :, 0] / (covariance[:, :1, 0] + NOISE**2))

    def step(self, acceleration: Array, reading: Array) -> None:
        """Go on by a period with a mean acceleration (n,), then take a reading of s (n,)."""
        ahead = np.einsum("nij,nj->ni", self._transition, self.estimate)
        ahead += self._pushed * acceleration[:, None]
        self.estimate = ahead + self._gain * (reading - ahead[:, 0])[:, None]


def regulator_gains(lengths: Array, gravity: float, period: float) -> Array:
    """Gains of a = -gains @ (x, dx, s, ds), shape (n, 4)."""
    num = len(lengths)
    hanging, pushed, _ = swinging(lengths, gravity, period)
    transition = np.zeros((num, 4, 4))
    transition[:, :2, :2] = ((1.0, period), (0.0, 1.0))
    transition[:, 2:, 2:] = hanging
    inputs = np.zeros((num, 4, 1))
    inputs[:, :2, 0], inputs[:, 2:] = (0.5 * period**2, period), pushed
    cost = np.tile(np.diag((PLACE**2, 0.0, 1.0, 0.0)), (num, 1, 1))
    effort = np.full((num, 1, 1), EFFORT**2)
    stage = _undisturbed(transition, inputs, cost, effort)
    return recursion(lambda _: stage, 1, stationary(stage)).state[0, :, 0]


def _undisturbed(transition: Array, inputs: Array, cost: Array, effort: Array) -> Stage:
    """A stage whose disturbance is zero."""
    num, states = transition.shape[:2]
    return Stage(
        transition, inputs, np.zeros((num, states, 1)), np.zeros((num, 1, 1)), cost, effort
    )


class Reading(NamedTuple):
    """What the regulator keeps until the next period."""

    rates: Array
    """Measured rates of the drives, (n, drives)."""
    late: Array
    """How much slower the trolley is than planned, (n,) [m/s]."""
    aside: Array
    """How far aside the load is to hang, (n,) [m]."""


class SwingRegulator(Law):
    """Takes the trolley over from the PD below it; the winch stays with that."""

    name = "SwingRegulator"

    def __init__(self, task: Any, feedback: PDLaw, numbers: Numbers, lengths: Array) -> None:
        self._task, self._numbers, self._below = task, numbers, feedback
        self._gains = regulator_gains(lengths, numbers.gravity, task.period)
        self.observer = SwingObserver(lengths, numbers.gravity, task.period)
        self._before: Reading | None = None
        self._tension, self._unseen = np.zeros((2, len(lengths)))

    def apply(self, actions: Array) -> Array:
        """Set the trolley's input, over its limit."""
        task, errors = self._task, self._task.encoders.errors
        self._observe()
        aside, aside_rate, wind = self.observer.estimate.T
        if task.loads is not None:
            aside, aside_rate = self._seen()
        trolley = -errors[:, [0, len(task.limits)]]
        state = np.column_stack((trolley, aside - wind, aside_rate))
        wanted = self._numbers.trolley * -(self._gains * state).sum(axis=1)
        wanted -= self._tension * (aside + self._unseen) / task.encoders.positions[:, 1]
        changed = np.array(actions)
        changed[:, 0] += wanted / task.limits[0] - self._below.feedback()[:, 0]
        return changed

    def _observe(self) -> None:
        """Bring the observer and the tension up to date."""
        task, before = self._task, self._before
        planned, drives = task.rows.parts, len(task.limits)
        aside = planned["outputs"][:, 0] - planned["drives"][:, 0]
        late = task.encoders.errors[:, drives].copy()
        self._before = now = Reading(task.encoders.rates.copy(), late, aside)
        if before is None or not task.steps[0]:
            self.observer.estimate[:] = self._unseen[:] = 0.0
            holding = planned["holding"][:, 1] * task.limits[1]
            self._tension = -holding / self._numbers.radius
            return
        felt = self._feel(before.rates, now.rates) - 0.5 * (aside + before.aside)
        reading = felt if task.loads is None else self._seen()[0]
        self._unseen += -math.expm1(-task.period / SLOW) * (felt - reading - self._unseen)
        self.observer.step((before.late - now.late) / task.period, reading)

    def _feel(self, before: Array, now: Array) -> Array:
        """How far aside the load has hung over the last period, from what the drives feel, (n,)."""
        task, numbers = self._task, self._numbers
        inputs = task.commands * task.limits / (1.0, numbers.radius)
        left = (now - before) / task.period * (numbers.trolley, numbers.winch)
        left += 0.5 * (now + before) * numbers.viscous - inputs
        self._tension = left[:, 1]
        return np.asarray(task.encoders.positions[:, 1] * left[:, 0] / left[:, 1])

    def _seen(self) -> tuple[Array, Array]:
        """How far aside the load hangs beyond the plan, and how fast, by its sensors, (n,) each."""
        errors, loads = self._task.encoders.errors, self._task.loads
        drives = len(self._task.limits)
        return errors[:, 0] - loads.errors[:, 0], errors[:, drives] - loads.rate_errors[:, 0]
