"""A spline that a sampled path may be: through the points, and through white noise beside them.

The noise goes through the same spline, so that its derivatives show what the points' own noise may
do to theirs, and its residual how much of that there is.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import scipy

from ...models.types import Array

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

ROUNDING = np.finfo(float).eps
"""Relative scatter of any points."""
EXACT = 8
"""Times the rounding: a deviation that nothing improves."""
DRAWS = 2
"""Of white noise for each column, of which the larger counts."""
PLACES = 4001
"""At which derivatives are compared, at most."""


class Shift(NamedTuple):
    """Mean squares over the points."""

    square: float
    noise: float
    doubt: float
    """Two standard deviations of the noise's mean square."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """The spline of some number of pieces through points and white noise, side by side."""

    spline: "BSpline"
    """Values of shape (size + DRAWS size,)."""
    times: Array
    """Shape (N,)."""
    values: Array
    """Of points and noise, shape (N, size + DRAWS size)."""
    order: int
    coarser: tuple["Candidate", ...]

    @property
    def size(self) -> int:
        """Number of columns of the points."""
        return int(self.values.shape[1]) // (1 + DRAWS)

    @property
    def interpolating(self) -> bool:
        """Whether the spline passes through the points, whatever happens between them."""
        return self.pieces == len(self.times) - 1

    @property
    def pieces(self) -> int:
        """Number of polynomial pieces."""
        return int(len(self.spline.t) - 2 * self.spline.k - 1)

    @cached_property
    def residual(self) -> Array:
        """Shape as `values`."""
        return np.asarray(self.values - self.spline(self.times))

    @cached_property
    def highest(self) -> Array:
        """Derivative n at the points and between them, shape (2N-1, size + DRAWS size)."""
        last = len(self.times) - 1
        numbers = np.linspace(0, last, min(2 * last + 1, PLACES))
        places = np.interp(numbers, np.arange(last + 1.0), self.times)
        return np.asarray(self.spline(places, nu=self.order))

    @cached_property
    def deviation(self) -> float:
        """Largest distance of a point's coordinate from the spline."""
        return float(np.abs(self.residual[:, : self.size]).max())

    @property
    def exact(self) -> bool:
        """Whether nothing can come closer to the points."""
        return bool(self.deviation <= EXACT * ROUNDING * np.abs(self.values[:, : self.size]).max())

    @cached_property
    def scatter(self) -> Array:
        """Standard deviation of the points' noise in each column, if all of their residual is."""
        spread = np.sqrt(np.mean(self.residual**2, axis=0))
        rounding = ROUNDING * np.abs(self.values[:, : self.size]).max()
        return np.asarray(np.maximum(spread[: self.size] / np.mean(spread[self.size :]), rounding))

    def noise(self, scatter: Array) -> float:
        """Largest derivative n of noise of a standard deviation (size,)."""
        return float((np.abs(self.highest[:, self.size :]) * np.tile(scatter, DRAWS)).max())

    @cached_property
    def gaps(self) -> list[float]:
        """Largest difference of derivatives n from each coarser candidate."""
        return [
            float(np.abs(self.highest - other.highest)[:, : self.size].max())
            for other in self.coarser
        ]

    def shift(self, coarser: "Candidate", scatter: Array) -> "Shift":
        """How far the points' splines lie apart, and how much of that noise explains."""
        count = self.pieces - coarser.pieces
        away = (self.residual - coarser.residual)[:, : self.size]
        noise = float(np.sum(scatter**2)) * count / len(away)
        return Shift(float(np.mean(np.sum(away**2, axis=1))), noise, noise * math.sqrt(8 / count))

    def part(self, draw: int = 0, scale: Array | float = 1.0) -> "BSpline":
        """The spline through the points, or through a draw of noise from 1 on."""
        columns = slice(draw * self.size, (draw + 1) * self.size)
        return scipy.interpolate.BSpline(
            self.spline.t, self.spline.c[:, columns] * scale, self.spline.k
        )
