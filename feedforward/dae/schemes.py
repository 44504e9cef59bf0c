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

from ...models.errors import OptionError, did_you_mean
from ...models.types import Array
from .formulation import Formulation
from .newton import Newton


class State(NamedTuple):
    """Unknowns with two derivatives; those of algebraic unknowns mean nothing."""

    z: Array
    """Unknowns, shape (N,)."""
    zd: Array
    """First derivatives, shape (N,)."""
    zdd: Array
    """Second derivatives, shape (N,)."""


class Orders(NamedTuple):
    """Orders of convergence, infinite where the values are exact."""

    positions: float
    """Order of the coordinates."""
    velocities: float
    """Order of their rates."""
    inputs: float
    """Order of the inputs and multipliers."""


class Stepped(NamedTuple):
    """Result of a step."""

    state: State
    """State at its end."""
    jump: Array | None
    """Estimated error of the rates z' [unit of z / s], of schemes that have one."""


class Scheme(Protocol):
    """A time-stepping method."""

    @property
    def name(self) -> str:
        """Name by which `integrate` knows it."""

    @property
    def order(self) -> int:
        """Order of convergence on ordinary differential equations."""

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
        """The next state, or None if the equations have no solution there.

        Parameters
        ----------
        equations
            The formulation.
        newton
            Newton's method, which counts the work.
        past
            States before the step, the latest one last, `memory` of them or more.
        given
            Prescribed values at the nodes, shape (derivatives + 1, nodes, a).
        h
            Length of the step [s].
        """


SCHEMES: dict[str, Scheme] = {}
"""All schemes by name; each file with schemes adds its own."""


def add_scheme(scheme: Scheme) -> None:
    """Make a scheme known by its name."""
    SCHEMES[scheme.name] = scheme


def scheme(name: str) -> Scheme:
    """A scheme by name.

    Raises
    ------
    OptionError
        There is none of that name.
    """
    if name not in tuple(SCHEMES):  # which need not be a word
        raise OptionError(f"there is no scheme {name!r}{did_you_mean(str(name), SCHEMES)}")
    return SCHEMES[name]


def orders(scheme: Scheme, index: int) -> Orders:
    """Orders of convergence along smooth references on a flat rig's equations of some index."""
    return Orders(*(scheme.after(max(index - less, 0)) for less in (3, 2, 1)))
