"""Time-stepping schemes: small immutable objects with a name, an order and a `step`.

A step goes from past states (z, z', z'') to the next one.  It asks the formulation for its
equations at given instants and Newton's method for their zero; None means that there is none.

`after` states the order of convergence of what follows from exact values of the unknowns by a
number of numerical differentiations.  With flat outputs that is all that a scheme does: nothing is
left to integrate, and from index nu the positions need nu - 3 differentiations, the velocities
nu - 2 and the inputs nu - 1 (`orders`).  On systems that are not flat the positions of an index-3
problem have the order of an integration, 2 s - 1 for Radau IIA with s stages; here they are exact.
"""

from typing import NamedTuple, Protocol

from ...models.types import Array
from .formulation import Formulation
from .newton import Newton


class State(NamedTuple):
    """Unknowns with two derivatives, each (N,); those of algebraic unknowns mean nothing."""

    z: Array
    zd: Array
    zdd: Array


class Orders(NamedTuple):
    """Orders of convergence, infinite where the values are exact."""

    positions: float
    velocities: float
    inputs: float


class Stepped(NamedTuple):
    """What a step comes to."""

    state: State
    jump: Array | None
    """Estimated error of the rates z' [unit of z / s], of schemes that have one."""


class Scheme(Protocol):
    """One step of a method."""

    @property
    def name(self) -> str:
        """As `integrate` knows it."""

    @property
    def order(self) -> int:
        """On ordinary differential equations."""

    def after(self, differentiations: int) -> float:
        """Order of what so many numerical differentiations yield; infinite for none."""

    @property
    def memory(self) -> int:
        """Number of past states that it needs."""

    @property
    def nodes(self) -> tuple[float, ...]:
        """Where in the step the equations are asked for, as shares of it."""

    @property
    def estimates(self) -> bool:
        """Whether it estimates its error, so that a tolerance can choose the steps."""

    def step(
        self, equations: Formulation, newton: Newton, past: list[State], given: Array, h: float
    ) -> Stepped | None:
        """The next state.

        Parameters
        ----------
        equations
            The formulation.
        newton
            Which counts.
        past
            States, the latest one last.
        given
            What is prescribed at the nodes, shape (derivatives + 1, nodes, a).
        h
            Step [s].
        """


def orders(scheme: Scheme, index: int) -> Orders:
    """Orders of convergence along smooth references on a flat rig's equations of some index."""
    return Orders(*(scheme.after(max(index - less, 0)) for less in (3, 2, 1)))
