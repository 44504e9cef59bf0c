"""The other rests of a crane under PD: those at which a rope pushes.

The springs of the controller and gravity balance not only at the set point, but also with the load
standing on its rope above the trolley or the pulley (K lemmas 8, 13, 18).  From wherever the
energy is less than at all of them the load comes to rest at the set point (K theorems 7 to 9).
"""

import numpy as np
import scipy

from ...models.types import Array
from .energy import Regulator

STEP = 1e-4
"""Of the differences, as a share of the rig's size."""
BALANCED = 1e-6
"""Largest force left at a rest, as a share of the rig's weight."""


def rivals(regulator: Regulator, starts: int = 48, seed: int = 0) -> Array:
    """Energies [J] of the rests other than the set point that were found, lowest first, shape (k,).

    Looks for points where the potential part of W is stationary, from random configurations with
    the loads high and low about the set point.  None at all means that PD so soft, or a rig such
    as this, has none within reach.
    """
    rig = regulator.rig
    rest = np.array(list(regulator.rest_values.values()))
    names = list(regulator.rest_values)
    angles = rig.angles
    size = float(np.max(regulator.rest.rope_lengths))
    scale = np.array([1.0 if name in angles else size for name in names])
    still = dict.fromkeys(names, np.zeros(1))

    def potential(places: Array) -> Array:
        return regulator.energy(dict(zip(names, places.T, strict=True)), still)

    def slope(place: Array) -> Array:
        steps = STEP * np.diag(scale)
        ahead, behind = potential(place + steps), potential(place - steps)
        return np.asarray((ahead - behind) / (2.0 * STEP * max(rig.weight, 1e-9) * size))

    draw = np.random.default_rng(seed)
    wide = np.where([name in angles for name in names], 0.0, size)
    levels: list[float] = []
    for _ in range(starts):
        solution = scipy.optimize.root(
            slope, rest + wide * draw.uniform(-2.0, 2.0, len(rest)), tol=1e-10
        )
        level = float(potential(np.atleast_2d(solution.x))[0])
        away = abs(level) > BALANCED * rig.weight * size  # not the set point by other angles
        known = np.isclose(level, levels, rtol=1e-3, atol=0.0).any()
        if np.abs(solution.fun).max() < BALANCED and away and not known:
            levels.append(level)
    return np.sort(levels)
