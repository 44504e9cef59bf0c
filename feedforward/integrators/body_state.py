"""What the schemes share: a state, a step's outcome, what was counted, why a step failed."""

from dataclasses import dataclass, field, replace
from typing import Protocol

from ...models.types import Array
from ..multibody.system import System


@dataclass(frozen=True, eq=False)
class State:
    """Where a run stands."""

    q: Array
    """Coordinates, shape (n,)."""
    v: Array
    """Their rates, shape (n,)."""
    multipliers: Array
    """Of the step that led here, shape (m,)."""
    memory: tuple[Array, ...] = ()
    """What else a scheme carries from step to step."""


@dataclass(frozen=True)
class Counters:
    """Work done."""

    steps: int = 0
    iterations: int = 0
    """Newton steps, each one evaluation of residual and Jacobian and one factorisation."""
    factorisations: int = 0
    """Of the iteration matrix, and of Jacobians for projection and null space."""

    def __add__(self, other: "Counters") -> "Counters":
        return Counters(
            self.steps + other.steps,
            self.iterations + other.iterations,
            self.factorisations + other.factorisations,
        )


@dataclass(frozen=True)
class Failure:
    """Why a step was not made."""

    reason: str
    """"not converged", "singular" or "not finite"."""
    detail: str
    """One line."""
    time: float = 0.0
    """At the start of the step [s]."""

    def at(self, time: float) -> "Failure":
        """The same failure, dated."""
        return replace(self, time=time)


@dataclass(frozen=True, eq=False)
class Step:
    """A step that was made."""

    state: State
    counters: Counters


class Scheme(Protocol):
    """A one-step scheme for constrained systems."""

    @property
    def name(self) -> str:
        """In the field's words."""

    @property
    def order(self) -> int:
        """Of convergence of the coordinates."""

    def begin(self, system: System, q: Array, v: Array) -> State:
        """The state to start from, at consistent coordinates and rates."""

    def step(self, system: System, state: State, h: float) -> Step | Failure:
        """One step of h seconds.

        Raises
        ------
        numpy.linalg.LinAlgError
            A matrix is singular; `integrate` makes it a failure.
        """

    def matrix(self, system: System, state: State, h: float) -> Array:
        """The iteration matrix of a step from a state, at its first guess, as printed."""


@dataclass(frozen=True, eq=False)
class Run:
    """A run, up to its end or its failure."""

    times: Array
    """Shape (N,) [s]."""
    q: Array
    """Coordinates, shape (N, n)."""
    v: Array
    """Rates, shape (N, n)."""
    multipliers: Array
    """Of the step that ended at each time, shape (N, m); at the first those of the start."""
    counters: Counters = field(default_factory=Counters)
    failure: Failure | None = None
