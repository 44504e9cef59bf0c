"""Reference paths: what the outputs of a rig are to do, as functions of time with derivatives.

    reference = rest_to_rest(start=(0, -4), goal=(5, -1), duration=3.0, order=4)
    reference.derivatives(times, order=4)       # (5, N, 2): path, velocity, ..., 4th derivative
    reference.order                             # 4: what a rig may need is refused beyond that

A path starts from rest at t = 0 and is at rest again from t = `duration` on; asked outside, it
answers with its start or its goal and zero derivatives.  Its `order` counts the derivatives that
are continuous over all time, those two joins included.  Higher derivatives may be asked for and
are those of the piece the time lies in, one-sided where pieces meet; at t = 0 and t = `duration`
they are those from inside.

Anything that has the members of `Reference` can be followed.  Whether its derivatives belong
together is seen when it is first used, see `consistency`; `solve(..., verify=False)` takes its
word.  Paths made here are frozen, hashable and equal if their data are.
"""

from abc import ABC, abstractmethod
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from ...models.types import Array
from ..checks import check_derivative, check_times
from ..series.products import factorials


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


class ReferencePath(ABC):
    """What the paths made here share: a `Reference` but for `order`, `duration` and `size`."""

    @property
    def start(self: Reference) -> Array:
        """Where the path rests for t <= 0.  Shape (size,)."""
        return np.asarray(self([0.0])[0])

    @property
    def goal(self: Reference) -> Array:
        """Where the path rests for t >= `duration`.  Shape (size,)."""
        return np.asarray(self([self.duration])[0])

    def derivatives(self, times: ArrayLike, order: int) -> Array:
        """Values and derivatives up to `order`, see `Reference`.  Shape (order+1, N, size)."""
        order = check_derivative(order)
        return self._derivatives(check_times(times), order)

    @abstractmethod
    def _derivatives(self, times: Array, order: int) -> Array:
        """The same at times (N,) and of an order that have been checked."""

    def __call__(self, times: ArrayLike) -> Array:
        """Values at `times` (N,), shape (N, size)."""
        return np.asarray(self.derivatives(times, 0)[0])


def taylor_of(reference: Reference, times: Array, order: int) -> Array:
    """Taylor coefficients of a reference, shape (order + 1, N, outputs)."""
    scale = factorials(order + 1)[:, None, None]
    return np.asarray(reference.derivatives(times, order) / scale)
