"""The parts that a rig is made of, as plain data in SI units."""

import math
from dataclasses import dataclass, field
from typing import Literal

from ..values import ENDLESS, Vector, clean

WORLD = "world"
"""Name of the frame that does not move."""


class _Part:
    """Checks the type of every field when it is made."""

    def __post_init__(self) -> None:
        clean(self)


@dataclass(frozen=True)
class Frame(_Part):
    """A structure that carries rails and anchors, and has one degree of freedom.

    `turning`: turns about the vertical axis through the origin; coordinate `NAME.angle` [rad].
    `sliding`: moves along `axis`; coordinate `NAME.position` [m].
    """

    name: str
    kind: Literal["turning", "sliding"]
    inertia: float
    """About the axis [kg m2] if turning, mass [kg] if sliding; includes all it carries rigidly."""
    axis: Vector = (0.0, 0.0, 1.0)
    """Unit direction of motion of a sliding frame; a turning one has (0, 0, 1)."""

    @property
    def coordinate(self) -> str:
        """Name of its coordinate."""
        return f"{self.name}.{'angle' if self.kind == 'turning' else 'position'}"


@dataclass(frozen=True)
class Anchor(_Part):
    """A point fixed in a frame: where a winch or a deflection pulley is mounted."""

    name: str
    position: Vector
    """In the frame [m]; in a platform from its centre of mass."""
    frame: str = WORLD
    """A frame's name, or a platform's: then a corner that ropes are tied to."""


@dataclass(frozen=True)
class Rail(_Part):
    """A straight rail fixed in a frame, from `start` to `end` along `direction`."""

    name: str
    direction: Vector
    """Unit vector in the frame."""
    origin: Vector = (0.0, 0.0, 0.0)
    """Where the trolley's position is zero, in the frame [m]."""
    frame: str = WORLD
    start: float = field(default=-math.inf, metadata=ENDLESS)
    """Lowest position of a trolley [m]."""
    end: float = field(default=math.inf, metadata=ENDLESS)
    """Highest position of a trolley [m]."""


@dataclass(frozen=True)
class Trolley(_Part):
    """A point mass on a rail; coordinate `NAME.position` [m] along it."""

    name: str
    mass: float
    """[kg]"""
    rail: str

    @property
    def coordinate(self) -> str:
        """Name of its coordinate."""
        return f"{self.name}.position"


@dataclass(frozen=True)
class Load(_Part):
    """A point mass free to move, a load or a free pulley; coordinates `NAME.x`, `.y`, `.z` [m].

    A planar rig has no `NAME.y`.
    """

    name: str
    mass: float
    """[kg]"""


@dataclass(frozen=True)
class Platform(_Part):
    """A rigid body hung from ropes.

    Coordinates: `NAME.x`, `.y`, `.z` of its centre of mass [m], and its Bryant angles `NAME.alpha`,
    `.beta`, `.gamma` [rad]: it is turned by Rx(alpha) Ry(beta) Rz(gamma) (Y 6.56, 6.71).
    """

    name: str
    mass: float
    """[kg]"""
    inertia: Vector
    """Principal moments of inertia about its own x, y and z axis [kg m2]."""

    @property
    def angles(self) -> tuple[str, str, str]:
        """Names of its Bryant angles."""
        return (f"{self.name}.alpha", f"{self.name}.beta", f"{self.name}.gamma")


@dataclass(frozen=True)
class Combination(_Part):
    """A weighted sum of coordinates that a reference can prescribe; it is an output by its name."""

    name: str
    of: tuple[str, ...]
    """Coordinates, angles excepted."""
    factors: tuple[float, ...]
    """One for each of them."""


@dataclass(frozen=True)
class Sheave(_Part):
    """A pulley with inertia at an inner point of a rope's path."""

    at: str
    inertia: float
    """[kg m2]"""
    radius: float
    """[m]"""


@dataclass(frozen=True)
class Rope(_Part):
    """An inextensible rope from a winch at `path[0]` through points to its end at `path[-1]`.

    Coordinates: `NAME.length`, the whole length [m], and for a path of more than two points
    `NAME.span1`, `NAME.span2`, ..., the lengths of all spans but the last.
    """

    name: str
    path: tuple[str, ...]
    """Names of anchors, trolleys and loads, two or more."""
    drum_radius: float
    """[m]"""
    winch_inertia: float
    """Of the winch with its motor [kg m2]."""
    sheaves: tuple[Sheave, ...] = ()
    falls: int = 1
    """Parallel parts of the last span, which then ends at a block: it shortens by one metre when
    the winch takes in `falls` metres, and pulls `falls` times as hard."""

    @property
    def coordinate(self) -> str:
        """Name of its coordinate."""
        return f"{self.name}.length"

    @property
    def inertia_along(self) -> float:
        """What the winch adds to the rope's inertia along its length [kg], J/r^2."""
        return self.winch_inertia / self.drum_radius**2

    def after(self, sheave: Sheave) -> int:
        """Place in `path` of a sheave's point, which is never the winch."""
        return self.path.index(sheave.at, 1)


@dataclass(frozen=True)
class Drive(_Part):
    """An input: a torque on a turning frame or a rope's winch, a force on a slide or trolley."""

    name: str
    on: str
    """Name of a frame, trolley or rope."""
    limit: float
    """Largest magnitude [N] or [N m]; scales the actions of the environments."""
