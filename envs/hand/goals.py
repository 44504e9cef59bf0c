"""Moves of hands for episodes: the default one, a given one, or goals drawn near the default."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from os import PathLike, fspath, sep
from typing import Any

import numpy as np

from ...feedforward.rolling.carried import carried_by
from ...models.arguments import keywords_of, known_keywords
from ...models.errors import OptionError
from ...models.hand.catalogue import HAND_CATALOGUE, default_hand_move, make_hand
from ...models.hand.described import load_hand, loads_hand
from ...models.hand.hand import Hand
from ...models.hand.move import HandMove
from ...models.values import shown
from ..plans import Planner
from .plan import HandPlan, make_hand_plan

HandReference = (
    HandMove | Mapping[str, Any] | Callable[[np.random.Generator], HandMove] | str | None
)

DURATION = 2.0
"""Duration of the default moves in environments [s]."""
AROUND = 0.15
"""By how much drawn goals turn more or less than the default move, each angle at most [rad]."""
ASIDE = 0.2
"""By how much they lie aside, along each axis at most, over the object's radius."""


@dataclass(frozen=True)
class RandomGoals:
    """Moves like `move` whose goals lie within `AROUND` and `ASIDE` of its goal.

    Objects go aside only in directions in which rolling alone does not decide where they are.
    """

    hand: Hand
    move: HandMove

    def __call__(self, generator: np.random.Generator) -> HandMove:
        """Draw one; whether the hand can make it is not known yet."""
        shares = generator.uniform(-1.0, 1.0, len(self.move.goal) + 3)
        turned = np.array(self.move.goal) + AROUND * shares[:-3]
        free = carried_by(self.hand, self.move).free
        aside = ASIDE * self.hand.held.radius * free @ shares[-3:]
        shift = tuple((np.array(self.move.shift) + aside).tolist())
        return replace(self.move, goal=tuple(turned.tolist()), shift=shift)


class HandPlanner(Planner[HandPlan]):
    """Makes the plan of each episode; goals that the hand cannot reach are drawn anew.

    `move` is the hand's own, in place of the catalogue's.
    """

    kinds = "a HandMove"

    def __init__(
        self,
        hand: Hand,
        option: HandReference,
        period: float,
        hold: float,
        move: HandMove | None = None,
    ) -> None:
        self._hand, self._move = hand, move
        if isinstance(option, Mapping):  # from a spec in JSON
            known_keywords("a HandMove has no", option, keywords_of(HandMove), OptionError)
            option = HandMove(**option)
        super().__init__(option, period, hold)

    def default(self) -> HandMove:
        """The hand's own move, or the catalogue's."""
        return self._move or default_move(self._hand)

    def random(self) -> RandomGoals:
        """Moves to goals near the catalogue's."""
        return RandomGoals(self._hand, self.default())

    def is_reference(self, option: object) -> bool:
        """Whether it is a move of a hand."""
        return isinstance(option, HandMove)

    def plan(self, reference: object) -> HandPlan:
        """The plan for a given move, or one that is made already, with a hold of its own."""
        if isinstance(reference, HandPlan):
            return reference
        if not isinstance(reference, HandMove):
            raise OptionError(f"reference is {shown(reference)}, it must be a HandMove")
        return make_hand_plan(self._hand, reference, self.period, self.hold)


def default_move(hand: Hand) -> HandMove:
    """The catalogue's move for a hand of that name, in `DURATION`.

    Raises
    ------
    OptionError
        The hand is not from the catalogue.
    """
    if hand.name not in HAND_CATALOGUE:
        raise OptionError(
            f"hand {hand.name} is not in the catalogue and brings no move; give `reference`"
        )
    return replace(default_hand_move(hand), duration=DURATION)


def hand_and_move(value: Any) -> tuple[Hand, HandMove | None]:
    """The option `hand`, and its move where a file gives one.

    Raises
    ------
    OptionError
        It is none of what a hand can be.
    RigError
        The catalogue has no hand of that name, or a file describes none.
    """
    if isinstance(value, Hand):
        return value, None
    if value is None:
        raise OptionError(
            "an environment needs a hand; give `hand`, a Hand, a name of the catalogue or a TOML "
            "file"
        )
    text = isinstance(value, str)
    if text and "\n" in value:
        hand, move = loads_hand(value)
    elif isinstance(value, PathLike) or (text and (value.endswith(".toml") or sep in value)):
        hand, move = load_hand(fspath(value))
    elif text:
        return make_hand(value), None
    else:
        raise OptionError(
            f"hand is {shown(value)}, it must be a Hand, a name of the catalogue or the path of a "
            "TOML file"
        )
    own = hand.name in HAND_CATALOGUE and move == default_hand_move(hand)
    return hand, None if own else move
