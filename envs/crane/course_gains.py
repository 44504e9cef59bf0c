"""What a regulator and its observer need along a plan, from the plan and the rig alone.

    gains = CourseGains(lineariser, scales, weights, delay, errors)
    table = AlongPlans(task, gains.of, lineariser.stride)
    now = gains.split(table.now())               # matrices at every simulation's present knot

`lqr` puts them to use.
"""

from typing import NamedTuple

import numpy as np

from ...models.errors import OptionError
from ...models.types import Array
from .geometry import Scales
from .linear_plans import along_plan
from .linearisation import Lineariser
from .optimal_feedback import Weights, output_weights, regulator
from .plan import CranePlan, feedforward_with

HEAVIER = 1.3
"""Mass at which the feedforward's slope is taken, over the rig's."""
UNSEEN = 1e-6
"""Singular values of what is measured, over the largest, below which joints do not show in it."""


class Gains(NamedTuple):
    """Matrices of n simulations."""

    feedback: Array
    """Of the regulators' state, (n, regulators, drives, state)."""
    transition: Array
    """Of joints and rates over a period, (n, states, states)."""
    push: Array
    """What inputs over the limits do in it, (n, states, drives)."""
    winds: Array
    """What horizontal forces over the weight do in it, (n, states, directions)."""
    seen: Array
    """How drives and outputs, if measured, follow joints, (n, measured, joints)."""
    joints: Array
    """Joints by least squares from what is measured, (n, joints, measured)."""
    slope: Array
    """Of the exact feedforward over the limits in the mass of the load, (n, 1, drives)."""


class CourseGains:
    """Makes the matrices of plans of a rig.

    Parameters
    ----------
    lineariser
        Of the rig.
    scales
        Its units.
    weights, delay
        Of the regulators, as many as there are changes of commands among the weights, and how
        late their commands are taken to act [periods].
    errors
        Standard deviations of measured drives, and of outputs if they are, (measured,).
    """

    def __init__(
        self, lineariser: Lineariser, scales: Scales, weights: Weights, delay: int, errors: Array
    ) -> None:
        self._lineariser, self._weights, self._errors = lineariser, weights, errors
        self._delays = np.full(np.size(weights.change), delay)
        self.outputs = output_weights(lineariser.rig, scales, weights)
        """What each output's deviation is multiplied with, (outputs,)."""
        self._shapes: list[tuple[int, ...]] = []

    def of(self, plan: CranePlan) -> Array:
        """Matrices at the knots of a plan, side by side in a row each, (knots, entries).

        Raises
        ------
        OptionError
            The rig cannot be regulated where the plan ends.
        """
        lineariser = self._lineariser
        model = along_plan(lineariser, plan)
        steps = model.knots[0].astype(int)
        every = model.repeated(len(self._delays))
        try:
            feedback = regulator(every, self._delays, self.outputs, self._weights).state[steps]
        except ArithmeticError as error:
            raise OptionError(
                f"no regulator holds {lineariser.rig.name} where its plan ends: its drives do not "
                "move all of what swings or is to be held; take PD and Feedforward alone"
            ) from error
        first, last = model.states, model.states + model.inputs
        transition, push, winds = np.split(
            model.transition[0, :, :, : last + model.axes], (first, last), axis=2
        )
        seen = np.concatenate((model.drives[0], model.outputs[0]), axis=1)[:, : len(self._errors)]
        joints = np.linalg.pinv(seen / self._errors[:, None], rcond=UNSEEN) / self._errors
        own, heavier = (feedforward_with(lineariser.rig, plan, mass) for mass in (1.0, HEAVIER))
        slopes = (heavier - own) / (HEAVIER - 1.0)
        slope = slopes[np.minimum(steps, len(slopes) - 1)][:, None]
        parts = Gains(feedback, transition, push, winds, seen, joints, slope)
        self._shapes = [part.shape[1:] for part in parts]
        return np.concatenate([part.reshape(len(steps), -1) for part in parts], axis=1)

    def split(self, rows: Array) -> Gains:
        """The matrices in rows of n simulations, (n, entries)."""
        ends = np.cumsum([np.prod(shape) for shape in self._shapes]).astype(int)
        parts = np.split(rows, ends[:-1], axis=1)
        return Gains(*(p.reshape(-1, *s) for p, s in zip(parts, self._shapes, strict=True)))
