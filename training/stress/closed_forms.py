"""What can be followed, by closed forms: judges of what is refused.

    can_follow(rig, reference)      # True where the path certainly can be followed
    order_needed(rig)               # continuous derivatives that its inputs take

A rope's direction is that of its load's acceleration less gravity, which leads from the load's path
to the trolley or pulley above it.  Between fixed winches the load's place says everything, as long
as the directions of the ropes stay apart.  False where a rig has no closed form, or where the path
comes so near to what cannot be done that it is left open.
"""

import math
from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from ...feedforward import Reference
from ...models import Rig
from ...models.rig.rope_ends import rope_ends
from ...models.types import Array

FINE = 2001
"""Samples by which a path is judged."""
NEAR = 1e-3
"""What is left open: this share of gravity, of the path's size, and of the largest determinant."""

ORDERS = {"rope_robot": 2, "six_rope_platform": 2, "tandem_crane": 2, "redundant_robot": 2}
"""Continuous derivatives for rigs whose outputs are all their coordinates."""


def order_needed(rig: Rig) -> int:
    """Continuous derivatives of the path that the inputs take.

    Two for the accelerations; two more if a place follows from an acceleration; two more again if
    a turning boom follows from the acceleration of a pulley that does, which has mass, and two for
    each link below a hook.
    """
    if rig.name == "hook_crane":
        return 4 + 2 * len(rig.links)
    heavy = rig.name == "pulley_crane" and rig.loads[0].mass > 0
    turning = any(frame.kind == "turning" for frame in rig.frames)
    return 6 if heavy and turning else ORDERS.get(rig.name, 4)


def can_follow(rig: Rig, reference: Reference) -> bool:
    """Whether a path certainly can be followed from its start on, on the branch of the home."""
    if any(load.drag for load in rig.loads) or rope_ends(rig):  # which no closed form knows
        return False
    judge = JUDGES.get(rig.name)
    return judge is not None and judge(rig, reference)


def _path(reference: Reference) -> tuple[Array, Array]:
    """Outputs and their second derivatives, (N, outputs) each."""
    taken = reference.derivatives(np.linspace(0.0, reference.duration, FINE), 2)
    return taken[0], taken[2]


def below(rig: Rig, reference: Reference) -> bool:
    """A load below a trolley or jib: its rope meets the plane in which that moves, on the rail."""
    path, second = _path(reference)
    axes = ["xyz".index(axis) for axis in rig.axes]
    place, force = np.zeros((2, FINE, 3))
    place[:, axes], force[:, axes] = path[:, : len(axes)], second[:, : len(axes)]
    force[:, 2] += rig.gravity
    frame = rig.frames[0] if rig.frames else None
    rail = rig.rails[0] if rig.rails else None
    along = np.array(rail.direction if rail is not None else rig.frames[0].axis)
    turning = frame is not None and frame.kind == "turning"
    if turning and along[2]:
        return False
    origin = np.array(rail.origin if rail is not None else rig.anchors[0].position)
    start, end = (rail.start, rail.end) if rail is not None else (-math.inf, math.inf)
    across = np.array((0.0, 1.0, 0.0))
    if rig.name == "deck_crane":
        origin = origin + np.multiply.outer(path[:, 2], np.array(rig.frames[0].axis))
    elif rig.dimensions == 3 and frame is not None and not turning:
        across = np.array(frame.axis)
    normal = np.cross(along, across)
    normal *= math.copysign(1.0, normal[2]) / np.linalg.norm(normal)
    lift, depth = force @ normal, (origin - place) @ normal
    size = np.ptp(path, axis=0).max() + np.abs(path).max()
    if lift.min() <= NEAR * rig.gravity or depth.min() <= NEAR * size:
        return False
    foot = place + (depth / lift)[:, None] * force - origin
    if turning:
        reach = np.linalg.norm(foot[:, :2], axis=1)
        start = max(start, 0.0)
    else:
        basis = np.stack([along, across], axis=1)
        reach = np.linalg.lstsq(basis, foot.T, rcond=None)[0][0]
    return bool(reach.min() > start + NEAR * size and reach.max() < end - NEAR * size)


