"""Terms that are not quadratic: springs and turns, with their discrete gradients.

A discrete gradient of f between q0 and q1 is a vector d with d . (q1 - q0) = f(q1) - f(q0)
(Y 3.6); of a quadratic it is the gradient half way (Y 3.7).  The two terms here are built from
quadratic forms, and so are their discrete gradients:

- a spring, V(e) with e the squared length: dV/de becomes the quotient of differences (Gonzalez);
- a turn, s cos(angle) - c sin(angle) = 0 with s and c the sine and the cosine that the directors
  show: each product takes the mean of one factor and the quotient of the other.

The source ties an angle to the directors by another equation (Y 2.104, 2.108), whose derivative
by the angle, cos + sin, vanishes at -45 and 135 degrees; the one here has the derivative -1.
"""

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from ...models.types import Array

SMALL = 1e-3
"""Half angle x [rad] below which sin(x)/x and its slope come from their series: the slope's formula
loses 1e-16 / x to cancellation, and the terms that are left out are below rounding."""


@dataclass(frozen=True, eq=False)
class Form:
    """A quadratic form 1/2 (q, 1)^T S (q, 1)."""

    matrix: Array
    """Symmetric matrix S, shape (n + 1, n + 1)."""

    def value(self, q: Array) -> float:
        """Value at q (n,)."""
        linear = self.matrix[:-1, -1]
        return float(0.5 * (q @ (self.hessian @ q + 2 * linear) + self.matrix[-1, -1]))

    def gradient(self, q: Array) -> Array:
        """Gradient at q (n,)."""
        return np.asarray(self.hessian @ q + self.matrix[:-1, -1])

    @property
    def hessian(self) -> Array:
        """Second derivatives (n, n)."""
        return self.matrix[:-1, :-1]


@dataclass(frozen=True, eq=False)
class SpringTerm:
    """1/2 stiffness (length - rest)^2."""

    square: Form
    """The squared length [m^2]."""
    stiffness: float
    """Stiffness [N/m]."""
    rest: float
    """Length without force [m]."""

    def value(self, q: Array) -> float:
        """Energy [J]."""
        return float(0.5 * self.stiffness * (self._length(q) - self.rest) ** 2)

    def gradient(self, q: Array) -> Array:
        """Gradient (n,)."""
        return 0.5 * self.stiffness * (1 - self.rest / self._length(q)) * self.square.gradient(q)

    def hessian(self, q: Array) -> Array:
        """Second derivatives (n, n)."""
        length, gradient = self._length(q), self.square.gradient(q)
        first = 0.5 * self.stiffness * (1 - self.rest / length)
        second = 0.25 * self.stiffness * self.rest / length**3
        return first * self.square.hessian + second * np.outer(gradient, gradient)

    def discrete_gradient(self, q0: Array, q1: Array) -> Array:
        """Discrete gradient (n,)."""
        return self._quotient(q0, q1) * self.square.gradient(0.5 * (q0 + q1))

    def discrete_slope(self, q0: Array, q1: Array) -> Array:
        """Derivative (n, n) of the discrete gradient by q1."""
        before, after = self._length(q0), self._length(q1)
        slope = 0.5 * self.stiffness * self.rest / (after * (before + after) ** 2)
        middle = self.square.gradient(0.5 * (q0 + q1))
        outer = slope * np.outer(middle, self.square.gradient(q1))
        return 0.5 * self._quotient(q0, q1) * self.square.hessian + outer

    def _length(self, q: Array) -> float:
        return float(np.sqrt(self.square.value(q)))

    def _quotient(self, q0: Array, q1: Array) -> float:
        """Difference of the energy by that of the squared length, without cancellation."""
        mean = 0.5 * (self._length(q0) + self._length(q1))
        return 0.5 * self.stiffness * (1 - self.rest / mean)


