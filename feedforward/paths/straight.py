"""Straight lines from rest to rest.

rest_to_rest(start=(0, -4), goal=(5, -1), duration=3.0, order=4)
three_phase(start=(0, -4), goal=(5, -1), duration=3.0, blend=1.0)   # at constant speed
hold((0, -4))                                                       # a set point
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...models.errors import PathError
from ...models.types import Array
from ..checks import check_duration, check_point
from .profiles import SHORTEST_BLEND, AtRest, Profile, RestToRest, ThreePhase, fractions
from .reference import ReferencePath


@dataclass(frozen=True)
class StraightPath(ReferencePath):
    """A straight line from `begin` to `end`, covered as a scalar profile says.

    Raises
    ------
    PathError
        A coordinate is not a finite number or beyond 1e12, the duration is not from
        1e-6 s to 1e9 s, or the two ends differ in length.
    """

    begin: tuple[float, ...]
    end: tuple[float, ...]
    duration: float
    """When the goal is reached [s]."""
    profile: Profile

    def __post_init__(self) -> None:
        object.__setattr__(self, "begin", check_point("start", self.begin))
        object.__setattr__(self, "end", check_point("goal", self.end))
        object.__setattr__(self, "duration", check_duration(self.duration))
        if len(self.begin) != len(self.end):
            raise PathError(
                f"start has {len(self.begin)} coordinates and goal {len(self.end)}, "
                "they need one each for every output"
            )

    @property
    def order(self) -> int:
        """Number of continuous derivatives."""
        return self.profile.order

    @property
    def size(self) -> int:
        """Number of columns."""
        return len(self.begin)

    def _derivatives(self, times: Array, order: int) -> Array:
        scalar = self.profile.derivatives(fractions(times, self.duration), order)
        scalar /= np.array([self.duration**k for k in range(order + 1)])[:, None]
        if len(times) == 1:  # columns at once, which for many times is slower
            result = scalar[..., None] * np.subtract(self.end, self.begin)
            result[0] = self.end if times[0] >= self.duration else result[0] + self.begin
            return np.asarray(result)
        # Column by column in memory, as it is written here and read by what solves with it.
        result = np.empty((order + 1, self.size, len(times))).transpose(0, 2, 1)
        arrived = times >= self.duration
        for column, (begin, end) in enumerate(zip(self.begin, self.end, strict=True)):
            np.multiply(scalar, end - begin, out=result[..., column])
            result[0, :, column] += begin
            result[0, arrived, column] = end
        return result


def rest_to_rest(
    start: Sequence[float] | Array, goal: Sequence[float] | Array, duration: float, order: int = 4
) -> StraightPath:
    """A straight line from rest to rest on a polynomial of degree 2 `order` + 1.

    Parameters
    ----------
    start
        Where it starts, shape (size,), in the rig's order of outputs.
    goal
        Where it ends, shape (size,).
    duration
        [s], > 0.
    order
        Number of derivatives that vanish at both ends; 4 is Y 4.87, 6 is K 3.57.

    Raises
    ------
    PathError
        See `StraightPath`, or the order is not a whole number from 0 to 100.
    """
    return StraightPath(
        check_point("start", start), check_point("goal", goal), duration, RestToRest(order)
    )


def three_phase(
    start: Sequence[float] | Array,
    goal: Sequence[float] | Array,
    duration: float,
    blend: float,
    order: int = 4,
) -> StraightPath:
    """A straight line at constant speed, with smooth blends from and to rest (Y 4.126-4.128).

    Parameters
    ----------
    start
        Where it starts, shape (size,), in the rig's order of outputs.
    goal
        Where it ends, shape (size,).
    duration
        Tau [s], > 0.
    blend
        tau0, how long the speed takes to build up and to die down [s],
        from a millionth of the duration to half of it.
    order
        Number of continuous derivatives, from 1 (trapezoidal speed) to 100; 4 is Y's.

    Raises
    ------
    PathError
        As for `rest_to_rest`, or the blend is out of range.
    """
    duration = check_duration(duration)
    fraction = check_duration(blend, "blend") / duration
    if fraction > 0.5:
        raise PathError(
            f"blend is {blend:g} s, it must be at most half of the duration {duration:g} s"
        )
    if fraction < SHORTEST_BLEND:
        raise PathError(
            f"blend is {blend:g} s, it must be at least {SHORTEST_BLEND:g} of the "
            f"duration {duration:g} s"
        )
    return StraightPath(
        check_point("start", start),
        check_point("goal", goal),
        duration,
        ThreePhase(fraction, order),
    )


def hold(position: Sequence[float] | Array, duration: float = 1.0) -> StraightPath:
    """The path that stays at `position` (shape (size,)): a set point.

    Raises
    ------
    PathError
        A coordinate is not finite, or the duration is not positive.
    """
    point = check_point("position", position)
    return StraightPath(point, point, duration, AtRest())
