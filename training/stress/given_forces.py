"""What drives give to what they drive, by hand: gears, their losses, and friction.

given(motion)               # force or torque along each driven coordinate, (N, drives)
smooth_twin(motion)         # the same motion of a rig that has no dry friction and loses nothing
"""

from dataclasses import replace

import numpy as np

from ...feedforward import Motion
from ...models.friction import REST, Friction
from ...models.rig.idealised import without_jumps
from ...models.rig.rig import Drive, Rig, Rope
from ...models.types import Array


def rubbed(friction: Friction, rates: Array) -> Array:
    """Force that friction takes at some rates (N,)."""
    moving = np.where(np.abs(rates) > REST, np.sign(rates), 0.0)
    return friction.coulomb * moving + friction.viscous * rates


def given(motion: Motion) -> tuple[Array, Array]:
    """Force [N] or torque [N m] that moves each driven coordinate, (N, drives), and its size.

    The size is what comes from the motor and what friction takes, their magnitudes together.
    """
    rig, columns, sizes = motion.rig, [], []
    for i, drive in enumerate(rig.drives):
        rates, inputs = motion.drive_velocities[:, i], motion.inputs[:, i]
        way = np.where(np.abs(rates) > REST, np.sign(rates), 0.0) * np.sign(inputs)
        kept = np.where(way > 0, drive.efficiency, np.where(way < 0, 1.0 / drive.efficiency, 1.0))
        radius = _radius(rig, drive)
        force = inputs * kept * drive.gear / radius
        taken = rubbed(rig.driven(drive).friction, rates)
        columns.append(force - taken)
        sizes.append(np.abs(force) + np.abs(taken))
    return np.stack(columns, axis=1), np.stack(sizes, axis=1)


def smooth_twin(motion: Motion) -> Motion:
    """The same motion of the rig without dry friction and with gears that lose nothing.

    That is what MuJoCo's model has to the last digit: its own dry friction is a soft constraint.
    """
    rig, twin = motion.rig, without_jumps(motion.rig)
    if twin == rig:
        return motion
    forces, columns = given(motion)[0], []
    for i, drive in enumerate(twin.drives):
        viscous = rig.driven(drive).friction.viscous * motion.drive_velocities[:, i]
        columns.append((forces[:, i] + viscous) * _radius(rig, drive) / drive.gear)
    return replace(motion, rig=twin, inputs=np.stack(columns, axis=1))


def _radius(rig: Rig, drive: Drive) -> float:
    part = rig.driven(drive)
    return part.drum_radius if isinstance(part, Rope) else 1.0


def added_by_sheave(rope: Rope, k: int, accelerations: Array) -> Array:
    """What the sheave before span k adds to the tension: its inertia times the rope's acceleration.

    Accelerations of the lengths of the spans are (N, spans).
    """
    beyond = accelerations[:, k:-1].sum(axis=1) + rope.falls * accelerations[:, -1]
    shares = [
        s.inertia / s.radius**2 for s in rope.sheaves if k and rope.path[1:].index(s.at) + 1 == k
    ]
    return np.asarray(sum(shares) * beyond)
