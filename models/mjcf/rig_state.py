"""Between a rig's coordinates and its MuJoCo model's joints, for any number of samples at once.

The model's joints count from the body above on the chain, in the turning axes of the frame below
which it hangs (see `flatrig.models.rig.chain`); a rig's coordinates count from the world.

Arrays may have any leading shape, written N below; columns are joints, drives or ropes.  Inside,
a motion is one array whose first axis is the order of the derivative: position, velocity and,
where needed, acceleration.  NumPy only.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ModelError
from ..friction import Friction
from ..rig.body import Body
from ..rig.chain import chain_of, joint_names
from ..rig.coordinate_values import gather
from ..rig.lengths import rope_lengths
from ..rig.rig import WORLD, Anchor, Frame, Platform, Rig, Trolley
from ..rig.turning_axes import carry
from ..types import Array
from ..values import reals
from .joint_motion import (
    fixed,
    free_base,
    joint_motion,
    on_rail,
    outwards_together,
    pivot_place,
    shift_of,
)
from .link_tensions import link_tensions
from .ropes import reach, stretches
from .swinging import turned_out, way


class HasState(Protocol):
    """Whatever has `qpos` and `qvel`: a `State`, mujoco.MjData, mujoco.batch.Batch."""

    @property
    def qpos(self) -> Any:
        """Joint positions, shape (N, nq)."""

    @property
    def qvel(self) -> Any:
        """Joint velocities, shape (N, nv)."""


class State(NamedTuple):
    """Joint positions (N, nq) and velocities (N, nv) of a model [m, rad, m/s, rad/s]."""

    qpos: Array
    qvel: Array


def joint_state(
    rig: Rig,
    model: Any,
    coordinates: Mapping[str, ArrayLike],
    rates: Mapping[str, ArrayLike] | None = None,
    tensions: ArrayLike = 0.0,
) -> State:
    """Joint positions and velocities of the model where the rig's coordinates have these values.

    Parameters
    ----------
    rig
        The description.
    model
        Its MuJoCo model.
    coordinates
        Positions [m, rad] of all frames, trolleys, loads and platforms by coordinate name
        ("bridge.angle", "trolley.position", "load.x"), each of shape (N,) or a number; those of
        ropes, of their spans, and of trolleys in the world ("trolley.x") follow and are ignored.
    rates
        Their rates [m/s, rad/s]; a coordinate without one is at rest.
    tensions
        Tensions that stretch the ropes which can stretch, (N, ropes), those of links after them or
        not, or one number [N].

    Raises
    ------
    ModelError
        A coordinate is missing, unknown or not finite, shapes do not match, or the
        model is of another rig.
    """
    _same(rig, model)
    qpos, qvel = joint_motion(rig, gather(rig, coordinates, rates or {}))
    if model.nq == qpos.shape[-1]:
        return State(qpos, qvel)
    ways = rope_lengths(rig, points(rig, qpos, qvel))
    paid, speeds = np.stack([ways[rope.name] for rope in rig.ropes], axis=-1)
    paid = np.broadcast_to(paid - stretches(rig, model, tensions), paid.shape)
    return State(np.concatenate([qpos, paid], -1), np.concatenate([qvel, speeds], -1))


def points(
    rig: Rig, qpos: ArrayLike, qvel: ArrayLike, qacc: ArrayLike | None = None
) -> dict[str, Array]:
    """Motion of every anchor, trolley, load and platform in the world, each (orders, N, 3).

    Orders are position [m], velocity [m/s] and, if `qacc` is given, acceleration [m/s2].
    `qpos`, `qvel`, `qacc` have the shape (N, nq).
    """
    orders = [qpos, qvel] if qacc is None else [qpos, qvel, qacc]
    joints = np.stack([reals("a joint's motion", value) for value in orders])
    motion = {name: joints[..., column] for column, name in enumerate(joint_names(rig))}
    place: dict[str, Array] = {}
    parts: list[tuple[Frame | None, str, Array]] = []
    for frame in (None, *rig.frames):
        here = [a for a in rig.anchors if a.frame == (frame.name if frame else WORLD)]
        if here:
            shift = shift_of(rig, frame, motion, joints)
            parts += [(frame, a.name, shift + fixed(a.position, joints)) for a in here]
    for link in chain_of(rig):
        part = link.part
        if isinstance(part, Frame):
            continue
        if isinstance(part, Trolley):
            terms = link.sums or ((part.coordinate, 1.0),)
            total = sum(factor * motion[name] for name, factor in terms)
            own = on_rail(rig, part, {**motion, part.coordinate: np.asarray(total)})
        elif link.swing is not None:
            own = pivot_place(rig, link, motion, place) + way(rig, link, motion, joints)
        else:
            own = np.array(
                np.broadcast_to(free_base(rig, link, motion, place), (*joints.shape[:-1], 3))
            )
            for axis in rig.axes:
                own[..., "xyz".index(axis)] += motion[f"{part.name}.{axis}"]
        place[part.name] = own
        parts.append((link.frame, part.name, own))
    world = outwards_together(rig, parts, motion)
    for link in chain_of(rig):
        for corner in rig.anchors if isinstance(link.part, Platform) else ():
            if corner.frame == link.part.name:
                world[corner.name] = world[link.part.name] + _out(rig, link, corner, motion)
    return world


def _out(rig: Rig, link: Body, corner: Anchor, motion: Mapping[str, Array]) -> Array:
    """From a platform's centre to a corner, (orders, N, 3)."""
    assert isinstance(link.part, Platform)
    angles = [motion[name] for name in rig.angles_of(link.part)]
    if len(angles) == 3:
        return carry(corner.position, (angles[0], angles[1], angles[2]))
    return turned_out(rig, link, fixed(corner.position, angles[0][..., None]), motion)


