"""Schemes that express z' and z'' by differences of z: implicit Euler, BDF, trapezoidal rule.

Twice the same formula, z' = s z + p and z'' = s z' + p', with a slope s ~ 1/h and sums p, p' over
the past: the equations of one instant are solved for z alone, J = F_z + s F_z' + s^2 F_z''.

The backward differentiation formulae of order k converge with order k in all unknowns of a DAE in
Hessenberg form, and with constant steps for any index (Brenan, Campbell, Petzold 1996, 3.2), after
the steps in which the past before the start still counts.  Here that past is known exactly: a path
starts from rest.  A reference with q continuous derivatives has inputs with q - 4 on a crane of
index 5, so near its joins the order is at most q - 3.

The trapezoidal rule is exact to second order and no use here.  Where constraints fix z, it gives
z'_(n+1) = 2 (z_(n+1) - z_n) / h - z'_n: an error in z' changes its sign with every step and never
decays, and in z'', its difference, the same root -1 appears twice, so that the error grows with the
number of steps.  That is the oscillation that Y 7 reports of midpoint-type rules.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...models.types import Array
from .formulation import Formulation
from .newton import Newton
from .schemes import State, Stepped


def advance(
    equations: Formulation,
    newton: Newton,
    guess: Array,
    given: Array,
    slope: float,
    sums: tuple[Array, Array],
) -> Stepped | None:
    """Solve the equations of one instant for z with z' = slope z + sums[0] and so on."""
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

    @property
    def name(self) -> str:
        """Implicit Euler or BDF k."""
        return "implicit Euler" if self.order == 1 else f"BDF {self.order}"

    def after(self, differentiations: int) -> float:
        """The same for all."""
        return self.order if differentiations else math.inf

    @property
    def memory(self) -> int:
        """Enough for the formula and a first guess by a polynomial of degree 3 at least."""
        return max(self.order + 1, 4)

    @property
    def nodes(self) -> tuple[float, ...]:
        """The end of the step."""
        return (1.0,)

    @property
    def estimates(self) -> bool:
        """With constant steps only."""
        return False

    @cached_property
    def factors(self) -> Array:
        """Of z_(n+1), z_n, ...: h z' = sum over j <= k of 1/j times the j-th difference."""
        factors = np.zeros(self.order + 1)
        for j in range(1, self.order + 1):
            for i in range(j + 1):
                factors[i] += (-1) ** i * math.comb(j, i) / j
        return factors

    @cached_property
    def forward(self) -> Array:
        """Extrapolation to z_(n+1) from z_n, z_(n-1), ..."""
        k = self.memory
        return np.array([-((-1.0) ** i) * math.comb(k, i) for i in range(1, k + 1)])

    def step(
        self, equations: Formulation, newton: Newton, past: list[State], given: Array, h: float
    ) -> Stepped | None:
        """The next state."""
        latest = past[: -self.memory - 1 : -1]
        weights = self.factors[1:] / h
        sums = tuple(
            sum(w * state[part] for w, state in zip(weights, latest, strict=False))
            for part in (0, 1)
        )
        guess = np.asarray(sum(w * state.z for w, state in zip(self.forward, latest, strict=True)))
        slope = float(self.factors[0] / h)
        pair = (np.asarray(sums[0]), np.asarray(sums[1]))
        return advance(equations, newton, guess, given[:, 0], slope, pair)


@dataclass(frozen=True)
class Trapezoidal:
    """The trapezoidal rule, which oscillates."""

    name: str = "trapezoidal rule"
    order: int = 2
    memory: int = 2
    nodes: tuple[float, ...] = (1.0,)
    estimates: bool = False

    def after(self, differentiations: int) -> float:
        """The same for all, as long as nothing makes it oscillate."""
        return self.order if differentiations else math.inf

    def step(
        self, equations: Formulation, newton: Newton, past: list[State], given: Array, h: float
    ) -> Stepped | None:
        """The next state."""
        (before, now), slope = past[-2:], 2.0 / h
        sums = (-slope * now.z - now.zd, -slope * now.zd - now.zdd)
        return advance(equations, newton, 2.0 * now.z - before.z, given[:, 0], slope, sums)
