"""The trapezoidal rule, exact to second order and no use here: it oscillates.

Where constraints fix z, it gives z'_(n+1) = 2 (z_(n+1) - z_n) / h - z'_n: an error in z' changes
its sign with every step and never decays, and in z'', its difference, the same root -1 appears
twice, so that the error grows with the number of steps.  That is the oscillation that Y 7 reports
of midpoint-type rules.
"""

import math
from dataclasses import dataclass

from ...models.types import Array
from .formulation import Formulation
from .multistep import advance
from .newton import Newton
from .schemes import State, Stepped, add_scheme


@dataclass(frozen=True)
class Trapezoidal:
    """z' and z'' by the trapezoidal rule, twice the same."""

    name: str = "trapezoidal rule"
    order: int = 2
    memory: int = 2
    nodes: tuple[float, ...] = (1.0,)
    estimates: bool = False

    def after(self, differentiations: int) -> float:
        """Order of the values, as long as nothing makes it oscillate."""
        return self.order if differentiations else math.inf

    def step(
        self, equations: Formulation, newton: Newton, past: list[State], given: Array, h: float
    ) -> Stepped | None:
        """The next state."""
        (before, now), slope = past[-2:], 2.0 / h
        sums = (-slope * now.z - now.zd, -slope * now.zd - now.zdd)
        return advance(equations, newton, 2.0 * now.z - before.z, given[:, 0], slope, sums)


add_scheme(Trapezoidal())
