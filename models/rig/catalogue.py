"""The rigs of the sources by name, with their numbers as defaults."""

import inspect
from collections.abc import Callable
from typing import Any

from ..errors import RigError, did_you_mean
from ..values import word
from .manipulators import cable_manipulator
from .move import Move
from .moves import MASSLESS_MOVES, MOVES, PRINTED_MASSLESS_MOVES, PRINTED_MOVES
from .navy_cranes import navy_crane_2d, navy_crane_3d
from .rig import Rig
from .trolley_cranes import (
    cantilever_crane,
    extended_rotary_crane,
    gantry_crane,
    overhead_crane,
    roped_overhead_crane,
    rotary_crane,
)

CATALOGUE: dict[str, Callable[..., Rig]] = {
    "overhead_crane": overhead_crane,
    "roped_overhead_crane": roped_overhead_crane,
    "rotary_crane": rotary_crane,
    "extended_rotary_crane": extended_rotary_crane,
    "cantilever_crane": cantilever_crane,
    "gantry_crane": gantry_crane,
    "navy_crane_2d": navy_crane_2d,
    "navy_crane_3d": navy_crane_3d,
    "cable_manipulator": cable_manipulator,
}
"""Every rig by its name."""


def full_name(name: str) -> str:
    """The catalogue's name for a name that may be short or hyphenated ("overhead", "navy-2d").

    Raises
    ------
    RigError
        No rig of the catalogue is called so.
    """
    plain = word("the name of a rig", name).replace("-", "_").lower()
    for known in CATALOGUE:
        if plain in (known, known.replace("_crane", "")):
            return known
    raise RigError(f"there is no rig {name!r} in the catalogue{did_you_mean(plain, CATALOGUE)}")


def make(name: str, **overrides: Any) -> Rig:
    """A rig of the catalogue by name, with some of its numbers replaced.

    Raises
    ------
    RigError
        The name or an override is unknown, or a number is wrong.
    """
    build = CATALOGUE[full_name(name)]
    known = inspect.signature(build).parameters
    for key in overrides:
        if key not in known:
            raise RigError(f"{full_name(name)} has no parameter {key!r}{did_you_mean(key, known)}")
    return build(**overrides)


def default_move(rig: Rig | str) -> Move:
    """A move that a rig of the catalogue can make.

    Raises
    ------
    RigError
        No rig of the catalogue is called so.
    """
    name = full_name(rig.name if isinstance(rig, Rig) else rig)
    return (MASSLESS_MOVES if _massless(name, rig) else MOVES)[name]


def printed_move(rig: Rig | str) -> Move:
    """The source's own move of a rig of the catalogue that cannot make it.

    Raises
    ------
    RigError
        No rig of the catalogue is called so, or its printed moves can be made.
    """
    name = full_name(rig.name if isinstance(rig, Rig) else rig)
    moves = PRINTED_MASSLESS_MOVES if _massless(name, rig) else PRINTED_MOVES
    if name not in moves:
        known = " and ".join(moves)
        raise RigError(f"rig {name} has no printed move that it cannot make, only {known}")
    return moves[name]


def _massless(name: str, rig: Rig | str) -> bool:
    """Whether it is a Navy crane without the rope that a heavy pulley hangs on."""
    return isinstance(rig, Rig) and name in MASSLESS_MOVES and len(rig.ropes) == 2
