"""What a regulator and its observer need along a plan, from the plan and the rig alone.

    gains = CourseGains(lineariser, scales, noise, weights)
    table = AlongPlans(task, gains.of, lineariser.stride)
    now = gains.split(table.now())               # matrices at every simulation's present knot

The regulator is that of `optimal_feedback`.  The observer is the Kalman filter that belongs to the
linear model at a knot, in its steady state; it is the dual of a regulator, and found as one.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...models.types import Array
from .courses import planned
from .geometry import Scales
from .linearisation import Lineariser, LinearModel
from .optimal_feedback import Weights, output_weights, regulator
from .outputs import levers
from .plan import CranePlan
from .riccati import Stage, stationary

LEAST = 1e-10
"""Variance in a period of what nothing else disturbs [m^2, rad^2 and their rates']."""

UNSEEN = 1e-6
"""Singular values of what is measured, over the largest, below which joints do not show in it."""


@dataclass(frozen=True)
class Noise:
    """What an observer takes plants and sensors for: standard deviations, white."""

    inputs: float
    """Of every input, over its limit: friction, gears, a wrong mass, late commands."""
    wind: float
    """Of horizontal forces on what hangs, over its weight."""
    outputs: float
    """Of measured outputs, [m] and [rad] times their lever; 0 where none is measured."""
    drives: float = 1e-3
    """Of measured drive positions [m, rad]."""


class Gains(NamedTuple):
    """Matrices of n simulations."""

    feedback: Array
    """Of the regulator's state, (n, drives, state)."""
    transition: Array
    """Of joints and rates over a period, (n, states, states)."""
    push: Array
    """What inputs over the limits do in it, (n, states, drives)."""
    correction: Array
    """What joints and rates are off by what was measured, (n, states, measured)."""
    seen: Array
    """How drives and outputs, if measured, follow joints, (n, measured, joints)."""
    joints: Array
    """Joints by least squares from what is measured, (n, joints, measured)."""


class CourseGains:
    """Makes the matrices of plans of a rig.

    Parameters
    ----------
    lineariser
        Of the rig.
    scales
        Its units.
    weights, delay
        Of the regulator, and how late its commands are taken to act [periods].
    noise
        For the observer.
    """

    def __init__(
        self, lineariser: Lineariser, scales: Scales, weights: Weights, delay: int, noise: Noise
    ) -> None:
        self._lineariser, self._weights, self._noise = lineariser, weights, noise
        self._delay = np.array([delay])
        rig = lineariser.rig
        self.outputs = output_weights(rig, scales, weights)
        """What each output's deviation is multiplied with, (outputs,)."""
        outputs = noise.outputs / levers(rig, scales) if noise.outputs else np.zeros(0)
        self.errors = np.append(np.full(len(rig.drives), noise.drives), outputs)
        """Standard deviations of what is measured, (measured,)."""
        self._shapes: list[tuple[int, ...]] = []

    def of(self, plan: CranePlan) -> Array:
        """Matrices at the knots of a plan, side by side in a row each, (knots, entries).

        Raises
        ------
        ArithmeticError
            The rig cannot be regulated, or its state does not show, somewhere along the plan.
        """
        lineariser = self._lineariser
        model = lineariser.along([planned(lineariser.rig, lineariser.model, plan)])
        steps = model.knots[0].astype(int)
        feedback = regulator(model, self._delay, self.outputs, self._weights).state[steps, 0]
        ends = model.states, model.states + model.inputs
        transition, push, forces = np.split(model.transition[0], ends, axis=2)
        seen = model.drives[0]
        if self._noise.outputs:
            seen = np.concatenate((seen, model.outputs[0]), axis=1)
        correction = self._corrections(model, transition, push, forces, seen)
        joints = np.linalg.pinv(seen / self.errors[:, None], rcond=UNSEEN) / self.errors
        parts = Gains(feedback, transition, push, correction, seen, joints)
        self._shapes = [part.shape[1:] for part in parts]
        return np.concatenate([part.reshape(len(steps), -1) for part in parts], axis=1)

    def split(self, rows: Array) -> Gains:
        """The matrices in rows of n simulations, (n, entries)."""
        ends = np.cumsum([np.prod(shape) for shape in self._shapes]).astype(int)
        parts = np.split(rows, ends[:-1], axis=1)
        return Gains(*(p.reshape(-1, *s) for p, s in zip(parts, self._shapes, strict=True)))

    def _corrections(
        self, model: LinearModel, transition: Array, push: Array, forces: Array, seen: Array
    ) -> Array:
        """Gains of the steady Kalman filter at every knot, (knots, states, measured)."""
        noise, states = self._noise, model.states
        winds = forces[..., : model.axes]
        spread = noise.inputs**2 * push @ push.swapaxes(1, 2) + LEAST * np.eye(states)
        spread += noise.wind**2 * winds @ winds.swapaxes(1, 2)
        measured = np.zeros((len(seen), seen.shape[1], states))
        measured[..., : seen.shape[2]] = seen
        none = np.zeros((len(seen), states, 0)), np.zeros((len(seen), 0, 0))
        unsure = np.broadcast_to(np.diag(self.errors**2), (len(seen), *2 * [seen.shape[1]]))
        dual = Stage(transition.swapaxes(1, 2), measured.swapaxes(1, 2), *none, spread, unsure)
        crossed = stationary(dual).state @ measured.swapaxes(1, 2)
        return np.asarray(
            np.linalg.solve(measured @ crossed + unsure, crossed.swapaxes(1, 2)).swapaxes(1, 2)
        )
