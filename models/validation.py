"""What must hold of a rig, checked when it is made."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

from .errors import RigError, did_you_mean
from .parts import WORLD, Anchor, Frame, Load, Rail, Rope, Trolley
from .values import Vector

if TYPE_CHECKING:
    from .rig import Rig


def validate(rig: "Rig") -> None:
    """Check a rig whole.

    Raises:
        RigError: what is wrong, in one line.
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


def _parts(rig: "Rig") -> Iterator[Frame | Anchor | Rail | Trolley | Load | Rope]:
    yield from (*rig.frames, *rig.anchors, *rig.rails, *rig.masses, *rig.ropes)


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
        _known(f"anchor {anchor.name}", anchor.frame, frames)
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
        elif mass.mass < 0:
            raise RigError(f"load {mass.name}: mass is {mass.mass:g} kg, it must be >= 0")
    if not any(load.mass > 0 for load in rig.loads):
        raise RigError(f"rig {rig.name}: there is no load with a mass > 0")


def _unit(label: str, quantity: str, vector: Vector) -> None:
    if abs(math.hypot(*vector) - 1) > 1e-9:
        raise RigError(f"{label}: {quantity} is {tuple(vector)}, it must be a unit vector")


def _in_plane(rig: "Rig", label: str, vector: Vector) -> None:
    if rig.dimensions == 2 and vector[1] != 0:
        raise RigError(f"{label}: y is {vector[1]:g}, a planar rig lies in the plane y = 0")


def _check_ropes(rig: "Rig") -> None:
    points = [part.name for part in (*rig.anchors, *rig.masses)]
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
    for output in rig.outputs:
        if output not in rig.coordinate_names:
            raise RigError(
                f"rig {rig.name}: output {output!r} is not a coordinate"
                f"{did_you_mean(output, rig.coordinate_names)}"
            )
        if rig.outputs.count(output) > 1:
            raise RigError(f"rig {rig.name}: output {output!r} is named twice")
    if len(rig.outputs) != len(rig.drives):
        raise RigError(
            f"rig {rig.name}: {len(rig.outputs)} outputs for {len(rig.drives)} drives, "
            "exact feedforward needs as many of one as of the other"
        )


def _check_home(rig: "Rig") -> None:
    parts = {part.name: part for part in (*rig.frames, *rig.masses)}
    for name, value in rig.home.items():
        _known("home", name, list(parts))
        if isinstance(parts[name], Load) != isinstance(value, tuple):
            needed = "(x, y, z)" if isinstance(parts[name], Load) else "a number"
            raise RigError(f"home of {name} is {value}, it must be {needed}")
    for load in rig.loads:
        if load.name not in rig.home:
            raise RigError(f"home of load {load.name} is missing, give its (x, y, z)")
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
