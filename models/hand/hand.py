"""What a rolling-contact hand is: fingers that hold a round object, as plain data in SI units.

    tip = Tip(radius=0.02, axes=((1, 0, 0), (0, 1, 0)))
    finger = Finger("thumb", tip, contact=(-0.6, 0.35, -0.7))
    hand = Hand("mine", HeldObject("sphere", radius=0.1, mass=0.2), (finger, ...), friction=0.8)

Every finger ends in a flat plate or a spherical tip and moves along slides; a plate never turns,
a tip is fixed or turned about axes that do not turn with it (K 2.1.7).  The object is a sphere,
or in a planar hand a disc in the vertical plane y = 0.  Contacts are points: they transmit forces
and no moments.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..errors import RigError, did_you_mean
from ..values import Vector, number, plain_name, sequence, vector, word

EVERY_WAY: tuple[Vector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
"""Slides of a finger that moves in space."""
IN_PLANE: tuple[Vector, ...] = (EVERY_WAY[0], EVERY_WAY[2])
"""Slides of a finger of a planar hand."""
ROUNDED = 4e-16
"""How far from 1 a unit vector's length may round; such are left as they are, to be read again."""
TAKEN = ("object", "world", "floor")
"""Names that no finger can have, since models give them to other things."""
SOLID = {"sphere": 0.4, "disc": 0.5}
"""Moment of inertia over mass times squared radius, about the axis it turns about."""


def _positive(label: str, value: object, *, endless: bool = False) -> float:
    plain = number(label, value, endless=endless)
    if plain <= 0.0:
        raise RigError(f"{label} is {plain:g}, it must be > 0")
    return plain


def unit(label: str, value: object) -> Vector:
    """The direction of a vector.

    Raises
    ------
    RigError
        It is not three finite numbers, or zero.
    """
    x, y, z = vector(label, value)
    length = math.hypot(x, y, z)
    if length == 0.0:
        raise RigError(f"{label} is (0, 0, 0), it must point somewhere")
    if abs(length - 1.0) <= ROUNDED:
        return (x, y, z)
    return (x / length, y / length, z / length)


def _directions(label: str, values: object) -> tuple[Vector, ...]:
    """Unit vectors that are perpendicular to each other."""
    units = tuple(unit(label, value) for value in sequence(label, values))
    # Rounding of directions written with ten digits passes.
    if units and np.abs(np.array(units) @ np.array(units).T - np.eye(len(units))).max() > 1e-9:
        raise RigError(f"{label} are {units}, they must be perpendicular")
    return units


def _name(label: str, value: object) -> str:
    """A plain word, as a name in a rig."""
    plain = plain_name(label, value)
    if plain in TAKEN:
        raise RigError(f"{label} is {plain!r}, which is taken; choose another")
    return plain


@dataclass(frozen=True)
class HeldObject:
    """The manipulated object: a homogeneous sphere or disc unless `inertia` says otherwise.

    Raises
    ------
    RigError
        The shape is unknown, or a number is not positive.
    """

    shape: Literal["sphere", "disc"]
    """Shape of the object: a `sphere`, or a `disc` in a planar hand."""
    radius: float
    """Radius of the object [m]."""
    mass: float
    """Mass of the object [kg]."""
    inertia: float = 0.0
    """Moment of inertia about every axis of a sphere, or the disc's axis [kg m2]; 0 stands for
    that of a homogeneous object."""

    def __post_init__(self) -> None:
        if word("object: shape", self.shape) not in SOLID:
            raise RigError(f"object: shape is {self.shape!r}{did_you_mean(self.shape, SOLID)}")
        for name in ("radius", "mass"):
            object.__setattr__(self, name, _positive(f"object: {name}", getattr(self, name)))
        solid = SOLID[self.shape] * self.mass * self.radius**2
        inertia = number("object: inertia", self.inertia)
        object.__setattr__(self, "inertia", _positive("object: inertia", inertia or solid))


@dataclass(frozen=True)
class Plate:
    """A flat, round fingertip, whose middle is its finger's position.

    Raises
    ------
    RigError
        The normal is zero, or the radius is not positive.
    """

    normal: Vector
    """Direction of the normal towards the object, made a unit vector."""
    radius: float = math.inf
    """Radius of the plate [m]."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "normal", unit("plate: normal", self.normal))
        radius = _positive("plate: radius", self.radius, endless=True)
        object.__setattr__(self, "radius", radius)


@dataclass(frozen=True)
class Tip:
    """A spherical fingertip, whose centre is its finger's position.

    Raises
    ------
    RigError
        A number is not positive, or the axes are not perpendicular.
    """

    radius: float
    """Radius of the sphere [m]."""
    axes: tuple[Vector, ...] = ()
    """Perpendicular axes that motors turn it about, made unit vectors and fixed in space as those
    of rollers on a trackball: none for a fixed tip, two as K's (2.1.7), three for any turn."""
    inertia: float = 1e-5
    """Moment of inertia of the tip with its motors about any axis [kg m2]."""
    reach: float = math.pi
    """Largest angle on a fixed tip from its contact at home to any contact [rad]."""
    torque_limit: float = 1.0
    """Largest torque of each motor [N m]."""

    def __post_init__(self) -> None:
        for name in ("radius", "inertia", "reach", "torque_limit"):
            object.__setattr__(self, name, _positive(f"tip: {name}", getattr(self, name)))
        object.__setattr__(self, "axes", _directions("tip: axes", self.axes))
        if len(self.axes) == 1:
            raise RigError("tip: axes has one axis, a tip needs none, two or three")


