"""Whether a move that a command is about can be made: the same answer for every command."""

from dataclasses import replace

from ...feedforward import Clearance, Feasibility, Reference, check, clearance, from_move
from ...models import Move, Rig
from ...models.errors import PathError, RigError

RATE = 500.0
"""Samples per second at which a move is looked at [Hz], if it is not too long."""
MOST_LOOKS = 20_000
"""Samples at most."""
INFEASIBLE = "the move is not feasible"
"""What `exits.refuse` is told of a move with problems."""


def look_at(
    rig: Rig, reference: Reference, rate: float = RATE, *, near: Clearance | None = None
) -> Feasibility:
    """What is wrong with a move, at so many samples per second or more [Hz].

    How near it comes to obstacles counts, too, where that is known.
    """
    report = check(rig, reference, rate=min(max(RATE, rate), MOST_LOOKS / reference.duration))
    if near is None or near.clear:
        return report
    return replace(report, problems=(*report.problems, str(near)))


def nearest(rig: Rig, move: Move, reference: Reference) -> Clearance | None:
    """How near a move comes to its obstacles; None without any, or where it has no solution."""
    if not move.obstacles:
        return None
    try:
        return clearance(rig, reference, move.obstacles, load_radius=move.load_radius)
    except (PathError, RigError):  # what else is said of the move says why
        return None


def problems_of(rig: Rig, move: Move) -> tuple[str, ...]:
    """All that keeps a rig from making a move, one sentence each.

    Raises
    ------
    FlatrigError
        The move is none for this rig, or the rig is not flat.
    """
    reference = from_move(move, rig)
    return look_at(rig, reference, near=nearest(rig, move, reference)).problems