def coordinates(rig: Rig, model: Any, state: HasState) -> tuple[dict[str, Array], dict[str, Array]]:
    """Values and rates of all the rig's coordinates, each (N,), by `rig.coordinate_names`.

    Parameters
    ----------
    rig
        The description.
    model
        Its MuJoCo model.
    state
        Anything with `qpos` (N, nq) and `qvel` (N, nv): a `State`, mujoco.MjData,
        mujoco.batch.Batch.

    Raises
    ------
    ModelError
        The model is of another rig.
    """
    _same(rig, model)
    motion = points(rig, state.qpos, state.qvel)
    joints = np.stack([np.asarray(state.qpos), np.asarray(state.qvel)])
    column = {name: joints[..., index] for index, name in enumerate(joint_names(rig))}
    motions: dict[str, Array] = {frame.coordinate: column[frame.coordinate] for frame in rig.frames}
    for link in chain_of(rig):
        if isinstance(link.part, Trolley):
            terms = link.sums or ((link.part.coordinate, 1.0),)
            motions[link.part.coordinate] = np.asarray(sum(f * column[name] for name, f in terms))
    for rope, length in rope_lengths(rig, motion).items():
        motions[f"{rope}.length"] = length
    for part in rig.hanging:
        for axis in rig.axes:
            motions[f"{part.name}.{axis}"] = motion[part.name][..., "xyz".index(axis)]
    for platform in rig.platforms:
        motions |= {name: column[name] for name in rig.angles_of(platform)}
    values = {name: motions[name][0].copy() for name in rig.coordinate_names}
    return values, {name: motions[name][1].copy() for name in rig.coordinate_names}


def paid_out(
    rig: Rig, qpos: ArrayLike, qvel: ArrayLike, qacc: ArrayLike | None = None
) -> dict[str, Array]:
    """Rope that each winch has paid out, with its derivatives, each (orders, N) [m].

    A rigid rope's is the length of its way; arguments as of `points`.

    Raises
    ------
    ModelError
        A spool has paid out more than it holds, and the model is no longer true.
    """
    orders = [qpos, qvel] if qacc is None else [qpos, qvel, qacc]
    joints = np.stack([reals("a joint's motion", value) for value in orders])
    first = len(joint_names(rig))
    if joints.shape[-1] == first:
        return rope_lengths(rig, points(rig, qpos, qvel, qacc))
    lengths = {rope.name: joints[..., first + i] for i, rope in enumerate(rig.ropes)}
    for rope in rig.ropes:
        most = lengths[rope.name][0].max(initial=0.0)
        if most >= reach(rig, rope):
            raise ModelError(
                f"rope {rope.name}: {most:.4g} m are paid out, its spool holds "
                f"{reach(rig, rope):.4g} m; hold the winch, or make the rope longer at home"
            )
    return lengths


def tensions(
    rig: Rig,
    qpos: ArrayLike,
    qvel: ArrayLike,
    qacc: ArrayLike,
    ctrl: ArrayLike,
    friction: ArrayLike | None = None,
) -> Array:
    """Tension of each rope where it leaves its winch, then of each link, (N, ropes + links) [N].

    T = (J/r^2) w'' - u/r - F with the length w that is paid out (of a rigid rope: its length), the
    winch's torque u and the force F of friction along w (as MuJoCo has it: negative while the winch
    pays out).  True of rigid, elastic and slack ropes alike.  Links follow from the balance of what
    they hold, `flatrig.models.mjcf.link_tensions`.

    Parameters
    ----------
    rig
        The description.
    qpos, qvel, qacc
        Joint positions, velocities and accelerations, (N, nv).
    ctrl
        Inputs, (N, drives), in the order of `rig.drives`.
    friction
        Forces of friction, (N, ropes) or a number [N].  By default the described friction at these
        speeds; a winch that sticks may bear anything up to its Coulomb friction.
    """
    lengths = paid_out(rig, qpos, qvel, qacc)
    inputs = reals("ctrl", ctrl)
    columns = {drive.on: (index, rig.arm(drive)) for index, drive in enumerate(rig.drives)}
    pulls = []
    for rope in rig.ropes:
        pull = rope.inertia_along * lengths[rope.name][2]
        if rope.name in columns:
            column, arm = columns[rope.name]
            pull = pull - inputs[..., column] / arm
        if friction is None and rope.friction != Friction():
            pull = pull + rope.friction.sliding(lengths[rope.name][1])
        pulls.append(pull)
    none = np.zeros((*inputs.shape[:-1], 0))
    along: Array = np.stack(pulls, axis=-1) if pulls else none
    if friction is not None and pulls:
        along = along - reals("friction", friction)
    if not rig.links:
        return along
    joints = np.stack([reals("a joint's motion", value) for value in (qpos, qvel, qacc)])
    motion = {name: joints[..., column] for column, name in enumerate(joint_names(rig))}
    held = link_tensions(rig, motion, points(rig, qpos, qvel, qacc), along, inputs)
    return np.concatenate((along, held), axis=-1)


def _same(rig: Rig, model: Any) -> None:
    if model.nq not in (len(joint_names(rig)), len(joint_names(rig)) + len(rig.ropes)):
        raise ModelError(
            f"the model has {model.nq} joints, rig {rig.name} has {len(joint_names(rig))}; "
            "use the model compiled from this rig"
        )
