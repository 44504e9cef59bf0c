"""A teacher for residual policies: it sees the load, the policy must do without.

The teacher feeds the load's true error, its rate and its integral back to the drives, each weighted
as below and turned into drive positions by the rig's static map J (see `statics`):

    residual = stiffness J (error + D rate error + I integral of the error)

On top of feedforward + PD that damps the swing and takes away what wind, friction and a wrong
load mass leave behind.  It is what imitation starts from; what it says is only known in simulation.
"""

from typing import Any

import numpy as np

from ...feedforward import Reference
from ...models.types import Array
from .statics import drive_jacobian

HORIZONTAL = (1.0, 1.0, 0.0)
"""Weights of error [1], rate error [s] and integral [1/s] of horizontal outputs."""
VERTICAL = (2.0, 0.4, 4.0)
"""The same for heights, which drives reach directly: the rope carries no swing there."""
MEMORY = 0.2
"""Bound of the integral [m s], which would otherwise wind up while a drive is at its limit."""


class Teacher:
    """Residuals for n simulations from what no encoder shows."""

    def __init__(self, task: Any, reference: Reference, reach: float) -> None:
        rig, self._task = task.rig, task
        length = task.rows.parts["outputs"].shape[1]
        steps = int(task.rows.length.max()) + 1
        self._map = drive_jacobian(rig, reference, task.period * np.arange(steps))
        self._stiffness = task.gains().stiffness
        travel = np.linalg.norm(self._map, axis=2).mean(axis=0)
        self.fractions = np.minimum(self._stiffness * travel * reach / task.limits, 1.0)
        heights = {f"{part.name}.z" for part in (*rig.loads, *rig.platforms)}
        up = np.array([all(name in heights for _, name in rig.terms(o)) for o in rig.outputs])
        weights = np.where(up, np.array([VERTICAL]).T, np.array([HORIZONTAL]).T)
        self._error, self._rate, self._integral = weights
        self._sum = np.zeros((task.num, length))
        self._step = np.zeros(task.num, dtype=np.int64)

    def reset(self, ids: Any = slice(None)) -> None:
        """Forget the past of some simulations."""
        self._sum[ids] = 0.0
        self._step[ids] = 0

    def watch(self, ids: Any = slice(None)) -> None:
        """Take in the present state; time has gone on in some simulations."""
        task = self._task
        self._offset = task.rows.parts["outputs"] - task.plant.outputs
        self._drift = task.rows.parts["output_rates"] - task.plant.output_rates
        self._sum[ids] += task.period * self._offset[ids]
        np.clip(self._sum, -MEMORY, MEMORY, out=self._sum)
        self._step[ids] += 1

    def advice(self) -> Array:
        """Residuals as shares of `fractions`, (n, drives) in [-1, 1]."""
        push = self._error * self._offset + self._rate * self._drift + self._integral * self._sum
        rows = self._map[np.minimum(self._step, len(self._map) - 1)]
        force = self._stiffness * np.einsum("nij,nj->ni", rows, push)
        return np.asarray(np.clip(force / (self._task.limits * self.fractions), -1.0, 1.0))
