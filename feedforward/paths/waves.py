"""A path on a base that moves: its motion added to columns that are not from rest to rest.

    swell = BaseMotion(waves=(Wave(3, amplitude=1.0, period=8.0),))
    path = at_sea(rest_to_rest(start, goal, 40.0), swell)

The path's other columns start and end in rest as ever.  The sea was there before the path starts,
and goes on after it.
"""

from dataclasses import dataclass

from ...models.types import Array
from .base_motion import BaseMotion
from .reference import Reference, ReferencePath


@dataclass(frozen=True)
class AtSea(ReferencePath):
    """A path on a base that moves."""

    still: Reference
    """What it does without the base's motion, from rest to rest."""
    base: BaseMotion
    """What is added, for all time."""

    @property
    def order(self) -> int:
        """As of the path, or of the roughest recording: waves are smooth."""
        return min([self.still.order, *(record.order for record in self.base.records)])

    @property
    def duration(self) -> float:
        """As of the path [s]."""
        return self.still.duration

    @property
    def size(self) -> int:
        """Number of columns."""
        return self.still.size

    def base_at(self, time: float) -> BaseMotion:
        """How the base moves from some time on."""
        return self.base.later(time)

    def _derivatives(self, times: Array, order: int) -> Array:
        return self.base.added(self.still.derivatives(times, order), times)


def at_sea(path: Reference, base: BaseMotion | None) -> Reference:
    """The path with a base's motion added; the path itself where there is none."""
    return AtSea(path, base) if base else path


def still(reference: Reference) -> Reference:
    """A path without the base's motion in it."""
    found: Reference = getattr(reference, "still", reference)
    return found


def base_at(reference: Reference, time: float) -> BaseMotion | None:
    """How the base moves from some time of a path on; None if it does not."""
    ask = getattr(reference, "base_at", None)
    found: BaseMotion | None = None if ask is None else ask(time)
    return found
