"""The sets of episodes on which cranes' controllers are judged, each registered once.

    @episode_set("halfway", "from the middle of the move on", share=0.2)
    def halfway(rig, move, number):
        return [Episode(...), ...]

One move can be learnt by heart, one direction is easier than the other, and what wind teaches in a
second is forgotten in thirty: no single set says which controller is better.  All draw from
`EVALUATION_SEED`, which training never uses, and none depends on which others are driven.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from math import ceil
from typing import Any

import numpy as np

from ...envs.crane.disturbances import Disturbances, Scenario, design
from ...envs.crane.plan import make_plan
from ...envs.crane.references import as_profile
from ...feedforward import from_move
from ...models import Move, Rig
from ...models.errors import FlatrigError, OptionError, did_you_mean
from ..random_moves import PERIOD, random_move
from .contenders import EVALUATION_SEED

OWN = "own"
"""Name of the set with the rig's own move, of which all is told."""
HOLD = 4.0
"""How long an episode goes on after arrival, if its set does not say [s]."""
HOLDS = (HOLD, 30.0)
"""How long those with random moves do [s]."""
LONG_HOLD = 60.0
"""How long those do in which an error must not grow [s]."""
RESOLUTION = 1e-3
"""Step of the encoders in half of the episodes with random moves [m, rad]."""
LATE = 3
"""A delay that no range holds [control periods]."""
STRONG = 1.5
"""How many times as large as their ranges say disturbances are, where they are too large."""


@dataclass(frozen=True)
class Episode:
    """What one plant is asked to do."""

    move: Move
    scenario: Scenario
    """How the plant differs from the rig."""
    hold: float = HOLD
    """How long it goes on after arrival [s]."""
    seed: int = 0
    """Of what is drawn on the way, such as sensors' noise; its place in the set."""


Make = Callable[[Rig, Move, int], Iterable[Episode]]


@dataclass(frozen=True)
class EpisodeSet:
    """Episodes that answer one question."""

    name: str
    title: str
    """What is asked, in a few words."""
    make: Make
    """Makes so many episodes of a rig and its own move."""
    share: float
    """How many episodes it has over the number that is asked for."""

    def episodes(self, rig: Rig, move: Move, number: int) -> list[Episode]:
        """Its episodes, `share` times `number` rounded up.

        Raises
        ------
        OptionError
            No random move of the rig can be followed.
        """
        made = self.make(rig, move, ceil(self.share * number))
        return [replace(episode, seed=place) for place, episode in enumerate(made)]


SETS: dict[str, EpisodeSet] = {}
"""Every set by its name, in the order of the columns."""


def episode_set(name: str, title: str, *, share: float = 1.0) -> Callable[[Make], Make]:
    """Register the function that makes a set's episodes; see `EpisodeSet`."""

    def register(make: Make) -> Make:
        SETS[name] = EpisodeSet(name, title, make, share)
        return make

    return register


def gather(
    rig: Rig, move: Move, scenarios: int, episodes: int, names: Iterable[str] = ()
) -> tuple[dict[str, list[Episode]], list[str]]:
    """Episodes of each set by its name, and why some sets are left out.

    Parameters
    ----------
    rig, move
        The crane and its own move.
    scenarios, episodes
        Number of episodes with the own move, and with each other set's share of 1.
    names
        Sets that are asked for, beside that with the own move; all that the rig can make if empty.

    Raises
    ------
    OptionError
        There is no set of a name.
    FlatrigError
        The rig cannot make what a named set asks for.
    """
    asked, left_out = list(names), []
    made = {OWN: SETS[OWN].episodes(rig, move, scenarios)}
    for entry in sets_of(asked):
        if entry.name == OWN:
            continue
        try:
            made[entry.name] = entry.episodes(rig, move, episodes)
        except FlatrigError as error:
            if asked:
                raise
            left_out.append(f"{entry.name}: {error}")
    return made, left_out


def sets_of(names: Iterable[str]) -> list[EpisodeSet]:
    """The sets of these names, in the order of the columns; all if there are none.

    Raises
    ------
    OptionError
        There is no set of a name.
    """
    chosen = list(names)
    for name in chosen:
        if name not in SETS:
            raise OptionError(f"there is no set of episodes {name!r}{did_you_mean(name, SETS)}")
    return [entry for entry in SETS.values() if not chosen or entry.name in chosen]


