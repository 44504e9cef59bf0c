"""What must hold of drives, of what rubs and of the ends of ropes, checked when a rig is made.

Raises
------
RigError
    From every check: what is wrong, in one line.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import pairwise

from ..errors import RigError, did_you_mean
from ..friction import Friction
from ..values import Vector
from .parts import Drive, Frame, Load, Rope, Trolley

Drivable = Frame | Trolley | Rope


def check_drives(
    rig: str, drives: Sequence[Drive], parts: Sequence[Drivable], loads: Iterable[Load]
) -> None:
    """Drives act on parts that exist, each on one of its own; limits and friction are possible."""
    driven = [part.name for part in parts]
    for drive in drives:
        label = f"drive {drive.name}"
        if drive.on not in driven:
            hint = did_you_mean(drive.on, driven)
            raise RigError(f"{label} names {drive.on!r}, which does not exist{hint}")
        _check_limits(label, drive)
    for name in driven:
        if [drive.on for drive in drives].count(name) > 1:
            raise RigError(f"rig {rig}: two drives act on {name!r}")
    _check_friction(driven={drive.on for drive in drives}, parts=parts, loads=loads)


def _check_limits(label: str, drive: Drive) -> None:
    if drive.lower is None:
        _positive(label, "limit", drive.limit, "N or N m")
    elif not drive.lower < drive.limit:
        raise RigError(
            f"{label}: lower is {drive.lower:g} N or N m, it must be below limit {drive.limit:g}"
        )
    _positive(label, "speed", drive.speed, "m/s or rad/s")
    _positive(label, "acceleration", drive.acceleration, "m/s2 or rad/s2")
    _positive(label, "power", drive.power, "W")
    _positive(label, "rate", drive.rate, "N/s or N m/s")
    _positive(label, "gear", drive.gear, "")
    if not 0 < drive.efficiency <= 1:
        raise RigError(f"{label}: efficiency is {drive.efficiency:g}, it must be > 0 and at most 1")


def _positive(label: str, quantity: str, value: float, unit: str) -> None:
    if not value > 0:
        raise RigError(f"{label}: {quantity} is {f'{value:g} {unit}'.strip()}, it must be > 0")


def _check_friction(
    driven: Collection[str], parts: Iterable[Drivable], loads: Iterable[Load]
) -> None:
    """What rubs has a law that a description can have; dry friction acts on what is driven."""
    for part in parts:
        label, law = f"{type(part).__name__.lower()} {part.name}", part.friction
        if law != Friction(law.coulomb, law.viscous):
            raise RigError(
                f"{label}: friction has a static or smoothed part, a description takes coulomb and "
                "viscous alone; static friction belongs to the scenarios of environments"
            )
        if law.coulomb and part.name not in driven:
            raise RigError(
                f"{label}: coulomb friction is {law.coulomb:g} N on what no drive acts on, where "
                "it is no smooth term of the equations; give viscous friction alone, or a drive"
            )
    for load in loads:
        if load.drag < 0:
            raise RigError(f"load {load.name}: drag is {load.drag:g} N s/m, it must be >= 0")
        if load.drag and not load.mass:
            raise RigError(
                f"load {load.name}: drag is {load.drag:g} N s/m on a pulley without mass, whose "
                "place follows from statics; give it a mass or no drag"
            )


def check_rope_ends(ropes: Iterable[Rope], places: Mapping[str, Vector]) -> None:
    """Ropes have lengths at home that they can have, where points are at `places` [m]."""
    for rope in ropes:
        label = f"rope {rope.name}"
        for quantity in ("shortest", "two_block"):
            value = getattr(rope, quantity)
            if value < 0:
                raise RigError(f"{label}: {quantity} is {value:g} m, it must be >= 0")
        if not rope.shortest < rope.longest:
            raise RigError(
                f"{label}: shortest {rope.shortest:g} m must lie below longest {rope.longest:g} m"
            )
        *before, last = (math.dist(places[a], places[b]) for a, b in pairwise(rope.path))
        whole = sum(before) + rope.falls * last
        if not rope.shortest <= whole <= rope.longest:
            raise RigError(
                f"home of {label} is {whole:g} m long, its lengths go from {rope.shortest:g} m to "
                f"{rope.longest:g} m"
            )
        if last < rope.two_block:
            raise RigError(
                f"home of {label}: its last span is {last:g} m, its blocks meet at "
                f"two_block = {rope.two_block:g} m"
            )
