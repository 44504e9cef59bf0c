"""What drives with limits take of an action: its size either way, its change, its power.

Limits of speed and acceleration are those of plans; they do not hold a simulation back.
"""

import numpy as np

from ...models.rig.rig import Rig
from ...models.types import Array
from ..signals import Band
from .plant import Plant


def band_of(rig: Rig, period: float) -> Band:
    """Bounds of a rig's actions, and by how much they may change in a period [s]."""
    drives, scale = rig.drives, np.array([drive.largest for drive in rig.drives])
    return Band(
        np.array([drive.lowest for drive in drives]) / scale,
        np.array([drive.limit for drive in drives]) / scale,
        np.array([drive.rate for drive in drives]) * period / scale,
    )


class PowerLimits:
    """Keeps the power that is asked of the drives of n simulations within their limits."""

    def __init__(self, plant: Plant, scale: Array) -> None:
        drives = plant.rig.drives
        arms = np.array([plant.rig.arm(drive) for drive in drives])
        self._most = np.array([drive.power for drive in drives]) * arms / scale
        self._plant, self._limited = plant, not np.isinf(self._most).all()

    def keep(self, actions: Array) -> Array:
        """Actions (n, drives) that ask no more power at the drives' present speeds."""
        if not self._limited:
            return actions
        with np.errstate(divide="ignore"):
            most = self._most / np.abs(self._plant.drive_rates)
        return np.asarray(np.clip(actions, -most, most))
