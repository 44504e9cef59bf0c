"""Motions of loads that swing on links (`flatrig.models.rig.swings`): directions and hinge angles.

A motion is one array whose first axis is the order of the derivative: position, velocity and,
where needed, acceleration.  NumPy only.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from ..rig.body import Body
from ..rig.rig import Platform, Rig, Vector
from ..rig.swings import Swing
from ..rig.turning_axes import turn_about
from ..types import Array

AXES: tuple[Vector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def way(rig: Rig, body: Body, motion: Mapping[str, Array], like: Array) -> Array:
    """From the point that a load swings about to the load, in its frame's axes, (orders, N, 3).

    `motion` has the joints' motion, (orders, N), and `like` their leading shape.
    """
    assert body.swing is not None
    vector = np.zeros((*like.shape[:-1], 3))
    vector[0] = body.swing.reach
    for name, axis in hinges_above(rig, body):
        vector = turn_about(axis, vector, motion[name])
    return vector


def hinges_above(rig: Rig, body: Body) -> list[tuple[str, Vector]]:
    """Joints by which a body and those that carry it turn, with axes, from the body's own on."""
    return [hinge for above in _upwards(body) for hinge in reversed(_turns(rig, above))]


def swing_angles(
    rig: Rig, body: Body, vector: Array, motion: Mapping[str, Array]
) -> dict[str, Array]:
    """Angles of a load's hinges, (orders, N) each, from its `way` (orders, N, 3).

    `motion` has that of the joints above.
    """
    swing = body.swing
    assert swing is not None
    for above in reversed(list(_upwards(body))[1:]):
        vector = _turned_in(rig, above, vector, motion)
    down = vector @ np.array(swing.rest)
    if len(swing.axes) == 1:
        (axis,) = swing.axes
        aside = vector @ np.cross(axis, swing.rest)
        return {swing.joints[0]: _angle(aside, down)}
    across = np.array(swing.axes[0])
    aside = vector @ np.cross(across, swing.rest)
    return {
        swing.joints[0]: _angle(aside, down),
        swing.joints[1]: _angle(vector @ across, _hypot(aside, down)),
    }


def turned_out(rig: Rig, body: Body, vector: Array, motion: Mapping[str, Array]) -> Array:
    """What a body's own axes have as this motion, (orders, N, 3), in the axes it turns against."""
    for name, axis in reversed(_turns(rig, body)):
        vector = turn_about(axis, vector, motion[name])
    return vector


def _turned_in(rig: Rig, body: Body, vector: Array, motion: Mapping[str, Array]) -> Array:
    """The inverse of `turned_out`."""
    for name, axis in _turns(rig, body):
        vector = turn_about(axis, vector, -motion[name])
    return vector


def _turns(rig: Rig, body: Body) -> list[tuple[str, Vector]]:
    """Hinges by which a body turns against the one below it, unless it is a frame, with axes."""
    if isinstance(body.part, Platform):
        axes = AXES if rig.dimensions == 3 else AXES[1:2]
        return list(zip(rig.angles_of(body.part), axes, strict=True))
    swing: Swing | None = body.swing
    return [] if swing is None else list(zip(swing.joints, swing.axes, strict=True))


def _upwards(body: Body) -> Iterator[Body]:
    """A body and those that carry it."""
    above: Body | None = body
    while above is not None:
        yield above
        above = above.parent


def _angle(y: Array, x: Array) -> Array:
    """Motion of the angle of a point in a plane, (orders, N)."""
    square = x[0] ** 2 + y[0] ** 2
    across = x[0] * y[1] - y[0] * x[1]
    angle = [np.arctan2(y[0], x[0]), across / square]
    if len(x) > 2:
        growth = 2.0 * (x[0] * x[1] + y[0] * y[1])
        angle.append((x[0] * y[2] - y[0] * x[2]) / square - across * growth / square**2)
    return np.stack(angle)


def _hypot(y: Array, x: Array) -> Array:
    """Motion of the distance of a point in a plane, (orders, N)."""
    size = np.hypot(x[0], y[0])
    rate = (x[0] * x[1] + y[0] * y[1]) / size
    distance = [size, rate]
    if len(x) > 2:
        bent = x[1] ** 2 + y[1] ** 2 - rate**2
        distance.append((x[0] * x[2] + y[0] * y[2] + bent) / size)
    return np.stack(distance)
