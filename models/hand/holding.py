"""Forces that hold a hand's object still at home, and the motors' share in contact forces.

    contact = holding_forces(hand, squeeze=3.0)          # (fingers, 3) [N], on the object
    inputs = motor_forces(hand, contact)                 # of the slides and the tips

For the resting hand only; `flatrig.feedforward.rolling` finds the forces of a moving one.
"""

import numpy as np

from ..errors import ModelError
from ..types import Array
from ..values import bounded
from .hand import Hand, Tip

SQUEEZE = 5.0
"""Normal force of each finger of a hand of several at home, over the object's weight."""
RESIDUAL = 1e-9
"""Largest unbalanced force or torque over radius that is put down to rounding, over the largest
force or torque over radius that is needed."""


def grasp_map(contacts: Array) -> Array:
    """From contact forces to force [N] and torque over radius [N] on the object, (6, 3 fingers).

    `contacts` are the unit vectors from the object's centre to the contacts, (fingers, 3).
    """
    turning = np.cross(contacts[:, None, :], np.eye(3)).swapaxes(1, 2)
    return np.concatenate([np.vstack((np.eye(3), turn)) for turn in turning], axis=1)


def nearest_forces(hand: Hand, contacts: Array, wrench: Array, squeeze: float) -> Array:
    """The contact forces (fingers, 3) of a given sum that are nearest to a plain squeeze [N].

    `wrench` (6,) is the force and the torque over the radius that the object needs.

    Raises
    ------
    ModelError
        No contact forces have that sum.
    """
    to_object = grasp_map(contacts)
    plain = -squeeze * contacts.ravel()
    missing = wrench - to_object @ plain
    forces = plain + np.linalg.lstsq(to_object, missing, rcond=1e-9)[0]
    residual = np.abs(to_object @ forces - wrench).max()
    if residual > RESIDUAL * max(np.abs(wrench).max(), squeeze):
        raise ModelError(
            f"hand {hand.name} cannot hold its object: {residual:.3g} N are unbalanced"
        )
    return np.asarray(forces.reshape(-1, 3))


def holding_forces(hand: Hand, squeeze: float | None = None) -> Array:
    """Contact forces on the object at home [N], (fingers, 3).

    `squeeze` is the normal force of each finger that they are nearest to [N]; None takes five
    times the object's weight for several fingers, 0 for a single one.

    Raises
    ------
    ModelError
        They do not hold the object, or need more friction than there is.
    """
    gravity, contacts = np.array(hand.gravity), np.array([f.contact for f in hand.fingers])
    weight = hand.held.mass * float(np.linalg.norm(gravity))
    if squeeze is None:
        squeeze = SQUEEZE * weight if len(hand.fingers) > 1 else 0.0
    rule = "a number >= 0"
    squeeze = bounded("squeeze", squeeze, least=0, unit="N", rule=rule, error=ModelError)
    wrench = np.concatenate((-hand.held.mass * gravity, np.zeros(3)))
    forces = nearest_forces(hand, contacts, wrench, squeeze)
    normal = -np.einsum("ij,ij->i", forces, contacts)
    tangential = np.linalg.norm(forces + normal[:, None] * contacts, axis=1)
    excess = tangential - hand.friction * normal
    worst = int(np.argmax(excess))
    if excess[worst] > 1e-9 * max(weight, squeeze):
        raise ModelError(
            f"hand {hand.name} drops its object at home: finger {hand.finger_names[worst]} presses "
            f"with {normal[worst]:.3g} N and would need {tangential[worst]:.3g} N of friction, "
            f"it has {hand.friction * max(normal[worst], 0):.3g}"
        )
    return forces


def motor_forces(hand: Hand, contact_forces: Array) -> Array:
    """Inputs that make a hand at home exert contact forces (fingers, 3) on its object [N].

    Finger by finger, forces of the slides [N], which also bear the weight of what they move, and
    torques of the turns [N m], as `rolling.joint_forces`.
    """
    gravity, inputs = np.array(hand.gravity), []
    for finger, force in zip(hand.fingers, contact_forces, strict=True):
        for slide, mass in zip(finger.slides, finger.masses, strict=True):
            inputs.append(np.dot(slide, force - mass * gravity))
        if isinstance(finger.surface, Tip):
            # the object pushes back with -force at -radius * contact from the tip's centre
            torque = -finger.surface.radius * np.cross(finger.contact, force)
            inputs += [np.dot(axis, torque) for axis in finger.surface.axes]
    return np.array(inputs)
