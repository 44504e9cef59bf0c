"""Feedforward of the mass that a crane really carries, estimated from what its drives pull.

    env = MassEstimate(Feedforward(PD(gym.make("flatrig/OverheadCrane-v0"))))

The exact feedforward F is affine in the loads' mass, F(m) = F(1) + (m - 1) s with m over the rig's
mass (where a free pulley has mass of its own almost so: to 2e-5 of the limits on the Navy crane in
space).  If the crane carries m and is fed for e, the feedback P ends up with what is missing,
(m - e) s.  So the weighted least-squares estimate of m - e is <P, s> / <s, s>, and

    de/dt = rate <P, s> / <s, s>,        then d(m - e)/dt = -rate (m - e) on every rig.

Inputs are weighed by the compliance of the feedback, <a, b> = a^T K^-1 b with its stiffness K and
forces along the drives' coordinates: the estimate takes the energy out of the springs that feedback
puts in the drives' places.  Only so is it integral action with a symmetric gain on positions,
rate s s^T / <s, s>, which a plant that gives back no more energy than it gets tolerates however its
drives are coupled.  Weighed otherwise, as by the winches' inputs alone, it is unstable where two
ropes carry one trolley.

What comes from above counts as input that moves the load, what stands below as known: so a
`FrictionCompensation` belongs below, and a `Residual` on top does not spoil the estimate.

Limits: friction and wind are taken for mass as far as they point along s: a winch that rubs with
3 % of the weight spoils the estimate by 3 %.
"""

import math
from typing import Any

import numpy as np

from ...models.errors import OptionError
from ...models.types import Array
from ...models.values import bounded
from ..controllers import FeedforwardLaw, PDLaw
from ..laws import AnyEnv, Law, laws_of, refuse_below, task_of, wrap
from .along_plans import AlongPlans
from .plan import CranePlan, feedforward_with
from .task import CraneTask
from .tuning import IMMOBILE, forces_of

RATE = 0.5
"""How fast the error of the estimate decays by default [1/s]: it converges within a move, and three
periods of delay leave room for it, as they do not for 1/s where two ropes carry a trolley."""
FARTHEST = 0.5
"""How far the estimate may go from the rig's mass, over that mass."""
SPAN = 0.3
"""The sensitivity is the slope of the feedforward up to a mass that is so much larger."""


class MassLaw(Law):
    """u = (estimate - 1) d feedforward / d mass, the estimate from what the feedback gives."""

    name = "MassEstimate"

    def __init__(self, task: CraneTask, feedback: PDLaw, rate: float) -> None:
        self._task, self._feedback = task, feedback
        self._share = 1.0 - math.exp(-rate * task.period)
        self._tables = AlongPlans(task, self._table)
        self.estimate = np.ones(task.num)
        """Mass of the loads over the rig's, shape (n,)."""

    @property
    def sensitivity(self) -> Array:
        """Slope of the feedforward over the limits in the mass ratio, now, (n, drives)."""
        return np.asarray(self._tables.now()[:, 0])

    @property
    def memory(self) -> tuple[Array, ...]:
        """The estimate."""
        return (self.estimate,)

    def apply(self, actions: Array) -> Array:
        """Add what the load takes more than the rig's."""
        slopes, along = self._tables.now().swapaxes(0, 1)
        found = np.clip(actions + self._feedback.feedback(), -1.0, 1.0)
        self.estimate[self._task.steps == 0] = 1.0
        self.estimate += self._share * (found * along).sum(axis=1)
        np.clip(self.estimate, 1.0 - FARTHEST, 1.0 + FARTHEST, out=self.estimate)
        return np.asarray(actions + (self.estimate - 1.0)[:, None] * slopes)

    def _table(self, plan: CranePlan) -> Array:
        """Along a plan s, and what gives <a, s> / <s, s> of inputs a, (steps + 1, 2, drives)."""
        task, drives = self._task, len(self._task.limits)
        own, heavier = (feedforward_with(task.rig, plan, mass) for mass in (1.0, 1.0 + SPAN))
        slopes = (heavier - own) / SPAN
        if self._feedback.schedule is None:
            stiffness = np.diag(self._feedback.gains[:drives])[None]
        else:
            stiffness = self._feedback.schedule.of(plan)[:, :, :drives]
        last = len(stiffness) - 1
        stiffness = stiffness[np.minimum(np.arange(len(slopes)), last)]
        # Where the feedback's springs yield to s, and the work of forces along it.
        if drives > task.plant.model.nv:  # tensions that move nothing meet no spring
            yielding = np.matvec(np.linalg.pinv(stiffness, rcond=IMMOBILE), slopes)
            along = yielding * forces_of(task.plant)
        else:
            along = np.linalg.solve(stiffness, slopes[..., None])[..., 0] * forces_of(task.plant)
        return np.stack((slopes, along / (slopes * along).sum(axis=1, keepdims=True)), axis=1)


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
    refuse_below(env, "MassEstimate", "LQR", "Observer")
    laws = list(laws_of(env))
    feedback = next((law for law in laws if isinstance(law, PDLaw) and law.moving), None)
    if feedback is None or not any(isinstance(law, FeedforwardLaw) for law in laws):
        raise OptionError(
            "MassEstimate needs feedforward and PD towards the moving reference below; "
            "take MassEstimate(Feedforward(PD(env)))"
        )
    if feedback.schedule is None and not (feedback.gains[: len(task.limits)] > 0).all():
        raise OptionError("MassEstimate needs a PD whose stiffness is > 0 for every drive")
    rate = bounded("rate", rate, above=0, unit="1/s")
    return wrap(env, MassLaw(task, feedback, rate), rate=rate)
