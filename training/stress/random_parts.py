"""Parts of rigs, drawn at random about one crane's length."""

import math
from dataclasses import dataclass

import numpy as np

from ...models import Drive, Frame, Rope, Sheave

LIMIT = 1e6
"""Limit of every drive [N, N m]; nothing depends on it."""


@dataclass(frozen=True)
class Dice:
    """Draws numbers about one crane's length."""

    rng: np.random.Generator
    size: float
    """Length of the crane [m]."""

    def decades(self, low: float, high: float) -> float:
        """A number whose logarithm is spread evenly."""
        return float(10.0 ** self.rng.uniform(math.log10(low), math.log10(high)))

    def length(self, low: float, high: float) -> float:
        """A share of the crane's length [m]."""
        return float(self.size * self.rng.uniform(low, high))

    def maybe(self, share: float = 0.5) -> bool:
        """True in this share of all cases."""
        return bool(self.rng.random() < share)

    def mass(self) -> float:
        """A mass [kg]."""
        return self.decades(1e-2, 1e4)

    def slope(self) -> float:
        """Angle of a slope, steep but never upright [rad]."""
        return float(self.rng.uniform(-1.2, 1.2))

    def ends(self, place: float) -> tuple[float, float]:
        """Ends of a rail with a trolley at a place, or none [m]."""
        if self.maybe(0.6):
            return -math.inf, math.inf
        return place - self.length(0.05, 1.0), place + self.length(0.05, 1.0)

    def rope(self, name: str, *path: str) -> Rope:
        """A rope with a winch of its own, perhaps sheaves and several falls."""
        sheaves = tuple(
            Sheave(point, self.decades(1e-6, 1e1), self.decades(1e-2, 1e0))
            for point in path[1:-1]
            if self.maybe(0.3)
        )
        falls = int(self.rng.integers(2, 7)) if self.maybe(0.25) else 1
        radius = self.decades(1e-2, 1e0)
        return Rope(name, path, radius, self.decades(1e-6, 1e2), sheaves, falls)


def drives(*parts: str) -> tuple[Drive, ...]:
    """A drive on each of these parts."""
    return tuple(Drive(f"{part}_drive", part, LIMIT) for part in parts)


def frame(dice: Dice, name: str = "frame") -> Frame:
    """One that carries a beam along x: round a tower, or across it, level or on a slope."""
    if dice.maybe():
        return Frame(name, "turning", dice.mass() * dice.size**2)
    turn = dice.rng.uniform(0.3, math.pi - 0.3) if dice.maybe() else 0.5 * math.pi
    rise = dice.slope() if dice.maybe() else 0.0
    level = math.cos(rise)
    axis = level * math.cos(turn), level * math.sin(turn), math.sin(rise)
    return Frame(name, "sliding", dice.mass(), axis)
