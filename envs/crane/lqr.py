"""Linear-quadratic regulators with Kalman filters around the exact trajectory.

    env = Feedforward(PD(TautGuard(env)))
    env = LQR(env)         # with load sensors, "sway" or "full"
    env = Observer(env)    # or with encoders alone

What they add makes the feedback of `PD` that of the regulator, and the feedforward that of the load
as it was weighed.  The state z holds joints, rates and commands that are on their way, I integrals
of the errors that load sensors show, so that a steady wind leaves none:

    added = m s - K z - L I - P,      K, L from `optimal_feedback`, P what the PD gives.

Joints, rates and m are what a Kalman filter along the plan believes (`kalman`).  Encoders alone do
not tell wind from friction: `Observer` has no integrals, it damps the swing that drives feel.

A regulator that is too sure of its model fails on a plant that is another one.  These take commands
to be three periods late, one more than the longest of the standard disturbances, count with inputs
that are off by a tenth or a fifth of the limits, and with forces of no model on the load.

One that asks for more than drives have, or most of the time for more than `TautGuard` lets pass, is
unstable too: there softer ones take over (`softening`).

Limits: the linear models are those of the rig's own mass.  With wind among what the filter
believes, one crane of three got better and the rotary one let ropes go slack.
"""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...models.errors import OptionError
from ...models.rig.rig import Rig
from ...models.types import Array, Mask
from ...models.values import bounded
from ..controllers import FeedforwardLaw, PDLaw
from ..laws import AnyEnv, Law, laws_of, refuse_below, task_of, wrap
from .along_plans import AlongPlans
from .course_gains import CourseGains, Gains
from .kalman import KalmanFilter, Noise
from .linear_plans import lineariser_for
from .load_sensors import LoadSensors
from .mass_estimate import FARTHEST
from .optimal_feedback import Weights
from .outputs import levers
from .softening import Softening
from .task import CraneTask
from .taut_guard import GuardLaw

DELAY = 3
"""Control periods that the regulator takes commands to be late."""
LIKELY = 2
"""Those that the Kalman filter does."""
CHANGE = 0.05
"""Change of a command in one period, over the limits, that costs as much as an error of a
centimetre."""
PATIENCE = 1.0
"""Time in which a lasting error counts once more [s]."""
CALM = 0.002, 3.0
"""The two where a free pulley hangs in space: light, it swings between its ropes faster than a
regulator that is late can follow, and linear models of it hold nearby only."""
SOFTER = 1.0, 0.4, 0.15, 0.05, 0.015, 0.005
"""Changes of commands of all regulators, over the stiffest's, see `softening`."""
SLOWER = -1.0 / 3.0
"""Power of these with which patience grows: a mass that a force moves by its rate is regulated in a
time that goes with the cube root, and an integral that hurries ahead of that swings it up."""
SWAY = 0.1
"""Deviation of a joint that does [m, rad]: below a drive that is held a load swings as a pendulum,
whatever its mass; one that yields swings with it."""
NOISE = {
    "sway": Noise(inputs=0.2, wind=0.1, outputs=3e-3),
    "full": Noise(inputs=0.2, wind=0.1, outputs=1e-3),
    "encoders": Noise(inputs=0.1, wind=0.01, outputs=0.0, drives=1e-3),
}
"""What plants and sensors are taken for.  Where only drives tell of the load, whatever they feel is
more likely their own friction."""


class Below(NamedTuple):
    """What stands below a regulator."""

    feedback: PDLaw
    """Whose place it takes."""
    guard: GuardLaw | None
    """What lets pass no more than keeps ropes taut."""

    def limits(self, task: CraneTask) -> tuple[Array, Array]:
        """Lowest and highest command that reaches the drives, (n, drives) each."""
        if self.guard is not None:
            return self.guard.band()
        shape = task.num, len(task.limits)
        return np.broadcast_to(task.band.lowest, shape), np.broadcast_to(task.band.highest, shape)


