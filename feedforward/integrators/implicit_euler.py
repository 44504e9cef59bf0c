"""Implicit Euler (Y 3.1): first order, damps whatever moves."""

from dataclasses import dataclass
from typing import ClassVar

from ...models.types import Array
from ..multibody.system import System
from .body_state import State
from .iteration import Stage
from .stage import OneStage, forces_at_end


@dataclass(frozen=True)
class ImplicitEuler(OneStage):
    """q1 - q0 = h v1, M (v1 - v0) = -h (grad V + G^T multipliers)(q1), Phi(q1) = 0 (Y 3.2)."""

    name: ClassVar[str] = "implicit Euler"
    order: ClassVar[int] = 1
    share: ClassVar[float] = 1.0

    def stage(self, system: System, state: State, h: float) -> Stage:
        """Forces at the end of the step."""
        return Stage(1.0, state.q + h * state.v, forces_at_end(system, h))

    def end(self, system: System, state: State, h: float, q: Array, multipliers: Array) -> State:
        """The rate is the quotient of differences."""
        return State(q, (q - state.q) / h, multipliers)
