"""Schemes that express z' and z'' by differences of z at the steps: implicit Euler, BDF 2 to 5.

Twice the same formula, z' = s z + p and z'' = s z' + p', with a slope s ~ 1/h and sums p, p' over
the past: the equations of one instant are solved for z alone, J = F_z + s F_z' + s^2 F_z''.

The backward differentiation formulae of order k converge with order k in all unknowns of a DAE in
Hessenberg form, and with constant steps for any index (Brenan, Campbell, Petzold 1996, 3.2), after
the steps in which the past before the start still counts.  Here that past is known exactly: a path
starts from rest.  A reference with q continuous derivatives has inputs with q - 4 on a crane of
index 5, so near its joins the order is at most q - 3.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from ...models.types import Array
from .formulation import Formulation
from .newton import Newton
from .schemes import State, Stepped, add_scheme


def advance(
    equations: Formulation,
    newton: Newton,
    guess: Array,
    given: Array,
    slope: float,
    sums: tuple[Array, Array],
) -> Stepped | None:
    """Solve the equations of one instant with z' = slope z + sums[0], z'' = slope z' + sums[1].

    `given` holds the prescribed values and their derivatives, shape (derivatives + 1, a).
    """
    counters = newton.counters

    def function(z: Array, slopes: bool) -> tuple[Array, Array | None]:
        zd = slope * z + sums[0]
        zdd = slope * zd + sums[1]
        counters.evaluations += 1
        residual, jacobian = equations.evaluate(given, z, zd, zdd, slopes)
        if jacobian is None:
            return residual, None
        counters.jacobians += 1
        return residual, jacobian[0] + slope * (jacobian[1] + slope * jacobian[2])

    places = len(equations.mechanics.coordinates.names)
    z = newton.solve(function, guess, float(np.abs(guess[:places]).max()))
    if z is None:
        return None
    zd = slope * z + sums[0]
    return Stepped(State(z, zd, slope * zd + sums[1]), None)


@dataclass(frozen=True)
class Backward:
    """Backward differentiation formula of order 1 (implicit Euler, Y 4.52, 5.38) to 5."""

    order: int
    """Order of convergence, from 1 to 5."""
    nodes: ClassVar[tuple[float, ...]] = (1.0,)
    estimates: ClassVar[bool] = False

    @property
    def name(self) -> str:
        """Name of the scheme, "implicit Euler" or "BDF k"."""
        return "implicit Euler" if self.order == 1 else f"BDF {self.order}"

    def after(self, differentiations: int) -> float:
        """Order of the values after so many differentiations, the same for any number of them."""
        return self.order if differentiations else math.inf

    @property
    def memory(self) -> int:
        """States that the formula needs, and a first guess by a polynomial of degree 3 at least."""
        return max(self.order + 1, 4)

    @cached_property
    def factors(self) -> Array:
        """Factors of z_(n+1), z_n, ... in h z', which is the sum of j-th differences over j."""
        factors = np.zeros(self.order + 1)
        for j in range(1, self.order + 1):
            for i in range(j + 1):
                factors[i] += (-1) ** i * math.comb(j, i) / j
        return factors

    @cached_property
    def forward(self) -> Array:
        """Factors of z_n, z_(n-1), ... in the extrapolation to z_(n+1)."""
        k = self.memory
        return np.array([-((-1.0) ** i) * math.comb(k, i) for i in range(1, k + 1)])

    def step(
        self, equations: Formulation, newton: Newton, past: list[State], given: Array, h: float
    ) -> Stepped | None:
        """The next state."""
        latest = past[: -self.memory - 1 : -1]
        weights = self.factors[1:] / h
        z, zd = (
            np.asarray(sum(w * state[part] for w, state in zip(weights, latest, strict=False)))
            for part in (0, 1)
        )
        guess = np.asarray(sum(w * state.z for w, state in zip(self.forward, latest, strict=True)))
        slope = float(self.factors[0] / h)
        return advance(equations, newton, guess, given[:, 0], slope, (z, zd))


for _order in range(1, 6):
    add_scheme(Backward(_order))
