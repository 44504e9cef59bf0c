"""Which of several regulators to follow: the stiffest whose commands drives can give.

A regulator that asks for more than there is, late, swings a load up instead of down.  Of several
that go from stiff to soft, n simulations follow the stiffest whose commands are within the limits,
and a stiffer one again only after its commands would have been for some time: in one swing they
are, whenever the load passes through the middle.

This is piecewise-linear LQ control (Wredenhagen, Belanger 1994), with time in the place of nested
ellipsoids.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.types import Array, Mask


class Softening:
    """The choice of n simulations.

    Parameters
    ----------
    num
        Number of simulations.
    wait
        Control periods in which stiffer commands must have been within the limits.
    """

    def __init__(self, num: int, wait: float) -> None:
        self._wait = wait
        self._waited = np.zeros(num)
        self.chosen = np.zeros(num, dtype=np.int64)
        """Index of each simulation's regulator, 0 the stiffest, (n,)."""

    @property
    def memory(self) -> tuple[NDArray[Any], ...]:
        """What is chosen, and for how long stiffer ones would do, live arrays (n,)."""
        return self.chosen, self._waited

    def choose(self, commands: Array, lowest: Array, highest: Array, fresh: Mask) -> Array:
        """Take note of the present commands of all, and give those of the chosen ones.

        Parameters
        ----------
        commands
            Over the limits, of regulators from stiff to soft, (n, regulators, drives).
        lowest, highest
            What drives can give, (n, drives) each.
        fresh
            Simulations that begin.

        Returns
        -------
        Array
            Those to send, (n, drives).
        """
        above, below = lowest[:, None] <= commands, commands <= highest[:, None]
        within = np.asarray((above & below).all(axis=2))
        within[:, -1] = True
        needed = within.argmax(axis=1)
        self.chosen[fresh], self._waited[fresh] = 0, 0.0
        self._waited = np.where(needed < self.chosen, self._waited + 1.0, 0.0)
        stiffer = self._waited > self._wait
        self.chosen = np.where(needed > self.chosen, needed, self.chosen - stiffer)
        self._waited[stiffer] = 0.0
        return np.asarray(commands[np.arange(len(commands)), self.chosen])
