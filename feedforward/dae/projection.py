"""The projection of Blajer and Kolodziejczyk (Y 4.23 in minimal coordinates, 4.33 in redundant).

With D spanning the null space of the servo constraints' matrix C the equations of motion are
split in two: D^T motion = 0 stays differential, and along the servo constraints the acceleration
a that the forces would cause is what is prescribed,

    D^T motion(x, x', x'', ...) = 0,     C a(x, x', multipliers, u) = gamma''.

Of the mass matrix M only W with W M = C is needed.  The source assumes an inverse of M; here
coordinates without inertia do no harm unless an output moves with them alone.  The outputs are
coordinates here, so C and D are constant in minimal coordinates too; the source's GEN has swing
angles for coordinates and needs D(x).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, NamedTuple, Self

import numpy as np
import scipy

from ...models.errors import RigError
from ...models.types import Array
from ..exact.problem import Problem
from .coordinates import Kind
from .direct import Direct
from .formulation import Evaluated
from .mechanics import Forces, Mechanics

RANK = 1e-9
"""Eigenvalues of a mass matrix below this share of the largest one count as zero."""


class Free(NamedTuple):
    """The acceleration that the forces cause."""

    forces: Forces
    """Forces with that acceleration."""
    acceleration: Array
    """The acceleration, shape (k,)."""
    jacobian: Array | None
    """Its derivatives by z and z', shape (2, k, N), if wanted."""


def free(
    mechanics: Mechanics, forces: Forces, z: Array, rate: Array, acceleration: Array, slopes: bool
) -> Free:
    """Acceleration that solves the equations of motion under given multipliers and inputs.

    It differs from any given acceleration by what leaves the forces unbalanced, over the mass.
    """
    k, *_ = mechanics.sizes
    slope = forces.place.slope
    weighted = mechanics.coordinates.equations.mass @ slope
    mass = forces.across @ weighted
    # What no mass resists keeps its acceleration.
    inverse = np.linalg.pinv(mass, RANK) if forces.place.bend is None else np.linalg.inv(mass)
    change = -inverse @ mechanics.motion(forces)
    forces = forces._replace(unbalanced=forces.unbalanced + weighted @ change)
    if not slopes:
        return Free(forces, acceleration + change, None)
    part = mechanics.slopes(forces, z, rate, acceleration + change)
    jacobian = np.zeros((2, k, len(z)))
    jacobian[0] = np.hstack((part.position, part.multipliers, part.inputs))
    jacobian[1, :, :k] = part.rate
    return Free(forces, acceleration + change, -inverse @ jacobian)


@dataclass(frozen=True, eq=False)
class Projection(Direct):
    """The projected equations, GEN in minimal and RED in redundant coordinates."""

    derivatives: ClassVar[int] = 2

    @classmethod
    def of(cls, problem: Problem, kind: Kind) -> Self:
        """The projection in one of a rig's sets of coordinates.

        The forces must determine what it asks for: in redundant coordinates the acceleration of the
        outputs, in others that of everything.

        Raises
        ------
        RigError
            The mass matrix is singular there.
        """
        equations = super().of(problem, kind)
        coordinates = equations.mechanics.coordinates
        # The rank is that of almost every place; this one has angles and lengths of no meaning.
        place = coordinates.place(1.0 + 0.37 * np.arange(float(len(coordinates.names))))
        own = coordinates.own
        across = place.slope.T if own is None else (place.slope * own).T
        mass = across @ coordinates.equations.mass @ place.slope
        massless = scipy.linalg.null_space(mass, RANK)
        if kind == "redundant":
            massless = massless[:, np.abs(coordinates.servo @ massless).max(axis=0) > RANK]
        if massless.shape[1]:
            raise RigError(
                f"rig {problem.rig.name}: no projection in {kind} coordinates, the mass matrix is "
                f"singular (no inertia along "
                f"{coordinates.names[int(np.abs(massless[:, 0]).argmax())]})"
            )
        return equations

    @cached_property
    def tangent(self) -> Array:
        """D, a basis of the null space of C, shape (k, k - a)."""
        return np.asarray(scipy.linalg.null_space(self.mechanics.coordinates.servo))

    @property
    def index(self) -> int:
        """Two less than that of the problem, but 3 where constraints are left, which stay as they
        are, and 2 elsewhere: the inputs need the rates.
        """
        least = 3 if self.mechanics.coordinates.constraints else 2
        return max(super().index - 2, least)

    def evaluate(self, given: Array, z: Array, zd: Array, zdd: Array, slopes: bool) -> Evaluated:
        """Tangential and orthogonal projection, constraints, servo constraints."""
        mechanics, servo = self.mechanics, self.mechanics.coordinates.servo
        k, *_ = mechanics.sizes
        forces = mechanics.forces(z, zd[:k], zdd[:k])
        inner = self.assemble(forces, given, z, zd, zdd, slopes)
        caused = free(mechanics, forces, z, zd[:k], zdd[:k], slopes)
        free_motion = self.tangent.T @ inner.residual[:k]
        prescribed = servo @ caused.acceleration - given[2]
        residual = np.concatenate((free_motion, prescribed, inner.residual[k:]))
        if inner.jacobian is None or caused.jacobian is None:
            return Evaluated(residual, None)
        along = np.zeros((3, len(servo), len(z)))
        along[:2] = servo @ caused.jacobian
        tangential = self.tangent.T @ inner.jacobian[:, :k]
        jacobian = np.concatenate((tangential, along, inner.jacobian[:, k:]), axis=1)
        return Evaluated(residual, jacobian)

    def rates(self, z: Array, zd: Array, zdd: Array) -> tuple[Array, Array]:
        """Rates of the coordinates, and the accelerations that the forces cause."""
        k, *_ = self.mechanics.sizes
        forces = self.mechanics.forces(z, zd[:k], zdd[:k])
        caused = free(self.mechanics, forces, z, zd[:k], zdd[:k], False)
        return zd[:k], caused.acceleration
