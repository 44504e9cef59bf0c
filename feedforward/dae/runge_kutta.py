"""Implicit Runge-Kutta schemes of collocation type: Radau IIA with 2 and 3 stages, midpoint rule.

The stages' places Z determine their rates and accelerations,

    Z' = A^-1 (Z - z_n) / h,     Z'' = A^-1 (Z' - z'_n) / h,

and the equations are solved at all stages at once.  Radau's last stage is the next state.

Orders of Radau IIA with s stages on problems of index 3 (Hairer, Lubich, Roche 1989, table 2.3):
2 s - 1 in positions, s in velocities, s - 1 in multipliers and inputs.  One derivative more, one
order less: with the index left at 5 the inputs of Radau IIA with 3 stages have order 0 and do not
converge, as Y 4.2 says.

The rate at t_n of the polynomial through z_n and the stages differs from z'_n, the end of the last
step's polynomial.  The difference has the order s of the rates' own error and, with three stages,
serves as its estimate.  With two stages it does not: it vanishes when a step is sqrt 2 times as
long as the one before.

The midpoint rule meets the equations in the middle of a step and goes twice as far: whatever is
wrong with z_n, z'_n and the inputs comes back with the other sign, and grows as it does with the
trapezoidal rule (see `trapezoidal`).
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

ROOT6 = 6.0**0.5


@dataclass(frozen=True)
class Collocation:
    """A scheme that collocates at `nodes`."""

    name: str
    """Name of the scheme."""
    order: int
    """Order on ordinary differential equations."""
    nodes: tuple[float, ...]
    """Stages, as shares of the step."""
    memory: ClassVar[int] = 1

    def after(self, differentiations: int) -> float:
        """Order of the values: one less each time, from the polynomial's first derivative.

        The midpoint rule has its order in everything, also in what the equations give exactly at
        its node, as long as nothing makes it oscillate.
        """
        if not self.stiffly_accurate:
            return self.order
        return len(self.nodes) + 1 - differentiations if differentiations else math.inf

    @property
    def stiffly_accurate(self) -> bool:
        """Whether the last stage is the next state."""
        return self.nodes[-1] == 1.0

    @property
    def estimates(self) -> bool:
        """Whether it estimates its error: with three stages, see above."""
        return self.stiffly_accurate and len(self.nodes) == 3

    @cached_property
    def differences(self) -> Array:
        """A^-1: h times the rates at the nodes of a polynomial that starts from zero, (s, s)."""
        c = np.array(self.nodes)
        powers = np.arange(1, len(c) + 1)
        slopes = powers * c[:, None] ** (powers - 1)
        return np.asarray(slopes @ np.linalg.inv(c[:, None] ** powers))

    @cached_property
    def begin(self) -> Array:
        """Factors of the values at the nodes in the rate at the start, times h, shape (s,)."""
        c = np.array(self.nodes)
        return np.asarray(np.linalg.inv(c[:, None] ** np.arange(1, len(c) + 1))[0])

    def step(
        self, equations: Formulation, newton: Newton, past: list[State], given: Array, h: float
    ) -> Stepped | None:
        """The next state."""
        now, stages, size = past[-1], len(self.nodes), len(past[-1].z)
        inverse, counters = self.differences / h, newton.counters
        twice = inverse @ inverse

        def derivatives(places: Array) -> tuple[Array, Array]:
            rates = inverse @ (places - now.z)
            return rates, inverse @ (rates - now.zd)

        def function(flat: Array, slopes: bool) -> tuple[Array, Array | None]:
            places = flat.reshape(stages, size)
            rates, seconds = derivatives(places)
            counters.evaluations += stages
            parts = [
                equations.evaluate(given[:, i], places[i], rates[i], seconds[i], slopes)
                for i in range(stages)
            ]
            residual = np.concatenate([part.residual for part in parts])
            if not slopes:
                return residual, None
            counters.jacobians += stages
            matrix = np.zeros((stages, size, stages, size))
            for i, part in enumerate(parts):
                assert part.jacobian is not None
                matrix[i] = np.tensordot(inverse[i], part.jacobian[1], 0).transpose(1, 0, 2)
                matrix[i] += np.tensordot(twice[i], part.jacobian[2], 0).transpose(1, 0, 2)
                matrix[i, :, i] += part.jacobian[0]
            return residual, matrix.reshape(stages * size, -1)

        count = len(equations.mechanics.coordinates.names)
        ahead = h * np.array(self.nodes)[:, None]
        guess = now.z + ahead * now.zd
        guess[:, :count] += 0.5 * ahead**2 * now.zdd[:count]
        largest = float(np.abs(now.z[:count]).max())
        flat = newton.solve(function, guess.ravel(), largest)
        if flat is None:
            return None
        places = flat.reshape(stages, size)
        rates, seconds = derivatives(places)
        if self.stiffly_accurate:
            jump = self.begin @ (places - now.z) / h - now.zd
            return Stepped(State(places[-1], rates[-1], seconds[-1]), jump)
        z = 2.0 * places[0] - now.z
        return Stepped(State(z, 2.0 * rates[0] - now.zd, 2.0 * seconds[0] - now.zdd), None)


def radau(stages: int) -> Collocation:
    """Radau IIA with 2 or 3 stages."""
    nodes = {2: (1.0 / 3.0, 1.0), 3: ((4.0 - ROOT6) / 10.0, (4.0 + ROOT6) / 10.0, 1.0)}[stages]
    return Collocation(f"Radau IIA {stages}", 2 * stages - 1, nodes)


for _stages in (2, 3):
    add_scheme(radau(_stages))
add_scheme(Collocation("midpoint rule", 2, (0.5,)))
