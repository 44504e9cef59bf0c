"""The catalogue of hands, in which each registers beside the function that builds it.

hand, move = make_hand("three-finger-hand"), default_hand_move("three-finger-hand")
"""

from ..registry import Catalogue
from .hand import Hand
from .move import HandMove

HAND_CATALOGUE: Catalogue[Hand, HandMove] = Catalogue("hand", ending="hand")
"""Every hand by its name; `flatrig.models.registry` says how one is added."""

full_hand_name = HAND_CATALOGUE.full_name
make_hand = HAND_CATALOGUE.make


def default_hand_move(hand: Hand | str) -> HandMove:
    """The catalogue's move for a hand.

    Raises
    ------
    RigError
        No hand of the catalogue is called so.
    """
    return HAND_CATALOGUE.entry(hand.name if isinstance(hand, Hand) else hand).move
