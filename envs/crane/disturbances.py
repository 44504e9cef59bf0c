"""What differs from the model in the plant: ranges, single scenarios, and a paired design.

    disturbances = Disturbances.standard(rig)         # load mass, friction, wind, delay
    scenarios = design(disturbances, 100, seed=1)     # one Latin hypercube
    env.reset(seed=0, options={"scenario": scenarios[17]})

A `Scenario` is one plant.  Controllers are compared on the same list of scenarios, each against
each, so that a difference between them is not a difference between their plants.
"""

import math
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import OptionError
from ...models.rig.rig import Rig
from ..common import LONGEST_DELAY, Range
from ..ranges import PlantScenario, Ranges, quantity
from .payloads import payload_weight

NONE: Range = (0.0, 0.0)
ONE: Range = (1.0, 1.0)


@dataclass(frozen=True)
class Scenario(PlantScenario):
    """How one plant differs from its rig; the defaults do not differ.

    Raises
    ------
    OptionError
        A number is not finite or not one that it can be, or gusts have no frequency.
    """

    load_mass: float = quantity(1.0, above=0)
    """Mass of every load over the rig's."""
    winch_friction: float = quantity(0.0, least=0)
    """Coulomb friction of every winch [N of rope force]."""
    trolley_friction: float = quantity(0.0, least=0)
    """Coulomb friction of every trolley on its rail [N]."""
    wind: float = quantity(0.0)
    """Steady force on every load [N]."""
    wind_direction: float = quantity(0.0)
    """Where the wind blows, from the x axis about z [rad]; in a planar rig along x, to the side
    of its cosine's sign."""
    gust: float = quantity(0.0)
    """Amplitude of a sinusoid on top of the wind, in the same direction [N]."""
    gust_frequency: float = quantity(0.0)
    """Frequency of that sinusoid [Hz]."""
    gust_phase: float = quantity(0.0)
    """Phase of that sinusoid at the start [rad]."""
    swing: float = quantity(0.0)
    """Angle of the ropes that loads hang from at the start [rad]; loads start at rest."""
    swing_direction: float = quantity(0.0)
    """Where loads have swung to, like `wind_direction` [rad]."""
    encoder_resolution: float = quantity(0.0, least=0)
    """Step of what encoders read [m] or [rad]; rates then come from counting over one period."""
    delay: int = quantity(0, least=0, most=LONGEST_DELAY, whole=True)
    """Whole control periods between command and input."""
    frame_friction: float = quantity(0.0, least=0)
    """Coulomb friction of every frame: [N] of a sliding one, [N m] of a turning one."""
    winch_viscous: float = quantity(0.0, least=0)
    """Viscous friction of every winch [N of rope force per m/s]."""
    trolley_viscous: float = quantity(0.0, least=0)
    """Viscous friction of every trolley [N s/m]."""
    frame_viscous: float = quantity(0.0, least=0)
    """Viscous friction of every frame [N s/m] or [N m s]."""
    static_friction: float = quantity(1.0, least=1)
    """Friction from rest, of all that rubs, over Coulomb friction."""
    stribeck_velocity: float = quantity(0.01, above=0)
    """Speed at which what static friction has more has fallen to a third [m/s, rad/s]."""

    def __post_init__(self) -> None:
        super().__post_init__()
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
class Disturbances(Ranges[Scenario]):
    """Ranges (lowest, highest) from which scenarios are drawn uniformly; units as in `Scenario`.

    Directions and the gusts' phase are drawn from the whole circle.  The resolution of encoders and
    the speed of Stribeck are one number each, the same in all scenarios.

    Raises
    ------
    OptionError
        A range is upside down or holds a value that no scenario can have, or gusts
        have no frequency.
    """

    load_mass: Range = ONE
    """Masses of the loads over the rig's."""
    winch_friction: Range = NONE
    """Coulomb friction of winches [N of rope force]."""
    trolley_friction: Range = NONE
    """Coulomb friction of trolleys [N]."""
    wind: Range = NONE
    """Steady forces on the loads [N]."""
    gust: Range = NONE
    """Amplitudes of gusts [N]."""
    gust_frequency: Range = NONE
    """Frequencies of gusts [Hz]."""
    swing: Range = NONE
    """Angles of the ropes at the start [rad]."""
    encoder_resolution: float = 0.0
    """Step of what encoders read [m, rad], the same in all scenarios."""
    delay: tuple[int, int] = (0, 0)
    """Whole control periods between command and input."""
    frame_friction: Range = NONE
    """Coulomb friction of frames [N, N m]."""
    winch_viscous: Range = NONE
    """Viscous friction of winches [N of rope force per m/s]."""
    trolley_viscous: Range = NONE
    """Viscous friction of trolleys [N s/m]."""
    frame_viscous: Range = NONE
    """Viscous friction of frames [N s/m, N m s]."""
    static_friction: Range = ONE
    """Friction from rest over Coulomb friction."""
    stribeck_velocity: float = 0.01
    """Speed at which static friction has fallen [m/s, rad/s], the same in all scenarios."""

    scenario_type: ClassVar[type[Scenario]] = Scenario
    single: ClassVar[tuple[str, ...]] = ("encoder_resolution", "stribeck_velocity")

    def __post_init__(self) -> None:
        super().__post_init__()
        if any(self.gust) and not any(self.gust_frequency):
            raise OptionError("disturbances: gusts need frequencies; give gust_frequency [Hz]")

    @classmethod
    def standard(cls, rig: Rig) -> Self:
        """Load mass off by up to 30 %, friction, wind with gusts, and up to two periods of delay.

        Forces follow from the weight of what the rig carries: friction up to 3 % of it, wind and
        gusts up to 2 % each.
        """
        weight = payload_weight(rig)
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
            It is no scenario, or has Coulomb friction where no range has.
        """
        super().check(scenario)
        if not isinstance(scenario, Scenario):
            return
        if scenario.friction and not self.friction:
            raise OptionError(
                "the scenario has Coulomb friction, but the environment was made without; make it "
                'with disturbances="standard" or a range, such as {"winch_friction": (0, 50)}'
            )
        if scenario.frame_friction > 0 and not self.frame_friction[1] > 0:
            raise OptionError(
                "frames have Coulomb friction in the scenario, but the environment was made "
                'without; make it with a range in disturbances, such as {"frame_friction": (0, 50)}'
            )

    @cached_property
    def more(self) -> bool:
        """Whether some of `MORE` is to be drawn."""
        return any(low < high for low, high in (getattr(self, name) for name in MORE))

    @property
    def shares(self) -> tuple[int, ...]:
        """How many shares make a scenario: the first ones, those of `MORE`, those added."""
        groups = (DIMENSIONS, len(MORE) * self.more, len(self.added))
        return tuple(count for count in groups if count)

    def scenario(self, shares: ArrayLike) -> Scenario:
        """The scenario at a place of the unit cube, shape (DIMENSIONS,) or (DIMENSIONS + more,).

        Without the shares of `MORE` these are at the low ends of their ranges.
        """
        names = (*_DRAWN, *MORE, *self.added)
        places = np.asarray(shares, dtype=float).tolist()
        places[DIMENSIONS:DIMENSIONS] = [0.0] * (len(names) - len(places))
        values: dict[str, Any] = {name: getattr(self, name) for name in self.single}
        for name, place in zip(names, places, strict=True):
            if name in _CIRCULAR:
                present = any(any(getattr(self, owner)) for owner in _CIRCULAR[name])
                values[name] = 2.0 * math.pi * place if present else 0.0
            elif name == "delay":
                low, high = self.delay
                values[name] = min(low + int(place * (high - low + 1)), high)
            else:
                values[name] = self.between(name, place)
        return self.scenario_type(**values)


MORE = ("frame_friction", "winch_viscous", "trolley_viscous", "frame_viscous", "static_friction")
"""Drawn after the others, and only where one of them has a range: draws without stay the same."""

_CIRCULAR = {
    "wind_direction": ("wind", "gust"),
    "gust_phase": ("gust",),
    "swing_direction": ("swing",),
}
"""Directions and phases with the disturbances that they belong to."""

_DRAWN = tuple(
    item.name for item in fields(Scenario) if item.name not in (*Disturbances.single, *MORE)
)

DIMENSIONS = len(_DRAWN)
"""Number of independent shares that make a scenario, `MORE` left aside."""


def design(disturbances: Disturbances, number: int, seed: int) -> list[Scenario]:
    """Scenarios that cover the ranges evenly: one Latin hypercube, the same for the same seed.

    Raises
    ------
    OptionError
        `number` is not a whole number >= 1 or `seed` not one >= 0.
    """
    return disturbances.design(number, seed)
