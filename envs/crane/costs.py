"""How near a crane is to what ends its episodes, for reinforcement learning with constraints.

The cost is the largest of these, each 0 where there is room, and 1 where there is none left:

    tension of a rope that cannot push        below `SCARCE` of what it is at home
    room on rails, below trolleys, ...        below `NEAR` of the rig's typical length
    command of a drive                        in the last `CLOSE` of its limit
"""

import mujoco
import numpy as np

from ...models.types import Array
from ..signals import Band
from .plant import Plant
from .residual_share import home_pulls

SCARCE = 0.25
NEAR = 0.05
CLOSE = 0.1


class Costs:
    """The costs of n simulations."""

    def __init__(self, plant: Plant, band: Band) -> None:
        self._pulling = list(plant.rig.pulling)
        pulls = home_pulls(plant, mujoco.MjData(plant.model))[self._pulling]
        self._plant, self._per_pull = plant, 1.0 / (SCARCE * np.abs(pulls))
        self._per_room = 1.0 / (NEAR * plant.geometry.scales.length)
        self._first = plant.margins.shape[1] - len(plant.geometry.reasons)
        with np.errstate(divide="ignore"):
            sides = np.array((1.0 / band.highest, 1.0 / band.lowest))
        self._sides = np.where(np.isfinite(sides), sides, 0.0)  # a drive that gives nothing there

    def of(self, commands: Array) -> Array:
        """Costs (n,) after the last commands (n, drives)."""
        used = (commands[:, None] * self._sides).max(axis=(1, 2))
        plant = self._plant
        taut = (plant.tensions[:, self._pulling] * self._per_pull).min(axis=1, initial=np.inf)
        away = plant.margins[:, self._first :].min(axis=1) * self._per_room
        short = 1.0 - np.minimum(taut, away)
        return np.asarray(np.clip(np.maximum(short, (used - 1.0) / CLOSE + 1.0), 0.0, 1.0))
