"""The catalogue of rigs, in which each registers beside the function that builds it."""

from ..errors import RigError
from ..registry import Catalogue
from .move import Move
from .rig import Rig

CATALOGUE: Catalogue[Rig, Move] = Catalogue("rig", ending="crane")
"""Every rig by its name; `flatrig.models.registry` says how one is added."""

full_name = CATALOGUE.full_name
make = CATALOGUE.make
parameters = CATALOGUE.parameters


def default_move(rig: Rig | str) -> Move:
    """A move that a rig of the catalogue can make.

    Raises
    ------
    RigError
        No rig of the catalogue is called so.
    """
    return _moves(rig)[0]


def printed_move(rig: Rig | str) -> Move:
    """The source's own move of a rig of the catalogue that cannot make it.

    Raises
    ------
    RigError
        No rig of the catalogue is called so, or its printed moves can be made.
    """
    printed = _moves(rig)[1]
    if printed is None:
        name = rig.name if isinstance(rig, Rig) else full_name(rig)
        known = " and ".join(CATALOGUE.printed)
        raise RigError(f"rig {name} has no printed move that it cannot make, only {known}")
    return printed


def _moves(rig: Rig | str) -> tuple[Move, Move | None]:
    """Default and printed move; those without pulley mass if it has their number of outputs."""
    entry = CATALOGUE.entry(rig.name if isinstance(rig, Rig) else rig)
    other = entry.without_pulley_mass
    if other is not None and isinstance(rig, Rig) and len(other[0].start) == len(rig.outputs):
        return other
    return entry.move, entry.printed
