"""From commanded velocities, which may jump, to a path that is smooth enough for a rig.

Each output y follows its command v through n equal lags, (T s + 1)^n y' = v.  So y has n continuous
derivatives whatever the command does, and comes to rest where y + T (z_1 + ... + z_n) is when the
command ends.  A filter's state holds the rows y, z_1, ..., z_n and v, one column for each output:

    T z_1' = v - z_1,    T z_i' = z_(i-1) - z_i,    y' = z_n
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from ...models.types import Array
from ..series.products import factorials

LOST = 1e-15
"""Share of a speed that is rounding."""


@dataclass(frozen=True)
class CommandFilter:
    """n lags of time constant T."""

    lag: float
    """T [s]."""
    order: int
    """n, the number of continuous derivatives."""

    @cached_property
    def _slope(self) -> Array:
        """A in x' = A x, shape (n+2, n+2)."""
        n = self.order
        slope = np.zeros((n + 2, n + 2))
        slope[0, n] = 1.0
        for i in range(1, n + 1):
            slope[i, i] = -1.0 / self.lag
            slope[i, i - 1 if i > 1 else n + 1] = 1.0 / self.lag
        return slope

    def step(self, time: float) -> Array:
        """What advances a state by some time [s] while the command is held, (n+2, n+2)."""
        return np.asarray(scipy.linalg.expm(self._slope * time))

    @cached_property
    def released(self) -> Array:
        """What sets the command to zero, shape (n+2, n+2)."""
        return np.diag([1.0] * (self.order + 1) + [0.0])

    def readout(self, order: int) -> Array:
        """What makes derivatives 0 .. `order` of the outputs of a state, (order+1, n+2)."""
        rows = [np.eye(self.order + 2)[0]]
        for _ in range(order):
            rows.append(rows[-1] @ self._slope)
        return np.array(rows)

    def state_of(self, derivatives: Array) -> Array:
        """The state whose outputs have these n derivatives (n+1 or more, size), without command."""
        n = self.order
        state = np.zeros((n + 2, derivatives.shape[1]))
        state[: n + 1] = np.linalg.solve(self.readout(n)[:, : n + 1], derivatives[: n + 1])
        return state

    def rest(self, state: Array) -> Array:
        """Where the outputs come to rest once the command ends, shape (size,)."""
        return np.asarray(state[0] + self.lag * state[1:-1].sum(axis=0))

    def resting(self, share: float = LOST) -> float:
        """Time [s] after a command's end at which so much of a speed in full is left."""
        lags = 1
        while np.abs(self.step(lags * self.lag)[self.order, 1:-1]).sum() > share:
            lags += 1
        return lags * self.lag

    @cached_property
    def rested(self) -> float:
        """Time [s] after a command's end at which what is left is rounding."""
        return self.resting()

    def advanced(self, states: Array, times: Array) -> Array:
        """States (N, n+2, size) after times (N,) [s] while their commands are held.

        In closed form: the distances d_k = z_k - v decay as exp(-x) sum_j d_(k-j) x^j / j! with
        x = t / T, and y moves by v t and by what they lose, times T.
        """
        n, x = self.order, times / self.lag
        command = states[:, -1:]
        distances = states[:, 1:-1] - command
        weights = np.exp(-x) * x ** np.arange(float(n))[:, None] / factorials(n)[:, None]
        after = np.zeros_like(distances)
        for j in range(n):
            after[:, j:] += weights[j, :, None, None] * distances[:, : n - j]
        result = states.copy()
        result[:, 1:-1] = command + after
        result[:, 0] += command[:, 0] * times[:, None]
        result[:, 0] += self.lag * (distances - after).sum(axis=1)
        return result
