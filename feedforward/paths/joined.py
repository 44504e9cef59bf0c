"""A path that is left for another one on the way."""

from dataclasses import dataclass

import numpy as np

from ...models.types import Array
from .base_motion import BaseMotion
from .reference import Reference, ReferencePath
from .waves import base_at, still


@dataclass(frozen=True)
class Joined(ReferencePath):
    """One path until some time, and from there on another, which starts as that one moves.

    Whether it does so is not looked at: `solve(rig, then, times, begin=motion.at(at))` does.
    """

    first: Reference
    at: float
    """When it is left [s]."""
    then: Reference
    """What is followed from there on; its time 0 is then."""

    @property
    def order(self) -> int:
        """Number of continuous derivatives."""
        return min(self.first.order, self.then.order)

    @property
    def size(self) -> int:
        """Number of columns."""
        return self.first.size

    @property
    def duration(self) -> float:
        """When the goal is reached [s]."""
        return self.at + self.then.duration

    @property
    def still(self) -> "Joined":
        """Without a base's motion; itself where there is none."""
        first, then = still(self.first), still(self.then)
        if first is self.first and then is self.then:
            return self
        return Joined(first, self.at, then)

    def base_at(self, time: float) -> BaseMotion | None:
        """How a base moves from some time on."""
        before = time < self.at
        return base_at(self.first, time) if before else base_at(self.then, time - self.at)

    def _derivatives(self, times: Array, order: int) -> Array:
        later = times >= self.at
        result = np.empty((order + 1, len(times), self.size))
        if not later.all():
            result[:, ~later] = self.first.derivatives(times[~later], order)
        if later.any():
            result[:, later] = self.then.derivatives(times[later] - self.at, order)
        return result
