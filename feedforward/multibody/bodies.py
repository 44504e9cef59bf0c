"""A mechanism as it is described: bodies, the pairs between them, springs and drives.

A pendulum of 2 kg on a pin, released level::

    rod = Body("rod", 2.0, euler_of((0.01, 0.2, 0.2)), position=(0.5, 0.0, 0.0))
    pin = Revolute("pin", Point(GROUND), Point("rod", (-0.5, 0.0, 0.0)), axis=(0.0, 1.0, 0.0))
    swing = Angle("swing", GROUND, "rod", axis=(0.0, 1.0, 0.0))
    mechanism = Mechanism("pendulum", (rod,), (pin,), (swing,), gravity=(0.0, 0.0, -9.81))
    system, start = assemble(mechanism)

Positions have three components, or two for a planar mechanism: then a body has two directors, an
angle no axis, and a spin one component.  Every body stands where it starts; the parts' axes are
given along its directors.  `GROUND` is a body that does not move, with the world's axes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

Vector = tuple[float, ...]

GROUND = "ground"
"""Name of what does not move."""


@dataclass(frozen=True)
class Body:
    """A rigid body, or a point mass if it has no Euler tensor."""

    name: str
    """Name of the body, unique in its mechanism."""
    mass: float
    """Mass of the body [kg]."""
    euler: Vector
    """Principal values E_i of the Euler tensor, integral of X_i^2 (Y 2.39) [kg m^2]; () for a
    point mass."""
    position: Vector
    """Position of the centre of mass at the start [m]."""
    rotation: tuple[Vector, ...] = ()
    """Rows of the rotation matrix at the start, whose columns are the directors; () is upright."""
    velocity: Vector = ()
    """Velocity of the centre of mass at the start [m/s]; () is at rest."""
    spin: Vector = ()
    """Angular velocity at the start in world axes [rad/s]; () is none."""


@dataclass(frozen=True)
class Point:
    """A material point of a body."""

    body: str
    """Name of the body, or `GROUND`."""
    at: Vector = ()
    """Components along the directors, from the centre of mass (of the ground, from the origin) [m];
    () is that centre itself."""


@dataclass(frozen=True)
class Pair:
    """A part between points of two bodies."""

    name: str
    """Name of the part, unique in its mechanism."""
    first: Point
    """Point of the first body."""
    second: Point
    """Point of the second body."""


@dataclass(frozen=True)
class Spherical(Pair):
    """A ball joint: two points coincide."""


@dataclass(frozen=True)
class Revolute(Pair):
    """A pin: two points coincide, and in space the bodies share an axis (Y 2.70)."""

    axis: Vector = ()
    """Axis fixed in the first body; () in the plane."""


@dataclass(frozen=True)
class Prismatic(Pair):
    """A guide: the second point stays on a line of the first body, which does not turn (Y 2.72)."""

    axis: Vector
    """Direction of the line, fixed in the first body."""


@dataclass(frozen=True)
class Angle:
    """The angle of the second body against the first as a coordinate of its own (Y 2.3.5)."""

    name: str
    """Name of the coordinate."""
    first: str
    """Name of the first body, or `GROUND`."""
    second: str
    """Name of the second body."""
    axis: Vector = ()
    """Axis fixed in both bodies; () in the plane."""


@dataclass(frozen=True)
class Slide(Pair):
    """The distance of two points along an axis as a coordinate of its own (Y 2.106)."""

    axis: Vector
    """Axis fixed in the first point's body."""


@dataclass(frozen=True)
class Rope(Pair):
    """A taut rope between two points, wound on a drum that an angle turns (Y 2.101)."""

    angle: str
    """Name of the angle whose increase pays the rope out; it starts at zero."""
    radius: float
    """Radius of the drum [m]."""


@dataclass(frozen=True)
class Spring(Pair):
    """A spring between two points."""

    stiffness: float
    """Stiffness of the spring [N/m]."""
    length: float
    """Length without force [m]."""


@dataclass(frozen=True)
class Effort:
    """A constant torque [N m] on an angle, or force [N] on a slide."""

    on: str
    """Name of the angle or slide."""
    value: float
    """Torque [N m] or force [N]."""


Joint = Spherical | Revolute | Prismatic | Rope
Augmentation = Angle | Slide


@dataclass(frozen=True)
class Mechanism:
    """Bodies and what joins them."""

    name: str
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...] = ()
    augmentations: tuple[Augmentation, ...] = ()
    springs: tuple[Spring, ...] = ()
    efforts: tuple[Effort, ...] = ()
    gravity: Vector = ()
    """Gravitational acceleration [m/s^2]; () is none."""


def euler_of(inertia: Sequence[float]) -> Vector:
    """Principal values of the Euler tensor from the three principal inertias (Y 2.123)."""
    half = 0.5 * sum(inertia)
    return tuple(half - value for value in inertia)


def planar(angle: float) -> tuple[Vector, ...]:
    """Rows of the rotation matrix of a planar body at an angle [rad]."""
    cos, sin = float(np.cos(angle)), float(np.sin(angle))
    return ((cos, -sin), (sin, cos))
