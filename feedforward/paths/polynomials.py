"""Rest-to-rest polynomials to rounding.

The polynomials are never summed in powers of s, where large coefficients of alternating signs
cancel.  With n the order and x = 1 - 2 s,

    c(s)  = s^(n+1) sum_k binom(n+k, k) (1-s)^k         all terms positive, used for s <= 1/2
    c'(s) = (2n+1)! / n!^2 (s (1-s))^n                  hence d^j c'/ds^j ~ (s (1-s))^(n-j) Q_j(x)

and c(s) = 1 - c(1-s) gives the other half.  Relative accuracy is kept up to both ends, and the
vanishing derivatives are zero there exactly.
"""

import math
from fractions import Fraction
from functools import cache
from typing import TypeVar

import numpy as np

from ...models.types import Array

Numbers = TypeVar("Numbers", float, Array)
"""One number or an array of them: both come to the same bits."""


def rising(u: Numbers, power: int, coefficients: tuple[float, ...]) -> Numbers:
    """u^power * sum_k coefficients[k] (1-u)^k, for positive coefficients free of cancellation."""
    rest = 1.0 - u
    total = 0.0 * u + coefficients[-1]
    for coefficient in coefficients[-2::-1]:
        total *= rest
        total += coefficient
    for _ in range(power):
        total *= u
    return total


def folded(s: Array, power: int, coefficients: tuple[float, ...]) -> Array:
    """`rising` for s <= 1/2, and 1 - its value at 1-s beyond."""
    second_half = s > 0.5
    half = rising(np.where(second_half, 1.0 - s, s), power, coefficients)
    return np.where(second_half, 1.0 - half, half)


def powers(base: Numbers, highest: int) -> list[Numbers]:
    """base^0 .. base^highest by multiplication, an order of magnitude faster than power()."""
    result = [0.0 * base + 1.0]
    for _ in range(highest):
        result.append(result[-1] * base)
    return result


def parity_horner(coefficients: tuple[float, ...], x: Numbers) -> Numbers:
    """The even or odd polynomial sum_i coefficients[i] x^i."""
    odd = 1 - len(coefficients) % 2
    square = x * x
    total = 0.0 * x + coefficients[-1]
    for coefficient in coefficients[-3::-2]:
        total *= square
        total += coefficient
    return total * x if odd else total


@cache
def rest_sum(order: int) -> tuple[float, ...]:
    """Coefficients a_k of the rest-to-rest polynomial as s^(n+1) sum_k a_k (1-s)^k."""
    return tuple(float(math.comb(order + k, k)) for k in range(order + 1))


@cache
def blend_sum(order: int) -> tuple[float, ...]:
    """Coefficients a_k of the blend in as u^(n+1) sum_k a_k (1-u)^k, all positive.

    They follow from the blend's end, 1/2 - (1-u) + O((1-u)^(n+1)), divided by u^(n+1).
    """
    n = order
    return tuple(float(Fraction(math.comb(n + k, k) * (n - k), 2 * (n + k))) for k in range(n))


@cache
def derivative_factor(order: int, j: int) -> tuple[float, ...]:
    """Polynomial in x that, times (s (1-s))^max(n-j, 0), is the derivative d^(j+1) c / ds^(j+1).

    From (1-x^2)^n, whose j-th derivative by x is (1-x^2)^(n-j) Q_j(x) with
    Q_(j+1) = (1-x^2) Q_j' - 2 (n-j) x Q_j, exactly in integers.
    """
    n = order
    factor = [1]
    for i in range(j):
        slope = [k * value for k, value in enumerate(factor)][1:] or [0]
        if i >= n:
            factor = slope
            continue
        following = [0] * (len(factor) + 1)
        for k, value in enumerate(slope):
            following[k] += value
            if value:
                following[k + 2] -= value
        for k, value in enumerate(factor):
            following[k + 1] -= 2 * (n - i) * value
        factor = following
    scale = Fraction(math.factorial(2 * n + 1), math.factorial(n) ** 2)
    scale *= Fraction((-2) ** j, 4 ** min(n, j))
    return tuple(float(scale * value) for value in factor)
