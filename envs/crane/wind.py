"""Wind on what a crane carries: a steady force with a sinusoid on top."""

from collections.abc import Callable

import mujoco
import numpy as np
from mujoco.batch import Batch

from ...models.rig.rig import Rig
from ...models.types import Array
from ..formulas import Formulas
from .disturbances import Scenario
from .payloads import payloads


class Wind:
    """A steady force on all that hangs with a sinusoid on top, held over each control period."""

    def __init__(self, rig: Rig, model: mujoco.MjModel, batch: Batch) -> None:
        num = batch.nsim
        self._rig = rig
        self._loads = [model.body(load.name).id for load in payloads(rig)]
        self._push = batch.bind("xfrc_applied")
        self._steady, self._gust, self._rate, self._phase = (np.zeros(num) for _ in range(4))
        self._heading = np.zeros((num, 3))
        self.blowing = False
        self.blow = self._blowing(batch.bind("time"))
        """Applies the forces of this instant."""

    def set(self, sim: int, scenario: Scenario) -> None:
        """The wind of one simulation."""
        self._steady[sim], self._gust[sim] = scenario.wind, scenario.gust
        self._rate[sim] = 2.0 * np.pi * scenario.gust_frequency
        self._phase[sim] = scenario.gust_phase
        self._heading[sim] = heading(self._rig, scenario.wind_direction)
        self.blowing = bool((self._steady != 0).any() or (self._gust != 0).any())

    def _blowing(self, time: Array) -> Callable[[], None]:
        """Formulas for the forces at the live times of all simulations."""
        blow = Formulas(len(self._heading))
        steady, gust, rate, phase, now, heading = map(
            blow.see, (self._steady, self._gust, self._rate, self._phase, time, self._heading)
        )
        force = (steady + gust * blow.apply(np.sin, rate * now + phase, 1)) * heading
        for load in self._loads:
            blow.keep(self._push[:, load, :3], force)
        return blow.made()


def heading(rig: Rig, direction: float) -> Array:
    """Horizontal unit vector, (3,); in a planar rig along x, to the side the direction points."""
    if rig.dimensions == 2:
        return np.array([1.0 if np.cos(direction) >= 0 else -1.0, 0.0, 0.0])
    return np.array([np.cos(direction), np.sin(direction), 0.0])
