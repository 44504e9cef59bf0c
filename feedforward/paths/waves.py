"""A path on a base that moves: sinusoids added to columns that are not from rest to rest.

    path = at_sea(rest_to_rest(start, goal, 40.0), (Wave(3, amplitude=1.0, period=8.0),))

The path's other columns start and end in rest as ever.  The sea was there before the path starts,
and goes on after it.
"""

from dataclasses import dataclass

import numpy as np

from ...models.rig.move import Wave
from ...models.types import Array
from .reference import Reference, ReferencePath


@dataclass(frozen=True)
class AtSea(ReferencePath):
    """A path with waves in some of its columns."""

    path: Reference
    """What it does without them, from rest to rest."""
    waves: tuple[Wave, ...]
    """What is added, for all time."""

    @property
    def order(self) -> int:
        """As of the path: waves are smooth."""
        return self.path.order

    @property
    def duration(self) -> float:
        """As of the path [s]."""
        return self.path.duration

    @property
    def size(self) -> int:
        """Number of columns."""
        return self.path.size

    def _derivatives(self, times: Array, order: int) -> Array:
        values = self.path.derivatives(times, order).copy()
        for wave in self.waves:
            turn = 2.0 * np.pi / wave.period
            angle = turn * times + wave.phase
            for k in range(order + 1):
                growth = wave.amplitude * turn**k
                values[k, :, wave.column] += growth * np.sin(angle + 0.5 * np.pi * k)
        return values


def at_sea(path: Reference, waves: tuple[Wave, ...]) -> Reference:
    """The path with waves added; the path itself where there are none."""
    return AtSea(path, waves) if waves else path


def still(reference: Reference) -> Reference:
    """A path without the waves in it."""
    return reference.path if isinstance(reference, AtSea) else reference
