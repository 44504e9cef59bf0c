"""What an environment reads off the joints of a rig's model at every step, as one affine map.

Seen from the frame that carries a rope, the points it runs through, the places of trolleys on
their rails and, unless frames tilt, the heights of loads are affine in the joints of
`flatrig.models.rig.chain`, and the corners of a platform in these and the nine entries of its
rotation matrix, and a load on a link in these and the link as a vector.  So one product with a
small matrix gives the spans of all ropes, their rates and accelerations, and how far everything is
from where it must not go.

The product is taken simulation by simulation: BLAS sums in another order when it is given another
number of rows, and what an environment says must not depend on how many run beside it.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...models.errors import OptionError
from ...models.mjcf.rig_state import State, coordinates, points
from ...models.mjcf.swinging import way
from ...models.rig.body import Body
from ...models.rig.chain import chain_of, joint_names, weighed
from ...models.rig.lengths import spans
from ...models.rig.rig import Anchor, Rig
from ...models.rig.turning_axes import carry
from ...models.types import Array
from .payloads import hung

REACH = 25.0
"""How far a joint may go from home: so many times `Scales.length`, or times 1 m if that is longer;
a turning frame as many radians."""

RAIL_MARGIN = 0.01
"""How far a trolley may stand beyond the ends of its rail [m]: moves may lead to the very end, and
no controller follows them without an error."""

UPRIGHT = 0.25
"""Cosine of how far a platform may lean, 76 degrees: near 90 its Bryant angles fail."""

OFF_RAIL, OUT_OF_REACH, TIPPED = "off the rail", "out of reach", "platform tipped over"
"""Reasons for which an episode ends, beside "load above trolley" and the like."""


@dataclass(frozen=True)
class Scales:
    """Lengths, times and forces typical of a rig, which make observations of order one."""

    length: float
    """How far loads and platforms hang below what they hang from, at home, the largest [m]."""
    time: float
    """Time in which a pendulum of that length swings one radian of its phase [s]."""
    weight: float
    """Weight of all loads and platforms [N]."""

    @classmethod
    def of(cls, rig: Rig, heights: dict[str, float]) -> "Scales":
        """From the rig and the home heights of its points [m]."""
        drops = [heights[above] - heights[load] for load, above in hangers(rig).items()]
        length = max(drops, default=0.0)
        if not length > 0:
            raise OptionError(f"rig {rig.name}: no load hangs below what its rope comes from")
        return cls(length, math.sqrt(length / rig.gravity), rig.weight)


@dataclass(frozen=True, eq=False)
class Geometry:
    """The affine map from joints to clearances and spans.

    Its rows act on q numbers: the joints, the rotation matrix of each platform row by row, the way
    from the point that it swings about to each load on a link, and a constant 1.
    """

    clearances: Array
    """Rows (clearances, q)."""
    reasons: tuple[str, ...]
    """For each clearance, why an episode ends when it is not > 0."""
    spans: Array
    """Rows (spans, 3, q): x, y and z of every span of all ropes."""
    rope_of_span: tuple[int, ...]
    """Index of the rope that each span belongs to."""
    affine: bool
    """Whether the spans hold; not so for a rope between a frame that turns and what carries it."""
    hung: tuple[tuple[str, str], ...]
    """Points (above, load) of the first clearances, if these are not affine: where frames tilt."""
    scales: Scales


def hangers(rig: Rig) -> dict[str, str]:
    """For each load or corner at the end of a rope, free pulleys excepted, what it hangs from.

    Then for each that hangs on a link, from the top down.
    """
    ends = {load.name for load in rig.loads} - rig.pulleys
    ends |= {anchor.name for anchor in rig.anchors if rig.platform(anchor.frame) is not None}
    found = {rope.path[-1]: rope.path[-2] for rope in rig.ropes if rope.path[-1] in ends}
    for low, high in hung(rig):
        if low not in found and (low in ends or high in ends):
            found[low] = high
    return found


def angle_joints(rig: Rig) -> list[slice]:
    """For each platform, the joints that are its angles, one after the other."""
    angles = [rig.angles_of(platform) for platform in rig.platforms]
    first = [joint_names(rig).index(own[0]) for own in angles]
    return [slice(joint, joint + len(own)) for joint, own in zip(first, angles, strict=True)]


def swing_bodies(rig: Rig) -> list[Body]:
    """The bodies of loads that swing on links."""
    return [body for body in chain_of(rig) if body.swing is not None]


def geometry_of(rig: Rig, model: object, home: Array) -> Geometry:
    """Probe the affine map at unit values; `home` is qpos of the rig's home, shape (nq,)."""
    size = len(home)
    platforms = angle_joints(rig)
    swings = swing_bodies(rig)
    columns = size + 9 * len(platforms) + 3 * len(swings)
    probes = np.vstack((np.zeros(size), np.eye(columns, size)))
    probes[:, _turning(rig)] = 0.0  # the frame's own axes: its angle does not matter
    for own in platforms:
        probes[:, own] = 0.0
    for body in swings:
        probes[:, [joint_names(rig).index(name) for name in body.joints]] = 0.0
    rest = np.zeros_like(probes)
    places = {name: motion[0] for name, motion in points(rig, probes, rest).items()}
    places |= _corners(rig, places, size)
    places |= _swung(rig, swings, places, size + 9 * len(platforms))
    along = coordinates(rig, model, State(probes, rest))[0]
    heights = {
        name: float(motion[0, 0, 2])
        for name, motion in points(rig, home[None], np.zeros((1, size))).items()
    }
    scales = Scales.of(rig, heights)

    owners = [index for index, rope in enumerate(rig.ropes) for _ in rope.path[1:]]
    ends = [pair for rope in rig.ropes for pair in pairwise(rope.path)]
    vectors = _affine(np.array([places[far] - places[near] for near, far in ends]))

    values: list[Array] = []
    reasons: list[str] = []
    for load, above in hangers(rig).items():
        values.append((places[above] - places[load])[:, 2])
        reasons.append(f"{_kind(rig, load)} above {_kind(rig, above)}")
    for trolley in rig.trolleys:
        rail, place = rig.rail(trolley.rail), along[trolley.coordinate]
        sides = [side for side in (place - rail.start, rail.end - place) if np.isfinite(side).all()]
        values += [side + RAIL_MARGIN for side in sides]
        reasons += [OFF_RAIL] * len(sides)
    reach = REACH * max(scales.length, 1.0)
    for departure in np.vstack((-home, np.eye(columns, size) - home)).T:
        values += [reach + departure, reach - departure]
        reasons += [OUT_OF_REACH] * 2
    for index in range(len(platforms)):
        values.append(np.eye(1, columns + 1, size + 9 * index + 9)[0] - UPRIGHT)
        reasons.append(TIPPED)
    clearances = _affine(np.array(values)[..., None])[:, 0]
    affine = not weighed(rig) and _holds(rig, vectors, owners, size)
    tilts = any(frame.kind == "turning" and abs(frame.axis[2]) != 1.0 for frame in rig.frames)
    hung = tuple((above, load) for load, above in hangers(rig).items()) if tilts else ()
    return Geometry(clearances, tuple(reasons), vectors, tuple(owners), affine, hung, scales)


