"""What differs from the model in the plant: ranges, single scenarios, and a paired design.

    disturbances = Disturbances.standard(rig)         # load mass, friction, wind, delay
    scenarios = design(disturbances, 100, seed=1)     # one Latin hypercube
    env.reset(seed=0, options={"scenario": scenarios[17]})

A `Scenario` is one plant.  Controllers are compared on the same list of scenarios, each against
each, so that a difference between them is not a difference between their plants.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import OptionError, did_you_mean
from ...models.rig.rig import Rig
from ..option_checks import number as checked
from .payloads import payloads

Range = tuple[float, float]

NONE: Range = (0.0, 0.0)

LONGEST_DELAY = 31
"""Of an input, in control periods."""


@dataclass(frozen=True)
class Scenario:
    """How one plant differs from its rig; the defaults do not differ.

    Raises
    ------
    OptionError
        A number is not finite or not one that it can be, or gusts have no frequency.
    """

    load_mass: float = 1.0
    """Mass of every load over the rig's."""
    winch_friction: float = 0.0
    """Coulomb friction of every winch [N of rope force]."""
    trolley_friction: float = 0.0
    """Coulomb friction of every trolley on its rail [N]."""
    wind: float = 0.0
    """Steady force on every load [N]."""
    wind_direction: float = 0.0
    """Where the wind blows, from the x axis about z [rad]; in a planar rig along x, to
    the side of its cosine's sign."""
    gust: float = 0.0
    """Amplitude of a sinusoid on top of the wind, in the same direction [N]."""
    gust_frequency: float = 0.0
    """[Hz]"""
    gust_phase: float = 0.0
    """[rad]"""
    swing: float = 0.0
    """Angle of the ropes that loads hang from at the start [rad]; loads start at rest."""
    swing_direction: float = 0.0
    """Like `wind_direction` [rad]."""
    encoder_resolution: float = 0.0
    """Step of what encoders read [m] or [rad]; rates then come from counting over one period."""
    delay: int = 0
    """Whole control periods between command and input."""
    frame_friction: float = 0.0
    """Coulomb friction of every frame: [N] of a sliding one, [N m] of a turning one."""
    winch_viscous: float = 0.0
    """Viscous friction of every winch [N of rope force per m/s]."""
    trolley_viscous: float = 0.0
    """Viscous friction of every trolley [N s/m]."""
    frame_viscous: float = 0.0
    """Viscous friction of every frame [N s/m] or [N m s]."""
    static_friction: float = 1.0
    """Friction from rest, of all that rubs, over Coulomb friction."""
    stribeck_velocity: float = 0.01
    """Speed at which what static friction has more has fallen to a third [m/s, rad/s]."""

    def __post_init__(self) -> None:
        for item in fields(self):
            _check("scenario", item.name, getattr(self, item.name))
        if self.gust and not self.gust_frequency:
            raise OptionError("scenario: a gust needs a frequency; give gust_frequency [Hz]")

    @property
    def friction(self) -> bool:
        """Whether anything rubs that can stick."""
        return max(self.winch_friction, self.trolley_friction, self.frame_friction) > 0

    @property
    def viscous(self) -> bool:
        """Whether anything rubs in proportion to its speed."""
        return max(self.winch_viscous, self.trolley_viscous, self.frame_viscous) > 0


