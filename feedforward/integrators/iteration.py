"""Newton's method for the equations of one step.

Every scheme here asks, with multipliers scaled by h^2 so that nothing grows as h shrinks, for

    weight M (q - target) + force(q, multipliers) = 0,    Phi(q) = 0

and differs from the others in the weight, the target and where it evaluates the force.  The
Jacobian is exact, so the error after a Newton step is about the square of that step.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...models.types import Array
from ..multibody.nullspace import negligible
from ..multibody.system import System, saddle
from .body_state import Counters, Failure

ROUNDS = 25
"""Newton steps allowed in one step of a scheme; from a useful guess it takes two to five."""


@dataclass(frozen=True, eq=False)
class Force:
    """Potential and constraint forces of a stage at one guess, times h^2."""

    potential: Array
    """Gradient of the potential, shape (n,)."""
    jacobian: Array
    """G where the scheme evaluates it, shape (m, n): the constraint force is G^T multipliers."""
    slope: Array
    """Derivative of the potential and the constraint force by q, shape (n, n)."""


@dataclass(frozen=True, eq=False)
class Stage:
    """The equations of one step."""

    weight: float
    """Factor of the inertia M (q - target)."""
    target: Array
    """Coordinates to which the step would lead without forces, shape (n,)."""
    force: Callable[[Array, Array], Force]
    """Forces at coordinates (n,) and scaled multipliers (m,)."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Coordinates and scaled multipliers at the end of a step."""

    q: Array
    """Coordinates, shape (n,)."""
    multipliers: Array
    """Multipliers times the scheme's share of h^2, shape (m,)."""
    counters: Counters
    """Work of the iteration."""


def solve(system: System, stage: Stage, q: Array, multipliers: Array) -> Solution | Failure:
    """Solve a stage from a guess."""
    n, update = len(q), np.full_like(q, np.inf)
    for count in range(1, ROUNDS + 1):
        matrix, residual = linearised(system, stage, q, multipliers)
        if not np.isfinite(residual).all():
            return Failure("not finite", f"Newton's step {count} left the range of numbers")
        update = np.asarray(np.linalg.solve(matrix, residual), dtype=np.float64)
        q, multipliers = q - update[:n], multipliers - update[n:]
        if negligible(update[:n], q):
            return Solution(q, multipliers, Counters(1, count, count))
    return unsettled(update[:n])


def unsettled(update: Array) -> Failure:
    """The failure of a method whose last step was this."""
    size = float(np.abs(update).max())
    detail = f"Newton's last step of {ROUNDS} was {size:.3g}; a smaller time step may help"
    return Failure("not converged", detail)


def linearised(system: System, stage: Stage, q: Array, multipliers: Array) -> tuple[Array, Array]:
    """Matrix (n + m, n + m) and residual (n + m,) of a stage at a guess."""
    force = stage.force(q, multipliers)
    balance = stage.weight * system.mass @ (q - stage.target) + force.potential
    balance += force.jacobian.T @ multipliers
    upper = stage.weight * system.mass + force.slope
    matrix = saddle(upper, force.jacobian.T, system.constraint_jacobian(q))
    return matrix, np.concatenate((balance, system.constraint_values(q)))
