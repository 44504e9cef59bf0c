"""Feedforward of the mass that a crane really carries, estimated from what its drives pull.

    env = MassEstimate(Feedforward(PD(gym.make("flatrig/OverheadCrane-v0"))))

The exact feedforward F is affine in the loads' mass, F(m) = F(1) + (m - 1) s with m over the rig's
mass (where a free pulley has mass of its own almost so: to 2e-5 of the limits on the Navy crane in
space).  If the crane carries m and is fed for e, the feedback P ends up with what is missing,
(m - e) s.  So the weighted least-squares estimate of m - e is <P, s> / <s, s>, and

    de/dt = rate <P, s> / <s, s>,        then d(m - e)/dt = -rate (m - e) on every rig.

Inputs are weighed by the compliance of the feedback, <a, b> = sum a_i b_i / k_i as forces along the
drives' coordinates: the estimate takes the energy out of the springs that feedback puts in the
drives' places.  Only so is it integral action with a symmetric gain, rate s s^T / <s, s>, on
positions, which a plant that gives back no more energy than it gets tolerates however its drives
are coupled.  Weighed otherwise, as by the winches' inputs alone, it is unstable where two ropes
carry one trolley.

What comes from above counts as input that moves the load, what stands below as known: so a
`FrictionCompensation` belongs below, and a `Residual` on top does not spoil the estimate.

Limits: friction and wind are taken for mass as far as they point along s: a winch that rubs with
3 % of the weight spoils the estimate by 3 %.
"""

import math
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from ...models.errors import OptionError
from ...models.rig.rig import Rope
from ...models.types import Array
from ...models.values import bounded
from ..controllers import FeedforwardLaw, PDLaw
from ..laws import AnyEnv, Law, laws_of, refuse_below, task_of, wrap
from .plan import CranePlan, feedforward_with
from .task import CraneTask

RATE = 1.0
"""How fast the error of the estimate decays by default [1/s]: slower than the feedback of winches,
which has to settle in between."""
FARTHEST = 0.5
"""How far the estimate may go from the rig's mass, over that mass."""
SPAN = 0.3
"""The sensitivity is the slope of the feedforward up to a mass that is so much larger."""


class MassLaw(Law):
    """u = (estimate - 1) d feedforward / d mass, the estimate from what the feedback gives."""

    name = "MassEstimate"

    def __init__(self, task: CraneTask, feedback: PDLaw, rate: float) -> None:
        self._task, self._gains = task, feedback.gains
        self._share = 1.0 - math.exp(-rate * task.period)
        self._weights = _compliances(task, feedback)
        self._slopes = Slopes(task)
        self.estimate = np.ones(task.num)
        """Mass of the loads over the rig's, shape (n,)."""

    @property
    def sensitivity(self) -> Array:
        """Slope of the feedforward over the limits in the mass ratio, now, (n, drives)."""
        return self._slopes.now()

    def apply(self, actions: Array) -> Array:
        """Add what the load takes more than the rig's."""
        task, drives = self._task, len(self._weights)
        slopes = self._slopes.now()
        feedback = task.encoders.errors * self._gains
        found = np.clip(actions + feedback[:, :drives] + feedback[:, drives:], -1.0, 1.0)
        along = slopes * self._weights
        change = (found * along).sum(axis=1) / (slopes * along).sum(axis=1)
        self.estimate[task.steps == 0] = 1.0
        self.estimate += self._share * change
        np.clip(self.estimate, 1.0 - FARTHEST, 1.0 + FARTHEST, out=self.estimate)
        return np.asarray(actions + (self.estimate - 1.0)[:, None] * slopes)


class Slopes:
    """d feedforward / d mass ratio along the plans of n simulations."""

    def __init__(self, task: CraneTask) -> None:
        self._task = task
        self._known: WeakKeyDictionary[CranePlan, Array] = WeakKeyDictionary()

    def now(self) -> Array:
        """Over the limits, at the present steps, shape (n, drives)."""
        task = self._task
        if task.planner.fixed is not None and all(p is task.planner.fixed for p in task.plans):
            return self._of(task.planner.fixed)[np.minimum(task.steps, task.planner.fixed.steps)]
        return np.array([
            self._of(plan)[min(step, plan.steps)]
            for plan, step in zip(task.plans, task.steps.tolist(), strict=True)
        ])  # fmt: skip

    def _of(self, plan: CranePlan) -> Array:
        """Along a plan, shape (steps + 1, drives)."""
        if plan not in self._known:
            heavier = feedforward_with(self._task.rig, plan, 1.0 + SPAN)
            self._known[plan] = (heavier - feedforward_with(self._task.rig, plan, 1.0)) / SPAN
        return self._known[plan]


def _compliances(task: CraneTask, feedback: PDLaw) -> Array:
    """Weight of each drive's input over its limit: energy in its spring, shape (drives,)."""
    driven = map(task.rig.driven, task.rig.drives)
    radii = np.array([part.drum_radius if isinstance(part, Rope) else 1.0 for part in driven])
    stiffness = feedback.gains[: len(radii)] * radii
    if not (stiffness > 0).all():
        raise OptionError("MassEstimate needs a PD whose stiffness is > 0 for every drive")
    return np.asarray(task.limits / stiffness)


def MassEstimate(env: AnyEnv, *, rate: float = RATE) -> Any:
    """Estimate the loads' mass from encoders only, and add the feedforward that it needs more.

    Parameters
    ----------
    env
        A crane with `PD` towards the moving reference and `Feedforward`, single or vector.
    rate
        At which the error of the estimate decays [1/s].

    Raises
    ------
    OptionError
        The rate is not a finite number > 0, `env` is no crane, lacks `PD` or `Feedforward`, or a
        `MassEstimate` or a `Residual` stands below.
    """
    task = task_of(env)
    if not isinstance(task, CraneTask):
        raise OptionError(f"{env} is no crane, MassEstimate is for loads of cranes")
    refuse_below(env, "MassEstimate")
    laws = list(laws_of(env))
    feedback = next((law for law in laws if isinstance(law, PDLaw) and law.moving), None)
    if feedback is None or not any(isinstance(law, FeedforwardLaw) for law in laws):
        raise OptionError(
            "MassEstimate needs feedforward and PD towards the moving reference below; "
            "take MassEstimate(Feedforward(PD(env)))"
        )
    rate = bounded("rate", rate, above=0, unit="1/s")
    return wrap(env, MassLaw(task, feedback, rate), rate=rate)
