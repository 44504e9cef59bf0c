"""Null-space reduction (Y 2.3.2) and projection onto the constraints.

The columns of P(q) span the velocities that the constraints allow: G P = 0.  Here they come from
a QR factorisation of G^T, orthonormal whatever the mechanism; `twist_basis` is the basis that the
source writes for one free body, whose columns are velocity and angular velocity.
"""

from typing import NamedTuple

import numpy as np

from ...models.errors import RigError
from ...models.types import Array
from .system import System, saddle

ROUNDS = 20
"""Newton steps allowed to reach the constraints."""
ENOUGH = 1e-9
"""Newton step, over 1 + the coordinates' size, whose square is below rounding: the error left after
a step with an exact Jacobian is about that square."""


class Split(NamedTuple):
    """A Jacobian's range and null space: G^T = range @ factor, G @ null = 0."""

    range: Array
    """Shape (n, m)."""
    factor: Array
    """Upper triangular, shape (m, m)."""
    null: Array
    """Shape (n, n - m)."""

    def least_norm(self, values: Array) -> Array:
        """The shortest x (n,) with G x = values (m,)."""
        return np.asarray(self.range @ np.linalg.solve(self.factor.T, values))

    def weights(self, vector: Array) -> Array:
        """The multipliers (m,) with G^T multipliers closest to a vector (n,)."""
        return np.asarray(np.linalg.solve(self.factor, self.range.T @ vector))


def split(jacobian: Array) -> Split:
    """Range and null space of the rows of a Jacobian (m, n) of full rank."""
    m = len(jacobian)
    q, r = np.linalg.qr(jacobian.T, mode="complete")
    return Split(q[:, :m], r[:m], q[:, m:])


def projected(system: System, q: Array) -> Array:
    """The coordinates near q that satisfy the constraints, to rounding.

    Raises
    ------
    RigError
        None are found.
    """
    place = onto_constraints(system, q)
    if place is None:
        raise RigError(f"{system.name}: the constraints cannot be satisfied near the start")
    return place


def onto_constraints(system: System, q: Array) -> Array | None:
    """The coordinates near q that satisfy the constraints, or None if none are found."""
    place = q.copy()
    for _ in range(ROUNDS):
        jacobian, values = system.constraint_jacobian(place), system.constraint_values(place)
        step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T, values)
        place -= step
        if not np.isfinite(step).all():
            return None
        if negligible(step, place):
            return place
    return None


def negligible(step: Array, q: Array) -> bool:
    """Whether what is left after a Newton step to coordinates q is below rounding."""
    return bool(np.abs(step).max() <= ENOUGH * (1 + np.abs(q).max()))


def projected_rate(system: System, q: Array, v: Array) -> Array:
    """The rates nearest to v, measured by the mass matrix, with G v = 0."""
    return with_momentum(system, q, system.mass @ v)[0]


def with_momentum(system: System, q: Array, momentum: Array) -> tuple[Array, Array]:
    """The rates v and impulses i with G v = 0 and M v + G^T i = momentum."""
    jacobian = system.constraint_jacobian(q)
    right = np.concatenate((momentum, np.zeros(len(jacobian))))
    matrix = saddle(system.mass, jacobian.T, jacobian)
    solution = np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)
    return solution[: len(q)], solution[len(q) :]


def reduced_accelerations(system: System, q: Array, v: Array) -> Array:
    """Accelerations (n,) by the reduced equations (Y 2.29b): no multipliers, f unknowns."""
    parts = split(system.constraint_jacobian(q))
    hessians = system.constraints[:, :-1, :-1]
    curvature = np.einsum("i,kij,j->k", v, hessians, v)
    for turn in system.turns:
        curvature[turn.constraint] = v @ turn.hessian(q) @ v
    # P' v = (P nu)' - P nu', the part of the acceleration that the curved constraints ask for.
    forced = -parts.least_norm(curvature)
    reduced_mass = parts.null.T @ system.mass @ parts.null
    right = -parts.null.T @ (system.mass @ forced + system.potential_gradient(q))
    return np.asarray(forced + parts.null @ np.linalg.solve(reduced_mass, right))


def twist_basis(directors: Array) -> Array:
    """Null-space matrix of a free body from its directors, rows of a (3, 3) array (Y 2.51).

    Returns (12, 6): rates of position and directors from the twist (velocity, spin).
    """
    basis = np.zeros((12, 6))
    basis[:3, :3] = np.eye(3)
    for i, director in enumerate(directors, start=1):
        # The rate of a director is spin x director.
        basis[3 * i : 3 * i + 3, 3:] = np.cross(np.eye(3), director).T
    return basis
