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
        pulls = home_pulls(plant, mujoco.MjData(plant.model))[list(plant.rig.pulling)]
        room = np.full(plant.margins.shape[1], NEAR * plant.geometry.scales.length)
        room[: len(pulls)] = SCARCE * np.abs(pulls)
        self._plant, self._per_room = plant, 1.0 / room
        with np.errstate(divide="ignore"):
            sides = np.array((1.0 / band.highest, 1.0 / band.lowest))
        self._sides = np.where(np.isfinite(sides), sides, 0.0)  # a drive that gives nothing there

    def of(self, commands: Array) -> Array:
        """Costs (n,) after the last commands (n, drives)."""
        used = (commands[:, None] * self._sides).max(axis=(1, 2))
        short = 1.0 - (self._plant.margins * self._per_room).min(axis=1)
        return np.asarray(np.clip(np.maximum(short, (used - 1.0) / CLOSE + 1.0), 0.0, 1.0))
