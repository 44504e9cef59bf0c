"""How the drives must move to move the load: the rig's static map, linearised along a path."""

import numpy as np

from ...feedforward import Reference, hold, solve
from ...models import Rig
from ...models.types import Array

POINTS = 17
"""Points of the path at which the map is linearised; in between it is interpolated."""
STEP = 1e-3
"""Step of the central differences [m]: far above the rounding of `solve`, far below a rope."""


def drive_jacobian(rig: Rig, reference: Reference, times: Array) -> Array:
    """Derivatives of drive positions by outputs, at rest, along a reference.

    Parameters
    ----------
    rig, reference
        The crane, and the path of its outputs.
    times
        Instants of the derivatives [s], shape (N,).

    Returns
    -------
    Array
        Shape (N, drives, outputs), [1] or [rad/m].
    """
    instants = np.linspace(0.0, reference.duration, POINTS)
    jacobian = np.zeros((POINTS, len(rig.drives), reference.size))
    for k, point in enumerate(reference(instants)):
        for column, step in enumerate(STEP * np.eye(reference.size)):
            ahead, behind = (
                solve(rig, hold(place), 0.0).drive_positions[0]
                for place in (point + step, point - step)
            )
            jacobian[k, :, column] = _without_turns(ahead - behind) / (2.0 * STEP)
    flat = jacobian.reshape(POINTS, -1)
    columns = [np.interp(times, instants, values) for values in flat.T]
    return np.stack(columns, axis=1).reshape(len(times), *jacobian.shape[1:])


def _without_turns(difference: Array) -> Array:
    """Small differences, of angles perhaps, without whole turns."""
    return np.asarray(np.remainder(difference + np.pi, 2.0 * np.pi) - np.pi)
