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
from dataclasses import dataclass
from functools import cached_property
from typing import Any, overload

from ..errors import RigError
from ..values import Home, Vector, clean, shown
from . import limit_checks, validation
from .description import Description, named
from .frames import outwards, parents_first
from .given import check_given
from .link import Link
from .link_checks import check_beams, check_held, check_links
from .open_tensions import TENSION, check_counts, check_structure, redundant_bodies
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
    "Link",
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
class Rig(Description):
    """A crane: its parts, its inputs, and the coordinates that a reference path prescribes.

    Raises
    ------
    RigError
        A value or a name is wrong; the message says which and what would be right.
    """

    def __post_init__(self) -> None:
        clean(self)
        object.__setattr__(self, "masses", (*self.trolleys, *self.loads, *self.platforms))
        object.__setattr__(self, "frames", parents_first(self.name, self.frames))
        self._check()

    def __hash__(self) -> int:
        """Of all parts, computed once: what is derived from a rig is looked up by it."""
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return super().__hash__()

    def __getstate__(self) -> dict[str, Any]:
        """Without the hash, which differs from one process to the next."""
        return {name: value for name, value in self.__dict__.items() if name != "_hash"}

    def _check(self) -> None:
        """Check the rig whole, part by part and then how the parts fit together."""
        planar = self.dimensions == 2
        bodies = (*self.frames, *self.anchors, *self.rails, *self.masses)
        parts = (*bodies, *self.ropes, *self.links, *self.combinations)
        ends: tuple[Anchor | Trolley | Load, ...] = (*self.anchors, *self.trolleys, *self.loads)
        points = [end.name for end in ends]
        known = [*self.coordinate_names, *(p.name for p in self.combinations)]
        known += [rope.name + TENSION for found in redundant_bodies(self) for rope in found.ropes]
        known += [link.name + TENSION for link in self.links]

        validation.check_space(self.name, self.dimensions, self.gravity)
        validation.check_names(self.name, [part.name for part in parts])
        validation.check_names(self.name, self.input_names)
        validation.check_parts(self.name, bodies, planar=planar)
        validation.check_ropes(self.ropes, points)
        limit_checks.check_drives(self.name, self.drives, self.drivable, self.loads)
        validation.check_combinations(self.combinations, self.coordinate_names, self.angles)
        validation.check_outputs(self.name, self.outputs, known)
        check_given(self.frames, self.drives, self.outputs)
        check_counts(self)
        validation.check_home(self.home, self.frames, self.masses, planar=planar)
        for trolley in self.trolleys:
            validation.check_trolley(trolley, self.home_of(trolley), self.rail(trolley.rail))
        places = {name: self.home_point(name) for name in points}
        validation.check_spans(self.ropes, places)
        check_links(self.links, places, {anchor.name: anchor.frame for anchor in self.anchors})
        check_beams(self)
        check_held(self)
        centres = {part.name: self.home_of(part) for part in self.hanging}
        check_structure(self, places | centres)

    @overload
    def home_of(self, part: Frame | Trolley) -> float: ...

    @overload
    def home_of(self, part: Load | Platform) -> Vector: ...

    def home_of(self, part: Frame | Trolley | Load | Platform) -> float | Vector:
        """Home value of a part: an angle [rad] or position [m], or (x, y, z) [m]."""
        free = isinstance(part, Load | Platform)
        return self.home.get(part.name, (0.0, 0.0, 0.0) if free else 0.0)

    def link_length(self, link: Link) -> float:
        """Length of a link, that at home if none is given [m]."""
        first, second = (self.home_point(end) for end in link.ends)
        return math.dist(first, second) if link.length is None else link.length

    @property
    def home_coordinates(self) -> dict[str, float]:
        """Home values [m], [rad] of all coordinates but ropes', by name."""
        values = {frame.coordinate: self.home_of(frame) for frame in self.frames}
        values |= {trolley.coordinate: self.home_of(trolley) for trolley in self.trolleys}
        for part in self.hanging:
            place = dict(zip("xyz", self.home_of(part), strict=True))
            values |= {f"{part.name}.{axis}": place[axis] for axis in self.axes}
        return values | dict.fromkeys(self.platform_angles, 0.0)

    def home_point(self, name: str) -> Vector:
        """Position in the world of an anchor, trolley, load or platform at home [m].

        Raises
        ------
        RigError
            There is no such point.
        """
        part = named("point", (*self.anchors, *self.masses), name)
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
        return outwards(self.frames, frame, self.home_of, (x, y, z))


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
