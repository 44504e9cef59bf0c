"""What a crane's controller can know of its loads, beside its encoders.

sensors="full" is the truth: where every output is, how fast, and the force in every rope.

sensors="sway" is what cranes have, a camera or an inertial sensor on the hook, and a load cell:

    deflection    every output with white noise, new in every control period, of `DEFLECTION`
                  standard deviation, and `LATE` control periods late; an angle of a platform with
                  that much at its farthest corner
    rates         from these readings, through the filter of `FADING`
    hoist force   every rope's tension with white noise of `FORCE` of the loads' weight

The noise of an episode is drawn from a child of its generator: seeded episodes repeat, and no
scenario or reference is another because of the sensors.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...models.types import Array
from ..common import Ids, Steps
from ..signals import Rows
from .plant import Plant

SWAY = "sway"
"""The set of sensors that cranes have."""

DEFLECTION = 3e-3
"""Standard deviation of where outputs seem to be [m]."""

LATE = 1
"""Control periods between what is and what is read."""

FORCE = 5e-3
"""Standard deviation of a rope's measured tension over the weight of all loads."""

FADING = 0.8
"""How much a reading a period ago counts in rates, over the latest: the double pole of the
g-h filter (Brookner, Tracking and Kalman Filtering Made Easy, 1998, 1.2).  At 50 Hz rates come with
8 mm/s of noise and 0.16 s late; the difference of two readings would have 0.2 m/s."""


class LoadSensors:
    """The truth about outputs and ropes of n simulations."""

    late = 0
    """How many control periods ago `errors` were [periods]."""

    def __init__(self, plant: Plant, rows: Rows) -> None:
        self._plant, self._planned = plant, rows.parts

    @property
    def errors(self) -> Array:
        """Planned minus measured outputs, shape (n, outputs) [m, rad]."""
        return np.asarray(self._planned["outputs"] - self._plant.outputs)

    @property
    def rate_errors(self) -> Array:
        """Planned minus measured rates of outputs, shape (n, outputs) [m/s, rad/s]."""
        return np.asarray(self._planned["output_rates"] - self._plant.output_rates)

    @property
    def tensions(self) -> Array:
        """Measured forces in the ropes, shape (n, ropes) [N]."""
        return self._plant.tensions

    @property
    def memory(self) -> tuple[Array, ...]:
        """What a simulation that rests must keep."""
        return ()

    def reset(self, ids: Ids, generators: Sequence[np.random.Generator], lengths: Steps) -> None:
        """Begin episodes of so many steps."""

    def last(self, ids: Ids, lengths: Steps) -> None:
        """Go on with episodes that are of so many steps now."""

    def step(self, steps: Steps) -> None:
        """Read the plants, which have come to these steps of their episodes."""

    def rest(self, sim: int) -> None:
        """Forget what was read of a plant that was put back to rest."""

    def noise_of(self, sim: int) -> Any:
        """What a state keeps of the episode's noise."""

    def take_noise(self, sim: int, noise: Any) -> None:
        """Go on with the noise of a state."""


class SwaySensors(LoadSensors):
    """Outputs late and with noise, their rates from that, and tensions with noise.

    Parameters
    ----------
    plant, rows
        What is, and what is planned.
    period
        Of control [s].
    levers
        What a unit of each output counts for in metres, (outputs,).
    weight
        Of all loads [N].
    """

    late = LATE

    def __init__(
        self, plant: Plant, rows: Rows, period: float, levers: Array, weight: float
    ) -> None:
        super().__init__(plant, rows)
        num, outputs = plant.outputs.shape
        ropes = plant.tensions.shape[1]
        self._period, self._outputs = period, outputs
        self._scale = np.append(DEFLECTION / levers, np.full(ropes, FORCE * weight))
        self._noise = np.zeros((num, 0, outputs + ropes))
        self._own: dict[int, np.random.Generator] = {}
        self._drawn = [0] * num
        self._every = np.arange(num)
        self._true = np.zeros((LATE + 1, num, outputs))  # the oldest first
        self._errors, self._smooth, self._rates = np.zeros((3, num, outputs))
        self._tensions = np.zeros((num, ropes))

    @property
    def errors(self) -> Array:
        """Planned minus measured outputs `LATE` periods ago, shape (n, outputs) [m, rad]."""
        return self._errors

    @property
    def rate_errors(self) -> Array:
        """The rates of `errors`, filtered, shape (n, outputs) [m/s, rad/s]."""
        return self._rates

    @property
    def tensions(self) -> Array:
        """Measured forces in the ropes, shape (n, ropes) [N]."""
        return self._tensions

    @property
    def memory(self) -> tuple[Array, ...]:
        """What a simulation that rests must keep."""
        return (*self._true, self._errors, self._smooth, self._rates, self._tensions)

    def reset(self, ids: Ids, generators: Sequence[np.random.Generator], lengths: Steps) -> None:
        """Draw the noise of episodes and read plants that were put at rest."""
        for sim, generator in zip(ids.tolist(), generators, strict=True):
            self._own[sim], self._drawn[sim] = generator.spawn(1)[0], 0
        self.last(ids, lengths)
        for sim in ids.tolist():
            self.rest(sim)

    def last(self, ids: Ids, lengths: Steps) -> None:
        """Draw what noise is missing for episodes of so many steps."""
        self._make_room(int(lengths.max()) + 1)
        for sim in ids.tolist():
            drawn, length = self._drawn[sim], int(lengths[sim]) + 1
            if length > drawn:
                shape = length - drawn, len(self._scale)
                noise = self._own[sim].standard_normal(shape) * self._scale
                self._noise[sim, drawn:length] = noise
                self._drawn[sim] = length

    def step(self, steps: Steps) -> None:
        """Read the plants, which have come to these steps of their episodes."""
        self._true[:-1] = self._true[1:]
        self._true[-1] = super().errors
        self._look(self._noise[self._every, np.minimum(steps, self._noise.shape[1] - 1)])
        ahead = self._smooth + self._period * self._rates
        surprise = self._errors - ahead
        self._smooth[...] = ahead + (1.0 - FADING**2) * surprise
        self._rates += (1.0 - FADING) ** 2 / self._period * surprise

    def rest(self, sim: int) -> None:
        """Begin anew with a plant at rest."""
        self._true[:, sim] = super().errors[sim]
        noise = self._noise[sim, 0]
        self._errors[sim] = self._true[0, sim] + noise[: self._outputs]
        self._tensions[sim] = super().tensions[sim] + noise[self._outputs :]
        self._smooth[sim], self._rates[sim] = self._errors[sim], 0.0

    def noise_of(self, sim: int) -> Any:
        """Noise that is drawn already, and what draws more."""
        return self._noise[sim, : self._drawn[sim]], self._own[sim]

    def take_noise(self, sim: int, noise: Any) -> None:
        """Go on with the noise of a state."""
        drawn, self._own[sim] = noise
        self._make_room(len(drawn))
        self._noise[sim, : len(drawn)], self._drawn[sim] = drawn, len(drawn)

    def _make_room(self, length: int) -> None:
        """Keep noise of so many steps."""
        missing = length - self._noise.shape[1]
        if missing > 0:
            self._noise = np.pad(self._noise, ((0, 0), (0, missing), (0, 0)))

    def _look(self, noise: Array) -> None:
        np.add(self._true[0], noise[:, : self._outputs], self._errors)
        np.add(super().tensions, noise[:, self._outputs :], self._tensions)
