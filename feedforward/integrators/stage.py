"""What the schemes that solve one stage per step have in common."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import ClassVar

from ...models.types import Array
from ..multibody.system import System
from .body_state import Counters, Failure, State, Step
from .iteration import Force, Stage, linearised, solve


class OneStage(ABC):
    """A scheme given by its stage and by what it makes of the solution."""

    name: ClassVar[str]
    order: ClassVar[int]
    share: ClassVar[float] = 0.5
    """Factor of h^2 by which the stage's multipliers are scaled."""
    factorisations_at_end: ClassVar[int] = 0
    """Matrices that `end` factorises."""

    @abstractmethod
    def stage(self, system: System, state: State, h: float) -> Stage:
        """The equations of a step."""

    def end(self, system: System, state: State, h: float, q: Array, multipliers: Array) -> State:
        """The state at the end of a step, from the stage's coordinates and plain multipliers.

        Unless a scheme says otherwise the mean of the old and the new rates is the quotient of
        differences (Y 2.119a).
        """
        return State(q, midpoint_rate(state, h, q), multipliers)

    def begin(self, system: System, q: Array, v: Array) -> State:
        """The state to start from, at consistent coordinates and rates."""
        return State(q, v, system.accelerations(q, v)[1])

    def guess(self, state: State, h: float) -> Array:
        """Coordinates from which Newton's method starts, shape (n,)."""
        return state.q + h * state.v

    def step(self, system: System, state: State, h: float) -> Step | Failure:
        """One step of h seconds."""
        scale = self.share * h**2
        stage, guess = self.stage(system, state, h), self.guess(state, h)
        solution = solve(system, stage, guess, scale * state.multipliers)
        if isinstance(solution, Failure):
            return solution
        end = self.end(system, state, h, solution.q, solution.multipliers / scale)
        extra = Counters(factorisations=self.factorisations_at_end)
        return Step(end, solution.counters + extra)

    def matrix(self, system: System, state: State, h: float) -> Array:
        """The iteration matrix of a step at its first guess, as printed.

        Rows are the momentum balance and the constraints, columns the coordinates and the plain
        multipliers; the solver itself scales both so that h does not spoil the condition.
        """
        stage, guess = self.stage(system, state, h), self.guess(state, h)
        matrix, _ = linearised(system, stage, guess, self.share * h**2 * state.multipliers)
        n = len(guess)
        matrix[:n] /= self.share * h
        matrix[:, n:] *= self.share * h**2
        return matrix


def midpoint_rate(state: State, h: float, q: Array) -> Array:
    """v1 from q1 - q0 = h (v0 + v1)/2 (Y 2.119a)."""
    return 2 * (q - state.q) / h - state.v


def forces_at_end(system: System, h: float) -> Callable[[Array, Array], Force]:
    """Forces of a stage that evaluates all of them at the end of the step."""

    def force(q: Array, multipliers: Array) -> Force:
        return Force(
            h**2 * system.potential_gradient(q),
            system.constraint_jacobian(q),
            h**2 * system.potential_hessian(q) + system.constraint_hessian(q, multipliers),
        )

    return force
