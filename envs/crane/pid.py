"""PID: the feedback of `PD`, and an integral that leaves no error of drives at rest.

    env = Feedforward(PID(gym.make("flatrig/OverheadCrane-v0")))

The integral has the stiffness of the proportional part, over an integral time T:

    u = PD + K int (reference - measured) dt / T

A drive alone, of inertia m with stiffness m omega^2 and damping 2 zeta omega m, is stable for
T > 1 / (2 zeta omega) (Routh), 0.12 s for winches; the load's swing asks for much more, since an
integral that follows it feeds it.  By default T is the period of a pendulum as long as the load
hangs at home: the integral sees the mean of a swing.  It helps against forces that stay, of a wrong
mass and of steady wind, and does harm while errors of a move are on their way out.

An integrator stands still while the command of its drive is at a limit (clamping: Astrom and
Hagglund, PID Controllers, 1995, 3.5), and starts from zero with every episode.
"""

import math
from typing import Any

import numpy as np

from ...models.errors import OptionError
from ...models.types import Array
from ...models.values import bounded
from ..controllers import PDLaw
from ..laws import AnyEnv, laws_of, refuse_below, task_of, wrap
from .task import CraneTask


class PIDLaw(PDLaw):
    """PD towards the moving reference, and the integral of position errors."""

    name = "PID"

    def __init__(self, task: CraneTask, hold: bool, integral_time: float) -> None:
        super().__init__(task, task.gains("moving"), True, hold)
        self._share = task.period / integral_time
        self._mean = np.zeros((task.num, len(task.limits)))

    @property
    def memory(self) -> tuple[Array, ...]:
        """The integrals."""
        return (self._mean,)

    def apply(self, actions: Array) -> Array:
        """Integrate, and add the feedback."""
        task, drives = self._task, len(self._task.limits)
        free = (np.abs(task.commands) < 1.0) & (task.steps > 0)[:, None]
        self._mean += np.where(free, self._share * task.encoders.errors[:, :drives], 0.0)
        return super().apply(actions)

    def feedback(self) -> Array:
        """What errors and their integral ask for, (n, drives) over the limits."""
        assert self.schedule is not None
        self._mean[self._task.steps == 0] = 0.0  # a law above may ask before `apply`
        stiffness = self.schedule.now()[:, :, : self._mean.shape[1]]
        return np.asarray(super().feedback() + np.matvec(stiffness, self._mean))


def PID(env: AnyEnv, *, integral_time: float | None = None) -> Any:
    """`PD` towards the moving reference with an integral, from encoders only; in its place.

    Parameters
    ----------
    env
        A crane, single or vector, wrapped or not.
    integral_time
        Time in which the integral of an error has grown to what the error itself asks for [s]; by
        default the period of a pendulum as long as the load hangs at home.

    Raises
    ------
    OptionError
        The time is not a finite number > 0, `env` is no crane, or a `PD`, `PID` or `Residual`
        stands below.
    """
    task = task_of(env)
    if not isinstance(task, CraneTask):
        raise OptionError(f"{env} is no crane, PID is for drives of cranes")
    refuse_below(env, "PID", "PD")
    if integral_time is None:
        integral_time = 2.0 * math.pi * task.scales.time
    time = bounded("integral_time", integral_time, above=0, unit="s")
    holds_below = any(law.holding() is not None for law in laws_of(env))
    return wrap(env, PIDLaw(task, not holds_below, time), integral_time=time)
