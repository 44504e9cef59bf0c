"""Variational integrator (Y 3.4): second order, symplectic, keeps momentum maps.

From the discrete action with the potential half way; as a one-step scheme, its momentum at a node
is that of the rates which the constraints allow there.  Its multipliers are of first order: a
node's are half this step's and half the next one's, and only the first half is known.
"""

from dataclasses import dataclass
from typing import ClassVar

from ...models.types import Array
from ..multibody.nullspace import with_momentum
from ..multibody.system import System
from .body_state import State
from .iteration import Force, Stage
from .stage import OneStage


@dataclass(frozen=True)
class Variational(OneStage):
    """Discrete Euler-Lagrange equations with constraint forces at the nodes (Y 3.33)."""

    name: ClassVar[str] = "variational"
    order: ClassVar[int] = 2
    factorisations_at_end: ClassVar[int] = 1

    def stage(self, system: System, state: State, h: float) -> Stage:
        """Constraint forces along the Jacobian of the old coordinates."""
        jacobian = system.constraint_jacobian(state.q)

        def force(q: Array, multipliers: Array) -> Force:
            middle = 0.5 * (state.q + q)
            return Force(
                0.5 * h**2 * system.potential_gradient(middle),
                jacobian,
                0.25 * h**2 * system.potential_hessian(middle),
            )

        return Stage(1.0, state.q + h * state.v, force)

    def end(self, system: System, state: State, h: float, q: Array, multipliers: Array) -> State:
        """The momentum there, whose constraint impulse is half this step's and half the next's."""
        momentum = system.mass @ (q - state.q) / h
        momentum -= 0.5 * h * system.potential_gradient(0.5 * (state.q + q))
        rate, impulse = with_momentum(system, q, momentum)
        return State(q, rate, 2 * impulse / h)