@dataclass(frozen=True)
class Finger:
    """A finger that moves along slides and ends in a plate or a spherical tip.

    Raises
    ------
    RigError
        A field has a value that it cannot have.
    """

    name: str
    """Name of the finger."""
    surface: Plate | Tip
    """What the finger ends in."""
    contact: Vector = (0.0, 0.0, 0.0)
    """Direction from the object's centre to a tip's contact at home, made a unit vector; a plate's
    is set to minus its normal."""
    slides: tuple[Vector, ...] = EVERY_WAY
    """Perpendicular directions of its slides, with one motor each, made unit vectors."""
    masses: tuple[float, ...] = ()
    """Mass that each slide moves [kg]; 0.1 kg each if left out."""
    force_limit: float = 50.0
    """Largest force of each slide's motor [N]."""

    def __post_init__(self) -> None:
        label = f"finger {_name('finger: name', self.name)}"
        if not isinstance(self.surface, Plate | Tip):
            raise RigError(f"{label}: surface is {self.surface!r}, it must be a Plate or a Tip")
        if isinstance(self.surface, Plate):
            x, y, z = self.surface.normal
            object.__setattr__(self, "contact", (-x, -y, -z))
        object.__setattr__(self, "contact", unit(f"{label}: contact", self.contact))
        slides = _directions(f"{label}: slides", self.slides)
        entries = sequence(f"{label}: masses", self.masses) or (0.1,) * len(slides)
        masses = tuple(_positive(f"{label}: masses", entry) for entry in entries)
        if len(masses) != len(slides) or not slides:
            raise RigError(f"{label} has {len(slides)} slides and {len(masses)} masses")
        limit = _positive(f"{label}: force_limit", self.force_limit)
        for name, value in (("slides", slides), ("masses", masses), ("force_limit", limit)):
            object.__setattr__(self, name, value)


@dataclass(frozen=True)
class Hand:
    """Fingers about an object, and where they hold it at home: upright at `position`.

    Raises
    ------
    RigError
        The parts do not fit together; the message names the finger.
    """

    name: str
    """Name of the hand."""
    held: HeldObject
    """Object that the fingers hold."""
    fingers: tuple[Finger, ...]
    """Fingers, one or more, in the order of all arrays."""
    friction: float = 1.0
    """Coulomb's coefficient of friction at every contact [1]."""
    planar: bool = False
    """Whether everything moves in the plane y = 0."""
    spin: bool = True
    """Whether the object may spin about the normal common to all contacts (K 2.14)."""
    position: Vector = (0.0, 0.0, 0.0)
    """Position of the object's centre at home [m]."""
    gravity: Vector = (0.0, 0.0, -9.81)
    """Acceleration of gravity [m/s2]."""

    def __post_init__(self) -> None:
        _name("hand: name", self.name)
        if not isinstance(self.held, HeldObject):
            raise RigError(f"hand {self.name}: held is {self.held!r}, it must be a HeldObject")
        for name in ("planar", "spin"):
            if not isinstance(flag := getattr(self, name), bool):
                raise RigError(f"hand {self.name}: {name} is {flag!r}, it must be True or False")
        fingers = sequence(f"hand {self.name}: fingers", self.fingers)
        if not fingers or not all(isinstance(finger, Finger) for finger in fingers):
            raise RigError(f"hand {self.name}: fingers must be one Finger or more")
        object.__setattr__(self, "fingers", fingers)
        friction = _positive(f"hand {self.name}: friction", self.friction)
        object.__setattr__(self, "friction", friction)
        for name in ("position", "gravity"):
            object.__setattr__(self, name, vector(f"hand {self.name}: {name}", getattr(self, name)))
        if len(set(self.finger_names)) < len(fingers):
            raise RigError(f"hand {self.name}: fingers {self.finger_names} must differ in name")
        if (self.held.shape == "disc") != self.planar:
            raise RigError(f"hand {self.name}: a disc needs a planar hand, a sphere one in space")
        for finger in fingers:
            self._check(finger)

    def _check(self, finger: Finger) -> None:
        label = f"hand {self.name}: finger {finger.name}"
        plane = (*finger.slides, finger.contact)
        if self.planar and any(abs(direction[1]) > 1e-9 for direction in plane):
            raise RigError(f"{label} must slide and touch in the plane y = 0 of a planar hand")
        needed = 2 if self.planar else 3
        if isinstance(finger.surface, Tip) and len(finger.slides) < needed:
            raise RigError(
                f"{label} has a round tip and {len(finger.slides)} slides, it needs {needed}"
            )
        if self.planar and isinstance(finger.surface, Tip) and finger.surface.axes:
            raise RigError(f"{label} has a turning tip, a planar hand's are fixed")

    @property
    def finger_names(self) -> tuple[str, ...]:
        """Names of the fingers, in the order of all arrays."""
        return tuple(finger.name for finger in self.fingers)

    def finger(self, name: str) -> Finger:
        """Finger of that name.

        Raises
        ------
        RigError
            There is no finger of that name.
        """
        if name not in self.finger_names:
            known = did_you_mean(name, self.finger_names)
            raise RigError(f"hand {self.name} has no finger {name!r}{known}")
        return self.fingers[self.finger_names.index(name)]
