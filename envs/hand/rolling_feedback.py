"""How to correct an object's pose by rolling: time-varying linear-quadratic feedback.

Let e = (p, r eta) be what the object's pose is off its plan: p in place, the small turn eta in
space, times its radius r.  A correction w of its twist, on top of the plan's, gives

    p' = v,    eta' = omega + omega_plan x eta,    (v, r omega) = S w.

The columns of S span the twists that the fingers can give the object: contacts must not slip
where fingers have no slides, and what no contact force can change of its momentum stays.  Fingers
that hold it from all sides give every twist, S = 1.  A ball on one plate or between two rolls two
ways only; its five errors are then corrected along the way, as the plan turns one into another,
and what is off after arrival stays.  The gains minimise the integral of |e|^2 + |w|^2 / `RATE`^2
until the episode's end, beyond which what can be corrected decays, and the rest stays for `LASTING`
(a Riccati equation, backwards).
"""

import numpy as np
from scipy.linalg import null_space

from ...feedforward.rolling import HandMotion
from ...feedforward.rolling.kinematics import cross_matrix, projector
from ...models.hand.hand import Plate
from ...models.hand.holding import grasp_map
from ...models.types import Array

RATE = 5.0
"""At which errors decay that can be corrected directly [1/s]."""
LASTING = 200.0
"""How long an error counts that is left at the end and cannot be corrected there [s]: a ball that
rolls two ways only wanders by some degrees to end in its pose; with 1 s it would end off it."""
RANK = 1e-6
"""Singular values below this share of the largest count as zero."""


def twists(motion: HandMotion) -> Array:
    """S: an orthonormal basis of the twists (v, r omega) that fingers can give, (6, ways)."""
    hand, normals = motion.hand, motion.normals[0]
    sizes = np.repeat((hand.held.mass, hand.held.inertia / hand.held.radius**2), 3)
    rows = [null_space(grasp_map(normals).T, RANK).T * sizes]
    for finger, normal in zip(hand.fingers, normals, strict=True):
        if isinstance(finger.surface, Plate):
            moving = np.hstack((np.eye(3), -cross_matrix(normal)))
            rows.append((np.eye(3) - projector(finger.slides)) @ moving)
    if hand.planar:
        rows = [np.eye(6)[[1, 3, 5]]]
    return np.asarray(null_space(np.vstack(rows), RANK))


def feedback_gains(motion: HandMotion, period: float) -> Array:
    """Gains G of (v, r omega) = -G e for each of evenly spaced instants, (N, 6, 6) [1/s]."""
    basis = twists(motion)
    ways, count = basis.shape[1], len(motion.times)
    steered = period * basis
    drift = np.tile(np.eye(6), (count, 1, 1))
    drift[:, 3:, 3:] += period * cross_matrix(motion.angular_velocity)
    gains = np.zeros((count, ways, 6))
    direct, effort = basis @ basis.T, period / RATE**2 * np.eye(ways)
    cost = direct / RATE + LASTING * (np.eye(6) - direct)
    for k in range(count - 1, -1, -1):
        reach = steered.T @ cost
        gains[k] = np.linalg.solve(effort + reach @ steered, reach @ drift[k])
        closed = drift[k] - steered @ gains[k]
        cost = period * np.eye(6) + drift[k].T @ cost @ closed
        cost = 0.5 * (cost + cost.T)
    return np.asarray(basis @ gains)
