"""Paths that start moving: to a new goal, or to rest on the way of another path.

    state = motion.at(2.0)
    away = connected(state.derivatives, goal=(1, -3), duration=4.0)     # leaves for a new goal
    stop = stopped(reference, at=2.0, duration=1.5)                     # slows down on its path
    solve(rig, stop, times, begin=state)

A base that moves goes on where a state says so: connected(state, goal, ...).

Both join what they continue with as many derivatives as their `order` says, and end in rest.
Asked before 0, they answer as at 0.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from ...models.errors import PathError
from ...models.types import Array
from ...models.values import as_number, reals
from ..checks import check_duration, check_order, check_point
from ..series.products import compose, factorials, product
from .base_motion import BaseMotion
from .polynomials import blend_sum, rising
from .profiles import RestToRest, fractions
from .reference import Reference, ReferencePath, taylor_of
from .waves import at_sea, base_at, still


@runtime_checkable
class Moving(Protocol):
    """What a `State` says of the outputs: without a base's motion, and that."""

    @property
    def still(self) -> Array:
        """Outputs and their derivatives without what a base adds to them, (order+1, size)."""

    @property
    def base(self) -> BaseMotion | None:
        """How a base moves from then on."""


HIGHEST_ORDER = 20
"""Of a path that starts moving: rounding in the polynomials stays below a millionth."""


@dataclass(frozen=True)
class Connected(ReferencePath):
    """The polynomial of degree 2 `order` + 1 from moving at 0 to rest at the end.

    With n the order, s = t / duration and the derivatives c_k by s at the start, it is

        goal + (1-s)^(n+1) sum_m s^m sum_(k<=m) (c_k / k!) binom(n+m-k, m-k),     m = 0 .. n,

    c_0 being counted from the goal: the start's Taylor series divided by (1-s)^(n+1) and cut off.
    """

    given: tuple[tuple[float, ...], ...]
    """Outputs at 0 and their first `order` derivatives, (order+1, size)."""
    end: tuple[float, ...]
    duration: float
    """When the goal is reached [s]."""

    @property
    def order(self) -> int:
        """Number of continuous derivatives, the join at 0 included."""
        return len(self.given) - 1

    @property
    def size(self) -> int:
        """Number of columns."""
        return len(self.end)

    def _derivatives(self, times: Array, order: int) -> Array:
        n, start = self.order, np.array(self.given)
        s = np.clip(fractions(times, self.duration), 0.0, 1.0)
        taylor = start * (self.duration ** np.arange(n + 1.0) / factorials(n + 1))[:, None]
        taylor[0] -= self.end
        inner = np.zeros((order + 1, len(s), self.size))
        for m in range(n + 1):
            factor = sum(math.comb(n + m - k, m - k) * taylor[k] for k in range(m + 1))
            for j in range(min(m, order) + 1):
                inner[j] += (math.comb(m, j) * s ** (m - j))[:, None] * factor
        outer = np.zeros((order + 1, len(s), 1))
        for j in range(min(n + 1, order) + 1):
            outer[j, :, 0] = (-1) ** j * math.comb(n + 1, j) * (1.0 - s) ** (n + 1 - j)
        scale = factorials(order + 1) / self.duration ** np.arange(order + 1.0)
        result = product(outer, inner) * scale[:, None, None]
        result[0] += self.end
        kept = min(n, order) + 1
        result[:kept, times <= 0.0] = start[:kept, None]
        result[1:, times > self.duration] = 0.0
        return np.asarray(result)


