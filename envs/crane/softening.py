"""Which of several regulators to follow: the stiffest whose commands drives can give.

A regulator that asks for more than there is, late, swings a load up instead of down.  Of several
that go from stiff to soft, n simulations follow the stiffest whose commands are within the limits,
and a stiffer one again only after its commands would have been for some time: in one swing they
are, whenever the load passes through the middle.

Something below may let less pass than the limits, as what keeps ropes taut does.  What that cuts
for a moment does no harm, a winch catches up; a regulator that it cuts most of the time is no
longer the one that was designed, and a softer one is followed.

This is piecewise-linear LQ control (Wredenhagen, Belanger 1994), with time in the place of nested
ellipsoids.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.types import Array, Mask

SWINGS = 3.0
"""Time before a stiffer regulator is taken again, over that in which a load swings by a radian."""
MOMENT = 0.5
"""Time constant over which it counts how often commands are cut, over the same."""
OFTEN = 0.5
"""Share of the time that they may be."""


class Softening:
    """The choice of n simulations.

    Parameters
    ----------
    num
        Number of simulations.
    regulators
        Number of regulators.
    swing
        Control periods in which a load swings by a radian.
    """

    def __init__(self, num: int, regulators: int, swing: float) -> None:
        self._wait, self._moment = SWINGS * swing, -np.expm1(-1.0 / (MOMENT * swing))
        self._waited = np.zeros(num)
        self._cut = np.zeros((num, regulators))
        self.chosen = np.zeros(num, dtype=np.int64)
        """Index of each simulation's regulator, 0 the stiffest, (n,)."""

    @property
    def memory(self) -> tuple[NDArray[Any], ...]:
        """What is chosen, for how long stiffer ones would do, and how often all are cut, live."""
        return self.chosen, self._waited, self._cut

    def choose(self, commands: Array, lowest: Array, highest: Array, fresh: Mask) -> Array:
        """Take note of the present commands of all, and give those of the chosen ones.

        Parameters
        ----------
        commands
            Over the limits, of regulators from stiff to soft, (n, regulators, drives).
        lowest, highest
            What is let pass, (n, drives) each.
        fresh
            Simulations that begin.

        Returns
        -------
        Array
            Those to send, (n, drives).
        """
        cut = ((commands < lowest[:, None]) | (commands > highest[:, None])).any(axis=2)
        self._cut[fresh] = 0.0
        self._cut += self._moment * (cut - self._cut)
        within = np.asarray((np.abs(commands) <= 1.0).all(axis=2)) & (self._cut <= OFTEN)
        within[:, -1] = True
        needed = within.argmax(axis=1)
        self.chosen[fresh], self._waited[fresh] = 0, 0.0
        self._waited = np.where(needed < self.chosen, self._waited + 1.0, 0.0)
        stiffer = self._waited > self._wait
        self.chosen = np.where(needed > self.chosen, needed, self.chosen - stiffer)
        self._waited[stiffer] = 0.0
        return np.asarray(commands[np.arange(len(commands)), self.chosen])