def between(rig: Rig, reference: Reference) -> bool:
    """A load or platform between fixed winches, all of whose coordinates are prescribed."""
    path, _ = _path(reference)
    home = np.array([rig.home_coordinates[name] for name in rig.outputs])
    way = np.linspace(home, path[0], 65)
    return _apart(np.concatenate([_wrenches(rig, way), _wrenches(rig, path)]))


def _wrenches(rig: Rig, path: Array) -> Array:
    """Directions of the ropes, and their moments over the size of the platform, (N, k, ropes)."""
    axes = ["xyz".index(axis) for axis in rig.axes]
    place = np.zeros((len(path), 3))
    place[:, axes] = path[:, : len(axes)]
    anchors = {anchor.name: anchor for anchor in rig.anchors}
    turns = Rotation.from_euler("XYZ", path[:, 3:]) if rig.platforms else None
    columns = []
    for rope in rig.ropes:
        arm = np.zeros_like(place)
        if turns is not None:
            arm = turns.apply(anchors[rope.path[-1]].position)
        span = np.array(anchors[rope.path[0]].position) - place - arm
        unit = span / np.linalg.norm(span, axis=1, keepdims=True)
        side = np.linalg.norm(arm, axis=1, keepdims=True)
        parts = [unit[:, axes]]
        if turns is not None:
            parts.append(np.cross(arm / side, unit))
        columns.append(np.concatenate(parts, axis=1))
    return np.stack(columns, axis=-1)


def _apart(matrices: Array) -> bool:
    """Whether determinants (N, k, k) keep their sign and stay away from zero."""
    values = np.linalg.det(matrices)
    values = values * np.sign(values[0])
    return bool(values.min() > NEAR * values.max())


def tandem(rig: Rig, reference: Reference) -> bool:
    """A load between two trolleys in prescribed places."""
    path, _ = _path(reference)
    (_, z, middle, spread), rail = path.T, rig.rails[0]
    ends = np.concatenate([middle - 0.5 * spread, middle + 0.5 * spread])
    size = np.abs(path).max()
    near = NEAR * size
    on = ends.min() > rail.start + near and ends.max() < rail.end - near
    return bool(on and z.max() < -near and spread.min() > near)


def pulley(rig: Rig, reference: Reference) -> bool:
    """A pulley in line with the rope below it, between two ropes that stay apart (plane only)."""
    if rig.dimensions == 3:
        return False
    path, second = _path(reference)
    (x, z, level), (side, up) = path.T, second[:, :2].T
    lift, depth = up + rig.gravity, level - z
    size = np.ptp(path, axis=0).max() + np.abs(path).max()
    if lift.min() <= NEAR * rig.gravity or depth.min() <= NEAR * size:
        return False
    place = np.stack([x + depth / lift * side, np.zeros(FINE), level], axis=1)
    spans = [np.array(rig.home_point(name)) - place for name in ("low", "middle", "high")]
    lengths = [np.linalg.norm(span, axis=1) for span in spans]
    if min(length.min() for length in lengths) <= NEAR * size:
        return False
    home = np.array(rig.home["pulley"])
    first = [np.array(rig.home_point(name)) - home for name in ("low", "high")]
    units = [s / n[:, None] for s, n in zip(spans, lengths, strict=True)]
    units = [np.vstack([f / np.linalg.norm(f), u]) for f, u in zip(first, units[::2], strict=True)]
    return _apart(np.stack(units, axis=-1)[:, [0, 2]])


JUDGES: dict[str, Callable[[Rig, Reference], bool]] = {
    "trolley_crane": below,
    "roped_crane": below,
    "jib_crane": below,
    "deck_crane": below,
    "rope_robot": between,
    "six_rope_platform": between,
    "tandem_crane": tandem,
    "pulley_crane": pulley,
}
"""By the names of `random_rigs`."""
