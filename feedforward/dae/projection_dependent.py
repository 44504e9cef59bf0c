"""The projection in dependent coordinates (Y 4.50, formulation ALT).

The equations of motion are split in three.  D spans what neither servo constraints nor constraints
forbid; the acceleration a that the forces cause is prescribed along the former and tangent to the
latter; the derivatives of the outputs are those of the reference:

    D^T motion(p'', gamma'') = 0,   C a = gamma'',   d2/dt2 constraints (a) = 0.

D depends on the coordinates: D = N K with the constant null space N of C and G N K = 0.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
import scipy

from ...models.errors import RigError
from ...models.types import Array
from ..exact.problem import Problem
from .coordinates import Kind
from .formulation import Evaluated
from .mechanics import Forces
from .projection import Free, Projection, free


@dataclass(frozen=True, eq=False)
class DependentProjection(Projection):
    """The equations projected into three subspaces; N is `tangent`."""

    @classmethod
    def of(cls, problem: Problem, kind: Kind) -> Self:
        """The projection in a rig's dependent coordinates.

        Raises
        ------
        RigError
            The mass matrix is singular, or as many constraints as outputs leave no direction.
        """
        equations = super().of(problem, kind)
        coordinates = equations.mechanics.coordinates
        constraints, outputs = len(coordinates.constraints), len(coordinates.servo)
        if not constraints < outputs:
            raise RigError(
                f"rig {problem.rig.name}: no projection in {kind} coordinates, {constraints} "
                f"constraints are not fewer than {outputs} outputs (Y 4.51)"
            )
        return equations

    @cached_property
    def inverse(self) -> Array:
        """Pseudo-inverse of C, shape (k, a)."""
        return np.asarray(np.linalg.pinv(self.mechanics.coordinates.servo), dtype=float)

    @property
    def index(self) -> int:
        """Two less than that of the problem, but at least 2: the inputs need the rates."""
        return max(self.mechanics.coordinates.problem.analysis.index - 2, 2)

    def evaluate(self, given: Array, z: Array, zd: Array, zdd: Array, slopes: bool) -> Evaluated:
        """The three projections, constraints, servo constraints."""
        mechanics, servo = self.mechanics, self.mechanics.coordinates.servo
        k, *_ = mechanics.sizes
        rate, acceleration = self._prescribed(given, zd, zdd)
        forces = mechanics.forces(z, rate, acceleration)
        inner = self.assemble(forces, given, z, rate, acceleration, slopes)
        caused = free(mechanics, forces, z, rate, acceleration, slopes)
        tangent, lever = self._tangent(mechanics.constraint_slope(caused.forces))
        motion = inner.residual[:k]
        prescribed = servo @ caused.acceleration - given[2]
        second = self._second(caused, rate)
        residual = np.concatenate((tangent.T @ motion, prescribed, second, inner.residual[k:]))
        if inner.jacobian is None or caused.jacobian is None:
            return Evaluated(residual, None)
        jacobian = np.zeros((3, len(z), len(z)))
        rows = tangent.shape[1]
        jacobian[:, :rows] = tangent.T @ inner.jacobian[:, :k]
        jacobian[0, :rows, :k] -= tangent.T @ self._bent(caused.forces, lever @ motion)
        jacobian[:2, rows : rows + len(servo)] = servo @ caused.jacobian
        end = rows + len(servo) + len(mechanics.coordinates.constraints)
        jacobian[:2, rows + len(servo) : end] = self._second_slopes(caused, z, rate)
        jacobian[:, end:] = inner.jacobian[:, k:]
        # What is prescribed does not depend on the unknowns.
        keep = np.eye(k) - self.inverse @ servo
        jacobian[1:, :, :k] = jacobian[1:, :, :k] @ keep
        return Evaluated(residual, jacobian)

    def _prescribed(self, given: Array, zd: Array, zdd: Array) -> tuple[Array, Array]:
        """Rates and accelerations with those of the outputs from the reference."""
        k, *_ = self.mechanics.sizes
        servo, inverse = self.mechanics.coordinates.servo, self.inverse
        rate, acceleration = zd[:k], zdd[:k]
        return (
            rate + inverse @ (given[1] - servo @ rate),
            acceleration + inverse @ (given[2] - servo @ acceleration),
        )

    def _tangent(self, gradient: Array) -> tuple[Array, Array]:
        """D, and the matrix L that gives the multipliers in D's derivative.

        For any r, d D^T r = -D^T dG^T (L r).
        """
        across = self.tangent
        inside = gradient @ across
        m = len(inside)
        *_, order = scipy.linalg.qr(inside, pivoting=True, mode="economic")
        solved, chosen = order[:m], order[m:]
        kernel = np.zeros((across.shape[1], len(chosen)))
        kernel[chosen, np.arange(len(chosen))] = 1.0
        kernel[solved] = -np.linalg.solve(inside[:, solved], inside[:, chosen])
        lever = np.linalg.solve(inside[:, solved].T, across[:, solved].T)
        return across @ kernel, np.asarray(lever, dtype=float)

    def _bent(self, forces: Forces, weights: Array) -> Array:
        """Derivative of (G P)^T weights by the coordinates, shape (k, k)."""
        c = self.mechanics.coordinates
        place, rows = forces.place, list(c.constraints)
        hessian = np.tensordot(weights, c.equations.constraints[rows, :-1, :-1], 1)
        bent = place.slope.T @ hessian @ place.slope
        if place.bend is not None:
            bent += np.tensordot(weights @ forces.gradient[rows], place.bend, 1)
        return np.asarray(bent)

    def _second(self, caused: Free, rate: Array) -> Array:
        """Second derivative of the constraints by time, shape (constraints,)."""
        c, place = self.mechanics.coordinates, caused.forces.place
        rows = list(c.constraints)
        second = place.second(rate, caused.acceleration)
        curvature = c.equations.constraint_curvature(place.slope @ rate)[rows]
        return np.asarray(caused.forces.gradient[rows] @ second + curvature)

    def _second_slopes(self, caused: Free, z: Array, rate: Array) -> Array:
        """Derivatives of `_second` by z and z', shape (2, constraints, N)."""
        c, place = self.mechanics.coordinates, caused.forces.place
        k, rows = len(rate), list(c.constraints)
        gradient, hessian = caused.forces.gradient[rows], c.equations.constraints[rows, :-1, :-1]
        assert caused.jacobian is not None
        jacobian = gradient @ place.slope @ caused.jacobian
        second, speed = place.second(rate, caused.acceleration), place.slope @ rate
        turned = np.zeros_like(place.slope)
        if place.bend is not None:
            turned = place.bend @ rate
            moved = place.bend @ caused.acceleration + c.third(place, z[:k], rate)
            jacobian[0, :, :k] += gradient @ moved
        jacobian[0, :, :k] += hessian @ second @ place.slope + 2.0 * hessian @ speed @ turned
        jacobian[1, :, :k] += 2.0 * (gradient @ turned + hessian @ speed @ place.slope)
        return np.asarray(jacobian)