@dataclass(frozen=True, eq=False)
class Turn:
    """The constraint s cos(angle) - c sin(angle)."""

    constraint: int
    """Index among the constraints."""
    angle: int
    """Index of the angle among the coordinates."""
    sine: Form
    """Sine that the directors show."""
    cosine: Form
    """Cosine that the directors show."""

    def value(self, q: Array) -> float:
        """Value of the constraint."""
        angle = q[self.angle]
        return self.sine.value(q) * cos(angle) - self.cosine.value(q) * sin(angle)

    def gradient(self, q: Array) -> Array:
        """Gradient (n,)."""
        angle = q[self.angle]
        result = self.sine.gradient(q) * cos(angle) - self.cosine.gradient(q) * sin(angle)
        result[self.angle] -= self.sine.value(q) * sin(angle) + self.cosine.value(q) * cos(angle)
        return np.asarray(result)

    def hessian(self, q: Array) -> Array:
        """Second derivatives (n, n)."""
        angle = q[self.angle]
        mixed = self.sine.gradient(q) * sin(angle) + self.cosine.gradient(q) * cos(angle)
        result = self.sine.hessian * cos(angle) - self.cosine.hessian * sin(angle)
        result[self.angle] -= mixed
        result[:, self.angle] -= mixed
        result[self.angle, self.angle] -= self.value(q)
        return np.asarray(result)

    def discrete_gradient(self, q0: Array, q1: Array) -> Array:
        """Discrete gradient (n,)."""
        middle = 0.5 * (q0 + q1)
        mean_cos, mean_sin = _means(q0[self.angle], q1[self.angle])
        slope_cos, slope_sin, *_ = _quotients(q0[self.angle], q1[self.angle])
        result = mean_cos * self.sine.gradient(middle) - mean_sin * self.cosine.gradient(middle)
        result[self.angle] += slope_cos * _mean(self.sine, q0, q1)
        result[self.angle] -= slope_sin * _mean(self.cosine, q0, q1)
        return np.asarray(result)

    def discrete_slope(self, q0: Array, q1: Array) -> Array:
        """Derivative (n, n) of the discrete gradient by q1."""
        middle, angle = 0.5 * (q0 + q1), q1[self.angle]
        mean_cos, mean_sin = _means(q0[self.angle], angle)
        slope_cos, slope_sin, bend_cos, bend_sin = _quotients(q0[self.angle], angle)
        result = 0.5 * (mean_cos * self.sine.hessian - mean_sin * self.cosine.hessian)
        result[:, self.angle] -= 0.5 * sin(angle) * self.sine.gradient(middle)
        result[:, self.angle] -= 0.5 * cos(angle) * self.cosine.gradient(middle)
        result[self.angle] += 0.5 * slope_cos * self.sine.gradient(q1)
        result[self.angle] -= 0.5 * slope_sin * self.cosine.gradient(q1)
        result[self.angle, self.angle] += bend_cos * _mean(self.sine, q0, q1)
        result[self.angle, self.angle] -= bend_sin * _mean(self.cosine, q0, q1)
        return np.asarray(result)


def _mean(form: Form, q0: Array, q1: Array) -> float:
    return 0.5 * (form.value(q0) + form.value(q1))


def _means(a: float, b: float) -> tuple[float, float]:
    """Means of cosine and sine at two angles."""
    return 0.5 * (cos(a) + cos(b)), 0.5 * (sin(a) + sin(b))


def _quotients(a: float, b: float) -> tuple[float, float, float, float]:
    """Quotients of differences of cosine and sine, and their derivatives by the second angle."""
    middle, half = 0.5 * (a + b), 0.5 * (b - a)
    if abs(half) < SMALL:
        ratio, slope = 1 - half**2 / 6 + half**4 / 120, -half / 3 + half**3 / 30
    else:
        ratio, slope = sin(half) / half, (half * cos(half) - sin(half)) / half**2
    c, s = cos(middle), sin(middle)
    bends = -0.5 * (c * ratio + s * slope), 0.5 * (c * slope - s * ratio)
    return -s * ratio, c * ratio, *bends