class LQRLaw(Law):
    """u = m s - K z - L I instead of the PD below."""

    name = "LQR"

    def __init__(
        self, task: CraneTask, loads: LoadSensors | None, below: Below, weights: Weights
    ) -> None:
        self._task, self._loads, self._below = task, loads, below
        drives = len(task.limits)
        lineariser = lineariser_for(task)
        noise = NOISE["encoders" if loads is None else task.sensors]
        errors, self._late = np.full(drives, noise.drives), np.zeros(drives, bool)
        if loads is not None:
            outputs = noise.outputs / levers(task.rig, task.scales)
            errors = np.append(errors, outputs)
            self._late = np.append(self._late, np.full(len(outputs), loads.late > 0))
        self._gains = CourseGains(lineariser, task.scales, weights, DELAY, errors)
        self._table = AlongPlans(task, self._gains.of, lineariser.stride)
        states = 2 * lineariser.model.nv
        self.filter = KalmanFilter(task.num, states, noise, errors, task.period)
        """What it believes of the crane's state."""
        swing = task.scales.time / task.period
        self._softening = Softening(task.num, len(SOFTER), swing)
        self._sum = np.zeros((task.num, len(task.rig.outputs)))
        self._sent = np.zeros((task.num, DELAY, drives))

    @property
    def estimate(self) -> Array:
        """Mass of the loads over the rig's, (n,)."""
        return np.asarray(1.0 + np.clip(self.filter.estimate[:, -1], -FARTHEST, FARTHEST))

    @property
    def memory(self) -> tuple[NDArray[Any], ...]:
        """What was sent, integrals, beliefs, and which regulator is followed."""
        return self._sent, self._sum, *self.filter.memory, *self._softening.memory

    def apply(self, actions: Array) -> Array:
        """Put the regulator's feedback in the place of the PD's."""
        task, fresh = self._task, self._task.steps == 0
        gains = self._gains.split(self._table.now())
        self._remember(fresh)
        self._observe(gains, fresh)
        heavier = (self.estimate - 1.0)[:, None] * gains.slope[:, 0]
        on_the_way = (self._sent - heavier[:, None]).reshape(task.num, -1)
        known = [self.filter.estimate[:, :-1], on_the_way]
        if self._loads is not None:
            known.append(self._integrals(self._loads, fresh))
        planned = task.rows.parts["feedforward"]
        commands = (planned + heavier)[:, None] - np.matvec(
            gains.feedback, np.hstack(known)[:, None]
        )
        wanted = self._softening.choose(commands, *self._below.limits(task), fresh) - planned
        return np.asarray(actions + wanted - self._below.feedback.feedback())

    def _remember(self, fresh: Mask) -> None:
        """Take in what was sent beyond the feedforward; nothing was before `fresh` episodes."""
        task = self._task
        self._sent[:, 1:] = self._sent[:, :-1]
        self._sent[:, 0] = task.commands - task.rows.later("feedforward", -1)
        self._sent[fresh] = 0.0

    def _observe(self, gains: Gains, fresh: Mask) -> None:
        """Correct what was foreseen by what is measured, and foresee the next period."""
        measured = -self._task.encoders.errors[:, : len(self._task.limits)]
        if self._loads is not None:
            measured = np.hstack((measured, -self._loads.errors))
        if fresh.any():
            self.filter.begin(gains, measured, fresh)
        self.filter.correct(gains, measured, self._late)
        self.filter.foresee(gains, self._sent[:, LIKELY - 1])

    def _integrals(self, loads: LoadSensors, fresh: Mask) -> Array:
        """Integrals of scaled outputs, which wait where a drive is at its limit, (n, outputs)."""
        task = self._task
        free = (np.abs(task.commands) < 1.0).all(axis=1, keepdims=True)
        self._sum[fresh] = 0.0
        self._sum -= free * task.period * self._gains.outputs * loads.errors
        return self._sum


