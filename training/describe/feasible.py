"""Whether a move that a command is about can be made: the same answer for every command."""

from ...feedforward import Feasibility, Reference, check, from_move
from ...models import Move, Rig

RATE = 500.0
"""Samples per second at which a move is looked at [Hz], if it is not too long."""
MOST_LOOKS = 20_000
"""Samples at most."""
INFEASIBLE = "the move is not feasible"
"""What `exits.refuse` is told of a move with problems."""


def look_at(rig: Rig, reference: Reference, rate: float = RATE) -> Feasibility:
    """What is wrong with a move, at so many samples per second or more [Hz]."""
    return check(rig, reference, rate=min(max(RATE, rate), MOST_LOOKS / reference.duration))


def problems_of(rig: Rig, move: Move) -> tuple[str, ...]:
    """All that keeps a rig from making a move, one sentence each.

    Raises
    ------
    FlatrigError
        The move is none for this rig, or the rig is not flat.
    """
    return look_at(rig, from_move(move, rig)).problems
