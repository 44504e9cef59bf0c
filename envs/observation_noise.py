"""White noise on observations, new in every control period.

Each simulation has a generator of its own for it, a child of its episode's: seeded episodes repeat,
and no scenario or reference is another because of the noise.
"""

from collections.abc import Sequence

import numpy as np

from .common import Ids


class ObservationNoise:
    """The noise of n simulations, of some standard deviation in the scaled units of observations.

    Attributes
    ----------
    values
        Present noise, (n, entries).
    """

    def __init__(self, num: int, entries: int, deviation: float) -> None:
        self.values = np.zeros((num, entries))
        self._deviation = deviation
        self._own: dict[int, np.random.Generator] = {}

    def reset(self, ids: Ids, generators: Sequence[np.random.Generator]) -> None:
        """Begin episodes."""
        for sim, generator in zip(ids.tolist(), generators, strict=True):
            self._own[sim] = generator.spawn(1)[0]
        self.step(ids)

    def step(self, ids: Ids) -> None:
        """Go on by a control period."""
        entries = self.values.shape[1]
        for sim in ids.tolist():
            self.values[sim] = self._deviation * self._own[sim].standard_normal(entries)

    def generator(self, sim: int) -> np.random.Generator:
        """What the noise of a simulation is drawn by."""
        return self._own[sim]

    def take(self, sim: int, generator: np.random.Generator) -> None:
        """Draw the noise of a simulation by another generator."""
        self._own[sim] = generator
