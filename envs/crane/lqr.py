"""Linear-quadratic regulators with Kalman filters around the exact trajectory.

    env = MassEstimate(Feedforward(PD(TautGuard(env))))
    env = LQR(env)         # with load sensors, "sway" or "full"
    env = Observer(env)    # or with encoders alone

What they add makes the feedback of `PD` that of the regulator.  The state z holds joints, rates and
commands that are on their way, I integrals of the errors that load sensors show, so that a steady
wind leaves none:

    added = -K z - L I - P,           K, L from `optimal_feedback`, P what the PD gives.

Joints and rates are those of a Kalman filter along the plan (`course_gains`).  Encoders alone do
not tell wind from friction: `Observer` has no integrals, it damps the swing that drives feel.

A regulator that is too sure of its model fails on a plant that is another one.  These take commands
to be three periods late, one more than the longest of the standard disturbances, count with inputs
that are off by some percent of the limits, and with forces of no model on the load.

Limits: the linear models are those of the rig's own mass.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from ...models.errors import OptionError
from ...models.types import Array
from ...models.values import bounded
from ..controllers import FeedforwardLaw, PDLaw
from ..laws import AnyEnv, Law, laws_of, refuse_below, task_of, wrap
from .along_plans import AlongPlans
from .course_gains import CourseGains, Gains, Noise
from .linearisation import Lineariser
from .load_sensors import LoadSensors
from .mass_estimate import MassLaw
from .optimal_feedback import Weights
from .task import CraneTask

DELAY = 3
"""Control periods that the regulator takes commands to be late."""
LIKELY = 2
"""Those that the Kalman filter does."""
CHANGE = 0.05
"""Change of a command in one period, over the limits, that costs as much as an error of a
centimetre."""
PATIENCE = 1.5
"""Time in which a lasting error counts once more [s]."""
SWAY = 0.1
"""Deviation of a joint that does [m, rad]: a drive that is held lets the load hang as a pendulum, as
fast whatever its mass; one that yields swings with it."""
NOISE = {
    "sway": Noise(inputs=0.1, wind=0.1, outputs=3e-3),
    "full": Noise(inputs=0.1, wind=0.1, outputs=1e-3),
    "encoders": Noise(inputs=0.1, wind=0.01, outputs=0.0),
}
"""What plants and sensors are taken for.  Where only drives tell of the load, whatever they feel is
more likely their own friction."""


class LQRLaw(Law):
    """u = -K z - L I instead of the PD below."""

    name = "LQR"

    def __init__(
        self, task: CraneTask, loads: LoadSensors | None, below: list[Law], weights: Weights
    ) -> None:
        self._task, self._loads, self._weights = task, loads, weights
        self._feedback = next(law for law in below if isinstance(law, PDLaw))
        self._mass = next((law for law in below if isinstance(law, MassLaw)), None)
        timestep = None if task.massless is None else float(task.plant.model.opt.timestep)
        lineariser = Lineariser(task.rig, task.period, massless=task.massless, timestep=timestep)
        noise = NOISE["encoders" if loads is None else task.sensors]
        self._gains = CourseGains(lineariser, task.scales, weights, DELAY, noise)
        self._table = AlongPlans(task, self._gains.of, lineariser.stride)
        outputs = len(task.rig.outputs)
        states, measured = 2 * lineariser.model.nv, len(self._gains.errors)
        self._foreseen = np.zeros((task.num, states))
        self.added = np.zeros((task.num, len(task.limits)))
        """What it added last, over the limits, (n, drives)."""
        self.state = np.zeros((task.num, states))
        """Joints and rates minus the planned ones as they seemed to be, (n, states)."""
        self.surprise = np.zeros((task.num, measured))
        """What was measured minus what was foreseen, over its error, (n, measured)."""
        self._before = np.zeros((task.num, outputs))
        self._sum = np.zeros((task.num, outputs))
        self._sent = np.zeros((task.num, DELAY, len(task.limits)))

    def apply(self, actions: Array) -> Array:
        """Put the regulator's feedback in the place of the PD's."""
        task = self._task
        gains = self._gains.split(self._table.now())
        fresh = task.steps == 0
        self._remember(fresh)
        self._observe(gains, fresh)
        known = [self.state, self._sent.reshape(task.num, -1)]
        if self._loads is not None:
            known.append(self._integrals(self._loads))
        wanted = -np.matvec(gains.feedback, np.hstack(known))
        self.added = np.asarray(wanted - self._feedback.feedback())
        return np.asarray(actions + self.added)

    def _remember(self, fresh: Array) -> None:
        """Take in what was sent beyond the feedforward; forget what was before `fresh` episodes."""
        task = self._task
        planned = task.rows.later("feedforward", -1)
        if self._mass is not None:
            planned = planned + (self._mass.estimate - 1.0)[:, None] * self._mass.sensitivity
        self._sent[:, 1:] = self._sent[:, :-1]
        self._sent[:, 0] = task.commands - planned
        for memory in (self._sent, self._sum, self._foreseen, self._before, self.added):
            memory[fresh] = 0.0

    def _observe(self, gains: Gains, fresh: Array) -> None:
        """Correct what was foreseen by what is measured, and foresee the next period."""
        joints, drives = gains.seen.shape[2], len(self._task.limits)
        measured = -self._task.encoders.errors[:, :drives]
        if self._loads is not None:
            measured = np.hstack((measured, -self._loads.errors))
        if fresh.any():  # nothing moves yet, but loads may hang aside
            self._foreseen[fresh, :joints] = np.matvec(gains.joints, measured)[fresh]
        foreseen = np.matvec(gains.seen, self._foreseen[:, :joints])
        if self._loads is not None and self._loads.late:
            foreseen[:, drives:] = np.where(fresh[:, None], foreseen[:, drives:], self._before)
        surprise = measured - foreseen
        self.surprise = surprise / self._gains.errors
        self.state = self._foreseen + np.matvec(gains.correction, surprise)
        if self._loads is not None:
            self._before = np.matvec(gains.seen[:, drives:], self.state[:, :joints])
        self._foreseen = np.matvec(gains.transition, self.state)
        self._foreseen += np.matvec(gains.push, self._sent[:, LIKELY - 1])

    def _integrals(self, loads: LoadSensors) -> Array:
        """Integrals of scaled outputs, which wait where a drive is at its limit, (n, outputs)."""
        task = self._task
        free = (np.abs(task.commands) < 1.0).all(axis=1, keepdims=True)
        share = task.period / self._weights.patience
        self._sum -= free * share * self._gains.outputs * loads.errors
        return self._sum


class ObserverLaw(LQRLaw):
    """The same from encoders alone."""

    name = "Observer"


def LQR(env: AnyEnv, *, change: float = CHANGE, patience: float = PATIENCE) -> Any:
    """Regulate drives and loads around the exact trajectory, by encoders and load sensors.

    Parameters
    ----------
    env
        A crane with load sensors, `Feedforward` and a `PD` towards the moving reference, single
        or vector; a `MassEstimate` above these feeds the mass that it carries.
    change
        Change of a command in one period, over the limits, that costs as much as the load's error
        of a centimetre: more is quicker, and bears less delay and noise.
    patience
        Time in which a lasting error costs once more what it does at once [s].

    Raises
    ------
    OptionError
        A number is not > 0, `env` is no crane, has no load sensors or lacks `PD` or `Feedforward`,
        or an `LQR`, `Observer`, `SwingDamping` or `Residual` stands below.
    """
    task, below = _below(env, "LQR")
    if task.loads is None:
        raise OptionError(
            'LQR needs load sensors; make the environment with sensors="sway" or "full", or take '
            "Observer"
        )
    change = bounded("change", change, above=0)
    patience = bounded("patience", patience, above=0, unit="s")
    weights = replace(
        Weights.of(task.rig, task.scales), change=change, patience=patience, sway=SWAY
    )
    law = LQRLaw(task, task.loads, below, weights)
    return wrap(env, law, change=change, patience=patience)


def Observer(env: AnyEnv, *, change: float = CHANGE) -> Any:
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
        `Observer`, `SwingDamping` or `Residual` stands below.
    """
    task, below = _below(env, "Observer")
    change = bounded("change", change, above=0)
    weights = replace(Weights.of(task.rig, task.scales), change=change, sway=SWAY)
    return wrap(env, ObserverLaw(task, None, below, weights), change=change)


def _below(env: AnyEnv, name: str) -> tuple[CraneTask, list[Law]]:
    """The task, and the controllers that a regulator needs below it.

    Raises
    ------
    OptionError
        They are not there, or others are that it does not bear.
    """
    task = task_of(env)
    if not isinstance(task, CraneTask):
        raise OptionError(f"{env} is no crane, {name} is for loads of cranes")
    refuse_below(env, name, "LQR", "Observer", "SwingDamping")
    laws = list(laws_of(env))
    moving = any(isinstance(law, PDLaw) and law.moving for law in laws)
    if not moving or not any(isinstance(law, FeedforwardLaw) for law in laws):
        raise OptionError(
            f"{name} needs feedforward and PD towards the moving reference below; "
            f"take {name}(MassEstimate(Feedforward(PD(env))))"
        )
    return task, laws
