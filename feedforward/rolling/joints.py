"""Forces and torques of a hand's motors along a motion."""

from typing import NamedTuple

import numpy as np

from ...models.hand.hand import Tip
from ...models.types import Array
from .grasp import ContactForces
from .hand_motion import HandMotion


class JointForces(NamedTuple):
    """What the hand's motors have to give."""

    names: tuple[str, ...]
    """"FINGER.slideK", then "FINGER.turnK" for the axes of its tip, finger by finger."""
    values: Array
    """Forces and torques [N, N m], shape (N, names)."""
    limits: Array
    """Limits of the motors [N, N m], shape (names,)."""
    units: tuple[str, ...]
    """[N] of a slide, [N m] of a turn."""


def joint_forces(motion: HandMotion, forces: ContactForces) -> JointForces:
    """Forces of the slides and torques of the tips along a motion (K 2.50, 2.62, 2.68).

    A finger feels the reaction -f of its force on the object, as in K 2.68; the minus sign in
    K 2.51 turns it round in 2.50 and 2.62.
    """
    names, columns, limits, units = [], [], [], []
    gravity = np.array(motion.hand.gravity)
    for i, finger in enumerate(motion.hand.fingers):
        force = forces.values[:, i]
        moving = motion.finger_accelerations[:, i] - gravity
        for k, (slide, mass) in enumerate(zip(finger.slides, finger.masses, strict=True), start=1):
            names.append(f"{finger.name}.slide{k}")
            columns.append((mass * moving + force) @ np.array(slide))
            limits.append(finger.force_limit)
            units.append("N")
        if isinstance(finger.surface, Tip):
            arm = finger.surface.radius * motion.normals[:, i]
            torque = finger.surface.inertia * motion.tip_accelerations[:, i] - np.cross(arm, force)
            for k, axis in enumerate(finger.surface.axes, start=1):
                names.append(f"{finger.name}.turn{k}")
                columns.append(torque @ np.array(axis))
                limits.append(finger.surface.torque_limit)
                units.append("N m")
    return JointForces(tuple(names), np.stack(columns, axis=1), np.array(limits), tuple(units))
