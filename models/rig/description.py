"""The parts of a rig, and how they are found by their names."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, TypeVar

from ..errors import RigError, did_you_mean
from ..values import Home, Vector
from .link import Link
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
    Trolley,
)


@dataclass(frozen=True)
class Description:
    """What a rig consists of; `flatrig.models.Rig` checks it."""

    name: str
    """Name of the rig."""
    masses: tuple[Trolley | Load | Platform, ...]
    """Bodies that ropes move; sorted into trolleys, then loads, then platforms."""
    ropes: tuple[Rope, ...]
    """Ropes with their winches."""
    drives: tuple[Drive, ...]
    """Inputs, as many as `outputs` and tensions that `distribution` says."""
    outputs: tuple[str, ...]
    """Coordinates, combinations, and tensions of links and redundant ropes, "ROPE.tension", that a
    reference prescribes, in the order of its columns."""
    frames: tuple[Frame, ...] = ()
    """Structures that move: booms, bridges, gantries; sorted so that each follows its parent."""
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
    links: tuple[Link, ...] = ()
    """Slings, pendants, struts and beams of constant length."""
    held: tuple[str, ...] = ()
    """Coordinates of loads and platforms that symmetry keeps at home, such as that across the plane
    in which a spreader hangs, and two or all of a platform's three angles.  Their equations are
    left out, and `feedforward.solve` looks whether they hold: whether nothing would move these
    freedoms if they were let go."""
    distribution: Mapping[str, float | Vector] = Home({})
    """Tensions [N] that ropes should have at home where a load or platform has more of them than
    freedoms, 0 for those left out.  Of all tensions that make a motion those are taken whose force
    densities, tension over length, are closest to the wanted ones in the sense of least squares."""

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
            names += [f"{platform.name}.{axis}" for axis in self.axes]
            names += self.angles_of(platform)
        return tuple(names)

    @cached_property
    def tension_names(self) -> tuple[str, ...]:
        """Names of what has a tension: ropes, then links."""
        return (*self.rope_names, *(link.name for link in self.links))

    @cached_property
    def pushing(self) -> frozenset[str]:
        """Names of the ropes and links that can push as well as pull."""
        ropes = (rope.name for rope in self.ropes if rope.pushes)
        return frozenset((*ropes, *(link.name for link in self.links if link.pushes or link.mass)))

    @cached_property
    def pulling(self) -> tuple[int, ...]:
        """Columns of `tension_names` whose tensions have to be positive."""
        names = enumerate(self.tension_names)
        return tuple(column for column, name in names if name not in self.pushing)

    def spoken(self, name: str) -> str:
        """Whether it is a rope or a link, and its name."""
        return f"{'rope' if name in self.rope_names else 'link'} {name}"

    def angles_of(self, platform: Platform) -> tuple[str, ...]:
        """Names of a platform's angles: all three, or in a plane that about y alone."""
        return platform.angles if self.dimensions == 3 else (platform.angles[1],)

    def turns_of(self, platform: Platform) -> tuple[str, ...]:
        """Names of those of a platform's angles that are not held: three, one or none."""
        return tuple(angle for angle in self.angles_of(platform) if angle not in self.held)

    @property
    def platform_angles(self) -> tuple[str, ...]:
        """Names of the angles of all platforms."""
        return tuple(angle for part in self.platforms for angle in self.angles_of(part))

    @cached_property
    def angles(self) -> frozenset[str]:
        """Names of the coordinates that are angles, of frames and platforms."""
        turning = [frame.coordinate for frame in self.frames if frame.kind == "turning"]
        return frozenset((*turning, *self.platform_angles))

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
        """Weight of all loads, platforms and beams [N]."""
        beams = sum(link.mass for link in self.links)
        return self.gravity * (sum(part.mass for part in self.hanging) + beams)

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
        return None if name == WORLD else named("frame", self.frames, name)

    def rail(self, name: str) -> Rail:
        """Rail of that name.

        Raises
        ------
        RigError
            There is no rail of that name.
        """
        return named("rail", self.rails, name)

    def driven(self, drive: Drive) -> Frame | Trolley | Rope:
        """Part that a drive acts on."""
        return next(part for part in self.drivable if part.name == drive.on)

    @cached_property
    def driven_coordinates(self) -> tuple[str, ...]:
        """Name of the coordinate that each drive acts on: a length, a position or an angle."""
        return tuple(self.driven(drive).coordinate for drive in self.drives)

    def arm(self, drive: Drive) -> float:
        """What makes an input of a force on what is driven: drum radius over gear [m], or [1]."""
        part = self.driven(drive)
        return (part.drum_radius if isinstance(part, Rope) else 1.0) / drive.gear

    @property
    def drivable(self) -> tuple[Frame | Trolley | Rope, ...]:
        """What a drive can act on: frames, trolleys and ropes."""
        return (*self.frames, *self.trolleys, *self.ropes)


P = TypeVar("P", Frame, Rail, Anchor | Trolley | Load | Platform)


def named(kind: str, parts: tuple[P, ...], name: str) -> P:
    """The part of that name.

    Raises
    ------
    RigError
        There is none.
    """
    for part in parts:
        if part.name == name:
            return part
    raise RigError(f"there is no {kind} {name!r}{did_you_mean(name, [p.name for p in parts])}")
