"""What must hold of a rig, checked when it is made; each check reads the parts it is given.

Raises
------
RigError
    From every check: what is wrong, in one line.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import pairwise

from ..errors import RigError, did_you_mean
from ..values import Vector
from .frame_checks import check_frame, check_tensor
from .limit_checks import check_rope_ends
from .parts import (
    WORLD,
    Anchor,
    Combination,
    Frame,
    Load,
    Platform,
    Rail,
    Rope,
    Trolley,
)

Part = Frame | Anchor | Rail | Trolley | Load | Platform | Rope | Combination
Mass = Trolley | Load | Platform


def check_space(rig: str, dimensions: int, gravity: float) -> None:
    """A rig lies in a plane or in space, and things fall in it."""
    if dimensions not in (2, 3):
        raise RigError(f"rig {rig}: dimensions is {dimensions!r}, it must be 2 or 3")
    _positive(f"rig {rig}", "gravity", gravity, "m/s2")


def check_names(rig: str, names: Sequence[str]) -> None:
    """No two parts, and no two drives, have one name."""
    for name in names:
        if name == WORLD:
            raise RigError(f"rig {rig}: the name {WORLD!r} is taken by the fixed frame")
        if names.count(name) > 1:
            raise RigError(f"rig {rig}: the name {name!r} is used twice")


def _known(what: str, name: str, known: Sequence[str]) -> None:
    if name not in known:
        raise RigError(f"{what} names {name!r}, which does not exist{did_you_mean(name, known)}")


def _positive(label: str, quantity: str, value: float, unit: str) -> None:
    if not value > 0:
        raise RigError(f"{label}: {quantity} is {value:g} {unit}, it must be > 0")


def check_parts(rig: str, parts: Sequence[Part], *, planar: bool) -> None:
    """Frames, anchors, rails and masses stand on one another, and have sizes they can have."""
    frames = [WORLD, *_names(parts, Frame)]
    for part in parts:
        label = f"{type(part).__name__.lower()} {part.name}"
        if isinstance(part, Frame):
            check_frame(label, part, frames, planar=planar)
        elif isinstance(part, Anchor):
            _known(label, part.frame, frames + _names(parts, Platform))
            _in_plane(label, part.position, planar=planar)
        elif isinstance(part, Rail):
            _known(label, part.frame, frames)
            _unit(label, "direction", part.direction)
            _in_plane(label, part.origin, planar=planar)
            _in_plane(label, part.direction, planar=planar)
            if not part.start < part.end:
                raise RigError(f"{label}: start {part.start:g} m must lie below end {part.end:g} m")
        elif isinstance(part, Trolley):
            _known(label, part.rail, _names(parts, Rail))
            _positive(label, "mass", part.mass, "kg")
        elif isinstance(part, Platform):
            _check_platform(label, part)
        elif isinstance(part, Load) and part.mass < 0:
            raise RigError(f"{label}: mass is {part.mass:g} kg, it must be >= 0")
    if not any(isinstance(part, Load | Platform) and part.mass > 0 for part in parts):
        raise RigError(f"rig {rig}: there is no load with a mass > 0")


def _names(parts: Iterable[Part], *kinds: type[Part]) -> list[str]:
    return [part.name for part in parts if isinstance(part, kinds)]


def _check_platform(label: str, platform: Platform) -> None:
    _positive(label, "mass", platform.mass, "kg")
    if len(platform.inertia) == 6:
        check_tensor(label, platform.inertia)
        return
    if len(platform.inertia) != 3:
        raise RigError(
            f"{label}: inertia has {len(platform.inertia)} numbers, it needs 3 (xx, yy, zz) or 6 "
            "(xx, yy, zz, xy, xz, yz)"
        )
    for moment in platform.inertia:
        _positive(label, "a principal moment of inertia", moment, "kg m2")
    # A flat body has the sum of two moments equal to the third, up to rounding.
    if 2 * max(platform.inertia) > sum(platform.inertia) * (1 + 1e-9):
        raise RigError(
            f"{label}: inertia is {platform.inertia}, no moment can exceed the sum of the others"
        )


def _unit(label: str, quantity: str, vector: Vector) -> None:
    # Looser than rounding, so that directions written with ten digits pass.
    if abs(math.hypot(*vector) - 1) > 1e-9:
        raise RigError(f"{label}: {quantity} is {tuple(vector)}, it must be a unit vector")


def _in_plane(label: str, vector: Vector, *, planar: bool) -> None:
    if planar and vector[1] != 0:
        raise RigError(f"{label}: y is {vector[1]:g}, a planar rig lies in the plane y = 0")


def check_ropes(ropes: Iterable[Rope], points: Sequence[str]) -> None:
    """Ropes run through points that exist, named `points`, over sheaves on their way."""
    for rope in ropes:
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
            _known(f"{label}: a sheave", sheave.at, rope.path[1:-1])
            _positive(f"{label}: the sheave at {sheave.at}", "radius", sheave.radius, "m")
            _positive(f"{label}: the sheave at {sheave.at}", "inertia", sheave.inertia, "kg m2")


def check_combinations(
    combinations: Iterable[Combination], coordinates: Iterable[str], angles: Collection[str]
) -> None:
    """Combinations weigh coordinates, none of which is one of the `angles`."""
    lengths = [name for name in coordinates if name not in angles]
    for combination in combinations:
        label, count = f"combination {combination.name}", len(combination.of)
        if not count or count != len(combination.factors):
            raise RigError(
                f"{label}: it has {count} coordinates and {len(combination.factors)} "
                "factors, it needs one factor for each coordinate"
            )
        for name in combination.of:
            if name in angles:
                raise RigError(f"{label}: {name} is an angle, it must be a length or position")
            _known(label, name, lengths)


def check_outputs(rig: str, outputs: Sequence[str], known: Sequence[str]) -> None:
    """Outputs are among what is `known`, each named once."""
    for output in outputs:
        if output not in known:
            hint = did_you_mean(output, known)
            raise RigError(f"rig {rig}: output {output!r} is not a coordinate{hint}")
        if outputs.count(output) > 1:
            raise RigError(f"rig {rig}: output {output!r} is named twice")


def check_home(
    home: Mapping[str, float | Vector],
    frames: Iterable[Frame],
    masses: Sequence[Mass],
    *,
    planar: bool,
) -> None:
    """Home names frames and masses, with a number or a point for each, and every free mass."""
    parts: dict[str, Frame | Mass] = {part.name: part for part in (*frames, *masses)}
    for name, value in home.items():
        _known("home", name, list(parts))
        moves_freely = isinstance(parts[name], Load | Platform)
        if moves_freely != isinstance(value, tuple):
            needed = "(x, y, z)" if moves_freely else "a number"
            raise RigError(f"home of {name} is {value}, it must be {needed}")
    for mass in masses:
        if isinstance(mass, Trolley):
            continue
        point = home.get(mass.name)
        if not isinstance(point, tuple):
            kind = type(mass).__name__.lower()
            raise RigError(f"home of {kind} {mass.name} is missing, give its (x, y, z)")
        _in_plane(f"home of {mass.name}", point, planar=planar)


def check_trolley(trolley: Trolley, place: float, rail: Rail) -> None:
    """A trolley at its `place` at home [m] is on its rail."""
    if not rail.start <= place <= rail.end:
        raise RigError(
            f"home of {trolley.name} is {place} m, rail {rail.name} goes from "
            f"{rail.start:g} m to {rail.end:g} m"
        )


def check_spans(ropes: Sequence[Rope], places: Mapping[str, Vector]) -> None:
    """Spans and ropes have lengths that they can have at home, where points are at `places` [m]."""
    for rope in ropes:
        for before, after in pairwise(rope.path):
            if math.dist(places[before], places[after]) == 0:
                raise RigError(f"home of rope {rope.name}: {before} and {after} coincide")
    check_rope_ends(ropes, places)