@dataclass(frozen=True)
class Disturbances:
    """Ranges (lowest, highest) from which scenarios are drawn uniformly; units as in `Scenario`.

    Directions and the gusts' phase are drawn from the whole circle.  The resolution of encoders and
    the speed of Stribeck are one number each, the same in all scenarios.

    Raises
    ------
    OptionError
        A range is upside down or holds a value that no scenario can have, or gusts
        have no frequency.
    """

    load_mass: Range = (1.0, 1.0)
    winch_friction: Range = NONE
    trolley_friction: Range = NONE
    wind: Range = NONE
    gust: Range = NONE
    gust_frequency: Range = NONE
    swing: Range = NONE
    encoder_resolution: float = 0.0
    delay: tuple[int, int] = (0, 0)
    frame_friction: Range = NONE
    winch_viscous: Range = NONE
    trolley_viscous: Range = NONE
    frame_viscous: Range = NONE
    static_friction: Range = (1.0, 1.0)
    stribeck_velocity: float = 0.01

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if item.name in _SINGLE:
                _check("disturbances", item.name, value)
                continue
            if not isinstance(value, tuple | list) or len(value) != 2:
                raise OptionError(f"disturbances: {item.name} is {value!r}, it must be (low, high)")
            low, high = value
            for end in (low, high):
                _check("disturbances", item.name, end)
            if not low <= high:
                raise OptionError(
                    f"disturbances: {item.name} is ({low}, {high}), low must not exceed high"
                )
            object.__setattr__(self, item.name, (low, high))
        if any(self.gust) and not any(self.gust_frequency):
            raise OptionError("disturbances: gusts need frequencies; give gust_frequency [Hz]")

    @classmethod
    def standard(cls, rig: Rig) -> "Disturbances":
        """Load mass off by up to 30 %, friction, wind with gusts, and up to two periods of delay.

        Forces follow from the weight of what the rig carries: friction up to 3 % of it, wind and
        gusts up to 2 % each.
        """
        weight = rig.gravity * sum(part.mass for part in payloads(rig))
        return cls(
            load_mass=(0.7, 1.3),
            winch_friction=(0.0, 0.03 * weight),
            trolley_friction=(0.0, 0.03 * weight),
            wind=(0.0, 0.02 * weight),
            gust=(0.0, 0.02 * weight),
            gust_frequency=(0.05, 0.5),
            delay=(0, 2),
        )

    @property
    def friction(self) -> bool:
        """Whether a scenario can have friction that sticks."""
        return max(self.winch_friction[1], self.trolley_friction[1], self.frame_friction[1]) > 0

    def check(self, scenario: object) -> None:
        """Refuse what an environment made for these cannot simulate; None stands for any.

        Raises
        ------
        OptionError
            It is no scenario, or has friction where no range has.
        """
        if scenario is None:
            return
        if not isinstance(scenario, Scenario):
            raise OptionError(f"scenario is {scenario!r}, it must be a Scenario")
        if scenario.friction and not self.friction:
            raise OptionError(
                "the scenario has friction, but the environment was made without; make it with "
                'disturbances="standard" or others that allow friction'
            )
        if scenario.frame_friction > 0 and not self.frame_friction[1] > 0:
            raise OptionError(
                "frames have friction in the scenario, but the environment was made without; make "
                'it with a range in disturbances, such as {"frame_friction": (0, 50)}'
            )

    def scenario(self, shares: ArrayLike) -> Scenario:
        """The scenario at a place of the unit cube, shape (DIMENSIONS,) or (DIMENSIONS + more,).

        Without the shares of `MORE` these are at the low ends of their ranges.
        """
        places = np.asarray(shares, dtype=float).tolist()
        places += [0.0] * (len(_DRAWN) + len(MORE) - len(places))
        values: dict[str, Any] = {name: getattr(self, name) for name in _SINGLE}
        for name, place in zip((*_DRAWN, *MORE), places, strict=True):
            if name in _CIRCULAR:
                present = any(any(getattr(self, owner)) for owner in _CIRCULAR[name])
                values[name] = 2.0 * math.pi * place if present else 0.0
            elif name == "delay":
                low, high = self.delay
                values[name] = min(low + int(place * (high - low + 1)), high)
            else:
                low, high = getattr(self, name)
                values[name] = low + place * (high - low)
        return Scenario(**values)

    def draw(self, generator: np.random.Generator) -> Scenario:
        """A scenario of its own for one episode."""
        return self.scenario(generator.random(DIMENSIONS + (len(MORE) if self.more else 0)))

    @property
    def more(self) -> bool:
        """Whether some of `MORE` is to be drawn."""
        return any(low < high for low, high in (getattr(self, name) for name in MORE))


_SINGLE = ("encoder_resolution", "stribeck_velocity")
"""One number for all scenarios."""

MORE = ("frame_friction", "winch_viscous", "trolley_viscous", "frame_viscous", "static_friction")
"""Drawn after the others, and only where one of them has a range: draws without stay the same."""

_CIRCULAR = {
    "wind_direction": ("wind", "gust"),
    "gust_phase": ("gust",),
    "swing_direction": ("swing",),
}
"""Directions and phases with the disturbances that they belong to."""

_DRAWN = tuple(item.name for item in fields(Scenario) if item.name not in (*_SINGLE, *MORE))

DIMENSIONS = len(_DRAWN)
"""Number of independent shares that make a scenario, `MORE` left aside."""


def design(disturbances: Disturbances, number: int, seed: int) -> list[Scenario]:
    """Scenarios that cover the ranges evenly: one Latin hypercube, the same for the same seed.

    Raises
    ------
    OptionError
        `number` is not a whole number >= 1 or `seed` not one >= 0.
    """
    from scipy.stats import qmc  # only here: slow to import

    number = int(checked("number of scenarios", number, least=1, whole=True))
    seed = int(checked("seed", seed, least=0, whole=True))
    cube = qmc.LatinHypercube(DIMENSIONS, rng=np.random.default_rng(seed)).random(number)
    if disturbances.more:
        generator = np.random.default_rng((seed, len(MORE)))
        cube = np.hstack((cube, qmc.LatinHypercube(len(MORE), rng=generator).random(number)))
    return [disturbances.scenario(place) for place in cube]


_LIMITS: dict[str, dict[str, Any]] = {
    "load_mass": {"above": 0},
    "winch_friction": {"least": 0},
    "trolley_friction": {"least": 0},
    "frame_friction": {"least": 0},
    "winch_viscous": {"least": 0},
    "trolley_viscous": {"least": 0},
    "frame_viscous": {"least": 0},
    "static_friction": {"least": 1},
    "stribeck_velocity": {"above": 0},
    "encoder_resolution": {"least": 0},
    "delay": {"least": 0, "most": LONGEST_DELAY, "whole": True},
}
"""What the numbers of a scenario must keep to, beyond being finite."""


def _check(owner: str, name: str, value: object) -> None:
    checked(f"{owner}: {name}", value, **_LIMITS.get(name, {}))


def as_disturbances(value: Disturbances | Mapping[str, Any] | str | None, rig: Rig) -> Disturbances:
    """The option `disturbances` of an environment: None, "standard", ranges by name, or ready.

    Raises
    ------
    OptionError
        It is something else.
    """
    if value is None:
        return Disturbances()
    if isinstance(value, Disturbances):
        return value
    if value == "standard":
        return Disturbances.standard(rig)
    if isinstance(value, Mapping):
        known = [item.name for item in fields(Disturbances)]
        for name in value:
            if name not in known:
                raise OptionError(
                    f"there is no disturbance {name!r}{did_you_mean(str(name), known)}"
                )
        return Disturbances(**value)
    raise OptionError(
        f'disturbances is {value!r}, it must be None, "standard", ranges by name or Disturbances'
    )
