"""From a move's description to its reference path."""

from ...models.errors import PathError
from ...models.rig.move import Move
from ...models.values import shown
from .recordings import from_csv
from .reference import Reference
from .straight import rest_to_rest, three_phase
from .turning import fixed_axis
from .waves import at_sea


def from_move(move: Move) -> Reference:
    """The path that a move describes.

    A sampled move follows its CSV: start, goal and duration are the file's, and if the move has a
    start of its own, the file needs as many outputs.

    Raises
    ------
    PathError
        It is no move, or the move's numbers make no path, or its file cannot be used.
    """
    if not isinstance(move, Move):
        raise PathError(f"move is {shown(move)}, it must be a Move")
    if move.profile == "sampled":
        path: Reference = from_csv(move.samples, move.order, size=len(move.start) or None)
        return at_sea(path, move.waves)
    if move.profile == "three_phase":
        path = three_phase(move.start, move.goal, move.duration, move.blend, move.order)
    else:
        path = rest_to_rest(move.start, move.goal, move.duration, move.order)
    if move.turning:
        return at_sea(fixed_axis(path, move.turning), move.waves)
    return at_sea(path, move.waves)
