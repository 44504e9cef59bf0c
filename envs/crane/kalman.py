"""A Kalman filter for cranes along plans: joints, rates, and what the load weighs.

Joints and rates z are counted from the planned ones, inputs v over their limits from the
feedforward of the rig's own mass.  A load that is heavier by the share m of its mass makes of them

    z' = A z + B (v - m s),           m' = m,           y = H q,

with s the slope of the exact feedforward in the mass, all of it from the linear model along the
plan (`course_gains`).  What the load weighs, encoders tell within some tenths of a second, because
the covariance of the estimate starts with how unsure it is: a filter in its steady state would take
seconds.

What sensors tell a period late is compared with what the filter believed then.
"""

from dataclasses import dataclass

import numpy as np

from ...models.types import Array, Mask
from .course_gains import Gains

LEAST = 1e-10
"""Variance in a period of what nothing else disturbs [m^2, rad^2 and their rates']."""
ASIDE = 0.02
"""Standard deviation at the start of joints that no sensor shows [m, rad]."""
STILL = 1e-3
"""Standard deviation of rates at the start [m/s, rad/s]."""


@dataclass(frozen=True)
class Noise:
    """What a filter takes plants and sensors for: standard deviations, white."""

    inputs: float
    """Of every input, over its limit: friction, gears, late commands."""
    wind: float
    """Of horizontal forces on what hangs, over its weight."""
    outputs: float
    """Of measured outputs, [m] and [rad] times their lever; 0 where none is measured."""
    drives: float = 3e-4
    """Of measured drive positions [m, rad]."""
    mass: float = 0.3
    """Of the load's mass at the start, over the rig's."""
    drift: float = 0.05
    """Of its change within a second."""


class KalmanFilter:
    """The filters of n simulations.

    Parameters
    ----------
    num, states
        Number of simulations, and of joints and rates.
    noise
        What plants and sensors are taken for.
    errors
        Standard deviations of what is measured, (measured,).
    period
        Of control [s].
    """

    def __init__(self, num: int, states: int, noise: Noise, errors: Array, period: float) -> None:
        self._noise, self._errors, self._states = noise, errors, states
        self._drift = period * noise.drift**2
        size = states + 1
        self._foreseen, self._covariance = np.zeros((num, size)), np.zeros((num, size, size))
        self._before = np.zeros((num, len(errors)))
        self.estimate = np.zeros((num, size))
        """Joints and rates, and the load's mass over the rig's minus 1, (n, states + 1)."""

    @property
    def memory(self) -> tuple[Array, ...]:
        """What is believed and foreseen, live arrays (n, ...)."""
        return self._foreseen, self._covariance, self._before, self.estimate

    def begin(self, gains: Gains, measured: Array, fresh: Mask) -> None:
        """Nothing moves yet, but loads may hang aside, and weigh what they like."""
        joints, states = gains.joints.shape[1], self._states
        self._foreseen[fresh] = 0.0
        self._foreseen[fresh, :joints] = np.matvec(gains.joints, measured)[fresh]
        unsure, unseen = gains.joints * self._errors, np.eye(joints) - gains.joints @ gains.seen
        covariance = np.zeros_like(self._covariance)
        covariance[:, :joints, :joints] = unsure @ unsure.swapaxes(1, 2)
        covariance[:, :joints, :joints] += ASIDE**2 * unseen @ unseen.swapaxes(1, 2)
        variances = np.full(states + 1, LEAST)
        variances[joints:states], variances[states] = STILL**2, self._noise.mass**2
        self._covariance[fresh] = (covariance + np.diag(variances))[fresh]
        self._before[fresh] = np.matvec(gains.seen, self._foreseen[:, :joints])[fresh]

    def correct(self, gains: Gains, measured: Array, late: Mask) -> None:
        """Take in what is measured, (n, measured); what is `late`, (measured,), is a period old."""
        joints, covariance = gains.seen.shape[2], self._covariance
        foreseen = np.matvec(gains.seen, self._foreseen[:, :joints])
        told = np.where(late, self._before, foreseen)
        crossed = covariance[:, :, :joints] @ gains.seen.swapaxes(1, 2)
        unsure = gains.seen @ crossed[:, :joints] + np.diag(self._errors**2)
        correction = np.linalg.solve(unsure, crossed.swapaxes(1, 2)).swapaxes(1, 2)
        self.estimate = self._foreseen + np.matvec(correction, measured - told)
        covariance = covariance - correction @ crossed.swapaxes(1, 2)
        self._covariance = 0.5 * (covariance + covariance.swapaxes(1, 2))
        self._before = np.matvec(gains.seen, self.estimate[:, :joints])

    def foresee(self, gains: Gains, inputs: Array) -> None:
        """Go on by a period in which inputs act, (n, drives) beyond the feedforward."""
        states, noise = self._states, self._noise
        moving = np.zeros_like(self._covariance)
        moving[:, :states, :states] = gains.transition
        moving[:, :states, states] = -np.matvec(gains.push, gains.slope[:, 0])
        moving[:, states, states] = 1.0
        self._foreseen = np.matvec(moving, self.estimate)
        self._foreseen[:, :states] += np.matvec(gains.push, inputs)
        self._covariance = moving @ self._covariance @ moving.swapaxes(1, 2)
        pushed, blown = noise.inputs * gains.push, noise.wind * gains.winds
        spread = pushed @ pushed.swapaxes(1, 2) + blown @ blown.swapaxes(1, 2)
        self._covariance[:, :states, :states] += spread + LEAST * np.eye(states)
        self._covariance[:, states, states] += self._drift
