"""What every formulation is: F(t, z, z', z'') = 0, with its Jacobians, and how to read z.

The unknowns z begin with coordinates, multipliers and inputs; dummy derivatives may follow.  Only
the coordinates stand under derivatives, and twice at most, so a scheme that replaces z' and z'' by
differences of z solves for z alone, as the sources do (Y 5.38, 5.118).
"""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ...models.types import Array
from ..paths.reference import Reference, taylor_of
from ..series.products import factorials
from .coordinates import Coordinates
from .mechanics import Mechanics


class Evaluated(NamedTuple):
    """The equations at one instant."""

    residual: Array
    """Values of F, shape (N,)."""
    jacobian: Array | None
    """Derivatives dF/dz, dF/dz', dF/dz'', shape (3, N, N), if asked for."""


class Instant(NamedTuple):
    """A rig at one instant of its exact motion."""

    place: Array
    """Coordinates x, shape (k,)."""
    rate: Array
    """Their rates."""
    acceleration: Array
    """Their second derivatives."""
    multipliers: Array
    """Of all constraints, shape (m,)."""
    inputs: Array
    """Shape (b,)."""
    derivatives: tuple[Array, ...]
    """Each unknown of the problem with as many derivatives as are known."""


class Formulation(Protocol):
    """A system of N equations in N unknowns z."""

    @property
    def mechanics(self) -> Mechanics:
        """The equations of motion that it is made of."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the N unknowns."""

    @property
    def derivatives(self) -> int:
        """Highest derivative of the reference in the equations."""

    @property
    def index(self) -> int:
        """Differentiation index."""

    def evaluate(self, given: Array, z: Array, zd: Array, zdd: Array, slopes: bool) -> Evaluated:
        """The equations at z, z', z'' (N,) and prescribed values (derivatives + 1, a)."""

    def moving(self, instant: Instant) -> tuple[Array, Array, Array]:
        """The unknowns z of a rig in motion with two derivatives, as far as they mean anything."""

    def rates(self, z: Array, zd: Array, zdd: Array) -> tuple[Array, Array]:
        """Rates x' and accelerations x'' of the coordinates, each (k,)."""


def prescribed(
    coordinates: Coordinates, reference: Reference, times: ArrayLike, order: int
) -> Array:
    """Values that the servo constraints prescribe, with derivatives, shape (order + 1, N, a)."""
    instants = np.asarray(times, dtype=float)
    if coordinates.kind != "redundant":
        return np.asarray(reference.derivatives(instants, order))
    taylor = coordinates.problem.servo.prescribe(taylor_of(reference, instants, order))
    return np.asarray(taylor * factorials(order + 1)[:, None, None])


def unknown_names(mechanics: Mechanics) -> tuple[str, ...]:
    """Names of coordinates, multipliers and inputs."""
    c = mechanics.coordinates
    constraints = (c.equations.constraint_names[k] for k in c.multipliers)
    multipliers = (f"multiplier of {name}" for name in constraints)
    return (*c.names, *multipliers, *c.problem.rig.input_names)
