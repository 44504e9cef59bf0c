"""A teacher for hands: it sees where the object is, and says what would bring it where it belongs.

Fingers that all move by -p carry their object by -p, however they hold it.  So the residual that
takes an error p of its place away is, through the stiffness k of PD,

    wanted = slow residual - k S P (p + t)

with S the directions of the slides.  The slow residual is the one that has brought p about, through
a low-pass filter that leaves the hand time to settle; fed back, this is integral action.

P and t leave what encoders can tell.  A round object looks the same however it is turned, and a
plate the same wherever it is touched: the encoders of a hand whose object is turned, or lies aside
along its plates, read the same to the last bit, so that nothing can be learned of either.  What
round tips hold they hold all ways, what plates hold along their normals.  And where all encoders
are wrong by the same displacement t, fingers and object are aside together, and feel nothing.
"""

import numpy as np

from ...envs.controllers import PDLaw
from ...envs.hand.plan import slide_drives
from ...envs.hand.task import HandTask
from ...models.hand.hand import Hand, Tip
from ...models.types import Array, Mask

SETTLING = 0.05
"""Time constant of the filter [s]; PD settles in 20 ms."""


class HandTeacher:
    """What n hands with feedforward and PD ought to get, from where their objects are.

    Parameters
    ----------
    task
        The simulations.
    servo
        The PD below.
    """

    def __init__(self, task: HandTask, servo: PDLaw) -> None:
        self._task, drives = task, len(task.limits)
        slides = np.zeros((drives, 3))
        slides[slide_drives(task.hand)] = np.vstack([f.slides for f in task.hand.fingers])
        self._stiffness = servo.gains[:drives]
        self._carry = -(slides @ visible(task.hand))
        pulled = self._stiffness[:, None] * slides
        self._together = pulled @ np.linalg.pinv(slides.T @ pulled)
        self._slow = np.zeros((task.num, drives))
        self._share = -np.expm1(-task.period / SETTLING)

    def advice(self) -> Array:
        """Residuals over the limits, (n, drives)."""
        task = self._task
        places = task.pose_errors()[:, :3] + task.plant.offsets @ self._together
        return np.asarray(self._slow + self.carried(places))

    def carried(self, places: Array) -> Array:
        """What moves objects by -(n, 3) [m], over the limits, (n, drives)."""
        return np.asarray(self._stiffness * (places @ self._carry.T))

    def sent(self, residual: Array, fresh: Mask) -> None:
        """Take in the residual of this period; episodes that are `fresh` have no past."""
        self._slow[fresh] = 0.0
        self._slow += self._share * (residual - self._slow)


def visible(hand: Hand) -> Array:
    """P: the projector on the directions in which encoders tell where the object is, (3, 3)."""
    if any(isinstance(finger.surface, Tip) for finger in hand.fingers):
        return np.diag([1.0, 0.0, 1.0]) if hand.planar else np.eye(3)
    normals = np.array([finger.contact for finger in hand.fingers])
    return np.asarray(np.linalg.pinv(normals) @ normals)
