"""The smallest contact forces inside the friction cones, by a second-order cone program.

    forces = in_cones(motion, margin=0.2)    # a fifth of the friction is kept in reserve

The unknowns at each instant are the few internal forces z of `grasp.split` and for every finger a
penalised excess s; all instants are solved at once.  It needs clarabel (`flatrig[hands]`): of the
solvers with second-order cones that install as a wheel without a compiler, the smallest; SciPy has
none.
"""

import numpy as np
from scipy import sparse

from ...models.errors import OptionError, PathError
from ...models.types import Array
from ...models.values import as_number
from .grasp import OUTSIDE, ContactForces, split, weight_of
from .hand_motion import HandMotion

PENALTY = 1e5
"""Cost of leaving a cone against that of the internal forces, both in units of `weight_of`; forces
that only just fit need a large one."""
TOLERANCE = 1e-11
"""Gap and feasibility at which the solver ends, far below `OUTSIDE`."""
LARGEST_FRICTION = 1e3
"""Largest friction made use of; with more the solver loses accuracy and forces hardly change."""


def in_cones(motion: HandMotion, margin: float = 0.2, press: float = 0.05) -> ContactForces:
    """The smallest contact forces inside the friction cones.

    Parameters
    ----------
    motion
        What the fingers make the object do.
    margin
        Share of the friction coefficient that is kept in reserve, from 0 to below 1.
    press
        How hard every finger presses at least, as a share of the object's weight.

    Raises
    ------
    PathError
        No such forces exist; with finger, time and amount.
    OptionError
        Margin or press is out of range, or clarabel is not installed.
    """
    if not 0.0 <= as_number(margin) < 1.0:
        raise OptionError(f"margin is {margin!r}, it must be from 0 to below 1")
    if not 0.0 <= as_number(press) < np.inf:
        raise OptionError(f"press is {press!r}, it must be a share of the weight >= 0")
    least = press * motion.hand.held.mass * float(np.linalg.norm(motion.hand.gravity))
    start, internal = split(motion)
    unit = max(weight_of(motion), least)
    friction = min(motion.hand.friction * (1.0 - margin), LARGEST_FRICTION)
    solution, beyond = _solve(motion, start / unit, internal, friction, least / unit)
    forces = ContactForces(motion, (unit * solution).reshape(motion.normals.shape))
    i = motion.earliest((beyond > OUTSIDE).any(axis=1))
    if i is not None:
        k = int(beyond[i].argmax())
        raise PathError(
            f"hand {motion.hand.name} cannot make the motion from t = {motion.times[i]:.4g} s on: "
            f"the force of finger {motion.hand.finger_names[k]} leaves its friction cone by up to "
            f"{unit * beyond[:, k].max():.3g} N at the best, with {friction:.3g} of friction "
            f"to use and {least:.3g} N to press at least"
        )
    return forces


def _frames(normals: Array) -> Array:
    """Orthonormal axes whose first is the inward normal, rows, (N, fingers, 3, 3)."""
    smallest = np.abs(normals).argmin(axis=-1)
    first = np.cross(normals, np.eye(3)[smallest])
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    return np.stack((-normals, first, np.cross(normals, first)), axis=-2)


def _rows(
    motion: HandMotion, start: Array, internal: Array, friction: float, least: float
) -> tuple[Array, Array]:
    """Matrix (N, 5 fingers, unknowns) and offset (N, 5 fingers) of what must lie in the cones.

    Five rows a finger, in its own axes: friction * normal + s and the tangential force, for
    |tangential| <= friction * normal + s; then normal + s >= least and s >= 0.
    """
    count, fingers = motion.normals.shape[:2]
    axes = _frames(motion.normals)
    five = np.concatenate((friction * axes[:, :, :1], axes[:, :, 1:], axes[:, :, :1]), axis=2)
    by_finger = internal.reshape(count, fingers, 3, -1)
    size = by_finger.shape[-1]
    matrix = np.zeros((count, fingers, 5, size + fingers))
    offset = np.zeros((count, fingers, 5))
    matrix[:, :, :4, :size] = five @ by_finger
    offset[:, :, :4] = (five @ start.reshape(count, fingers, 3, 1))[..., 0]
    offset[:, :, 3] -= least
    for i in range(fingers):
        matrix[:, i, [0, 3, 4], size + i] = 1.0
    return matrix.reshape(count, 5 * fingers, -1), offset.reshape(count, 5 * fingers)


def _solve(
    motion: HandMotion, start: Array, internal: Array, friction: float, least: float
) -> tuple[Array, Array]:
    """Forces (N, 3 fingers) and by how much they leave the cones (N, fingers)."""
    try:
        import clarabel
    except ImportError:
        raise OptionError(
            "forces inside the friction cones need clarabel: pip install 'flatrig[hands]'"
        ) from None
    count, fingers = motion.normals.shape[:2]
    size = internal.shape[2]
    matrix, offset = _rows(motion, start, internal, friction, least)
    cones = [clarabel.SecondOrderConeT(3), clarabel.NonnegativeConeT(2)] * (count * fingers)
    quadratic = np.tile(np.repeat([1.0, 0.0], [size, fingers]), count)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = TOLERANCE
    solution = clarabel.DefaultSolver(
        sparse.diags_array(quadratic, format="csc"),
        np.tile(np.repeat([0.0, PENALTY], [size, fingers]), count),
        sparse.csc_matrix(-sparse.block_diag(list(matrix))),
        offset.ravel(),
        cones,
        settings,
    ).solve()
    if "Solved" not in str(solution.status):
        raise PathError(f"no contact forces were found: clarabel ended with {solution.status}")
    unknowns = np.array(solution.x).reshape(count, size + fingers)
    forces = start + np.einsum("nij,nj->ni", internal, unknowns[:, :size])
    return forces, unknowns[:, size:]
