"""Frames in space, and what their bodies take to move, by Newton and Euler."""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from ...feedforward import Motion
from ...models.rig.frames import tensor
from ...models.rig.rig import WORLD, Frame, Rig
from ...models.types import Array


class Moving(NamedTuple):
    """A frame at N instants, in the world."""

    turned: Array
    """Its axes, the columns, (N, 3, 3)."""
    spin: Array
    """Angular velocity, (N, 3)."""
    twist: Array
    """Angular acceleration, (N, 3)."""
    origin: Array
    """Its origin, (N, 3)."""
    second: Array
    """Acceleration of its origin, (N, 3)."""

    def place(self, point: tuple[float, float, float]) -> Array:
        """World position of a point in its axes, (N, 3)."""
        return np.asarray(self.origin + self.turned @ np.array(point))

    def acceleration(self, point: tuple[float, float, float]) -> Array:
        """Acceleration of such a point, (N, 3)."""
        arm = self.turned @ np.array(point)
        return np.asarray(
            self.second + np.cross(self.twist, arm) + np.cross(self.spin, np.cross(self.spin, arm))
        )


def moving_frames(motion: Motion) -> dict[str, Moving]:
    """All frames of a motion, and the world, by name."""
    none = np.zeros((len(motion.times), 3))
    at_rest = Moving(np.tile(np.eye(3), (len(motion.times), 1, 1)), none, none, none, none)
    moving = {WORLD: at_rest}
    for frame in motion.rig.frames:
        column = motion.column(frame.coordinate)
        value, rate, second = (
            table[:, [column]]
            for table in (motion.positions, motion.velocities, motion.accelerations)
        )
        below = moving[frame.parent]
        axis = below.turned @ np.array(frame.axis)
        if frame.kind == "turning":
            turned = below.turned @ Rotation.from_rotvec(value * frame.axis).as_matrix()
            twist = below.twist + second * axis + np.cross(below.spin, rate * axis)
            spin = below.spin + rate * axis
            origin, pushed = below.place(frame.origin), below.acceleration(frame.origin)
        else:
            turned, spin, twist = below.turned, below.spin, below.twist
            out = np.array(frame.origin) + value * np.array(frame.axis)
            arm = np.einsum("nij,nj->ni", turned, out)
            origin = below.origin + arm
            pushed = below.second + np.cross(twist, arm) + np.cross(spin, np.cross(spin, arm))
            pushed = pushed + 2.0 * np.cross(spin, rate * axis) + second * axis
        moving[frame.name] = Moving(turned, spin, twist, origin, pushed)
    return moving


def carried(rig: Rig, frame: Frame) -> list[Frame]:
    """A frame and all frames on it."""
    names = {frame.name}
    for other in rig.frames:  # each follows its parent
        if other.parent in names:
            names.add(other.name)
    return [other for other in rig.frames if other.name in names]


def taken(rig: Rig, frame: Frame, at: Moving) -> tuple[Array, Array, Array, Array]:
    """What a frame's own body takes: force (N, 3), where (N, 3), and moment about there (N, 3).

    With the moment's size (N,): its parts are accelerated towards the axis, too, by the square of
    the angular velocity, which no moment shows and which rounding is a share of.
    """
    up = np.array((0.0, 0.0, rig.gravity))
    mass, centre = frame.mass, frame.centre
    if frame.kind == "sliding":
        mass, centre = (frame.mass, centre) if frame.mass else (frame.along, (0.0, 0.0, 0.0))
    force = mass * (at.acceleration(centre) + up)
    own = np.einsum("nij,jk,nlk->nil", at.turned, tensor(frame.inertia), at.turned)
    momentum = np.einsum("nij,nj->ni", own, at.spin)
    moment = np.einsum("nij,nj->ni", own, at.twist) + np.cross(at.spin, momentum)
    return force, at.place(centre), moment, np.linalg.norm(own, axis=(1, 2)) * turning(at)


def turning(at: Moving) -> Array:
    """How fast directors change their velocity, over their length, (N,) [1/s2]."""
    return np.asarray(np.linalg.norm(at.twist, axis=1) + np.square(at.spin).sum(axis=1))
