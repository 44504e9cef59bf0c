"""What must hold of a rig, checked when it is made."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

from ..errors import RigError, did_you_mean
from ..values import Vector
from .parts import WORLD, Anchor, Combination, Frame, Load, Platform, Rail, Rope, Trolley

if TYPE_CHECKING:
    from .rig import Rig


def validate(rig: "Rig") -> None:
    """Check a rig whole.

    Raises
    ------
    RigError
        What is wrong, in one line.
    """
    if rig.dimensions not in (2, 3):
        raise RigError(f"rig {rig.name}: dimensions is {rig.dimensions!r}, it must be 2 or 3")
    _positive(f"rig {rig.name}", "gravity", rig.gravity, "m/s2")
    _check_names(rig)
    _check_parts(rig)
    _check_ropes(rig)
    _check_drives(rig)
    _check_outputs(rig)
    _check_home(rig)


def _parts(
    rig: "Rig",
) -> Iterator[Frame | Anchor | Rail | Trolley | Load | Platform | Rope | Combination]:
    yield from (*rig.frames, *rig.anchors, *rig.rails, *rig.masses, *rig.ropes, *rig.combinations)


def _check_names(rig: "Rig") -> None:
    """Parts have names of their own, drives too; a name is a plain word."""
    for owners in ([part.name for part in _parts(rig)], [drive.name for drive in rig.drives]):
        for name in owners:
            if not name.replace("_", "a").replace("-", "a").isalnum():
                raise RigError(
                    f"rig {rig.name}: name {name!r} must be letters, digits, '-' and '_' only"
                )
            if name == WORLD:
                raise RigError(f"rig {rig.name}: the name {WORLD!r} is taken by the fixed frame")
            if owners.count(name) > 1:
                raise RigError(f"rig {rig.name}: the name {name!r} is used twice")


def _known(what: str, name: str, known: list[str]) -> None:
    if name not in known:
        raise RigError(f"{what} names {name!r}, which does not exist{did_you_mean(name, known)}")


def _positive(label: str, quantity: str, value: float, unit: str) -> None:
    if not value > 0:
        raise RigError(f"{label}: {quantity} is {value:g} {unit}, it must be > 0")


def _check_parts(rig: "Rig") -> None:
    frames = [WORLD, *(frame.name for frame in rig.frames)]
    platforms = [platform.name for platform in rig.platforms]
    for frame in rig.frames:
        if frame.kind not in ("turning", "sliding"):
            raise RigError(
                f"frame {frame.name}: kind is {frame.kind!r}, it must be turning or sliding"
            )
        unit = "kg m2" if frame.kind == "turning" else "kg"
        _positive(f"frame {frame.name}", "inertia", frame.inertia, unit)
        _unit(f"frame {frame.name}", "axis", frame.axis)
        _in_plane(rig, f"frame {frame.name}", frame.axis)
        if frame.kind == "turning" and tuple(frame.axis) != (0.0, 0.0, 1.0):
            raise RigError(f"frame {frame.name}: a turning frame's axis must be (0, 0, 1)")
        if frame.kind == "turning" and rig.dimensions == 2:
            raise RigError(f"frame {frame.name}: a planar rig has no turning frame")
    for anchor in rig.anchors:
        _known(f"anchor {anchor.name}", anchor.frame, frames + platforms)
        _in_plane(rig, f"anchor {anchor.name}", anchor.position)
    for rail in rig.rails:
        _known(f"rail {rail.name}", rail.frame, frames)
        _unit(f"rail {rail.name}", "direction", rail.direction)
        _in_plane(rig, f"rail {rail.name}", rail.origin)
        _in_plane(rig, f"rail {rail.name}", rail.direction)
        if not rail.start < rail.end:
            raise RigError(
                f"rail {rail.name}: start {rail.start:g} m must lie below end {rail.end:g} m"
            )
    for mass in rig.masses:
        if isinstance(mass, Trolley):
            _known(f"trolley {mass.name}", mass.rail, [rail.name for rail in rig.rails])
            _positive(f"trolley {mass.name}", "mass", mass.mass, "kg")
        elif isinstance(mass, Platform):
            _check_platform(rig, mass)
        elif mass.mass < 0:
            raise RigError(f"load {mass.name}: mass is {mass.mass:g} kg, it must be >= 0")
    if not rig.weight > 0:
        raise RigError(f"rig {rig.name}: there is no load with a mass > 0")


def _check_platform(rig: "Rig", platform: Platform) -> None:
    label = f"platform {platform.name}"
    _positive(label, "mass", platform.mass, "kg")
    for moment in platform.inertia:
        _positive(label, "a principal moment of inertia", moment, "kg m2")
    # A flat body has the sum of two moments equal to the third, up to rounding.
    if 2 * max(platform.inertia) > sum(platform.inertia) * (1 + 1e-9):
        raise RigError(
            f"{label}: inertia is {platform.inertia}, no moment can exceed the sum of the others"
        )
    if rig.dimensions == 2:
        raise RigError(f"{label}: a planar rig has no platform; take 3 dimensions")


def _unit(label: str, quantity: str, vector: Vector) -> None:
    if abs(math.hypot(*vector) - 1) > 1e-9:
        raise RigError(f"{label}: {quantity} is {tuple(vector)}, it must be a unit vector")


def _in_plane(rig: "Rig", label: str, vector: Vector) -> None:
    if rig.dimensions == 2 and vector[1] != 0:
        raise RigError(f"{label}: y is {vector[1]:g}, a planar rig lies in the plane y = 0")


def _check_ropes(rig: "Rig") -> None:
    ends: tuple[Anchor | Trolley | Load, ...] = (*rig.anchors, *rig.trolleys, *rig.loads)
    points = [part.name for part in ends]
    for rope in rig.ropes:
        label = f"rope {rope.name}"
        if len(rope.path) < 2:
            raise RigError(f"{label}: its path has {len(rope.path)} point, it needs 2 or more")
        for point in rope.path:
            _known(label, point, points)
        for before, after in pairwise(rope.path):
            if before == after:
                raise RigError(f"{label}: its path goes from {before!r} to itself")
        _positive(label, "drum_radius", rope.drum_radius, "m")
        _positive(label, "winch_inertia", rope.winch_inertia, "kg m2")
        if rope.falls < 1:
            raise RigError(f"{label}: falls is {rope.falls}, it must be >= 1")
        for sheave in rope.sheaves:
            if [other.at for other in rope.sheaves].count(sheave.at) > 1:
                raise RigError(f"{label}: two sheaves stand at {sheave.at!r}")
            _known(f"{label}: a sheave", sheave.at, list(rope.path[1:-1]))
            _positive(f"{label}: the sheave at {sheave.at}", "radius", sheave.radius, "m")
            _positive(f"{label}: the sheave at {sheave.at}", "inertia", sheave.inertia, "kg m2")


def _check_drives(rig: "Rig") -> None:
    driven = [part.name for part in rig.frames]
    driven += [part.name for part in rig.trolleys]
    driven += [part.name for part in rig.ropes]
    for drive in rig.drives:
        _known(f"drive {drive.name}", drive.on, driven)
        _positive(f"drive {drive.name}", "limit", drive.limit, "N or N m")
    for name in driven:
        if [drive.on for drive in rig.drives].count(name) > 1:
            raise RigError(f"rig {rig.name}: two drives act on {name!r}")


def _check_outputs(rig: "Rig") -> None:
    for combination in rig.combinations:
        _check_combination(rig, combination)
    known = [*rig.coordinate_names, *(part.name for part in rig.combinations)]
    for output in rig.outputs:
        if output not in known:
            raise RigError(
                f"rig {rig.name}: output {output!r} is not a coordinate"
                f"{did_you_mean(output, known)}"
            )
        if rig.outputs.count(output) > 1:
            raise RigError(f"rig {rig.name}: output {output!r} is named twice")
    if len(rig.outputs) != len(rig.drives):
        raise RigError(
            f"rig {rig.name}: {len(rig.outputs)} outputs for {len(rig.drives)} drives, "
            "exact feedforward needs as many of one as of the other"
        )


def _check_combination(rig: "Rig", combination: Combination) -> None:
    label = f"combination {combination.name}"
    if not combination.of or len(combination.of) != len(combination.factors):
        raise RigError(
            f"{label}: it has {len(combination.of)} coordinates and {len(combination.factors)} "
            "factors, it needs one factor for each coordinate"
        )
    angles = [frame.coordinate for frame in rig.frames if frame.kind == "turning"]
    angles += [angle for platform in rig.platforms for angle in platform.angles]
    for name in combination.of:
        if name in angles:
            raise RigError(f"{label}: {name} is an angle, it must be a length or position")
        _known(label, name, [known for known in rig.coordinate_names if known not in angles])


def _check_home(rig: "Rig") -> None:
    parts = {part.name: part for part in (*rig.frames, *rig.masses)}
    for name, value in rig.home.items():
        _known("home", name, list(parts))
        moves_freely = isinstance(parts[name], Load | Platform)
        if moves_freely != isinstance(value, tuple):
            needed = "(x, y, z)" if moves_freely else "a number"
            raise RigError(f"home of {name} is {value}, it must be {needed}")
    free: tuple[Load | Platform, ...] = (*rig.loads, *rig.platforms)
    for load in free:
        if load.name not in rig.home:
            kind = type(load).__name__.lower()
            raise RigError(f"home of {kind} {load.name} is missing, give its (x, y, z)")
        _in_plane(rig, f"home of {load.name}", rig.home_point(load.name))
    for trolley in rig.trolleys:
        rail, place = rig.rail(trolley.rail), rig.home_of(trolley)
        if not rail.start <= place <= rail.end:  # type: ignore[operator]
            raise RigError(
                f"home of {trolley.name} is {place} m, rail {rail.name} goes from "
                f"{rail.start:g} m to {rail.end:g} m"
            )
    for rope in rig.ropes:
        for before, after in pairwise(rope.path):
            if math.dist(rig.home_point(before), rig.home_point(after)) == 0:
                raise RigError(f"home of rope {rope.name}: {before} and {after} coincide")
