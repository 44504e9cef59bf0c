"""The equations as they are: motion, constraints and servo constraints (Y 4.2, 5.10, 5.102).

The index is that of the problem, 5 for most cranes.  Multistep formulae with constant steps still
converge in theory; each of the four differentiations that the inputs need multiplies the rounding
error by 1 / step, so the error stops falling early.  Runge-Kutta methods lose one order with each
differentiation: Radau IIA with three stages has none left for the inputs (Y 4.2).
"""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from ...models.types import Array
from ..exact.problem import Problem
from .coordinates import Kind, coordinates_of
from .formulation import Evaluated, Instant, unknown_names
from .mechanics import Forces, Mechanics


@dataclass(frozen=True, eq=False)
class Direct:
    """Equations of motion, constraints and servo constraints, none of them differentiated."""

    mechanics: Mechanics
    """Equations of motion in some coordinates."""
    derivatives: ClassVar[int] = 0

    @classmethod
    def of(cls, problem: Problem, kind: Kind) -> Self:
        """The formulation of a rig's inverse dynamics in one of its sets of coordinates.

        Raises
        ------
        RigError
            It does not apply to the rig, and why.
        """
        return cls(Mechanics(coordinates_of(problem, kind)))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of coordinates, multipliers and inputs."""
        return unknown_names(self.mechanics)

    @property
    def index(self) -> int:
        """Index of the problem."""
        return self.mechanics.coordinates.problem.analysis.index

    def evaluate(self, given: Array, z: Array, zd: Array, zdd: Array, slopes: bool) -> Evaluated:
        """Equations of motion, constraints, servo constraints."""
        k, *_ = self.mechanics.sizes
        forces = self.mechanics.forces(z, zd[:k], zdd[:k])
        return self.assemble(forces, given, z, zd, zdd, slopes)

    def assemble(
        self, forces: Forces, given: Array, z: Array, zd: Array, zdd: Array, slopes: bool
    ) -> Evaluated:
        """The same equations from known forces."""
        mechanics, servo = self.mechanics, self.mechanics.coordinates.servo
        k, m, _ = mechanics.sizes
        residual = np.concatenate(
            (mechanics.motion(forces), mechanics.constraints(forces), servo @ z[:k] - given[0])
        )
        if not slopes:
            return Evaluated(residual, None)
        jacobian = np.zeros((3, len(residual), len(z)))
        part = mechanics.slopes(forces, z, zd[:k], zdd[:k])
        jacobian[0, :k, :k] = part.position
        jacobian[1, :k, :k] = part.rate
        jacobian[2, :k, :k] = part.acceleration
        jacobian[0, :k, k : k + m] = part.multipliers
        jacobian[0, :k, k + m :] = part.inputs
        jacobian[0, k : -len(servo), :k] = mechanics.constraint_slope(forces)
        jacobian[0, -len(servo) :, :k] = servo
        return Evaluated(residual, jacobian)

    def moving(self, instant: Instant) -> tuple[Array, Array, Array]:
        """Coordinates, multipliers and inputs; rates and accelerations of the first."""
        rows = list(self.mechanics.coordinates.multipliers)
        rest = np.concatenate((instant.multipliers[rows], instant.inputs))
        none = np.zeros_like(rest)
        parts = (instant.place, rest), (instant.rate, none), (instant.acceleration, none)
        z, zd, zdd = (np.concatenate(part) for part in parts)
        return z, zd, zdd

    def rates(self, z: Array, zd: Array, zdd: Array) -> tuple[Array, Array]:
        """Rates and accelerations of the coordinates."""
        k, *_ = self.mechanics.sizes
        return zd[:k], zdd[:k]