def connected(
    derivatives: Sequence[Sequence[float]] | Array | Moving,
    goal: Sequence[float] | Array,
    duration: float,
    order: int | None = None,
) -> Reference:
    """The polynomial from a moving start to rest at a goal, of degree 2 `order` + 1.

    Parameters
    ----------
    derivatives
        Outputs at the start and their derivatives, as `State.derivatives` has them, shape
        (order+1 or more, size).  Or a `State`: where its base moves that goes on.
    goal
        Where it ends, shape (size,).
    duration
        [s], > 0.
    order
        Number of derivatives that are continued at the start and vanish at the goal; all that are
        given, unless said otherwise.

    Raises
    ------
    PathError
        A number is not finite, there are fewer derivatives than the order asks for, or they and
        the goal are not of the same outputs.
    """
    if isinstance(derivatives, Moving):
        return at_sea(connected(derivatives.still, goal, duration, order), derivatives.base)
    rows = np.atleast_2d(reals("derivatives", derivatives, error=PathError))
    if rows.ndim != 2 or not rows.size or not np.isfinite(rows).all():
        raise PathError("derivatives must be finite numbers of shape (order+1, outputs)")
    number = len(rows) - 1 if order is None else order
    number = check_order("order", number, highest=HIGHEST_ORDER)
    if len(rows) <= number:
        raise PathError(f"{len(rows)} derivatives are given, order {number} needs {number + 1}")
    end = check_point("goal", goal)
    if rows.shape[1] != len(end):
        raise PathError(
            f"derivatives have {rows.shape[1]} columns and goal {len(end)} coordinates, "
            "they need one each for every output"
        )
    given = tuple(tuple(row) for row in rows[: number + 1].tolist())
    return Connected(given, end, check_duration(duration))


@dataclass(frozen=True)
class Stopped(ReferencePath):
    """Another path from some time on, slowed down to rest: r(sigma(t)), sigma' from 1 to 0.

    The pace sigma' falls on the rest-to-rest polynomial of order `smoothness` - 1, so that the
    path is left half the duration further on, or at its end.
    """

    path: Reference
    at: float
    """When the path is taken over [s]."""
    duration: float
    """How long it takes to come to rest [s]."""
    smoothness: int

    @property
    def order(self) -> int:
        """Number of continuous derivatives, the join at 0 included."""
        return min(self.path.order, self.smoothness)

    @property
    def size(self) -> int:
        """Number of columns."""
        return self.path.size

    def _derivatives(self, times: Array, order: int) -> Array:
        n = self.smoothness
        left = np.clip(1.0 - fractions(times, self.duration), 0.0, 1.0)
        pace = np.zeros((order + 1, len(times)))
        pace[0] = self.at + self.duration * (0.5 - rising(left, n + 1, blend_sum(n)))
        if order:
            slopes = RestToRest(n - 1).derivatives(left, order - 1)
            back = (-self.duration) ** -np.arange(float(order)) / factorials(order + 1)[1:]
            pace[1:] = slopes * back[:, None]
        pace[1:, times > self.duration] = 0.0
        scale = factorials(order + 1)[:, None, None]
        return np.asarray(compose(taylor_of(self.path, pace[0], order), pace) * scale)


def stopped(
    reference: Reference, at: float, duration: float, order: int | None = None
) -> Reference:
    """A path from the time `at` on, slowed down to rest on its own way within a duration.

    A base that moves goes on at its own pace.

    Parameters
    ----------
    reference
        Any path.
    at
        Its time [s] at which slowing down begins.
    duration
        How long that takes [s].  For the shortest that a rig can do::

            shortest_duration(rig, lambda T: stopped(reference, at, T), begin=motion.at(at))
    order
        Number of continuous derivatives of the pace; the reference's, but at most 20.  A lower one
        that the rig still allows brakes harder from the beginning and stops sooner.

    Raises
    ------
    PathError
        `at` is not finite, or the duration or the order is out of range.
    """
    begin = as_number(at)
    if not math.isfinite(begin):
        raise PathError(f"at is {at!r}, it must be a finite number of seconds")
    number = min(reference.order, HIGHEST_ORDER) if order is None else order
    number = check_order("order", number, lowest=1, highest=HIGHEST_ORDER)
    path = Stopped(still(reference), begin, check_duration(duration), number)
    return at_sea(path, base_at(reference, begin))
