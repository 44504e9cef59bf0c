"""The equations of motion of a rig in any of its coordinates, with their Jacobians.

With q = phi(x), P = d phi and the equations of motion in polynomial coordinates,

    motion      = P^T (M q'' + D q' - f + G^T multipliers - (B + B'q) u),
                  q' = P x',   q'' = P x'' + d2 phi (x', x')
    constraints = Phi(phi(x)) of those that are left

(Y 4.11, 5.33, 5.113): one set of generated equations and a null-space reduction, no second one
written by hand.

Of a base that moves as given nothing is reduced: its own equations, input = acceleration, take no
part of what it carries.  P^T is then V^T with the columns of its coordinates cut down to their own
rows, and of G^T there are left those that push.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...models.types import Array
from .coordinates import Coordinates, Place


class Forces(NamedTuple):
    """What stands in the equations of motion at one instant."""

    place: Place
    """Configuration and coordinate map."""
    unbalanced: Array
    """Sum M q'' + D q' - f + G^T multipliers - (B + B'q) u, shape (n,)."""
    gradient: Array
    """Gradients G of all constraints, shape (m, n)."""
    push: Array
    """What a unit of each multiplier pushes by, shape (m, n): G, but for what moves as given."""
    across: Array
    """Transposed directions V of the equations, shape (k, n): P^T, but for what moves as given."""


class Slopes(NamedTuple):
    """Derivatives of the reduced equations of motion."""

    position: Array
    """Derivative by the coordinates, shape (k, k)."""
    rate: Array
    """Derivative by their rates, shape (k, k)."""
    acceleration: Array
    """Derivative by their accelerations, the mass matrix, shape (k, k)."""
    multipliers: Array
    """Derivative by the multipliers, shape (k, multipliers)."""
    inputs: Array
    """Derivative by the inputs, shape (k, inputs)."""


@dataclass(frozen=True, eq=False)
class Mechanics:
    """The equations of motion in one set of coordinates."""

    coordinates: Coordinates
    """The coordinates x, k of them."""

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of coordinates, multipliers and inputs."""
        c = self.coordinates
        return len(c.names), len(c.multipliers), c.equations.input_constant.shape[1]

    def split(self, z: Array) -> tuple[Array, Array, Array]:
        """Coordinates, multipliers and inputs of unknowns that begin with these."""
        k, m, b = self.sizes
        return z[:k], z[k : k + m], z[k + m : k + m + b]

    def forces(self, z: Array, rate: Array, acceleration: Array) -> Forces:
        """At unknowns z, rates x' (k,) and accelerations x'' (k,)."""
        e = self.coordinates.equations
        x, multipliers, inputs = self.split(z)
        place = self.coordinates.place(x)
        gradient = e.constraints[:, :-1, :-1] @ place.q + e.constraints[:, :-1, -1]
        inertia = e.mass @ place.second(rate, acceleration)
        unbalanced = inertia - e.force - self._input(place.q) @ inputs
        if e.damping is not None:
            unbalanced += e.damping @ (place.slope @ rate)
        push = gradient if e.pushed is None else gradient * e.pushed
        unbalanced += multipliers @ push[list(self.coordinates.multipliers)]
        own = self.coordinates.own
        across = place.slope.T if own is None else (place.slope * own).T
        return Forces(place, unbalanced, gradient, push, across)

    def motion(self, forces: Forces) -> Array:
        """Residual of the reduced equations of motion, shape (k,)."""
        return forces.across @ forces.unbalanced

    def constraints(self, forces: Forces) -> Array:
        """Residual of the constraints that are left."""
        values = self.coordinates.equations.constraint_values(forces.place.q)
        return values[list(self.coordinates.constraints)]

    def constraint_slope(self, forces: Forces) -> Array:
        """Derivative of `constraints` by the coordinates, shape (constraints, k)."""
        return forces.gradient[list(self.coordinates.constraints)] @ forces.place.slope

    def slopes(self, forces: Forces, z: Array, rate: Array, acceleration: Array) -> Slopes:
        """Derivatives of `motion`."""
        e = self.coordinates.equations
        x, multipliers, inputs = self.split(z)
        rows = list(self.coordinates.multipliers)
        place, own = forces.place, self.coordinates.own
        hessians = e.constraints[rows, :-1, :-1]
        if e.pushed is not None:
            hessians = hessians * e.pushed[rows][..., None]
        stiffness = np.tensordot(multipliers, hessians, 1)
        stiffness -= np.einsum("iaj,a->ij", e.input_linear, inputs)
        across = forces.across
        position = across @ stiffness @ place.slope
        turning = np.zeros_like(position)
        if place.bend is not None:
            moved = place.bend @ acceleration + self.coordinates.third(place, x, rate)
            position += across @ e.mass @ moved
            bend = place.bend if own is None else place.bend * own[..., None]
            bend = bend.reshape(len(place.q), -1)
            position += (forces.unbalanced @ bend).reshape(position.shape)
            turning = 2.0 * across @ e.mass @ (place.bend @ rate)
        if e.damping is not None:
            turning = turning + across @ e.damping @ place.slope
            if place.bend is not None:
                position += across @ e.damping @ (place.bend @ rate)
        return Slopes(
            position=position,
            rate=turning,
            acceleration=across @ e.mass @ place.slope,
            multipliers=across @ forces.push[rows].T,
            inputs=-across @ self._input(place.q),
        )

    def _input(self, q: Array) -> Array:
        e = self.coordinates.equations
        return e.input_constant + e.input_linear @ q
