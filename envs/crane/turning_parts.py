"""Formulas for motions of what turns: platforms' rotation matrices, and ways of loads on links.

They are those of `flatrig.models.rig.turning_axes`.  Products of complex numbers are left to NumPy,
whose rounding of them plain floats do not have.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from ...models.mjcf.swinging import hinges_above
from ...models.rig.body import Body
from ...models.rig.frames import UPRIGHT
from ...models.rig.rig import Rig
from ...models.rig.turning_axes import as_upright
from ...models.types import Array
from ...models.values import Vector
from ..formulas import Formulas, Value, in_order

Motion = list[Value]
"""A number's position, velocity and acceleration."""


def rotation(step: Formulas, angles: Sequence[Motion]) -> Motion:
    """Rotation matrices (n, 9), row by row, from Bryant angles; in a plane from beta alone."""
    unit, none = np.eye(3), step.constant([0.0] * 3)
    parts = [[step.constant(unit[axis]), none, none] for axis in range(3)]
    about = dict(zip((0, 1, 2) if len(angles) == 3 else (1,), angles, strict=True))
    for axis in sorted(about, reverse=True):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        parts[first], parts[second] = _in_plane(step, parts[first], parts[second], about[axis])
    return _orders(step, parts)


def way(step: Formulas, rig: Rig, body: Body, joints: Mapping[str, Motion]) -> Motion:
    """From the point that a load swings about to the load, in its frame's axes, (n, 3)."""
    assert body.swing is not None
    none = step.constant(0.0)
    parts = [[step.constant(part), none, none] for part in body.swing.reach]
    for name, axis in hinges_above(rig, body):
        parts = _turn_about(step, axis, parts, joints[name])
    return _orders(step, parts)


def _orders(step: Formulas, parts: list[Motion]) -> Motion:
    """x, y and z behind each other."""
    return [step.join(order) for order in zip(*parts, strict=True)]


def _turn_about(step: Formulas, axis: Vector, parts: list[Motion], angle: Motion) -> list[Motion]:
    """x, y and z seen from axes against which their own turn about an axis."""
    (first, second, along), sign, basis = [0, 1, 2], 1.0, None
    if axis != UPRIGHT:
        (first, second, along), sign, basis = as_upright(axis)
    if basis is not None:
        turned = _turn_about(step, UPRIGHT, _mapped(step, parts, basis), angle)
        return _mapped(step, turned, basis.T)
    angle = angle if sign > 0 else [-part for part in angle]
    plane = _in_plane(step, parts[first], parts[second], angle)
    by_axis = dict(zip((first, second, along), (*plane, parts[along]), strict=True))
    return [by_axis[axis] for axis in range(3)]


def _mapped(step: Formulas, parts: list[Motion], matrix: Array) -> list[Motion]:
    """A matrix times a vector in motion."""
    rows = [[step.constant(float(entry)) for entry in row] for row in matrix]
    return [
        [in_order([part * by for part, by in zip(order, row, strict=True)])
         for order in zip(*parts, strict=True)]
        for row in rows
    ]  # fmt: skip


def _in_plane(step: Formulas, x: Motion, y: Motion, angle: Motion) -> tuple[Motion, Motion]:
    """Motions of points of a plane that turns, each of some points."""
    twice = step.constant(2.0) * angle[1]
    points = [
        (x[0], y[0]),
        (x[1] - angle[1] * y[0], y[1] + angle[1] * x[0]),
        (x[2] - twice * y[1], y[2] + twice * x[1]),
    ]
    width = x[0].width
    numbers = [step.constant(0.0), angle[0], -(angle[1] * angle[1]), angle[2]]
    numbers += [part[[k]] for point in points for k in range(width) for part in point]
    turned = step.apply(_spin, step.join(numbers), 6 * width)
    ends = range(0, 6 * width, 2 * width)
    at_x, at_y = (
        [turned[range(first + part, first + 2 * width, 2)] for first in ends] for part in (0, 1)
    )
    return at_x, at_y


def _spin(values: Array, out: Array) -> None:
    """Turn points, with their velocities and accelerations but for that towards the pivot."""
    numbers, turned = values.view(complex), out.view(complex)
    width = turned.shape[1] // 3
    by, inwards, points = numbers[:, :1], numbers[:, 1:2], numbers[:, 2:]
    points[:, 2 * width :] += inwards * points[:, :width]
    np.multiply(np.exp(by), points, turned)
