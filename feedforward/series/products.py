"""Taylor series in time of angles, rotations and angular velocities.

A series is an array whose first axis is the order of the Taylor coefficient, as in
`feedforward.series.rotation`; here rotations are RPY, Rz(phi) Ry(theta) Rx(psi) (K 2.15).
"""

import math

import numpy as np

from ...models.types import Array
from ..paths.profiles import RestToRest
from .rotation import product, sine_cosine

ORDERS = 3
"""Coefficients of a pose: its value, velocity and half its acceleration."""


def share(times: Array, duration: float, order: int, orders: int = ORDERS) -> Array:
    """How far a rest-to-rest motion has come, from 0 to 1, (orders, N) (K 2.102)."""
    derivatives = RestToRest(order).derivatives(times / duration, orders - 1)
    scale = np.array([math.factorial(k) * duration**k for k in range(orders)])
    return np.asarray(derivatives / scale[:, None])


def between(start: Array, goal: Array, part: Array) -> Array:
    """Series (orders, N, size) from a start to a goal, both (size,), at shares (orders, N)."""
    result = part[..., None] * (np.asarray(goal) - np.asarray(start))
    result[0] += start
    return result


def derivative(series: Array) -> Array:
    """Series of the rate, one coefficient shorter."""
    factors = np.arange(1, len(series)).reshape(-1, *[1] * (series.ndim - 1))
    return np.asarray(series[1:] * factors)


def quotient(a: Array, b: Array) -> Array:
    """Series of a / b, each (orders, ...)."""
    result = np.empty_like(a)
    for k in range(len(a)):
        result[k] = (a[k] - sum(result[i] * b[k - i] for i in range(k))) / b[0]
    return result


def compose(outer: Array, inner: Array) -> Array:
    """Series of outer(inner(t)); `outer` (orders, N, ...) is taken about inner[0] (N,)."""
    step = inner.copy()
    step[0] = 0.0
    step = step.reshape(*step.shape, *[1] * (outer.ndim - 2))
    result = np.zeros_like(outer)
    for coefficient in outer[::-1]:
        result = product(result, np.broadcast_to(step, result.shape))
        result[0] += coefficient
    return result


def matmul(a: Array, b: Array) -> Array:
    """Series of a matrix product of series of equal length."""
    return np.array([sum(a[i] @ b[k - i] for i in range(k + 1)) for k in range(len(a))])


def apply(matrix: Array, vector: Array) -> Array:
    """Series of matrices (orders, N, 3, 3) times vectors (orders, N, 3)."""
    return np.asarray(matmul(matrix, vector[..., None])[..., 0])


def cross(a: Array, b: Array) -> Array:
    """Series of a x b, each (orders, N, 3)."""
    return np.array([sum(np.cross(a[i], b[k - i]) for i in range(k + 1)) for k in range(len(a))])


def dot(a: Array, b: Array) -> Array:
    """Series of the scalar product, each (orders, N, 3); shape (orders, N)."""
    return np.asarray(product(a, b).sum(axis=-1))


def rpy_matrix(angles: Array) -> Array:
    """Rotations (orders, ..., 3, 3) of RPY angles (orders, ..., 3) (K 2.15)."""
    (sf, cf), (st, ct), (sp, cp) = (sine_cosine(angles[..., i]) for i in range(3))
    sf_st, cf_st = product(sf, st), product(cf, st)
    rows = [
        [
            product(cf, ct),
            product(cf_st, sp) - product(sf, cp),
            product(cf_st, cp) + product(sf, sp),
        ],
        [
            product(sf, ct),
            product(sf_st, sp) + product(cf, cp),
            product(sf_st, cp) - product(cf, sp),
        ],
        [-st, product(ct, sp), product(ct, cp)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def rpy_angles(rotation: Array) -> Array:
    """RPY angles (..., 3) of rotations (..., 3, 3); theta lies in [-pi/2, pi/2]."""
    level = np.hypot(rotation[..., 0, 0], rotation[..., 1, 0])
    return np.stack(
        (
            np.arctan2(rotation[..., 1, 0], rotation[..., 0, 0]),
            np.arctan2(-rotation[..., 2, 0], level),
            np.arctan2(rotation[..., 2, 1], rotation[..., 2, 2]),
        ),
        axis=-1,
    )


def rotation_of(angles: tuple[float, ...]) -> Array:
    """One rotation (3, 3) of RPY angles, or of a planar hand's single angle from x to z."""
    if len(angles) == 1:
        angles = (0.0, -angles[0], 0.0)
    return np.asarray(rpy_matrix(np.array([angles]))[0])


def angular_velocity(rotation: Array) -> Array:
    """Series (orders - 1, N, 3) from that of a rotation (orders, N, 3, 3) (K A.4)."""
    turned = rotation.swapaxes(-1, -2)[:-1]
    skew = matmul(derivative(rotation), turned)
    parts = (
        skew[..., 2, 1] - skew[..., 1, 2],
        skew[..., 0, 2] - skew[..., 2, 0],
        skew[..., 1, 0] - skew[..., 0, 1],
    )
    return np.stack(parts, axis=-1) / 2


def about_axis(vector: Array, part: Array) -> Array:
    """Rotations (orders, N, 3, 3) about a fixed axis times angle (3,), at shares (orders, N)."""
    angle = float(np.linalg.norm(vector))
    axis = np.cross(np.eye(3), vector / angle if angle else vector)
    sine, cosine = sine_cosine(angle * part)
    square = axis @ axis
    result = sine[..., None, None] * axis - cosine[..., None, None] * square
    result[0] += np.eye(3) + square
    return result
