"""How far along a hand's move is, as a Taylor series in time."""

from ...models.hand.move import HandMove
from ...models.types import Array
from ..paths.profiles import RestToRest, progress

ORDERS = 3
"""Coefficients of a pose: its value, velocity and half its acceleration."""


def share(move: HandMove, times: Array, orders: int = ORDERS) -> Array:
    """How much of a move is done at times (N,) [s], from 0 to 1, (orders, N) (K 2.102)."""
    return progress(RestToRest(move.order), times, move.duration, orders - 1)
