"""The path that a stream of commands has made, as a reference."""

from dataclasses import dataclass

import numpy as np

from ...models.types import Array
from ..paths.reference import ReferencePath
from .command_filter import CommandFilter


@dataclass(frozen=True, eq=False)
class Commanded(ReferencePath):
    """What was commanded of a stream until some time, and then its stop.

    It starts as the stream did, in rest or moving, and ends where what is left of the motion is
    lost in rounding.
    """

    filter: CommandFilter
    knots: Array
    """When the command changed [s], the last one being the stop, shape (K,)."""
    states: Array
    """Of the filter from then on, the new command included, shape (K, order+2, size)."""
    duration: float
    """When it rests [s]."""

    @property
    def order(self) -> int:
        """Number of continuous derivatives."""
        return self.filter.order

    @property
    def size(self) -> int:
        """Number of columns."""
        return int(self.states.shape[2])

    def _derivatives(self, times: Array, order: int) -> Array:
        within = np.clip(times, 0.0, self.duration)
        piece = np.searchsorted(self.knots, within, side="right") - 1
        states = self.filter.advanced(self.states[piece], within - self.knots[piece])
        result = np.einsum("ki,nis->kns", self.filter.readout(order), states)
        over = times >= self.duration
        result[:, over] = 0.0
        result[0, over] = self.filter.rest(self.states[-1])
        return np.asarray(result)


def stop_from(filter: CommandFilter, state: Array, held: float) -> Commanded:
    """The path from a state on, whose command ends after some time [s]; its time 0 is now."""
    if not held:
        return Commanded(filter, np.zeros(1), (filter.released @ state)[None], filter.rested)
    stop = filter.released @ filter.step(held) @ state
    knots, states = np.array([0.0, held]), np.array([state, stop])
    return Commanded(filter, knots, states, held + filter.rested)
