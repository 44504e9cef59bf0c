"""Motions seen from axes that turn: about z with a frame, by Bryant angles with a platform.

A motion is an array whose first axis is the order of the derivative, position, velocity and,
where needed, acceleration, each (N, 3); so is the motion of an angle, each (N,).
"""

from functools import lru_cache

import numpy as np

from ..types import Array
from ..values import Vector
from .frames import UPRIGHT


def turn_about(axis: Vector, motion: Array, angle: Array) -> Array:
    """A motion (orders, N, 3) seen from axes against which its own turn by `angle` about `axis`."""
    if axis == UPRIGHT:
        return turn(motion, angle)
    order, sign, basis = _third(axis)
    if basis is not None:
        return _mapped(turn(_mapped(motion, basis), angle), basis.T)
    turned = np.empty_like(motion)
    turned[..., order] = turn(motion[..., order], sign * angle)
    return turned


@lru_cache(maxsize=64)
def _third(axis: Vector) -> tuple[list[int], float, Array | None]:
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
    flat = motion[..., 0] + 1j * motion[..., 1]
    terms = [flat[0], flat[1] + 1j * angle[1] * flat[0]]
    if len(motion) > 2:
        terms.append(flat[2] + 2j * angle[1] * flat[1] + (1j * angle[2] - angle[1] ** 2) * flat[0])
    plane = np.exp(1j * angle[0]) * np.stack(terms)
    turned[..., 0], turned[..., 1] = plane.real, plane.imag
    return turned


def carry(vector: Vector, angles: tuple[Array, Array, Array]) -> Array:
    """Motion (orders, N, 3) of a vector fixed in a body turned by Bryant angles (orders, N).

    The body is turned by Rx(alpha) Ry(beta) Rz(gamma) (Y 6.56): about z, then y, then x.
    """
    motion = np.zeros((*angles[0].shape, 3))
    motion[0] = vector
    for axis in (2, 1, 0):
        # put the axis in the place of z, in cyclic order
        order = [(axis + 1) % 3, (axis + 2) % 3, axis]
        motion[..., order] = turn(motion[..., order], angles[axis])
    return motion
