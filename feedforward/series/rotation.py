"""Taylor series of angles, rotations and angular velocities; see `products` for what a series is.

A crane's platform is turned by R = Rx(alpha) Ry(beta) Rz(gamma), its Bryant angles (Y 6.56, 6.71),
whose columns are its directors; an object in a hand by RPY angles, R = Rz(phi) Ry(theta) Rx(psi)
(K 2.15).  From angles to R there is no singular place; back there is one where the middle angle
is +-90 degrees.
"""

import numpy as np

from ...models.types import Array
from .products import derivative, matmul, product

LEAST_COSINE = 1e-9
"""Of beta, below which alpha and gamma have no value of their own."""


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


def about_axis(vector: Array, share: Array) -> Array:
    """Rotations (orders, N, 3, 3) about a fixed axis by shares (orders, N) of an angle.

    Axis times angle is (3,) [rad].  Rodrigues: R = 1 + sin(s) K + (1 - cos(s)) K K with the
    axis' cross product K.
    """
    angle = float(np.linalg.norm(vector))
    axis = np.cross(np.eye(3), vector / angle if angle else vector)
    square = axis @ axis
    sine, cosine = (series[..., None, None] for series in sine_cosine(angle * share))
    result = sine * axis - cosine * square
    result[0] += np.eye(3) + square
    return np.asarray(result)


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
