"""Consistent starting values: the equations at rest, solved by Newton's method.

A path starts from rest, so before its start everything rests too: z solves F(z, 0, 0) = 0 with all
dummies zero, and every past state that a multistep formula asks for is this one, exactly.  Which of
the solutions it is (the load below the trolley, not above) the rig's home says; the exact solver's
rest there is the first guess and nothing more.
"""

import numpy as np

from ...models.errors import PathError
from ...models.types import Array
from ..exact.branch import branch_of
from ..exact.problem import Problem
from ..paths.reference import Reference
from ..paths.straight import hold
from ..series.rotation import bryant
from .direct import Direct
from .formulation import Formulation, prescribed

ITERATIONS = 20
"""Newton steps allowed; the guess is exact but for a pulley that chooses its own place."""
BALANCED = 1e-11
"""Largest residual of a start, over the size of the terms in its equation, or over a thousandth of
the largest equation's where an equation has hardly any."""


def at_rest(equations: Formulation, reference: Reference) -> Array:
    """The unknowns of a formulation at the start of a path, shape (N,).

    Raises
    ------
    RigError, PathError
        As `feedforward.solve` for the rig at rest at the start.
    """
    direct = Direct(equations.mechanics)
    z = _guess(direct, reference)
    still = np.zeros(len(z))
    target = prescribed(direct.mechanics.coordinates, reference, [0.0], 0)[:, 0]
    for _ in range(ITERATIONS):
        residual, jacobian = direct.evaluate(target, z, still, still, True)
        assert jacobian is not None
        size = np.abs(jacobian[0]) @ np.abs(z)
        if (np.abs(residual) <= BALANCED * np.maximum(size, size.max() * 1e-3)).all():
            break
        # Least squares: a pulley without mass may start at a place of its own choice.
        z = z - np.linalg.lstsq(jacobian[0], residual, rcond=None)[0]
    else:
        rig = direct.mechanics.coordinates.problem.rig
        raise PathError(f"rig {rig.name} has no equilibrium at the start of the path")
    return np.concatenate((z, np.zeros(len(equations.names) - len(z))))


def start_angles(problem: Problem, reference: Reference) -> dict[str, float]:
    """Angles of the turning frames at the start of a path [rad], full turns counted."""
    branch = branch_of(problem, hold(reference.start))
    return {name: float(angles[0]) for name, angles in branch.angles.items()}


def _guess(direct: Direct, reference: Reference) -> Array:
    """Coordinates, multipliers and inputs of the exact rest."""
    coordinates = direct.mechanics.coordinates
    e = coordinates.equations
    branch = branch_of(coordinates.problem, hold(reference.start))
    n, m = len(e.names), len(e.constraint_names)
    q, multipliers, inputs = np.split(branch.values[:, 0], [n, n + m])
    values = dict(zip(e.names, q, strict=True))
    values |= start_angles(coordinates.problem, reference)
    for orientation in e.orientations:
        rotation = q[list(orientation.directors)].reshape(3, 3).T
        values |= dict(zip(orientation.angles, bryant(rotation[None])[0], strict=True))
    x = [values[name] for name in coordinates.names]
    return np.concatenate((x, multipliers[list(coordinates.multipliers)], inputs))
