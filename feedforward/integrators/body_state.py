"""What the schemes share: a state, a step's outcome, what was counted, why a step failed."""

from dataclasses import dataclass, field, replace
from typing import Protocol

from ...models.types import Array
from ..multibody.system import System


@dataclass(frozen=True, eq=False)
class State:
    """State of a run between two steps."""

    q: Array
    """Coordinates, shape (n,)."""
    v: Array
    """Their rates, shape (n,)."""
    multipliers: Array
    """Multipliers of the step that led here, shape (m,)."""
    memory: tuple[Array, ...] = ()
    """Other vectors that a scheme carries from step to step."""


@dataclass(frozen=True)
class Counters:
    """Work that a run or a step took."""

    steps: int = 0
    """Steps of the scheme."""
    iterations: int = 0
    """Newton steps, each with one evaluation of residual and Jacobian and one factorisation."""
    factorisations: int = 0
    """Factorisations of iteration matrices, and of Jacobians for projection and null space."""

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
    """Kind of failure: "not converged", "singular" or "not finite"."""
    detail: str
    """The reason in one line."""
    time: float = 0.0
    """Time at the start of the step [s]."""

    def at(self, time: float) -> "Failure":
        """The same failure at a time [s]."""
        return replace(self, time=time)


@dataclass(frozen=True, eq=False)
class Step:
    """A step that succeeded."""

    state: State
    """State at its end."""
    counters: Counters
    """Work that it took."""


class Scheme(Protocol):
    """A one-step scheme for constrained systems."""

    @property
    def name(self) -> str:
        """Name of the scheme, as tables print it."""

    @property
    def order(self) -> int:
        """Order of convergence of the coordinates."""

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
    """Times of the states, shape (N,) [s]."""
    q: Array
    """Coordinates, shape (N, n)."""
    v: Array
    """Rates, shape (N, n)."""
    multipliers: Array
    """Multipliers of the step that ended at each time, shape (N, m); first those of the start."""
    counters: Counters = field(default_factory=Counters)
    """Work of all steps."""
    failure: Failure | None = None
    """Why the run ended early, if it did."""
