"""When a residual may act: once the encoders show that the plant is not as described.

On a plant that is what the description says, feedforward and PD leave next to no error, and
whatever a policy believes to see there is its own doing.  The evidence of a disturbance is the
low-passed position error of the drives over what is usual, remembered about as long as a load
needs to come to rest:

    evidence <- max(rms_i(slow error_i / usual_i), evidence exp(-dt / forget))

and the residual counts for clip((evidence - low) / (high - low), 0, 1) of itself.  A residual of
zero leaves the evidence as small as it is, so that a gate that is shut stays shut.  What encoders
count is far below what is usual, and opens no gate.
"""

import numpy as np

from ..models.types import Array, Mask

SLOW = 0.15
"""Time constant of the low-pass filter of errors [s]."""


class Gate:
    """The gates of n simulations.

    Parameters
    ----------
    usual
        Root mean square position errors of the drives without a residual, (drives,) [m, rad].
    low, high, forget
        Evidence at which the residual begins and counts whole, and its time constant [s].
    period
        Of control [s].
    """

    def __init__(self, usual: Array, low: float, high: float, forget: float, period: float) -> None:
        self._usual, self._low, self._width = usual, low, high - low
        self._decay, self._share = np.exp(-period / forget), -np.expm1(-period / SLOW)
        self._slow, self._evidence = np.zeros((0, len(usual))), np.zeros(0)

    def memory(self, num: int) -> tuple[Array, ...]:
        """What the gates of n simulations remember, live arrays (n, ...)."""
        if len(self._evidence) != num:
            self._slow, self._evidence = np.zeros((num, len(self._usual))), np.zeros(num)
        return self._slow, self._evidence

    def open(self, errors: Array, fresh: Mask) -> Array:
        """Shares of the residual that count, (n, 1), at position errors (n, drives)."""
        self.memory(len(errors))
        self._slow[fresh], self._evidence[fresh] = 0.0, 0.0
        self._slow += self._share * (errors - self._slow)
        present = np.sqrt(np.square(self._slow / self._usual).mean(axis=1))
        np.maximum(present, self._decay * self._evidence, out=self._evidence)
        return np.clip((self._evidence - self._low) / self._width, 0.0, 1.0)[:, None]
