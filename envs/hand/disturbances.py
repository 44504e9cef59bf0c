"""What differs from a hand's model in the plant: ranges, single scenarios, and a paired design.

    disturbances = HandDisturbances.standard(hand)
    scenarios = hand_design(disturbances, 100, seed=1)
    env.reset(seed=0, options={"scenario": HandScenario(mass=1.2, turn=(0, 0, 0.03))})

An object that lies aside of where the plan has it is still held: fingertips close on it where it
is, and plates follow along their normals only, so that they touch it aside of their middle.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import OptionError, did_you_mean
from ...models.hand.hand import Hand
from ...models.values import Vector
from ..crane.disturbances import LONGEST_DELAY, Range
from ..option_checks import number

STANDARD_SHIFT = 0.02
"""Placement error of the standard disturbances at most, over the object's radius."""
STANDARD_TURN = math.radians(2.0)
"""The same for its orientation [rad]."""
STANDARD_OFFSET = 1e-4
"""Error of slides' encoders at most [m]."""


@dataclass(frozen=True)
class HandScenario:
    """How one plant differs from its hand; the defaults do not differ.

    Raises
    ------
    OptionError
        A number is not finite or not one that it can be.
    """

    mass: float = 1.0
    """Mass and inertia of the object over the hand's."""
    friction: float = 1.0
    """Of every contact over the hand's."""
    shift: Vector = (0.0, 0.0, 0.0)
    """By which the object lies aside of the plan at the start [m]."""
    turn: Vector = (0.0, 0.0, 0.0)
    """By which it is turned from the plan at the start, axis times angle in space [rad]."""
    offset: float = 0.0
    """Error of slides' encoders, one way and the other by turns [m]."""
    encoder_resolution: float = 0.0
    """Step of what encoders read [m, rad]; rates then come from counting over one period."""
    delay: int = 0
    """Whole control periods between command and input."""

    def __post_init__(self) -> None:
        number("scenario: mass", self.mass, above=0)
        number("scenario: friction", self.friction, above=0)
        number("scenario: offset", self.offset)
        number("scenario: encoder_resolution", self.encoder_resolution, least=0)
        number("scenario: delay", self.delay, least=0, most=LONGEST_DELAY, whole=True)
        for name in ("shift", "turn"):
            value = getattr(self, name)
            if not isinstance(value, tuple | list | np.ndarray) or len(value) != 3:
                raise OptionError(f"scenario: {name} is {value!r}, it must be three numbers")
            parts = tuple(number(f"scenario: {name}", part) for part in value)
            object.__setattr__(self, name, parts)


@dataclass(frozen=True)
class HandDisturbances:
    """Ranges (lowest, highest) from which scenarios are drawn uniformly; units as there.

    Placement errors have sizes from their ranges and directions from the whole sphere.

    Raises
    ------
    OptionError
        A range is upside down or holds a value that no scenario can have.
    """

    mass: Range = (1.0, 1.0)
    friction: Range = (1.0, 1.0)
    shift: Range = (0.0, 0.0)
    """Distance [m]."""
    turn: Range = (0.0, 0.0)
    """Angle [rad]."""
    offset: Range = (0.0, 0.0)

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            label = f"disturbances: {item.name}"
            if not isinstance(value, tuple | list) or len(value) != 2:
                raise OptionError(f"{label} is {value!r}, it must be (low, high)")
            positive = item.name in ("mass", "friction")
            low, high = (
                number(label, end, above=0) if positive else number(label, end) for end in value
            )
            if not low <= high:
                raise OptionError(f"{label} is ({low}, {high}), low must not exceed high")
            object.__setattr__(self, item.name, (low, high))

    @classmethod
    def standard(cls, hand: Hand) -> "HandDisturbances":
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

    def scenario(self, shares: ArrayLike) -> HandScenario:
        """The scenario at a place of the unit cube, shape (DIMENSIONS,)."""
        places = np.asarray(shares, dtype=float)
        names = [item.name for item in fields(self)]
        ends = np.array([getattr(self, name) for name in names])
        drawn = ends[:, 0] + places[: len(names)] * (ends[:, 1] - ends[:, 0])
        values: dict[str, Any] = dict(zip(names, drawn.tolist(), strict=True))
        for name, (azimuth, height) in zip(
            ("shift", "turn"), places[len(names) :].reshape(2, 2), strict=True
        ):
            values[name] = tuple(values[name] * _direction(azimuth, height))
        return HandScenario(**values)

    def draw(self, generator: np.random.Generator) -> HandScenario:
        """A scenario of its own for one episode."""
        return self.scenario(generator.random(DIMENSIONS))

    def check(self, scenario: HandScenario | None) -> None:
        """Refuse what is no scenario of a hand.

        Raises
        ------
        OptionError
            It is something else.
        """
        if scenario is not None and not isinstance(scenario, HandScenario):
            raise OptionError(f"scenario is {scenario!r}, it must be a HandScenario")


DIMENSIONS = len(fields(HandDisturbances)) + 4
"""Number of independent shares that make a scenario: ranges, then two directions."""


def _direction(azimuth: float, height: float) -> np.ndarray[Any, np.dtype[np.float64]]:
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
    from scipy.stats import qmc  # only here: slow to import

    size = int(number("number of scenarios", size, least=1, whole=True))
    seed = int(number("seed", seed, least=0, whole=True))
    cube = qmc.LatinHypercube(DIMENSIONS, rng=np.random.default_rng(seed)).random(size)
    return [disturbances.scenario(place) for place in cube]


def as_hand_disturbances(value: Any, hand: Hand) -> HandDisturbances:
    """The option `disturbances`: None, "standard", ranges by name, or ready.

    Raises
    ------
    OptionError
        It is something else.
    """
    if value is None:
        return HandDisturbances()
    if isinstance(value, HandDisturbances):
        return value
    if isinstance(value, str) and value == "standard":
        return HandDisturbances.standard(hand)
    if isinstance(value, Mapping):
        known = [item.name for item in fields(HandDisturbances)]
        for name in value:
            if name not in known:
                near = did_you_mean(str(name), known)
                raise OptionError(f"there is no disturbance {name!r}{near}")
        return HandDisturbances(**value)
    raise OptionError(
        f'disturbances is {value!r}, it must be None, "standard", ranges by name or '
        "HandDisturbances"
    )
