"""Motions seen from axes that turn: about z with a frame, by Bryant angles with a platform.

A motion is an array whose first axis is the order of the derivative, position, velocity and,
where needed, acceleration, each (N, 3); so is the motion of an angle, each (N,).
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..types import Array
from ..values import Vector
from .frames import UPRIGHT


def turn_about(axis: Vector, motion: Array, angle: Array) -> Array:
    """A motion (orders, N, 3) seen from axes against which its own turn by `angle` about `axis`."""
    if axis == UPRIGHT:
        return turn(motion, angle)
    order, sign, basis = as_upright(axis)
    if basis is not None:
        return _mapped(turn(_mapped(motion, basis), angle), basis.T)
    turned, (first, second, _) = motion.copy(), order
    plane = _in_plane(motion[..., first], motion[..., second], sign * angle)
    turned[..., first], turned[..., second] = plane.real, plane.imag
    return turned


@lru_cache(maxsize=64)
def as_upright(axis: Vector) -> tuple[list[int], float, Array | None]:
    """What brings an axis into the place of z: an order of x, y, z and a sign, or a rotation."""
    a = np.array(axis)
    along = int(np.abs(a).argmax())
    if abs(a[along]) == 1.0:
        return [(along + 1) % 3, (along + 2) % 3, along], float(a[along]), None
    b = np.cross(a, np.eye(3)[np.abs(a).argmin()])
    b /= np.linalg.norm(b)
    return [0, 1, 2], 1.0, np.array([b, np.cross(a, b), a])


def _mapped(motion: Array, matrix: Array) -> Array:
    """A matrix times vectors (..., 3), in an order of sums that does not depend on their number."""
    return np.stack([(motion * row).sum(axis=-1) for row in matrix], axis=-1)


def turn(motion: Array, angle: Array) -> Array:
    """A motion (orders, N, 3) seen from axes against which its own turn about z by `angle`."""
    turned = motion.copy()
    plane = _in_plane(motion[..., 0], motion[..., 1], angle)
    turned[..., 0], turned[..., 1] = plane.real, plane.imag
    return turned


def _in_plane(x: Array, y: Array, angle: Array) -> NDArray[np.complex128]:
    """Motion (orders, N) of a point of a plane that turns, as complex numbers."""
    plane, spin = np.empty(x.shape, complex), 1j * angle
    plane.real, plane.imag = x, y
    if len(x) > 2:
        plane[2] += 2.0 * spin[1] * plane[1]
        plane[2] += (spin[2] - angle[1] ** 2) * plane[0]
    plane[1] += spin[1] * plane[0]
    np.multiply(np.exp(spin[0]), plane, plane)
    return plane


def carry(vector: Vector, angles: tuple[Array, Array, Array]) -> Array:
    """Motion (orders, N, 3) of a vector fixed in a body turned by Bryant angles (orders, N).

    The body is turned by Rx(alpha) Ry(beta) Rz(gamma) (Y 6.56): about z, then y, then x.
    """
    still = np.zeros(angles[0].shape)
    still[0] = 1.0
    parts = [still * part for part in np.transpose(vector)]
    for axis in (2, 1, 0):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        plane = _in_plane(parts[first], parts[second], angles[axis])
        parts[first], parts[second] = plane.real, plane.imag
    return np.stack(parts, axis=-1)
