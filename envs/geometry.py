"""What an environment reads off the joints of a rig's model at every step, as one affine map.

Seen from the frame that carries a rope, the points it runs through, the places of trolleys on
their rails and the heights of loads are affine in the joints of `flatrig.models.chain`.  So one
product with a small matrix gives the spans of all ropes, their rates and accelerations, and how
far everything is from where it must not go.

The product is taken simulation by simulation: BLAS sums in another order when it is given another
number of rows, and what an environment says must not depend on how many run beside it.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..models.chain import links, pulleys
from ..models.errors import OptionError
from ..models.rig import Frame, Load, Rig
from ..models.state import State, coordinates, points, spans

Array = NDArray[np.float64]

REACH = 25.0
"""How far a joint may go from home: so many times `Scales.length`, or times 1 m if that is longer;
a turning frame as many radians."""

RAIL_MARGIN = 0.01
"""How far a trolley may stand beyond the ends of its rail [m]: moves may lead to the very end, and
no controller follows them without an error."""

TOO_HIGH, OFF_RAIL, OUT_OF_REACH = "load above trolley", "off the rail", "out of reach"
"""Reasons for which an episode ends."""


@dataclass(frozen=True)
class Scales:
    """Lengths, times and forces typical of a rig, which make observations of order one."""

    length: float
    """How far loads hang below what they hang from, at home, the largest [m]."""
    time: float
    """Of a pendulum of that length, per radian [s]."""
    weight: float
    """Of all loads [N]."""

    @classmethod
    def of(cls, rig: Rig, heights: dict[str, float]) -> "Scales":
        """From the rig and the home heights of its points [m]."""
        drops = [heights[above] - heights[load] for load, above in hangers(rig).items()]
        length = max(drops, default=0.0)
        if not length > 0:
            raise OptionError(f"rig {rig.name}: no load hangs below what its rope comes from")
        weight = rig.gravity * sum(load.mass for load in rig.loads)
        return cls(length, math.sqrt(length / rig.gravity), weight)


@dataclass(frozen=True, eq=False)
class Geometry:
    """The affine map from joints to clearances and spans."""

    clearances: Array
    """Rows (clearances, nq + 1) that act on the joints and a constant 1 after them."""
    reasons: tuple[str, ...]
    """For each clearance, why an episode ends when it is not > 0."""
    spans: Array
    """Rows (spans, 3, nq + 1): x, y and z of every span of all ropes."""
    rope_of_span: tuple[int, ...]
    """Index of the rope that each span belongs to."""
    affine: bool
    """Whether the spans hold; not so for a rope between a turning frame and a fixed anchor."""
    scales: Scales


def hangers(rig: Rig) -> dict[str, str]:
    """For each load at the end of a rope, free pulleys excepted, the point that it hangs from."""
    loads = {load.name for load in rig.loads} - pulleys(rig)
    return {rope.path[-1]: rope.path[-2] for rope in rig.ropes if rope.path[-1] in loads}


def geometry_of(rig: Rig, model: object, home: Array) -> Geometry:
    """Probe the affine map at unit joint values; `home` is qpos of the rig's home, shape (nq,)."""
    size = len(home)
    probes = np.vstack((np.zeros(size), np.eye(size)))
    probes[:, _turning(rig)] = 0.0  # the frame's own axes: its angle does not matter
    rest = np.zeros_like(probes)
    places = {name: motion[0] for name, motion in points(rig, probes, rest).items()}
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
        reasons.append(TOO_HIGH)
    for trolley in rig.trolleys:
        rail, place = rig.rail(trolley.rail), along[trolley.coordinate]
        sides = [side for side in (place - rail.start, rail.end - place) if np.isfinite(side).all()]
        values += [side + RAIL_MARGIN for side in sides]
        reasons += [OFF_RAIL] * len(sides)
    reach = REACH * max(scales.length, 1.0)
    for departure in np.vstack((-home, np.eye(size) - home)).T:
        values += [reach + departure, reach - departure]
        reasons += [OUT_OF_REACH] * 2
    clearances = _affine(np.array(values)[..., None])[:, 0]
    affine = _holds(rig, vectors, owners)
    return Geometry(clearances, tuple(reasons), vectors, tuple(owners), affine, scales)


def _affine(probed: Array) -> Array:
    """Rows (quantities, components, nq + 1) from values (quantities, 1 + nq, components)."""
    constant = probed[:, :1]
    rows = np.concatenate((probed[:, 1:] - constant, constant), axis=1)
    return rows.swapaxes(1, 2)


def _turning(rig: Rig) -> list[int]:
    """Joints that are angles: those of turning frames, which come first on their chains."""
    joints = [(link, name) for link in links(rig) for name in link.joints]
    return [
        index
        for index, (link, _) in enumerate(joints)
        if isinstance(link.part, Frame) and link.part.kind == "turning"
    ]


def _holds(rig: Rig, vectors: Array, owners: list[int]) -> bool:
    """Whether the spans have the right lengths at random joints too."""
    joints = np.random.default_rng(0).normal(size=(8, vectors.shape[-1] - 1))
    ones = np.hstack((joints, np.ones((8, 1))))
    mine = np.linalg.norm(vectors @ ones.T, axis=1).T
    truth = spans(rig, points(rig, joints, np.zeros_like(joints)))
    stacked = np.concatenate([truth[rope.name][0] for rope in rig.ropes], axis=-1)
    return bool(np.allclose(mine, stacked, 1e-9, 1e-9))


def output_columns(rig: Rig, sites: list[str]) -> list[int]:
    """Columns of the rig's outputs in site positions (N, 3 sites).

    Raises:
        OptionError: an output is not a load's coordinate.
    """
    names = {f"{load.name}.{axis}": (load, axis) for load in rig.loads for axis in "xyz"}
    found = []
    for output in rig.outputs:
        if output not in names:
            raise OptionError(
                f"rig {rig.name}: output {output!r} is not the coordinate of a load, "
                "environments need those"
            )
        part, axis = names[output]
        assert isinstance(part, Load)
        found.append(3 * sites.index(part.name) + "xyz".index(axis))
    return found


def evenly(columns: list[int]) -> slice | None:
    """The slice that picks these columns, so that a view will do; None if there is none."""
    steps = {after - before for before, after in pairwise(columns)}
    if len(steps) > 1 or min(steps, default=1) < 1:
        return None
    step = steps.pop() if steps else 1
    return slice(columns[0], columns[-1] + 1, step)
