"""Tensions of a rig's links, from the balance of the bodies that they hold.

Every load gives three equations, a platform six, a trolley one along its rail: mass times
acceleration is its weight, what drives, ropes and the inertia of beams do, and the links' unknown
pulls.  Masses are the description's own, and nothing else may push the bodies.
"""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from ..rig.beams import beams
from ..rig.body import Body
from ..rig.chain import chain_of
from ..rig.frames import second_moments, tensor
from ..rig.lengths import spans
from ..rig.rig import Frame, Load, Platform, Rig, Rope, Trolley
from ..rig.swings import body_of
from ..types import Array
from .joint_motion import fixed, outwards
from .swinging import turned_out


def link_tensions(
    rig: Rig, motion: Mapping[str, Array], world: Mapping[str, Array], pulls: Array, ctrl: Array
) -> Array:
    """Tensions of the links [N], (..., links), by least squares of all balances.

    NaN for a link that joins frames alone: no body's balance tells.

    Parameters
    ----------
    rig
        The description.
    motion
        That of the joints by name, (3 orders, ...).
    world
        That of its points, (3 orders, ..., 3), as `rig_state.points` returns it.
    pulls
        Tensions of the ropes where they leave their winches, (..., ropes) [N].
    ctrl
        Inputs, (..., drives).
    """
    matrix, wanted = [], []
    known = _of_ropes(rig, world, pulls) + _of_beams(rig, world)
    for body in chain_of(rig):
        if isinstance(body.part, Frame):
            continue
        missing = _needed(rig, body, motion, world, ctrl)
        for point, force in known:
            if body_of(rig, point) == body.name:
                missing = missing - _effect(rig, body, motion, world, point, force)
        columns = [np.zeros(missing.shape) for _ in rig.links]
        for column, link in zip(columns, rig.links, strict=True):
            for near, far in (link.ends, link.ends[::-1]):
                if body_of(rig, near) == body.name:
                    column += _effect(rig, body, motion, world, near, _towards(world, near, far))
        matrix.append(np.stack(columns, axis=-1))
        wanted.append(missing)
    rows = np.concatenate(matrix, axis=-2)
    tensions = np.einsum("...ij,...j->...i", np.linalg.pinv(rows), np.concatenate(wanted, axis=-1))
    told = (rows != 0).any(axis=-2)
    return np.where(told, tensions, np.nan)


def _towards(world: Mapping[str, Array], near: str, far: str) -> Array:
    """Unit vector from one point to another, (..., 3)."""
    way = world[far][0] - world[near][0]
    return np.asarray(way / np.linalg.norm(way, axis=-1, keepdims=True))


def _needed(
    rig: Rig, body: Body, motion: Mapping[str, Array], world: Mapping[str, Array], ctrl: Array
) -> Array:
    """Mass times acceleration less weight, drives and friction, of each equation, (..., rows)."""
    part = body.part
    assert not isinstance(part, Frame)
    force = part.mass * (world[part.name][2] + np.array([0.0, 0.0, rig.gravity]))
    if isinstance(part, Trolley):
        along = (force * _rail(rig, part, motion)).sum(axis=-1, keepdims=True)
        for column, drive in enumerate(rig.drives):
            if drive.on == part.name:
                along = along - ctrl[..., column : column + 1] / rig.arm(drive)
        terms = body.sums or ((part.coordinate, 1.0),)
        rate = np.asarray(sum(factor * motion[name][1] for name, factor in terms))
        return np.asarray(along + part.friction.sliding(rate)[..., None])
    if isinstance(part, Load):
        force = force + part.drag * world[part.name][1]
    if not isinstance(part, Platform):
        return np.asarray(force)
    second, torque = second_moments(tensor(part.inertia)), np.zeros(force.shape)
    directors = [
        turned_out(rig, body, fixed((axis[0], axis[1], axis[2]), world[part.name]), motion)
        for axis in np.eye(3)
    ]
    for i, k in np.argwhere(second):
        torque += second[i, k] * np.cross(directors[i][0], directors[k][2])
    return np.concatenate((force, torque), axis=-1)


def _effect(
    rig: Rig,
    body: Body,
    motion: Mapping[str, Array],
    world: Mapping[str, Array],
    point: str,
    force: Array,
) -> Array:
    """What a force (..., 3) at a point of a body does in each of its equations, (..., rows)."""
    part = body.part
    if isinstance(part, Trolley):
        return np.asarray((force * _rail(rig, part, motion)).sum(axis=-1, keepdims=True))
    if not isinstance(part, Platform):
        return force
    lever = world[point][0] - world[part.name][0]
    return np.concatenate((force, np.cross(lever, force)), axis=-1)


def _rail(rig: Rig, trolley: Trolley, motion: Mapping[str, Array]) -> Array:
    """Direction of a trolley's rail in the world, (..., 3)."""
    rail = rig.rail(trolley.rail)
    like, frame = motion[trolley.coordinate][..., None], rig.frame(rail.frame)
    ends = [outwards(rig, frame, motion, fixed(v, like)) for v in (rail.direction, (0.0, 0.0, 0.0))]
    return np.asarray(ends[0][0] - ends[1][0])


def _of_ropes(rig: Rig, world: Mapping[str, Array], pulls: Array) -> list[tuple[str, Array]]:
    """Forces (..., 3) of all ropes on the points that they run through."""
    lengths, forces = spans(rig, world), []
    for column, rope in enumerate(rig.ropes):
        tensions = _along(rope, lengths[rope.name], pulls[..., column])
        for (near, far), tension in zip(pairwise(rope.path), tensions, strict=True):
            force = tension[..., None] * _towards(world, near, far)
            forces += [(near, force), (far, -force)]
    return forces


def _of_beams(rig: Rig, world: Mapping[str, Array]) -> list[tuple[str, Array]]:
    """Forces (..., 3) of the weight and inertia of all beams on their ends."""
    forces = []
    for beam in beams(rig):
        ends = [world[end][2] for end in beam.link.ends]
        for end, masses, share in zip(beam.link.ends, beam.masses, beam.shares, strict=True):
            moved = sum(mass * second for mass, second in zip(masses, ends, strict=True))
            down = np.array([0.0, 0.0, -share * beam.link.mass * rig.gravity])
            forces.append((end, np.asarray(down - moved)))
    return forces


def _along(rope: Rope, lengths: Array, pull: Array) -> list[Array]:
    """Force in each span of a rope, all falls of the last one together.

    Parameters
    ----------
    lengths
        Of its spans, (3 orders, ..., spans).
    pull
        Tension at the winch, (...).
    """
    times = np.ones(lengths.shape[-1])
    times[-1] = rope.falls
    tensions, sheaves = [pull], {rope.after(sheave): sheave for sheave in rope.sheaves}
    for k in range(1, len(times)):
        tension = tensions[-1]
        if k in sheaves:
            beyond = (lengths[2][..., k:] * times[k:]).sum(axis=-1)
            tension = tension + sheaves[k].inertia / sheaves[k].radius ** 2 * beyond
        tensions.append(tension)
    return [tension * number for tension, number in zip(tensions, times, strict=True)]
