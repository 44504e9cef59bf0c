"""Two checks of a plan that share nothing with how it was made.

`residuals` puts a motion into the contact and rolling constraints; `replay` integrates the
driftless system from the plan's generalized velocities alone.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from ...models.hand.hand import Plate
from ...models.types import Array
from .hand_motion import HandMotion
from .hand_plan import HandPlan
from .kinematics import Rolling, constraint_matrix

STEPS = 2000
"""Steps of the integration, whose own error is then far below 1e-8 rad for a few turns."""


class Residuals(NamedTuple):
    """Largest violation of each kind of constraint over a motion."""

    surface: float
    """Distance of contact points from the object or their finger's surface (K 2.3 to 2.5) [m]."""
    tangency: float
    """Difference of one surface's normal from the other's opposite (K 2.6)."""
    slides: float
    """Distance of fingers from their slides, seen from the first instant [m]."""
    rolling: float
    """Velocity against rolling, slides, axes, excluded spin (K 2.8, 2.14, 2.58) [m/s or rad/s]."""


def residuals(motion: HandMotion) -> Residuals:
    """How well a motion keeps the contact and rolling constraints."""
    hand = motion.hand
    surface, tangency, slides = [0.0], [0.0], [0.0]
    on_object = np.linalg.norm(motion.contacts_on_object, axis=-1) - hand.held.radius
    surface.append(float(np.abs(on_object).max()))
    for i, finger in enumerate(hand.fingers):
        contact, outward = motion.contacts_on_fingers[:, i], -motion.normals[:, i]
        if isinstance(finger.surface, Plate):
            own = np.broadcast_to(np.array(finger.surface.normal), outward.shape)
            off = contact @ np.array(finger.surface.normal)
        else:
            own = contact / finger.surface.radius
            off = np.linalg.norm(contact, axis=1) - finger.surface.radius
        surface.append(float(np.abs(off).max()))
        tangency.append(float(np.abs(own - outward).max()))
        moved = motion.finger_positions[:, i] - motion.finger_positions[0, i]
        directions = np.linalg.qr(np.array(finger.slides).T)[0]
        slides.append(float(np.abs(moved - moved @ directions @ directions.T).max()))
    return Residuals(max(surface), max(tangency), max(slides), _rolling(motion))


def _rolling(motion: HandMotion) -> float:
    """See `Residuals.rolling`."""
    count = len(motion.times)
    fingers = motion.finger_velocities.reshape(count, -1)
    tips = motion.tip_velocities.reshape(count, -1)
    velocities = np.concatenate((motion.velocity, motion.angular_velocity, fingers, tips), axis=1)
    worst = 0.0
    for normals, velocity in zip(motion.normals, velocities, strict=True):
        worst = max(worst, float(np.abs(constraint_matrix(motion.hand, normals) @ velocity).max()))
    return worst


class Replay(NamedTuple):
    """How far the driftless system ends from the plan."""

    orientation: float
    """Angle between the two orientations at the end [rad]."""
    position: float
    """Distance of the object's centre [m]."""
    contacts: float
    """Largest distance of a contact point [m]."""


def replay(plan: HandPlan) -> Replay:
    """Integrate the driftless system over the plan's inputs, from its beginning to its end.

    By the classical Runge-Kutta method of order four.
    """
    rolling = Rolling.of(plan.hand)
    step = plan.move.duration / STEPS
    ends = plan(np.array([0.0, plan.move.duration]))
    inputs = plan_inputs(rolling, plan, np.linspace(0.0, plan.move.duration, 2 * STEPS + 1))
    rates = step * np.einsum("nk,kij->nij", inputs, rolling.generators)
    last, planned = _state(rolling, ends, 0), _state(rolling, ends, 1)
    for begin, middle, end in zip(rates[:-2:2], rates[1:-1:2], rates[2::2], strict=True):
        first = begin @ last
        second = middle @ (last + first / 2)
        third = middle @ (last + second / 2)
        fourth = end @ (last + third)
        last = last + (first + 2 * second + 2 * third + fourth) / 6
    rotation, goal = (Rotation.from_matrix(state[:9].reshape(3, 3).T) for state in (last, planned))
    off = 0.0
    for finger in plan.hand.fingers:
        plate = isinstance(finger.surface, Plate)
        place = rolling.blocks[f"{'c' if plate else 'e'}.{finger.name}"]
        scale = 1.0 if plate else plan.hand.held.radius
        off = max(off, scale * float(np.linalg.norm(last[place] - planned[place])))
    position = float(np.linalg.norm((last - planned)[rolling.blocks["p"]]))
    return Replay(float((rotation * goal.inv()).magnitude()), position, off)


def plan_inputs(rolling: Rolling, plan: HandPlan, times: Array) -> Array:
    """The generalized velocities `Rolling.input_names` at times (N,), shape (N, inputs)."""
    velocity, turning, tips = plan.velocities(times)
    both = np.concatenate((velocity, turning, tips.reshape(len(times), -1)), axis=1)
    return np.asarray(both @ np.linalg.pinv(rolling.basis).T)


def _state(rolling: Rolling, motion: HandMotion, k: int) -> Array:
    """X at the k-th instant of a motion."""
    blocks = {}
    for i, finger in enumerate(motion.hand.fingers):
        if isinstance(finger.surface, Plate):
            blocks[f"c.{finger.name}"] = motion.contacts_on_fingers[k, i]
        else:
            blocks[f"e.{finger.name}"] = motion.normals[k, i]
            if finger.surface.axes:
                blocks[f"q.{finger.name}"] = motion.tip_turns[k, i]
    return rolling.state(motion.rotation[k], motion.position[k], **blocks)
