"""Generalised-alpha scheme (Y 3.5; Arnold and Brüls 2007, for index 3): second order, damps what
is too fast for the step.

Beside the true acceleration it carries an average of its own, a filter whose damping of infinitely
fast motion is `radius`: 1 damps nothing, 0 forgets it in one step.
"""

from dataclasses import dataclass
from typing import ClassVar

from ...models.errors import OptionError
from ...models.types import Array
from ...models.values import as_number
from ..multibody.system import System
from .body_state import State
from .iteration import Stage
from .stage import OneStage, forces_at_end


@dataclass(frozen=True)
class GeneralisedAlpha(OneStage):
    """Newmark's formulas with averaged accelerations, equilibrium and constraints at the end.

    Raises
    ------
    OptionError
        The radius is not between 0 and 1.
    """

    radius: float = 0.8
    """Spectral radius for infinitely fast motion, from 0 to 1."""
    name: ClassVar[str] = "generalised-alpha"
    order: ClassVar[int] = 2
    share: ClassVar[float] = 1.0

    def __post_init__(self) -> None:
        if not 0 <= as_number(self.radius) <= 1:
            raise OptionError(f"spectral radius {self.radius!r}: it must be between 0 and 1")

    @property
    def alpha_m(self) -> float:
        """Weight of the old average."""
        return (2 * self.radius - 1) / (self.radius + 1)

    @property
    def alpha_f(self) -> float:
        """Weight of the old acceleration."""
        return self.radius / (self.radius + 1)

    @property
    def gamma(self) -> float:
        """Newmark's gamma, chosen for second order."""
        return 0.5 + self.alpha_f - self.alpha_m

    @property
    def beta(self) -> float:
        """Newmark's beta, chosen for the damping."""
        return 0.25 * (self.gamma + 0.5) ** 2

    def begin(self, system: System, q: Array, v: Array) -> State:
        """The state to start from: the average begins as the acceleration."""
        acceleration, multipliers = system.accelerations(q, v)
        return State(q, v, multipliers, (acceleration, acceleration))

    def guess(self, state: State, h: float) -> Array:
        """Coordinates that the old average of the accelerations leads to, shape (n,)."""
        return state.q + h * state.v + 0.5 * h**2 * state.memory[1]

    def stage(self, system: System, state: State, h: float) -> Stage:
        """Forces at the end; h^2 times the acceleration there is weight (q - target)."""
        acceleration, average = state.memory
        weight = (1 - self.alpha_m) / (self.beta * (1 - self.alpha_f))
        known = (self.alpha_m * average - self.alpha_f * acceleration) / (1 - self.alpha_f)
        target = self._explicit(state, h) - h**2 * known / weight
        return Stage(weight, target, forces_at_end(system, h))

    def end(self, system: System, state: State, h: float, q: Array, multipliers: Array) -> State:
        """Newmark's rate, and both accelerations."""
        acceleration, average = state.memory
        new = (q - self._explicit(state, h)) / (self.beta * h**2)
        rate = state.v + h * ((1 - self.gamma) * average + self.gamma * new)
        after = (1 - self.alpha_m) * new + self.alpha_m * average - self.alpha_f * acceleration
        return State(q, rate, multipliers, (after / (1 - self.alpha_f), new))

    def _explicit(self, state: State, h: float) -> Array:
        """The part of Newmark's coordinates that is known."""
        return state.q + h * state.v + h**2 * (0.5 - self.beta) * state.memory[1]
