"""The parts that a rig is made of, as plain data in SI units."""

import math
from dataclasses import dataclass, field
from typing import Literal

from ..friction import Friction
from ..values import ENDLESS, Vector, clean

WORLD = "world"
"""Name of the frame that does not move."""

FRICTIONLESS = Friction()
"""Of a part that does not rub."""


class Part:
    """Checks the type of every field when it is made."""

    def __post_init__(self) -> None:
        clean(self)


@dataclass(frozen=True)
class Frame(Part):
    """A structure that carries rails, anchors and other frames, and has one degree of freedom.

    Its axes are its parent's where it turns by nothing.
    """

    name: str
    """Name of the frame, which rails, anchors and frames give to stand on it."""
    kind: Literal["turning", "sliding"]
    """How it moves against its parent: `turning` about `axis` through `origin`, with coordinate
    `NAME.angle` [rad], or `sliding` along `axis`, with coordinate `NAME.position` [m]."""
    inertia: float | tuple[float, ...] = 0.0
    """One number: of a turning frame the moment of inertia about its axis [kg m2], with everything
    that it carries rigidly, against its parent as a motor's is; of a sliding frame its mass [kg].
    Three or six numbers: the tensor about the centre of `mass` along the frame's own axes [kg m2],
    xx, yy, zz or xx, yy, zz, xy, xz, yz."""
    axis: Vector = (0.0, 0.0, 1.0)
    """Unit vector about or along which it moves, in its parent's axes."""
    origin: Vector = (0.0, 0.0, 0.0)
    """Where its own origin is while its coordinate is zero, in its parent's axes [m]."""
    parent: str = WORLD
    """Name of the frame that carries it."""
    mass: float = 0.0
    """Mass [kg] of a body with a centre and a tensor; a turning frame whose axis stands upright in
    the world does without."""
    centre: Vector = (0.0, 0.0, 0.0)
    """Centre of that mass, in the frame's own axes [m]."""
    given: bool = False
    """Whether its motion is given, as a ship's is, whatever pushes it: a path prescribes it, and
    the input of its drive is its acceleration [m/s2] or [rad/s2].  Inertia then plays no part."""
    friction: Friction = FRICTIONLESS
    """Friction of its bearing [N m], [N m s], or of its rails [N], [N s/m]."""

    @property
    def coordinate(self) -> str:
        """Name of the frame's coordinate."""
        return f"{self.name}.{'angle' if self.kind == 'turning' else 'position'}"

    @property
    def along(self) -> float:
        """Inertia along its coordinate alone, a number [kg m2] or [kg]; 0 where a tensor stands."""
        return self.inertia if isinstance(self.inertia, float) else 0.0


@dataclass(frozen=True)
class Anchor(Part):
    """A point fixed in a frame: where a winch or a deflection pulley is mounted."""

    name: str
    """Name of the anchor, which ropes give in their paths."""
    position: Vector
    """Position in the axes of its frame [m]; on a platform, from the centre of mass."""
    frame: str = WORLD
    """Name of the frame that carries it, or of a platform, of which it is then a corner that ropes
    are tied to."""


@dataclass(frozen=True)
class Rail(Part):
    """A straight rail fixed in a frame, from `start` to `end` along `direction`."""

    name: str
    """Name of the rail, which a trolley gives to run on it."""
    direction: Vector
    """Unit vector in the axes of its frame, along which a trolley's position grows."""
    origin: Vector = (0.0, 0.0, 0.0)
    """Point at which a trolley's position is zero, in the axes of its frame [m]."""
    frame: str = WORLD
    """Name of the frame that carries it."""
    start: float = field(default=-math.inf, metadata=ENDLESS)
    """Lowest position that a trolley can have [m]."""
    end: float = field(default=math.inf, metadata=ENDLESS)
    """Highest position that a trolley can have [m]."""


@dataclass(frozen=True)
class Trolley(Part):
    """A point mass on a rail; coordinate `NAME.position` [m] along it."""

    name: str
    """Name of the trolley."""
    mass: float
    """Mass of the trolley with all it carries rigidly, such as a winch [kg]."""
    rail: str
    """Name of the rail that it runs on."""
    friction: Friction = FRICTIONLESS
    """Friction along the rail [N], [N s/m]."""

    @property
    def coordinate(self) -> str:
        """Name of the trolley's coordinate."""
        return f"{self.name}.position"


@dataclass(frozen=True)
class Load(Part):
    """A point mass free to move, a load or a free pulley; coordinates `NAME.x`, `.y`, `.z` [m].

    A planar rig has no `NAME.y`.
    """

    name: str
    """Name of the load."""
    mass: float
    """Mass of the load [kg]; a free pulley may have none, 0."""
    drag: float = 0.0
    """Drag of the air per speed [N s/m]."""


