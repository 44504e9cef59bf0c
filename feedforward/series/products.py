"""Products, quotients and compositions of Taylor series in time.

A series is an array whose first axis is the order of the Taylor coefficient; the other axes belong
to the thing itself, of shape (orders, N) for a scalar at N samples.  Sums of products are formed
in ascending order of the first factor's coefficients, so that results do not change by rounding.
"""

import math
from collections.abc import Callable
from functools import cache

import numpy as np

from ...models.types import Array


def factorials(orders: int) -> Array:
    """0!, 1!, ...: derivatives are Taylor coefficients times these; shape (orders,)."""
    return _factorials(orders).copy()


@cache
def _factorials(orders: int) -> Array:
    return np.array([math.factorial(k) for k in range(orders)], dtype=float)


def product(a: Array, b: Array, times: Callable[[Array, Array], Array] = np.multiply) -> Array:
    """Series of the product of two series (orders, ...), or of another bilinear operation."""
    return np.array([sum(times(a[i], b[k - i]) for i in range(k + 1)) for k in range(len(a))])


def matmul(a: Array, b: Array) -> Array:
    """Series of a matrix product of series of equal length."""
    return product(a, b, np.matmul)


def apply(matrix: Array, vector: Array) -> Array:
    """Series of matrices (orders, N, 3, 3) times vectors (orders, N, 3)."""
    return np.asarray(matmul(matrix, vector[..., None])[..., 0])


def cross(a: Array, b: Array) -> Array:
    """Series of a x b, each (orders, N, 3)."""
    return product(a, b, np.cross)


def dot(a: Array, b: Array) -> Array:
    """Series of the scalar product, each (orders, N, 3); shape (orders, N)."""
    return np.asarray(product(a, b).sum(axis=-1))


def quotient(a: Array, b: Array) -> Array:
    """Series of a / b, each (orders, ...)."""
    result = np.empty_like(a)
    for k in range(len(a)):
        result[k] = (a[k] - sum(result[i] * b[k - i] for i in range(k))) / b[0]
    return result


def derivative(series: Array) -> Array:
    """Series of the rate, one coefficient shorter."""
    factors = np.arange(1, len(series)).reshape(-1, *[1] * (series.ndim - 1))
    return np.asarray(series[1:] * factors)


def compose(outer: Array, inner: Array) -> Array:
    """Series of outer(inner(t)), by Horner's rule.

    Parameters
    ----------
    outer
        Coefficients (orders, N, ...) in powers of the distance from inner[0].
    inner
        Coefficients (orders, N) in powers of time.
    """
    step = inner.copy()
    step[0] = 0.0
    step = step.reshape(*step.shape, *[1] * (outer.ndim - 2))
    result = np.zeros_like(outer)
    for coefficient in outer[::-1]:
        result = product(step, result)
        result[0] += coefficient
    return result


def between(start: Array, goal: Array, part: Array) -> Array:
    """Series (orders, N, size) from a start to a goal, both (size,), at shares (orders, N)."""
    result = part[..., None] * (np.asarray(goal) - np.asarray(start))
    result[0] += start
    return result
