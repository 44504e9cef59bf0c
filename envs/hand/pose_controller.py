"""Feedback from the object's pose, on top of a hand's plan, which K leaves open.

    env = gym.make("flatrig/TwoFingerHand-v0", sensors="full")
    env = PoseFeedback(Feedforward(PD(env)))

The object's pose error is turned into a correction of its twist (`rolling_feedback`), that into
velocities of the fingers by the condition that contacts roll without slipping, and their integral
moves the reference that `PD` follows.  So errors of mass, friction, placement and encoders are
corrected through the same servo, without touching the squeeze.

Limits: tips do not turn more or less than planned; a ball on one plate, or between two, is
corrected along the way only, and what is off after arrival stays.
"""

from typing import Any

import numpy as np

from ...models.errors import OptionError
from ...models.types import Array
from ..controllers import PDLaw
from ..laws import AnyEnv, Law, laws_of, refuse_below, task_of, wrap
from .plan import slide_drives
from .task import HandTask

FASTEST = 2.0
"""Correction of the object's twist at most, in its radii per second."""


class PoseFeedbackLaw(Law):
    """u = k q + d q', with q the integral of the fingers' corrections q'."""

    name = "PoseFeedback"

    def __init__(self, task: HandTask, servo: PDLaw) -> None:
        self._task, self._radius = task, task.hand.held.radius
        self._stiffness, self._damping = np.split(servo.gains, 2)
        self._moved = np.zeros((task.num, len(task.limits)))
        fingers = [len(finger.slides) for finger in task.hand.fingers]
        self._finger = np.repeat(np.arange(len(fingers)), fingers)
        self._slides = np.vstack([finger.slides for finger in task.hand.fingers])
        self._columns = np.flatnonzero(slide_drives(task.hand))

    @property
    def memory(self) -> tuple[Array, ...]:
        """How far the reference is moved."""
        return (self._moved,)

    def apply(self, actions: Array) -> Array:
        """Add what the moved reference asks of the servo."""
        task = self._task
        self._moved[task.steps == 0] = 0.0
        rates = np.zeros_like(self._moved)
        rates[:, self._columns] = self._corrections()
        self._moved += task.period * rates
        return np.asarray(actions + self._stiffness * self._moved + self._damping * rates)

    def _corrections(self) -> Array:
        """Velocities of all slides on top of the plan's, (n, slides) [m/s]."""
        task = self._task
        errors = task.pose_errors()
        errors[:, 3:] *= self._radius
        gains = np.stack(
            [
                plan.twist_gains[min(step, plan.steps)]
                for plan, step in zip(task.plans, task.steps.tolist(), strict=True)
            ]
        )
        twist = -np.einsum("nij,nj->ni", gains, errors)
        size = np.linalg.norm(twist, axis=1, keepdims=True)
        # The tiny number keeps a vanishing twist from being divided by zero.
        twist *= np.minimum(1.0, FASTEST * self._radius / np.maximum(size, 1e-12))
        normals = task.plant.normals
        points = twist[:, None, :3] + np.cross(twist[:, None, 3:], normals)
        return np.asarray(np.einsum("nij,ij->ni", points[:, self._finger], self._slides))


def PoseFeedback(env: AnyEnv) -> Any:
    """Correct the reference of the `PD` below by the object's measured pose.

    Raises
    ------
    OptionError
        `env` is no hand with sensors="full", has no `PD` that follows the moving reference below,
        or a `PoseFeedback` or a `Residual` stands there.
    """
    task = task_of(env)
    refuse_below(env, "PoseFeedback")
    if not isinstance(task, HandTask) or task.sensors != "full":
        raise OptionError('PoseFeedback needs the pose of a hand\'s object, sensors="full"')
    servos = [law for law in laws_of(env) if isinstance(law, PDLaw) and law.moving]
    if not servos:
        raise OptionError("PoseFeedback moves the reference of a PD; put PD below")
    return wrap(env, PoseFeedbackLaw(task, servos[0]))
