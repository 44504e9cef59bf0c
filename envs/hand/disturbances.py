"""What differs from a hand's model in the plant: ranges, single scenarios, and a paired design.

    disturbances = HandDisturbances.standard(hand)
    scenarios = hand_design(disturbances, 100, seed=1)
    env.reset(seed=0, options={"scenario": HandScenario(mass=1.2, turn=(0, 0, 0.03))})

An object that lies aside of where the plan has it is still held: fingertips close on it where it
is, and plates follow along their normals only, so that they touch it aside of their middle.
"""

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import OptionError
from ...models.hand.hand import Hand
from ...models.types import Array
from ...models.values import Vector, bounded, shown
from ..common import LONGEST_DELAY, Range
from ..ranges import PlantScenario, Ranges, quantity

STANDARD_SHIFT = 0.02
"""Placement error of the standard disturbances at most, over the object's radius."""
STANDARD_TURN = math.radians(2.0)
"""The same for its orientation [rad]."""
STANDARD_OFFSET = 1e-4
"""Error of slides' encoders at most [m]."""


@dataclass(frozen=True)
class HandScenario(PlantScenario):
    """How one plant differs from its hand; the defaults do not differ.

    Raises
    ------
    OptionError
        A number is not finite or not one that it can be.
    """

    mass: float = quantity(1.0, above=0)
    """Mass and inertia of the object over the hand's."""
    friction: float = quantity(1.0, above=0)
    """Friction of every contact over the hand's."""
    shift: Vector = (0.0, 0.0, 0.0)
    """How far the object lies aside of the plan at the start [m]."""
    turn: Vector = (0.0, 0.0, 0.0)
    """How it is turned from the plan at the start, axis times angle in space [rad]."""
    offset: float = quantity(0.0)
    """Error of slides' encoders, one way and the other by turns [m]."""
    encoder_resolution: float = quantity(0.0, least=0)
    """Step of what encoders read [m, rad]; rates then come from counting over one period."""
    delay: int = quantity(0, least=0, most=LONGEST_DELAY, whole=True)
    """Whole control periods between command and input."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("shift", "turn"):
            value = getattr(self, name)
            if not isinstance(value, tuple | list | np.ndarray) or len(value) != 3:
                raise OptionError(f"scenario: {name} is {shown(value)}, it must be three numbers")
            parts = tuple(bounded(f"scenario: {name}", part) for part in value)
            object.__setattr__(self, name, parts)


@dataclass(frozen=True)
class HandDisturbances(Ranges[HandScenario]):
    """Ranges (lowest, highest) from which scenarios are drawn uniformly; units as there.

    Placement errors have sizes from their ranges and directions from the whole sphere.

    Raises
    ------
    OptionError
        A range is upside down or holds a value that no scenario can have.
    """

    mass: Range = (1.0, 1.0)
    """Masses and inertias of the object over the hand's."""
    friction: Range = (1.0, 1.0)
    """Friction of every contact over the hand's."""
    shift: Range = (0.0, 0.0)
    """Distances by which the object lies aside of the plan at the start [m]."""
    turn: Range = (0.0, 0.0)
    """Angles by which it is turned from the plan at the start [rad]."""
    offset: Range = (0.0, 0.0)
    """Errors of slides' encoders, one way and the other by turns [m]."""

    scenario_type: ClassVar[type[HandScenario]] = HandScenario

    @classmethod
    def standard(cls, hand: Hand) -> Self:
        """Mass off by up to 20 %, friction from 10 % less to 20 % more, misplaced objects.

        Placement errors are up to 2 % of the object's radius and 2 degrees, slides' encoders up
        to 0.1 mm wrong.
        """
        return cls(
            mass=(0.8, 1.2),
            friction=(0.9, 1.2),
            shift=(0.0, STANDARD_SHIFT * hand.held.radius),
            turn=(0.0, STANDARD_TURN),
            offset=(-STANDARD_OFFSET, STANDARD_OFFSET),
        )

    @property
    def shares(self) -> tuple[int, ...]:
        """How many shares make a scenario: ranges and two directions, then what is added."""
        return (DIMENSIONS, len(self.added)) if self.added else (DIMENSIONS,)

    def scenario(self, shares: ArrayLike) -> HandScenario:
        """The scenario at a place of the unit cube, shape (DIMENSIONS,)."""
        places = np.asarray(shares, dtype=float).tolist()
        added = zip(self.added, places[DIMENSIONS:], strict=True)
        values: dict[str, Any] = {
            name: self.between(name, place)
            for name, place in (*zip(_DRAWN, places, strict=False), *added)
        }
        directions = np.reshape(places[len(_DRAWN) : DIMENSIONS], (2, 2)).tolist()
        for name, (azimuth, height) in zip(("shift", "turn"), directions, strict=True):
            values[name] = tuple(values[name] * _direction(azimuth, height))
        return self.scenario_type(**values)


_DRAWN = ("mass", "friction", "shift", "turn", "offset")
"""Ranges in the order of their shares."""

DIMENSIONS = len(_DRAWN) + 4
"""Number of independent shares that make a scenario: ranges, then two directions."""


def _direction(azimuth: float, height: float) -> Array:
    """A unit vector, uniform on the sphere for shares uniform in [0, 1)."""
    z, angle = 2.0 * height - 1.0, 2.0 * math.pi * azimuth
    level = math.sqrt(1.0 - z * z)
    return np.array([level * math.cos(angle), level * math.sin(angle), z])


def hand_design(disturbances: HandDisturbances, size: int, seed: int) -> list[HandScenario]:
    """Scenarios that cover the ranges evenly: one Latin hypercube, the same for the same seed.

    Raises
    ------
    OptionError
        `size` is not a whole number >= 1 or `seed` not one >= 0.
    """
    return disturbances.design(size, seed)
