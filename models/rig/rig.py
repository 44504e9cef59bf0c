"""What a rig is: frames, rails, masses and ropes, and what drives and describes them.

A `Rig` is plain data in the words of the field.  The planar overhead crane is

    Rig(
        name="overhead_crane",
        dimensions=2,
        rails=(Rail("beam", direction=(1, 0, 0)),),
        masses=(Trolley("trolley", mass=10.0, rail="beam"), Load("load", mass=100.0)),
        ropes=(Rope("hoist", path=("trolley", "load"), drum_radius=0.1, winch_inertia=0.1),),
        drives=(Drive("trolley", on="trolley", limit=1e3), Drive("winch", on="hoist", limit=2e2)),
        outputs=("load.x", "load.z"),
        home={"trolley": 0.0, "load": (0.0, 0.0, -4.0)},
    )

Everything is checked on construction; a `RigError` says in one line what is wrong.
Units are SI, z points up, a rope's length grows when its winch pays out, and a winch's
torque is positive when it pays out.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, TypeVar, cast

from ..errors import RigError, did_you_mean
from ..values import Home, Vector, clean
from .parts import (
    WORLD,
    Anchor,
    Combination,
    Drive,
    Frame,
    Load,
    Platform,
    Rail,
    Rope,
    Sheave,
    Trolley,
)
from .validation import validate

__all__ = [
    "WORLD",
    "Anchor",
    "Combination",
    "Drive",
    "Frame",
    "Home",
    "Load",
    "Platform",
    "Rail",
    "Rig",
    "Rope",
    "Sheave",
    "Trolley",
    "Vector",
]


@dataclass(frozen=True)
class Rig:
    """A crane: its parts, its inputs, and the coordinates that a reference path prescribes.

    Parameters are checked on construction.

    Raises
    ------
    RigError
        A value or a name is wrong; the message says which and what would be right.
    """

    name: str
    masses: tuple[Trolley | Load | Platform, ...]
    ropes: tuple[Rope, ...]
    drives: tuple[Drive, ...]
    outputs: tuple[str, ...]
    """Coordinates and combinations that a reference prescribes, in the order of its columns."""
    frames: tuple[Frame, ...] = ()
    anchors: tuple[Anchor, ...] = ()
    rails: tuple[Rail, ...] = ()
    combinations: tuple[Combination, ...] = ()
    home: Mapping[str, float | Vector] = Home({})
    """A configuration at rest: angle [rad] or position [m] of each frame and trolley (0 if
    left out), (x, y, z) [m] of each load and of each platform, which is upright.  It fixes the
    branch of the equations' solutions."""
    dimensions: Literal[2, 3] = 3
    """2: everything stays in the plane y = 0."""
    gravity: float = 9.81
    """[m/s2], along -z."""

    def __post_init__(self) -> None:
        clean(self)
        object.__setattr__(self, "masses", (*self.trolleys, *self.loads, *self.platforms))
        validate(self)

    @cached_property
    def input_names(self) -> tuple[str, ...]:
        """Names of the inputs, in the order of `drives`."""
        return tuple(drive.name for drive in self.drives)

    @cached_property
    def rope_names(self) -> tuple[str, ...]:
        """Names of the ropes."""
        return tuple(rope.name for rope in self.ropes)

    @property
    def axes(self) -> str:
        """Letters of the axes in which loads move: "xz" or "xyz"."""
        return "xz" if self.dimensions == 2 else "xyz"

    @cached_property
    def coordinate_names(self) -> tuple[str, ...]:
        """Names of the coordinates: of frames, trolleys, ropes, loads, platforms."""
        names = [frame.coordinate for frame in self.frames]
        names += [mass.coordinate for mass in self.trolleys]
        names += [rope.coordinate for rope in self.ropes]
        names += [f"{load.name}.{axis}" for load in self.loads for axis in self.axes]
        for platform in self.platforms:
            names += [f"{platform.name}.{axis}" for axis in "xyz"]
            names += platform.angles
        return tuple(names)

    @property
    def trolleys(self) -> tuple[Trolley, ...]:
        """The masses on rails."""
        return tuple(mass for mass in self.masses if isinstance(mass, Trolley))

    @property
    def loads(self) -> tuple[Load, ...]:
        """The free masses."""
        return tuple(mass for mass in self.masses if isinstance(mass, Load))

    @property
    def platforms(self) -> tuple[Platform, ...]:
        """The rigid bodies that hang from ropes."""
        return tuple(mass for mass in self.masses if isinstance(mass, Platform))

    @property
    def weight(self) -> float:
        """Of all loads and platforms [N]."""
        loads: tuple[Load | Platform, ...] = (*self.loads, *self.platforms)
        return self.gravity * sum(part.mass for part in loads)

    def platform(self, name: str) -> Platform | None:
        """The platform of that name, if there is one."""
        return next((part for part in self.platforms if part.name == name), None)

    def frame(self, name: str) -> Frame | None:
        """The frame of that name; None for the world.

        Raises
        ------
        RigError
            There is none.
        """
        return None if name == WORLD else _named("frame", self.frames, name)

    def rail(self, name: str) -> Rail:
        """The rail of that name.

        Raises
        ------
        RigError
            There is none.
        """
        return _named("rail", self.rails, name)

    def driven(self, drive: Drive) -> Frame | Trolley | Rope:
        """What a drive acts on."""
        parts: tuple[Frame | Trolley | Rope, ...] = (*self.frames, *self.trolleys, *self.ropes)
        return next(part for part in parts if part.name == drive.on)

    def home_of(self, part: Frame | Trolley | Load | Platform) -> float | Vector:
        """Home value of a frame, trolley, load or platform."""
        free = isinstance(part, Load | Platform)
        return self.home.get(part.name, (0.0, 0.0, 0.0) if free else 0.0)

    def home_point(self, name: str) -> Vector:
        """Where an anchor, trolley, load or platform is at home, in the world [m]."""
        part = _named("point", (*self.anchors, *self.masses), name)
        if isinstance(part, Load | Platform):
            return cast(Vector, self.home_of(part))
        if isinstance(part, Trolley):
            rail = self.rail(part.rail)
            frame, along = self.frame(rail.frame), cast(float, self.home_of(part))
            pairs = zip(rail.origin, rail.direction, strict=True)
            x, y, z = (start + along * step for start, step in pairs)
        elif (platform := self.platform(part.frame)) is not None:
            centre = cast(Vector, self.home_of(platform))
            x, y, z = (a + b for a, b in zip(centre, part.position, strict=True))
            return (x, y, z)
        else:
            frame, (x, y, z) = self.frame(part.frame), part.position
        if frame is None:
            return (x, y, z)
        value = cast(float, self.home_of(frame))
        if frame.kind == "turning":
            cos, sin = math.cos(value), math.sin(value)
            return (cos * x - sin * y, sin * x + cos * y, z)
        a, b, c = frame.axis
        return (x + value * a, y + value * b, z + value * c)


P = TypeVar("P", Frame, Rail, Anchor | Trolley | Load | Platform)


def _named(kind: str, parts: tuple[P, ...], name: str) -> P:
    for part in parts:
        if part.name == name:
            return part
    raise RigError(f"there is no {kind} {name!r}{did_you_mean(name, [p.name for p in parts])}")
