"""Reference paths: what the outputs of a rig are to do, as functions of time with derivatives.

    reference = rest_to_rest(start=(0, -4), goal=(5, -1), duration=3.0, order=4)
    reference.derivatives(times, order=4)       # (5, N, 2): path, velocity, ..., 4th derivative
    reference.order                             # 4: what a rig may need is refused beyond that

A path starts from rest at t = 0 and is at rest again from t = `duration` on; asked outside, it
answers with its start or its goal and zero derivatives.  Its `order` counts the derivatives that
are continuous over all time, those two joins included.  Higher derivatives may be asked for and
are those of the piece the time lies in, one-sided where pieces meet; at t = 0 and t = `duration`
they are those from inside.

Anything that has the members of `Reference` can be followed.  Paths made here are frozen, hashable
and equal if their data are.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import PathError
from ...models.types import Array
from ..checks import check_derivative, check_duration, check_point, check_times
from .profiles import SHORTEST_BLEND, AtRest, Profile, RestToRest, ThreePhase
from .recordings import from_csv

if TYPE_CHECKING:
    from ...models.rig.move import Move


class Reference(Protocol):
    """A path of the outputs over time, from rest to rest."""

    @property
    def order(self) -> int:
        """Number of derivatives continuous over all time, the joins to rest included."""

    @property
    def duration(self) -> float:
        """When the goal is reached [s]; the path starts at t = 0."""

    @property
    def size(self) -> int:
        """Number of columns, one for each output."""

    @property
    def start(self) -> Array:
        """Where the path rests for t <= 0.  Shape (size,), a copy."""

    @property
    def goal(self) -> Array:
        """Where the path rests for t >= `duration`.  Shape (size,), a copy."""

    def derivatives(self, times: ArrayLike, order: int) -> Array:
        """Values and derivatives d^k/dt^k, k = 0 .. `order`.

        Parameters
        ----------
        times
            Shape (N,) [s], in any order.
        order
            Highest derivative, 0 for values only; the paths made here have up to 30.

        Returns
        -------
        Array
            Shape (order+1, N, size).

        Raises
        ------
        PathError
            A time is NaN, or the order is out of range.
        """

    def __call__(self, times: ArrayLike) -> Array:
        """Values at `times` (N,), shape (N, size)."""

    def __hash__(self) -> int:
        """Of the path's data: solutions are remembered by it."""


def taylor_of(reference: Reference, times: Array, order: int) -> Array:
    """Taylor coefficients of a reference, shape (order + 1, N, outputs)."""
    factorials = [math.factorial(k) for k in range(order + 1)]
    derivatives = reference.derivatives(times, order)
    return np.asarray(derivatives / np.array(factorials, dtype=float)[:, None, None])


class OfPath:
    """What a path made from another one, its `path`, has from that one."""

    path: Reference

    @property
    def size(self) -> int:
        """Number of columns."""
        return self.path.size

    @property
    def start(self) -> Array:
        """Shape (size,)."""
        return self.path.start

    @property
    def goal(self) -> Array:
        """Shape (size,)."""
        return self.path.goal

    def derivatives(self, times: ArrayLike, order: int) -> Array:
        """Values and derivatives up to `order`, see `Reference`.  Shape (order+1, N, size)."""
        return self.path.derivatives(times, order)

    def __call__(self, times: ArrayLike) -> Array:
        """Values at `times` (N,), shape (N, size)."""
        return np.asarray(self.derivatives(times, 0)[0])


@dataclass(frozen=True)
class StraightPath:
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
    """[s]"""
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

    @property
    def start(self) -> Array:
        """Shape (size,)."""
        return np.array(self.begin)

    @property
    def goal(self) -> Array:
        """Shape (size,)."""
        return np.array(self.end)

    def derivatives(self, times: ArrayLike, order: int) -> Array:
        """Values and derivatives up to `order`, see `Reference`.  Shape (order+1, N, size)."""
        order = check_derivative(order)
        times = check_times(times)
        with np.errstate(over="ignore"):  # of a time at the end of the world, which is outside
            fractions = times / self.duration
        scalar = self.profile.derivatives(fractions, order)
        for k in range(1, order + 1):
            scalar[k] /= self.duration**k
        result = np.empty((*scalar.shape, self.size))
        arrived = times >= self.duration
        for column, (begin, end) in enumerate(zip(self.begin, self.end, strict=True)):
            np.multiply(scalar, end - begin, out=result[..., column])
            result[0, :, column] += begin
            result[0, arrived, column] = end
        return result

    def __call__(self, times: ArrayLike) -> Array:
        """Values at `times` (N,), shape (N, size)."""
        return np.asarray(self.derivatives(times, 0)[0])


def rest_to_rest(
    start: Sequence[float] | Array,
    goal: Sequence[float] | Array,
    duration: float,
    order: int = 4,
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


def from_move(move: "Move") -> Reference:
    """The path that a move describes.

    A sampled move follows its CSV: start, goal and duration are the file's, and if the move has a
    start of its own, the file needs as many outputs.

    Raises
    ------
    PathError
        The move's numbers make no path, or its file cannot be used.
    """
    if move.profile == "sampled":
        return from_csv(move.samples, move.order, size=len(move.start) or None)
    if move.profile == "three_phase":
        path = three_phase(move.start, move.goal, move.duration, move.blend, move.order)
    else:
        path = rest_to_rest(move.start, move.goal, move.duration, move.order)
    if move.turning:
        from .turning import fixed_axis  # which is made of the paths of this module

        return fixed_axis(path, move.turning)
    return path
