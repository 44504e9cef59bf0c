"""Midpoint-type rule (Y 3.2): second order, forces half way, constraints at the end."""

from dataclasses import dataclass
from typing import ClassVar

from ...models.types import Array
from ..multibody.system import System
from .body_state import State
from .iteration import Force, Stage
from .stage import OneStage


@dataclass(frozen=True)
class Midpoint(OneStage):
    """q1 - q0 = h (v0 + v1)/2, M (v1 - v0) = -h (grad V + G^T multipliers)(half way) (Y 3.3).

    Of a system with quadratic constraints and a linear potential it is the energy-momentum
    scheme; springs and turns make the difference.
    """

    name: ClassVar[str] = "midpoint"
    order: ClassVar[int] = 2

    def stage(self, system: System, state: State, h: float) -> Stage:
        """Forces at the mean of old and new coordinates."""

        def force(q: Array, multipliers: Array) -> Force:
            middle = 0.5 * (state.q + q)
            slope = 0.5 * h**2 * system.potential_hessian(middle)
            slope += system.constraint_hessian(middle, multipliers)
            return Force(
                0.5 * h**2 * system.potential_gradient(middle),
                system.constraint_jacobian(middle),
                0.5 * slope,
            )

        return Stage(1.0, state.q + h * state.v, force)
