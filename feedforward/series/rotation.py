"""Rotations along Taylor series: Bryant angles to a rotation matrix and back.

A series is an array whose first axis is the order of the Taylor coefficient.  A platform is
turned by R = Rx(alpha) Ry(beta) Rz(gamma) (Y 6.56, 6.71), whose columns are its directors.  From
angles to R there is no singular place; back there is one at beta = +-90 degrees.
"""

import numpy as np

from ...models.types import Array

LEAST_COSINE = 1e-9
"""Of beta, below which alpha and gamma have no value of their own."""


def product(a: Array, b: Array) -> Array:
    """Series of the product of two series, each (orders, ...)."""
    return np.array([sum(a[i] * b[k - i] for i in range(k + 1)) for k in range(len(a))])


def sine_cosine(angle: Array) -> tuple[Array, Array]:
    """Series of sine and cosine of a series (orders, ...)."""
    sin, cos = np.zeros_like(angle), np.zeros_like(angle)
    sin[0], cos[0] = np.sin(angle[0]), np.cos(angle[0])
    for k in range(1, len(angle)):
        # From sin' = cos angle' and cos' = -sin angle'.
        rates = [i * angle[i] / k for i in range(1, k + 1)]
        sin[k] = sum(rate * cos[k - i] for i, rate in enumerate(rates, start=1))
        cos[k] = -sum(rate * sin[k - i] for i, rate in enumerate(rates, start=1))
    return sin, cos


def matrix(angles: Array) -> Array:
    """Rotation matrices (orders, ..., 3, 3) from Bryant angles (orders, ..., 3)."""
    (sa, ca), (sb, cb), (sc, cc) = (sine_cosine(angles[..., i]) for i in range(3))
    sa_sb, ca_sb = product(sa, sb), product(ca, sb)
    rows = [
        [product(cb, cc), -product(cb, sc), sb],
        [
            product(ca, sc) + product(sa_sb, cc),
            product(ca, cc) - product(sa_sb, sc),
            -product(sa, cb),
        ],
        [
            product(sa, sc) - product(ca_sb, cc),
            product(sa, cc) + product(ca_sb, sc),
            product(ca, cb),
        ],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def bryant(rotation: Array) -> Array:
    """Bryant angles (orders, ..., 3) of rotation matrices (orders, ..., 3, 3).

    alpha and gamma lie in (-pi, pi], beta in [-pi/2, pi/2]; not finite where |beta| = pi/2.
    """
    cosine = _hypotenuse(rotation[..., 0, 0], rotation[..., 0, 1])
    return np.stack(
        (
            arctangent(-rotation[..., 1, 2], rotation[..., 2, 2]),
            arctangent(rotation[..., 0, 2], cosine),
            arctangent(-rotation[..., 0, 1], rotation[..., 0, 0]),
        ),
        axis=-1,
    )


def arctangent(y: Array, x: Array) -> Array:
    """Series of the angle of the point (x, y), each (orders, ...)."""
    angle = np.empty_like(x)
    angle[0] = np.arctan2(y[0], x[0])
    square = product(x, x) + product(y, y)
    with np.errstate(all="ignore"):
        weak = square[0] < LEAST_COSINE**2
        for k in range(1, len(x)):
            # From (x^2 + y^2) angle' = x y' - y x'.
            right = sum(i * (x[k - i] * y[i] - y[k - i] * x[i]) for i in range(1, k + 1))
            right = right - sum(i * angle[i] * square[k - i] for i in range(1, k))
            angle[k] = np.where(weak, np.nan, right / (k * square[0]))
    return angle


def _hypotenuse(x: Array, y: Array) -> Array:
    """Series of sqrt(x^2 + y^2), each (orders, ...)."""
    square = product(x, x) + product(y, y)
    root = np.empty_like(square)
    root[0] = np.sqrt(square[0])
    with np.errstate(all="ignore"):
        for k in range(1, len(x)):
            root[k] = (square[k] - sum(root[i] * root[k - i] for i in range(1, k))) / (2 * root[0])
    return root
