"""Are a motion's rates and accelerations the derivatives of its places?

    drift(rig, reference, motion)        # relative, must be small

Over short intervals rates are integrated and compared with what the places, and accelerations with
what the rates, have changed by.  Nothing of a Taylor expansion is used: a wrong factorial in it
makes places, rates and accelerations that satisfy every equation and are not one motion's.
"""

import math

import numpy as np

from ...feedforward import Motion, Reference, solve
from ...models import Rig
from ...models.types import Array

NODES = np.array([-1.0, -math.sqrt(3.0 / 7.0), 0.0, math.sqrt(3.0 / 7.0), 1.0])
WEIGHTS = np.array([9.0, 49.0, 64.0, 49.0, 9.0]) / 180.0
"""Gauss-Lobatto rule of five nodes, exact for polynomials of degree 7."""
PLACES = np.linspace(0.07, 0.91, 7)
"""Where the intervals begin, as shares of a path's duration."""
LENGTHS = (1e-2, 1e-3, 1e-4, 1e-5)
"""Lengths of the intervals as shares of the duration; the next where something happens faster."""
EXACT = 1e-9
"""An interval whose error is less is not divided."""
NOISE = 1e-13
"""Rounding of places and rates, relative to the largest of the same coordinate along the path."""
ROUNDING = 1e-15
"""The same, relative to the largest of any coordinate."""
TOLERANCE = 1e-7
"""Largest error that is rounding or what the shortest intervals leave."""


def drift(rig: Rig, reference: Reference, motion: Motion, room: float = 0.0) -> float:
    """The largest error of a change, over the rate's size times the interval's length.

    `room` is what directions of ropes are known to, relative: near a singular place that is what
    all coordinates are known to.
    """
    left, errors = PLACES * reference.duration, np.zeros(0)
    settled = 0.0
    for share in LENGTHS:
        errors = _errors(rig, reference, motion, left, share * reference.duration, room)
        rough = ~(errors <= EXACT)
        settled = max(settled, float(errors[~rough].max(initial=0.0)))
        left = left[rough]
        if not len(left):
            return settled
    return float(errors.max())


def _errors(
    rig: Rig, reference: Reference, motion: Motion, left: Array, length: float, room: float
) -> Array:
    """Of the worst coordinate in each interval."""
    times = left[:, None] + 0.5 * length * (1.0 + NODES)
    found = solve(rig, reference, times.ravel())
    shape = (*times.shape, -1)
    tables = (
        (motion.positions, found.positions, found.velocities),
        (motion.velocities, found.velocities, found.accelerations),
    )
    errors, rough = np.zeros(len(left)), 0.0
    for whole, change, rate in tables:
        values, rates = change.reshape(shape), rate.reshape(shape)
        integral = length * np.einsum("k,nkc->nc", WEIGHTS, rates)
        wrong = np.abs(values[:, -1] - values[:, 0] - integral)
        largest = np.abs(whole).max(axis=0) + np.abs(change).max(axis=0)
        rough = float(largest.max()) + rough / reference.duration
        noise = NOISE * largest + (ROUNDING + room) * rough
        scale = length * np.abs(rates).max(axis=1) + noise / TOLERANCE
        share = np.divide(wrong, scale, out=np.zeros_like(wrong), where=scale > 0)
        errors = np.maximum(errors, share.max(axis=1))
    return errors