class ObserverLaw(LQRLaw):
    """The same from encoders alone."""

    name = "Observer"


def LQR(env: AnyEnv, *, change: float | None = None, patience: float | None = None) -> Any:
    """Regulate drives and loads around the exact trajectory, by encoders and load sensors.

    Parameters
    ----------
    env
        A crane with load sensors, `Feedforward` and a `PD` towards the moving reference, single
        or vector.
    change
        Change of a command in one period, over the limits, that costs as much as the load's error
        of a centimetre: more is quicker, and bears less delay and noise; 0.05 if left out, 0.002
        with a free pulley in space.
    patience
        Time in which a lasting error costs once more what it does at once [s]; 1, or 3 with such
        a pulley, if left out.

    Raises
    ------
    OptionError
        A number is not > 0, `env` is no crane, has no load sensors or lacks `PD` or `Feedforward`,
        or an `LQR`, `Observer`, `SwingDamping`, `MassEstimate` or `Residual` stands below.
    """
    task, below = _below(env, "LQR")
    if task.loads is None:
        raise OptionError(
            'LQR needs load sensors; make the environment with sensors="sway" or "full", or take '
            "Observer"
        )
    own = usual(task.rig)
    change = bounded("change", own[0] if change is None else change, above=0)
    patience = bounded("patience", own[1] if patience is None else patience, above=0, unit="s")
    law = LQRLaw(task, task.loads, below, _weights(task, change, patience))
    return wrap(env, law, change=change, patience=patience)


def Observer(env: AnyEnv, *, change: float | None = None) -> Any:
    """Regulate drives around the exact trajectory, and the swing that they feel, by encoders alone.

    Parameters
    ----------
    env
        A crane with `Feedforward` and a `PD` towards the moving reference, single or vector.
    change
        As of `LQR`.

    Raises
    ------
    OptionError
        A number is not > 0, `env` is no crane or lacks `PD` or `Feedforward`, or an `LQR`,
        `Observer`, `SwingDamping`, `MassEstimate` or `Residual` stands below.
    """
    task, below = _below(env, "Observer")
    change = bounded("change", usual(task.rig)[0] if change is None else change, above=0)
    law = ObserverLaw(task, None, below, _weights(task, change, 0.0))
    return wrap(env, law, change=change)


def usual(rig: Rig) -> tuple[float, float]:
    """Change and patience that suit a rig."""
    hanging = any(part.name in rig.pulleys for part in rig.loads)
    return CALM if hanging and rig.dimensions == 3 else (CHANGE, PATIENCE)


def _weights(task: CraneTask, change: float, patience: float) -> Weights:
    """Costs of the stiffest regulator and of the softer ones."""
    usual = Weights.of(task.rig, task.scales)
    softer = np.array(SOFTER)
    return replace(usual, change=change * softer, patience=patience * softer**SLOWER, sway=SWAY)


def _below(env: AnyEnv, name: str) -> tuple[CraneTask, Below]:
    """The task, and what a regulator needs of the controllers below it.

    Raises
    ------
    OptionError
        They are not there, or others are that it does not bear.
    """
    task = task_of(env)
    if not isinstance(task, CraneTask):
        raise OptionError(f"{env} is no crane, {name} is for loads of cranes")
    refuse_below(env, name, "LQR", "Observer", "SwingDamping", "MassEstimate")
    laws = list(laws_of(env))
    feedback = next((law for law in laws if isinstance(law, PDLaw) and law.moving), None)
    if feedback is None or not any(isinstance(law, FeedforwardLaw) for law in laws):
        raise OptionError(
            f"{name} needs feedforward and PD towards the moving reference below; "
            f"take {name}(Feedforward(PD(env)))"
        )
    guard = next((law for law in laws if isinstance(law, GuardLaw)), None)
    return task, Below(feedback, guard)
