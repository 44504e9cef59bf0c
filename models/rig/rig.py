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
from typing import Literal, TypeVar, overload

from ..errors import RigError, did_you_mean
from ..values import Home, Vector, clean, shown
from . import validation
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

    Raises
    ------
    RigError
        A value or a name is wrong; the message says which and what would be right.
    """

    name: str
    """Name of the rig."""
    masses: tuple[Trolley | Load | Platform, ...]
    """Bodies that ropes move; sorted into trolleys, then loads, then platforms."""
    ropes: tuple[Rope, ...]
    """Ropes with their winches."""
    drives: tuple[Drive, ...]
    """Inputs, as many as `outputs`."""
    outputs: tuple[str, ...]
    """Coordinates and combinations that a reference prescribes, in the order of its columns."""
    frames: tuple[Frame, ...] = ()
    """Structures that move: booms, bridges, gantries."""
    anchors: tuple[Anchor, ...] = ()
    """Points fixed in the world, in frames and in platforms."""
    rails: tuple[Rail, ...] = ()
    """Rails that trolleys run on."""
    combinations: tuple[Combination, ...] = ()
    """Weighted sums of coordinates that can be outputs."""
    home: Mapping[str, float | Vector] = Home({})
    """A configuration at rest, by the parts' names: angle [rad] or position [m] of each frame and
    trolley (0 if left out), (x, y, z) [m] of each load and of each platform, which is upright.  It
    fixes the branch of the equations' solutions."""
    dimensions: Literal[2, 3] = 3
    """Number of dimensions; with 2, everything stays in the plane y = 0."""
    gravity: float = 9.81
    """Acceleration of gravity along -z [m/s2]."""

    def __post_init__(self) -> None:
        clean(self)
        object.__setattr__(self, "masses", (*self.trolleys, *self.loads, *self.platforms))
        self._check()

    def _check(self) -> None:
        """Check the rig whole, part by part and then how the parts fit together."""
        planar = self.dimensions == 2
        bodies = (*self.frames, *self.anchors, *self.rails, *self.masses)
        parts = (*bodies, *self.ropes, *self.combinations)
        ends: tuple[Anchor | Trolley | Load, ...] = (*self.anchors, *self.trolleys, *self.loads)
        points = [end.name for end in ends]
        angles = [frame.coordinate for frame in self.frames if frame.kind == "turning"]
        angles += [angle for platform in self.platforms for angle in platform.angles]
        known = [*self.coordinate_names, *(p.name for p in self.combinations)]

        validation.check_space(self.name, self.dimensions, self.gravity)
        validation.check_names(self.name, [part.name for part in parts])
        validation.check_names(self.name, self.input_names)
        validation.check_parts(self.name, bodies, planar=planar)
        validation.check_ropes(self.ropes, points)
        validation.check_drives(self.name, self.drives, [part.name for part in self._drivable])
        validation.check_combinations(self.combinations, self.coordinate_names, angles)
        validation.check_outputs(self.name, self.outputs, known, len(self.drives))
        validation.check_home(self.home, self.frames, self.masses, planar=planar)
        for trolley in self.trolleys:
            validation.check_trolley(trolley, self.home_of(trolley), self.rail(trolley.rail))
        validation.check_spans(self.ropes, {name: self.home_point(name) for name in points})

    @cached_property
    def input_names(self) -> tuple[str, ...]:
        """Names of the inputs, in the order of `drives`."""
        return tuple(drive.name for drive in self.drives)

    @cached_property
    def rope_names(self) -> tuple[str, ...]:
        """Names of the ropes, in their order."""
        return tuple(rope.name for rope in self.ropes)

    @property
    def axes(self) -> str:
        """Letters of the axes in which loads move: "xz" or "xyz"."""
        return "xz" if self.dimensions == 2 else "xyz"

    @cached_property
    def coordinate_names(self) -> tuple[str, ...]:
        """Names of the coordinates: of frames, trolleys, ropes, loads, then platforms."""
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
        """Point masses on rails."""
        return tuple(mass for mass in self.masses if isinstance(mass, Trolley))

    @property
    def loads(self) -> tuple[Load, ...]:
        """Point masses that are free to move, free pulleys included."""
        return tuple(mass for mass in self.masses if isinstance(mass, Load))

    @property
    def platforms(self) -> tuple[Platform, ...]:
        """Rigid bodies that hang from ropes."""
        return tuple(mass for mass in self.masses if isinstance(mass, Platform))

    @property
    def hanging(self) -> tuple[Load | Platform, ...]:
        """The loads and platforms, which are free to move."""
        return (*self.loads, *self.platforms)

    @cached_property
    def pulleys(self) -> frozenset[str]:
        """Names of the anchors, trolleys and loads that some rope only passes on its way."""
        return frozenset(point for rope in self.ropes for point in rope.path[1:-1])

    @property
    def weight(self) -> float:
        """Weight of all loads and platforms [N]."""
        return self.gravity * sum(part.mass for part in self.hanging)

    def terms(self, output: str) -> tuple[tuple[float, str], ...]:
        """An output as a weighted sum of coordinates: (factor, coordinate) of each term."""
        for combination in self.combinations:
            if combination.name == output:
                return tuple(zip(combination.factors, combination.of, strict=True))
        return ((1.0, output),)

    def platform(self, name: str) -> Platform | None:
        """Platform of that name; None if there is none."""
        return next((part for part in self.platforms if part.name == name), None)

    def frame(self, name: str) -> Frame | None:
        """Frame of that name; None for the world.

        Raises
        ------
        RigError
            There is no frame of that name.
        """
        return None if name == WORLD else _named("frame", self.frames, name)

    def rail(self, name: str) -> Rail:
        """Rail of that name.

        Raises
        ------
        RigError
            There is no rail of that name.
        """
        return _named("rail", self.rails, name)

    def driven(self, drive: Drive) -> Frame | Trolley | Rope:
        """Part that a drive acts on."""
        return next(part for part in self._drivable if part.name == drive.on)

    @property
    def _drivable(self) -> tuple[Frame | Trolley | Rope, ...]:
        return (*self.frames, *self.trolleys, *self.ropes)

    @overload
    def home_of(self, part: Frame | Trolley) -> float: ...

    @overload
    def home_of(self, part: Load | Platform) -> Vector: ...

    def home_of(self, part: Frame | Trolley | Load | Platform) -> float | Vector:
        """Home value of a part: an angle [rad] or position [m], or (x, y, z) [m]."""
        free = isinstance(part, Load | Platform)
        return self.home.get(part.name, (0.0, 0.0, 0.0) if free else 0.0)

    @property
    def home_coordinates(self) -> dict[str, float]:
        """Home values [m], [rad] of all coordinates but ropes', by name."""
        values = {frame.coordinate: self.home_of(frame) for frame in self.frames}
        values |= {trolley.coordinate: self.home_of(trolley) for trolley in self.trolleys}
        for part in self.hanging:
            place = dict(zip("xyz", self.home_of(part), strict=True))
            values |= {f"{part.name}.{axis}": place[axis] for axis in self.axes}
        return values | {angle: 0.0 for part in self.platforms for angle in part.angles}

    def home_point(self, name: str) -> Vector:
        """Position in the world of an anchor, trolley, load or platform at home [m].

        Raises
        ------
        RigError
            There is no such point.
        """
        part = _named("point", (*self.anchors, *self.masses), name)
        if isinstance(part, Load | Platform):
            return self.home_of(part)
        if isinstance(part, Trolley):
            rail = self.rail(part.rail)
            frame, along = self.frame(rail.frame), self.home_of(part)
            pairs = zip(rail.origin, rail.direction, strict=True)
            x, y, z = (start + along * step for start, step in pairs)
        elif (platform := self.platform(part.frame)) is not None:
            pairs = zip(self.home_of(platform), part.position, strict=True)
            x, y, z = (a + b for a, b in pairs)
            return (x, y, z)
        else:
            frame, (x, y, z) = self.frame(part.frame), part.position
        if frame is None:
            return (x, y, z)
        value = self.home_of(frame)
        if frame.kind == "turning":
            cos, sin = math.cos(value), math.sin(value)
            return (cos * x - sin * y, sin * x + cos * y, z)
        a, b, c = frame.axis
        return (x + value * a, y + value * b, z + value * c)


def require_rig(value: object) -> Rig:
    """A rig.

    Raises
    ------
    RigError
        It is none.
    """
    if not isinstance(value, Rig):
        raise RigError(f"rig is {shown(value)}, it must be a Rig; models.make(name) makes one")
    return value


P = TypeVar("P", Frame, Rail, Anchor | Trolley | Load | Platform)


def _named(kind: str, parts: tuple[P, ...], name: str) -> P:
    for part in parts:
        if part.name == name:
            return part
    raise RigError(f"there is no {kind} {name!r}{did_you_mean(name, [p.name for p in parts])}")
