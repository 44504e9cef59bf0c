"""Energy-momentum scheme (Y 3.3): second order, exact energy balance at any step.

Discrete gradients stand in the place of gradients, so that the forces' work over a step is the
difference of the potential, and the constraints' is none.  Angular momentum about an axis is kept
where springs and constraints do not change if everything is turned about it.  A turn against the
ground is no such constraint; its own force is zero unless its angle is driven.
"""

from dataclasses import dataclass
from typing import ClassVar

from ...models.types import Array
from ..multibody.system import System
from .body_state import State
from .iteration import Force, Stage
from .stage import OneStage


@dataclass(frozen=True)
class EnergyMomentum(OneStage):
    """The midpoint rule with discrete gradients (Y 2.119, 3.4)."""

    name: ClassVar[str] = "energy-momentum"
    order: ClassVar[int] = 2

    def stage(self, system: System, state: State, h: float) -> Stage:
        """Forces by discrete gradients between old and new coordinates."""

        def force(q: Array, multipliers: Array) -> Force:
            slope = 0.5 * h**2 * system.discrete_potential_slope(state.q, q)
            return Force(
                0.5 * h**2 * system.discrete_potential_gradient(state.q, q),
                system.discrete_jacobian(state.q, q),
                slope + system.discrete_constraint_slope(state.q, q, multipliers),
            )

        return Stage(1.0, state.q + h * state.v, force)