@dataclass(frozen=True)
class Platform(Part):
    """A rigid body hung from ropes.

    Coordinates: `NAME.x`, `.y`, `.z` of its centre of mass [m], and its Bryant angles `NAME.alpha`,
    `.beta`, `.gamma` [rad]: it is turned by Rx(alpha) Ry(beta) Rz(gamma) (Y 6.56, 6.71).  In a
    planar rig `NAME.x`, `.z` and `.beta`.
    """

    name: str
    """Name of the platform, which anchors give to be its corners."""
    mass: float
    """Mass of the platform [kg]."""
    inertia: tuple[float, ...]
    """Moments of inertia about its own x, y and z axes through its centre of mass [kg m2], three
    principal ones, or six numbers of the tensor: xx, yy, zz, xy, xz, yz."""

    @property
    def angles(self) -> tuple[str, str, str]:
        """Names of its Bryant angles alpha, beta and gamma; in a plane it has beta alone."""
        return (f"{self.name}.alpha", f"{self.name}.beta", f"{self.name}.gamma")


@dataclass(frozen=True)
class Combination(Part):
    """A weighted sum of coordinates that a reference can prescribe; it is an output by its name."""

    name: str
    """Name of the sum, which `Rig.outputs` gives."""
    of: tuple[str, ...]
    """Names of the coordinates that are summed, none of them an angle."""
    factors: tuple[float, ...]
    """Factor of each of these coordinates [1]."""


@dataclass(frozen=True)
class Sheave(Part):
    """A pulley with inertia at an inner point of a rope's path."""

    at: str
    """Name of the point in the rope's path at which it turns."""
    inertia: float
    """Moment of inertia about its axle [kg m2]."""
    radius: float
    """Radius at which the rope runs over it [m]."""


@dataclass(frozen=True)
class Rope(Part):
    """An inextensible rope from a winch at `path[0]` through points to its end at `path[-1]`.

    Coordinates: `NAME.length`, the whole length [m], and for a path of more than two points
    `NAME.span1`, `NAME.span2`, ..., the lengths of all spans but one: the last, or the one before
    it if the rope comes to its last span over a free pulley's sheave with inertia.
    """

    name: str
    """Name of the rope."""
    path: tuple[str, ...]
    """Names of the anchors, trolleys and loads that it runs through, two or more, from the winch
    to its end."""
    drum_radius: float
    """Radius of the winch's drum [m]."""
    winch_inertia: float
    """Moment of inertia of the winch with its motor [kg m2]."""
    sheaves: tuple[Sheave, ...] = ()
    """Pulleys with inertia that it runs over; all other inner points of its path turn freely."""
    falls: int = 1
    """Number of parallel parts of the last span, which then ends at a block: it shortens by one
    metre when the winch takes in `falls` metres, and pulls `falls` times as hard."""
    friction: Friction = FRICTIONLESS
    """Friction of the winch, along the rope where it leaves the drum [N], [N s/m]."""
    shortest: float = 0.0
    """Least whole length [m]."""
    longest: float = field(default=math.inf, metadata=ENDLESS)
    """Largest whole length, all that the drum has [m]."""
    two_block: float = 0.0
    """Length of the last span at which its end meets the point that it hangs from [m]."""
    pushes: bool = False
    """Whether it can push as well as pull: a hydraulic cylinder or a rack in place of a rope."""

    @property
    def coordinate(self) -> str:
        """Name of the coordinate that is its whole length."""
        return f"{self.name}.length"

    @property
    def inertia_along(self) -> float:
        """Inertia that the winch adds along the rope, J/r^2 [kg]."""
        return self.winch_inertia / self.drum_radius**2

    def after(self, sheave: Sheave) -> int:
        """Index in `path` of a sheave's point, which is never the winch."""
        return self.path.index(sheave.at, 1)


@dataclass(frozen=True)
class Drive(Part):
    """An input: a torque on a turning frame or a rope's winch, a force on a slide or trolley.

    All its limits are those of its motor, which stands before the gear.
    """

    name: str
    """Name of the drive and of its input."""
    on: str
    """Name of the frame, trolley or rope that it acts on."""
    limit: float
    """Highest input [N] or [N m]; with `lower` left out also the largest magnitude."""
    lower: float | None = None
    """Lowest input [N] or [N m]; `-limit` if left out.  A winch that hoists has a negative one."""
    speed: float = field(default=math.inf, metadata=ENDLESS)
    """Largest speed [m/s] or [rad/s]; a winch's is that of its motor, not of the rope."""
    acceleration: float = field(default=math.inf, metadata=ENDLESS)
    """Largest acceleration [m/s2] or [rad/s2]."""
    power: float = field(default=math.inf, metadata=ENDLESS)
    """Largest power, delivered or taken up [W]."""
    rate: float = field(default=math.inf, metadata=ENDLESS)
    """Largest rate of change of the input [N/s] or [N m/s]."""
    gear: float = 1.0
    """Turns of the motor for one of the drum or frame, or its way for one metre of a slide's [1];
    inertias of the description are those behind the gear, the motor's part times its square."""
    efficiency: float = 1.0
    """Share of the power that passes the gear, either way [1]."""

    @property
    def lowest(self) -> float:
        """Lowest input [N] or [N m]."""
        return -self.limit if self.lower is None else self.lower

    @property
    def largest(self) -> float:
        """Largest magnitude of the input [N] or [N m], which scales the environments' actions."""
        return self.limit if self.lower is None else max(abs(self.limit), abs(self.lower))
