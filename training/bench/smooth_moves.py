"""The cranes and paths of `flatrig bench feedforward`.

The paths are the catalogue's moves with `ORDER` continuous derivatives in `STRETCH` times their
duration, so that ropes stay taut and drives suffice.  The moves themselves have kinks in the
inputs at their joins, where every scheme is of order 1; these are kinder to time stepping.
"""

from dataclasses import dataclass, replace
from functools import cache, cached_property

from ...feedforward import Reference, from_move
from ...models import CATALOGUE, Move, Rig, default_move, make

ORDER, STRETCH = 10, 1.5
"""Continuous derivatives of a path, and its duration over that of the catalogue's move."""


@dataclass(frozen=True)
class Case:
    """A rig with a smooth path."""

    name: str
    """Name of the rig in the catalogue."""
    massless: bool = False
    """Whether its pulley has no mass."""

    @property
    def label(self) -> str:
        """The rig's name, and whether its pulley has no mass."""
        return f"{self.name}, massless" if self.massless else self.name

    @cached_property
    def rig(self) -> Rig:
        """The rig."""
        return make(self.name, pulley_mass=0.0) if self.massless else make(self.name)

    @cached_property
    def move(self) -> Move:
        """Its move, smoother and slower."""
        move = default_move(self.rig)
        return replace(move, profile="polynomial", order=ORDER, duration=STRETCH * move.duration)

    @cached_property
    def reference(self) -> Reference:
        """The path."""
        return from_move(self.move)


_case = cache(Case)  # so that each rig and path is made once


def cases() -> dict[str, Case]:
    """Cranes of the catalogue, then those whose pulley may be massless, by label."""
    every = [_case(name) for name in CATALOGUE]
    light = (entry.name for entry in CATALOGUE.entries if entry.without_pulley_mass)
    every += [_case(name, massless=True) for name in light]
    return {case.label: case for case in every}