def turned(motion: Array) -> Array:
    """Rotation matrices (N, orders, 9), row by row, from Bryant angles (N, orders, 3).

    In a plane from beta alone, (N, orders, 1).
    """
    if motion.shape[-1] == 1:
        none = np.zeros_like(motion)
        motion = np.concatenate((none, motion, none), axis=-1)
    angles = np.repeat(motion.swapaxes(0, 1)[..., None], 3, axis=-1)
    alpha, beta, gamma = (angles[:, :, index] for index in range(3))
    columns = carry(np.eye(3), (alpha, beta, gamma))  # type: ignore[arg-type]
    return columns.transpose(1, 0, 3, 2).reshape(*motion.shape[:2], 9)


def _corners(rig: Rig, places: dict[str, Array], size: int) -> dict[str, Array]:
    """Corners of platforms at the probes: where their centres are, and what the rotation adds."""
    corners = {}
    for index, platform in enumerate(rig.platforms):
        first = 1 + size + 9 * index
        for anchor in rig.anchors:
            if anchor.frame == platform.name:
                place = places[platform.name].copy()
                for row in range(3):
                    place[first + 3 * row : first + 3 * row + 3, row] += anchor.position
                corners[anchor.name] = place
    return corners


def _swung(rig: Rig, swings: list[Body], places: dict[str, Array], size: int) -> dict[str, Array]:
    """Loads on links at the probes: where they swing about, and what their `way` adds."""
    found = dict(places)
    for index, body in enumerate(swings):
        assert body.swing is not None
        place = found[body.swing.upper].copy()
        first = 1 + size + 3 * index
        place[first : first + 3] += np.eye(3)
        found[body.name] = place
    return {body.name: found[body.name] for body in swings}


def _kind(rig: Rig, point: str) -> str:
    """What a rope's end or the point before it is called."""
    if point in rig.pulleys and point in {load.name for load in rig.loads}:
        return "pulley"
    part = next(part for part in (*rig.masses, *rig.anchors) if part.name == point)
    if isinstance(part, Anchor) and rig.platform(part.frame) is not None:
        return "corner"
    return type(part).__name__.lower()


def _affine(probed: Array) -> Array:
    """Rows (quantities, components, nq + 1) from values (quantities, 1 + nq, components)."""
    constant = probed[:, :1]
    rows = np.concatenate((probed[:, 1:] - constant, constant), axis=1)
    return rows.swapaxes(1, 2)


def _turning(rig: Rig) -> list[int]:
    """Joints that are the angles of turning frames."""
    turning = [frame.coordinate for frame in rig.frames if frame.kind == "turning"]
    return [index for index, name in enumerate(joint_names(rig)) if name in turning]


def _holds(rig: Rig, vectors: Array, owners: list[int], size: int) -> bool:
    """Whether the spans have the right lengths at so many random joints too."""
    joints = np.random.default_rng(0).normal(size=(8, size))
    still = np.stack((joints, np.zeros_like(joints)), axis=1)
    parts = [turned(still[..., own])[:, 0] for own in angle_joints(rig)]
    motion = {name: still[..., i].swapaxes(0, 1) for i, name in enumerate(joint_names(rig))}
    like = still.swapaxes(0, 1)
    parts += [way(rig, body, motion, like)[0] for body in swing_bodies(rig)]
    ones = np.hstack((joints, *parts, np.ones((8, 1))))
    mine = np.linalg.norm(vectors @ ones.T, axis=1).T
    truth = spans(rig, points(rig, joints, np.zeros_like(joints)))
    none = [np.zeros((8, 0))]
    stacked = np.concatenate([*none, *(truth[rope.name][0] for rope in rig.ropes)], axis=-1)
    # Rounding leaves 1e-14; a span that is not affine is off by a share of its length.
    return bool(np.allclose(mine, stacked, 1e-9, 1e-9))
