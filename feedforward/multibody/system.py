"""The equations of a mechanism in redundant coordinates (Y 2.20), ready to be integrated.

    q' = v
    M v' + grad V(q) + G(q)^T multipliers = 0
    Phi(q) = 0,   G = dPhi/dq

with a constant mass matrix, zero for the added angles and slides.  Phi is quadratic but for the
turns, V is linear but for the springs (terms.py).  States are single vectors, not batches.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...models.errors import RigError, did_you_mean
from ...models.types import Array
from ..exact.equations import Equations
from .terms import SpringTerm, Turn


@dataclass(frozen=True, eq=False)
class System:
    """Equations of motion with n coordinates and m constraints."""

    name: str
    names: tuple[str, ...]
    """Names of the n coordinates."""
    constraint_names: tuple[str, ...]
    """Names of the m constraints."""
    mass: Array
    """Mass matrix M, shape (n, n)."""
    force: Array
    """Constant part of the force, gravity and efforts, shape (n,)."""
    constraints: Array
    """Symmetric matrices S_k with Phi_k = 1/2 (q, 1)^T S_k (q, 1), shape (m, n + 1, n + 1); zero
    for turns."""
    turns: tuple[Turn, ...] = ()
    """Constraints of the added angles, which are not quadratic."""
    springs: tuple[SpringTerm, ...] = ()
    """Springs, whose potential is not quadratic."""
    vectors: tuple[tuple[int, ...], ...] = ()
    """Indices of each coordinate that is a vector: positions and directors."""

    @property
    def degrees_of_freedom(self) -> int:
        """Coordinates less constraints."""
        return len(self.names) - len(self.constraint_names)

    def index(self, name: str) -> int:
        """Index of a coordinate.

        Raises
        ------
        RigError
            There is no coordinate of that name.
        """
        if name not in self.names:
            known = did_you_mean(name, self.names)
            raise RigError(f"{self.name} has no coordinate {name!r}{known}")
        return self.names.index(name)

    def potential(self, q: Array) -> float:
        """V(q) [J]."""
        return float(sum(s.value(q) for s in self.springs) - self.force @ q)

    def potential_gradient(self, q: Array) -> Array:
        """Gradient of V, shape (n,)."""
        return np.asarray(sum((s.gradient(q) for s in self.springs), -self.force))

    def potential_hessian(self, q: Array) -> Array:
        """Second derivatives of V, shape (n, n)."""
        return np.asarray(sum((s.hessian(q) for s in self.springs), np.zeros_like(self.mass)))

    def discrete_potential_gradient(self, q0: Array, q1: Array) -> Array:
        """Discrete gradient of V, shape (n,)."""
        gradients = (s.discrete_gradient(q0, q1) for s in self.springs)
        return np.asarray(sum(gradients, -self.force))

    def discrete_potential_slope(self, q0: Array, q1: Array) -> Array:
        """Its derivative by q1, shape (n, n)."""
        slopes = (s.discrete_slope(q0, q1) for s in self.springs)
        return np.asarray(sum(slopes, np.zeros_like(self.mass)))

    def constraint_values(self, q: Array) -> Array:
        """Phi(q), shape (m,)."""
        z = np.append(q, 1.0)
        values = 0.5 * (self.constraints @ z) @ z
        for turn in self.turns:
            values[turn.constraint] = turn.value(q)
        return np.asarray(values)

    def constraint_jacobian(self, q: Array) -> Array:
        """G(q), shape (m, n)."""
        jacobian = self.constraints[:, :-1] @ np.append(q, 1.0)
        for turn in self.turns:
            jacobian[turn.constraint] = turn.gradient(q)
        return np.asarray(jacobian)

    def constraint_hessian(self, q: Array, weights: Array) -> Array:
        """Sum of the constraints' second derivatives times weights (m,), shape (n, n)."""
        hessian = self._weighted(weights)
        for turn in self.turns:
            hessian += weights[turn.constraint] * turn.hessian(q)
        return hessian

    def discrete_jacobian(self, q0: Array, q1: Array) -> Array:
        """Discrete gradients of the constraints (Y 3.5), shape (m, n)."""
        jacobian = self.constraints[:, :-1] @ np.append(0.5 * (q0 + q1), 1.0)
        for turn in self.turns:
            jacobian[turn.constraint] = turn.discrete_gradient(q0, q1)
        return np.asarray(jacobian)

    def discrete_constraint_slope(self, q0: Array, q1: Array, weights: Array) -> Array:
        """Derivative by q1 of their sum times weights (m,), shape (n, n)."""
        slope = 0.5 * self._weighted(weights)
        for turn in self.turns:
            slope += weights[turn.constraint] * turn.discrete_slope(q0, q1)
        return slope

    def accelerations(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Accelerations (n,) and multipliers (m,) of the index-1 form at a consistent state."""
        n = len(q)
        matrix = saddle(self.mass, (jacobian := self.constraint_jacobian(q)).T, jacobian)
        curvature = (self._hessians @ v) @ v
        for turn in self.turns:
            curvature[turn.constraint] = v @ turn.hessian(q) @ v
        right = np.concatenate((-self.potential_gradient(q), -curvature))
        solution = np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)
        return solution[:n], solution[n:]

    def energy(self, q: Array, v: Array) -> float:
        """Kinetic and potential energy [J]."""
        return float(0.5 * v @ self.mass @ v) + self.potential(q)

    def angular_momentum(self, q: Array, v: Array) -> Array:
        """Angular momentum about the origin [kg m^2/s], shape (3,), in the plane (1,)."""
        blocks = np.array(self.vectors)
        position, momentum = q[blocks], (self.mass @ v)[blocks]
        if blocks.shape[1] == 2:
            moment = position[:, 0] * momentum[:, 1] - position[:, 1] * momentum[:, 0]
            return np.array([moment.sum()])
        return np.asarray(np.cross(position, momentum).sum(axis=0))

    @cached_property
    def _hessians(self) -> Array:
        return np.ascontiguousarray(self.constraints[:, :-1, :-1])

    def _weighted(self, weights: Array) -> Array:
        flat = self._hessians.reshape(len(self._hessians), -1)
        return np.asarray(weights @ flat).reshape(self.mass.shape)


def of_equations(equations: Equations) -> System:
    """The free motion of a rig: its generated equations without inputs."""
    return System(
        name=equations.rig.name,
        names=equations.names,
        constraint_names=equations.constraint_names,
        mass=np.array(equations.mass),
        force=np.array(equations.force),
        constraints=np.array(equations.constraints),
    )


def saddle(upper: Array, transposed: Array, jacobian: Array) -> Array:
    """The matrix ((upper, transposed), (jacobian, 0)), shape (n + m, n + m)."""
    n, m = transposed.shape
    matrix = np.zeros((n + m, n + m))
    matrix[:n, :n], matrix[:n, n:], matrix[n:, :n] = upper, transposed, jacobian
    return matrix
