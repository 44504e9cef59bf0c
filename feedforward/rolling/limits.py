"""What a hand cannot do, found in a motion and said in one line with finger, time and amount."""

import math
from collections.abc import Iterator
from itertools import permutations
from typing import NamedTuple

import numpy as np

from ...models.errors import PathError
from ...models.hand.hand import Finger, Plate, Tip
from ...models.types import Array
from .hand_motion import HandMotion
from .kinematics import projector, spin_direction

ROUNDING = 1e-9
"""Excess [m], [rad] or [rad/s] that is rounding of the plan, not worth a refusal."""
LEAST_LIFT = math.radians(5.0)
"""Least angle between a contact normal and the plane of two turning axes [rad]; nearer, tips have
to turn fast: the spin that they need grows like one over its sine."""


class Fault(NamedTuple):
    """How far a limit is overstepped at N instants, and how to say so."""

    excess: Array
    """Excess over the limit, wrong where above 0, shape (N,)."""
    words: str
    """The fault in words, with {} for the largest excess in `unit`."""
    unit: float = 1.0
    """Unit in which the words tell the excess."""


def check_limits(motion: HandMotion) -> None:
    """Refuse a motion for its first fault, as far as the samples show it.

    Raises
    ------
    PathError
        With finger, time and amount.
    """
    first: tuple[float, str] | None = None
    for fault in _faults(motion):
        wrong = ~(fault.excess <= ROUNDING)  # what is not a number is wrong too
        i = motion.earliest(wrong)
        if i is None:
            continue
        time = float(motion.times[i])
        if first is None or time < first[0]:
            worst = fault.excess[wrong].max() / fault.unit
            first = (time, fault.words.format(f"up to {worst:.3g}"))
    if first is not None:
        raise PathError(
            f"hand {motion.hand.name} cannot make the move: from t = {first[0]:.4g} s on {first[1]}"
        )


def _faults(motion: HandMotion) -> Iterator[Fault]:
    hand = motion.hand
    if not hand.spin:
        contacts = np.array([finger.contact for finger in hand.fingers])
        axis = spin_direction(hand, contacts)[3:]
        spin = np.abs(motion.angular_velocity @ axis)
        yield Fault(
            spin,
            "the object would spin about its contacts by {} rad/s, which the hand excludes; "
            'plan it with turning="rolling"',
        )
    for i, finger in enumerate(hand.fingers):
        yield from _of_finger(motion, i, finger)
    for i, k in permutations(range(len(hand.fingers)), 2):
        fault = _between(motion, i, k)
        if fault is not None:
            yield fault


def _of_finger(motion: HandMotion, i: int, finger: Finger) -> Iterator[Fault]:
    """Faults of one finger on its own."""
    blocked = motion.finger_velocities[:, i] @ (np.eye(3) - projector(finger.slides))
    yield Fault(
        np.linalg.norm(blocked, axis=1),
        f"finger {finger.name} would have to move by {{}} m/s where it has no slide",
    )
    normal, surface = motion.normals[:, i], finger.surface
    if isinstance(surface, Plate):
        away = np.linalg.norm(motion.contacts_on_fingers[:, i], axis=1)
        yield Fault(
            away - surface.radius,
            f"the contact leaves the plate of finger {finger.name} by {{}} mm",
            1e-3,
        )
    elif len(surface.axes) == 2:
        missing = np.cross(*np.array(surface.axes))
        lift = np.arcsin(np.abs(normal @ missing) / np.linalg.norm(missing))
        yield Fault(
            LEAST_LIFT - lift,
            f"the contact of finger {finger.name} is {{}} degrees too near the plane of the axes "
            "that its tip turns about",
            math.radians(1.0),
        )
    elif not surface.axes:
        angle = np.arccos(np.clip(normal @ np.array(finger.contact), -1.0, 1.0))
        yield Fault(
            angle - surface.reach,
            f"the contact leaves the tip of finger {finger.name} by {{}} degrees",
            math.radians(1.0),
        )


def _between(motion: HandMotion, i: int, k: int) -> Fault | None:
    """How far finger i is in the space of finger k; None if the pair is looked at elsewhere."""
    finger, other = motion.hand.fingers[i], motion.hand.fingers[k]
    apart = motion.finger_positions[:, i] - motion.finger_positions[:, k]
    if isinstance(finger.surface, Tip) and isinstance(other.surface, Tip):
        near = finger.surface.radius + other.surface.radius
        return None if i > k else Fault(
            near - np.linalg.norm(apart, axis=1),
            f"fingers {finger.name} and {other.name} would be {{}} mm inside each other",
            1e-3,
        )  # fmt: skip
    if not isinstance(other.surface, Plate):
        return None
    normal = np.array(other.surface.normal)
    if isinstance(finger.surface, Tip):
        depth, what = finger.surface.radius - apart @ normal, f"finger {finger.name}"
    else:
        contact = motion.contacts[:, i] - motion.finger_positions[:, k]
        depth, what = -(contact @ normal), f"the contact of finger {finger.name}"
    return Fault(depth, f"{what} would be {{}} mm behind the plate of finger {other.name}", 1e-3)