def scenarios_for(rig: Rig, number: int, seed: int = EVALUATION_SEED) -> list[Scenario]:
    """Scenarios from the standard disturbances of a rig."""
    return design(Disturbances.standard(rig), number, seed)


@episode_set(OWN, "the rig's own move")
def own(rig: Rig, move: Move, number: int) -> Iterable[Episode]:
    """The move that a controller may have been made for."""
    return (Episode(move, scenario) for scenario in scenarios_for(rig, number))


@episode_set("reversed", "the same move back")
def reversed_move(rig: Rig, move: Move, number: int) -> Iterable[Episode]:
    """From the goal to the start, in the same time and the same scenarios."""
    there = as_profile(move)
    back = replace(there, start=there.goal, goal=there.start)
    make_plan(rig, from_move(back, rig), PERIOD, 0.0)  # ropes may be slack, or drives too weak
    return own(rig, back, number)


@episode_set("random", "unseen moves, half between edges; holds of 4 to 30 s; half 1 mm encoders")
def random_moves(rig: Rig, move: Move, number: int) -> Iterable[Episode]:
    """Moves that no controller was made for."""
    return _random(rig, move, scenarios_for(rig, number, EVALUATION_SEED + 1))


@episode_set("nominal", "random moves of plants like the rig", share=0.2)
def nominal(rig: Rig, move: Move, number: int) -> Iterable[Episode]:
    """What a controller costs where nothing is wrong."""
    undisturbed = _random(rig, move, [Scenario()] * (number - 1))
    return (
        replace(episode, scenario=Scenario())
        for episode in (Episode(move, Scenario()), *undisturbed)
    )


@episode_set("hold", "the own move and 60 s of hold", share=0.2)
def long_hold(rig: Rig, move: Move, number: int) -> Iterable[Episode]:
    """Whether an error grows while nothing happens."""
    scenarios = scenarios_for(rig, number, EVALUATION_SEED + 2)
    return (Episode(move, scenario, LONG_HOLD) for scenario in scenarios)


@episode_set("late", "random moves with a delay of three periods", share=0.2)
def late(rig: Rig, move: Move, number: int) -> Iterable[Episode]:
    """A delay that is longer than any in the standard disturbances."""
    drawn = Disturbances.standard(rig)
    late = replace(drawn, delay=(LATE, LATE))
    return _random(rig, move, design(late, number, EVALUATION_SEED + 3))


@episode_set("strong", "random moves with disturbances 1.5 times as large", share=0.2)
def strong(rig: Rig, move: Move, number: int) -> Iterable[Episode]:
    """Masses, friction and wind that are further off than any in the standard disturbances."""
    drawn = stronger(Disturbances.standard(rig), STRONG)
    return _random(rig, move, design(drawn, number, EVALUATION_SEED + 4))


def stronger(ranges: Disturbances, factor: float) -> Disturbances:
    """Ranges of which all but frequencies and delays is so many times as large."""
    grown: dict[str, Any] = {}
    for item in fields(ranges):
        value = getattr(ranges, item.name)
        if item.name in ("gust_frequency", "delay") or not isinstance(value, tuple):
            continue
        middle = 1.0 if item.name in ("load_mass", "static_friction") else 0.0
        grown[item.name] = tuple(middle + factor * (end - middle) for end in value)
    return replace(ranges, **grown)


def _random(rig: Rig, move: Move, scenarios: list[Scenario]) -> Iterable[Episode]:
    """An episode with a random move for each scenario; the first ones are the same in all sets.

    Every second move is between edges of the box, the third and the fourth of four have encoders
    with a resolution.
    """
    for i, scenario in enumerate(scenarios):
        drawn, hold = _drawn(rig, move, i)
        if i % 4 > 1:
            scenario = replace(scenario, encoder_resolution=RESOLUTION)
        yield Episode(drawn, scenario, hold)


@lru_cache(maxsize=1024)
def _drawn(rig: Rig, move: Move, number: int) -> tuple[Move, float]:
    """The random move of this number, from 0, and its hold [s]."""
    rng = np.random.default_rng((EVALUATION_SEED, number))
    hold = float(rng.uniform(*HOLDS))
    return random_move(rig, move, rng, edges=float(number % 2)), hold
