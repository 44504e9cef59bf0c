"""From the motion of a rig's coordinates to that of its MuJoCo model's joints.

A motion is one array whose first axis is the order of the derivative: position, velocity and,
where needed, acceleration.  NumPy only.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from ..rig.body import Body
from ..rig.chain import chain_of, joint_names
from ..rig.frames import carriers
from ..rig.rig import WORLD, Frame, Platform, Rig, Trolley, Vector
from ..rig.turning_axes import turn_about
from ..types import Array
from .swinging import swing_angles, turned_out


def joint_motion(rig: Rig, motion: Mapping[str, Array]) -> Array:
    """Motion of the joints (orders, N, nv) from that of all coordinates but ropes', (orders, N)."""
    columns: dict[str, Array] = {}
    place: dict[str, Array] = {}
    for link in chain_of(rig):
        part = link.part
        if isinstance(part, Frame):
            columns[part.coordinate] = motion[part.coordinate]
        elif isinstance(part, Trolley):
            upper = sum(factor * columns[name] for name, factor in link.sums[:-1])
            columns[part.coordinate] = motion[part.coordinate] - upper
            place[part.name] = on_rail(rig, part, motion)
        else:
            world = np.zeros((*motion[f"{part.name}.x"].shape, 3))
            for axis in rig.axes:
                world[..., "xyz".index(axis)] = motion[f"{part.name}.{axis}"]
            place[part.name] = inwards(rig, link.frame, motion, world)
            if link.swing is not None:
                vector = place[part.name] - pivot_place(rig, link, motion, place)
                columns |= swing_angles(rig, link, vector, columns)
                continue
            relative = place[part.name] - free_base(rig, link, motion, place)
            for axis in rig.axes:
                columns[f"{part.name}.{axis}"] = relative[..., "xyz".index(axis)]
            if isinstance(part, Platform):
                columns |= {name: motion[name] for name in rig.angles_of(part)}
    return np.stack([columns[name] for name in joint_names(rig)], axis=-1)


def on_rail(rig: Rig, trolley: Trolley, motion: Mapping[str, Array]) -> Array:
    """Motion of a trolley in its frame's axes, (orders, N, 3)."""
    rail = rig.rail(trolley.rail)
    along = np.multiply.outer(motion[trolley.coordinate], np.asarray(rail.direction))
    shift = shift_of(rig, rig.frame(rail.frame), motion, along)
    return np.asarray(along + shift + fixed(rail.origin, along))


def free_base(
    rig: Rig, link: Body, motion: Mapping[str, Array], place: Mapping[str, Array]
) -> Array:
    """Motion of what a free mass counts from, in its frame's axes, (orders, N, 3)."""
    above = link.parent
    if above is not None and not isinstance(above.part, Frame):
        return place[above.name]
    return shift_of(rig, link.frame, motion, next(iter(motion.values()))[..., None])


def pivot_place(
    rig: Rig, link: Body, motion: Mapping[str, Array], place: Mapping[str, Array]
) -> Array:
    """Motion of the point that a load swings about, in its frame's axes, (orders, N, 3)."""
    swing = link.swing
    assert swing is not None
    if swing.upper in place:
        return place[swing.upper]
    above = link.parent
    own = fixed(swing.pivot, next(iter(motion.values()))[..., None])
    if above is None or isinstance(above.part, Frame):
        return own + shift_of(rig, link.frame, motion, own)
    return place[above.name] + turned_out(rig, above, own, motion)


def shift_of(rig: Rig, frame: Frame | None, motion: Mapping[str, Array], like: Array) -> Array:
    """Motion of a frame's origin in its axes, (orders, N, 3), or (orders, 1, N, 3) `like` many.

    It counts from the origin of the next frame below that turns, or from the world's, as all that a
    sliding frame carries does: zero for the frame that turns.
    """
    if frame is None or frame.kind != "sliding":
        return np.zeros((*like.shape[:-1], 3))
    slid = np.multiply.outer(motion[frame.coordinate], np.asarray(frame.axis))
    slid = slid.reshape(len(slid), *(1,) * (like.ndim - slid.ndim), *slid.shape[1:])
    return np.asarray(slid + _foot(rig, frame, motion, like))


def _foot(rig: Rig, frame: Frame, motion: Mapping[str, Array], like: Array) -> Array:
    """Where a frame stands on its parent, seen as `shift_of` sees the parent."""
    return fixed(frame.origin, like) + shift_of(rig, rig.frame(frame.parent), motion, like)


def outwards(rig: Rig, frame: Frame | None, motion: Mapping[str, Array], own: Array) -> Array:
    """Motion in the world of what moves so in a frame's axes, (orders, N, 3)."""
    for turning in _turning(rig, frame):
        own = turn_about(turning.axis, own, motion[turning.coordinate])
        own = own + _foot(rig, turning, motion, own)
    return own


def outwards_together(
    rig: Rig, parts: Sequence[tuple[Frame | None, str, Array]], motion: Mapping[str, Array]
) -> dict[str, Array]:
    """`outwards` of many points by name, each with its frame: all on a frame are turned at once."""
    held: dict[str, list[tuple[str, Array]]] = {}
    for frame, name, own in parts:
        held.setdefault(_first_turning(rig, frame), []).append((name, own))
    for turning in reversed(rig.frames):  # each follows what carries it
        on = held.pop(turning.name, [])
        if on:
            own = np.stack([motion for _, motion in on], axis=1)
            own = turn_about(turning.axis, own, motion[turning.coordinate])
            own = own + _foot(rig, turning, motion, own)
            below = held.setdefault(_first_turning(rig, rig.frame(turning.parent)), [])
            below += [(name, own[:, k]) for k, (name, _) in enumerate(on)]
    return dict(held.get(WORLD, ()))


def _first_turning(rig: Rig, frame: Frame | None) -> str:
    """The frame in whose axes a frame sees what it carries, or the world."""
    return next((part.name for part in _turning(rig, frame)), WORLD)


def inwards(rig: Rig, frame: Frame | None, motion: Mapping[str, Array], world: Array) -> Array:
    """Motion in a frame's axes of what moves so in the world: the inverse of `outwards`."""
    own = world
    for turning in reversed(_turning(rig, frame)):
        own = own - _foot(rig, turning, motion, own)
        own = turn_about(turning.axis, own, -motion[turning.coordinate])
    return own


def _turning(rig: Rig, frame: Frame | None) -> list[Frame]:
    """Frames that turn what a frame carries, outwards."""
    return [part for part in carriers(rig.frames, frame) if part.kind == "turning"]


def fixed(vector: Vector, like: Array) -> Array:
    """A vector that does not move, (orders, N, 3)."""
    constant = np.zeros((*like.shape[:-1], 3))
    constant[0] = vector
    return constant
