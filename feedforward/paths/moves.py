"""From a move's description to its reference path."""

from ...models.errors import PathError
from ...models.rig.move import Move
from ...models.rig.rig import Rig
from ...models.values import shown
from .base_motion import BaseMotion, recorded
from .curves import CurvedPath, Waypoints, over
from .deck import deck_of
from .recordings import from_csv
from .reference import Reference
from .straight import rest_to_rest, three_phase
from .turning import fixed_axis
from .waves import at_sea


def from_move(move: Move, rig: Rig | None = None) -> Reference:
    """The path that a move describes.

    A sampled move follows its CSV: start, goal and duration are the file's, and if the move has a
    start of its own, the file needs as many outputs.

    Parameters
    ----------
    move
        From rest to rest, but for a base that moves.
    rig
        Whose outputs are led; a move on a frame of it (`Move.frame`) needs it.

    Raises
    ------
    PathError
        It is no move, or the move's numbers make no path, or its files cannot be used, or what it
        leads cannot be on its frame.
    """
    if not isinstance(move, Move):
        raise PathError(f"move is {shown(move)}, it must be a Move")
    path = _still(move)
    return at_sea(path, _base(move, rig, path.order))


def _still(move: Move) -> Reference:
    """The path without its base's motion."""
    if move.profile == "sampled":
        return from_csv(move.samples, move.order, size=len(move.start) or None)
    path = (
        three_phase(move.start, move.goal, move.duration, move.blend, move.order)
        if move.profile == "three_phase"
        else rest_to_rest(move.start, move.goal, move.duration, move.order)
    )
    if move.turning:
        return fixed_axis(path, move.turning)
    if move.rise:
        curve = over(move.start, move.goal, move.rise, move.duration, move.order).curve
        return CurvedPath(curve, move.duration, path.profile)
    if move.waypoints:
        points = (move.start, *move.waypoints, move.goal)
        return CurvedPath(Waypoints(points, move.order), move.duration, path.profile)
    return path


def _base(move: Move, rig: Rig | None, order: int) -> BaseMotion:
    """What the move says of a base."""
    if move.frame and rig is None:
        raise PathError(
            f"the move's places are on frame {move.frame}, and only its rig knows where that is: "
            "say from_move(move, rig)"
        )
    deck = deck_of(rig, move.frame) if move.frame and rig is not None else None
    records = tuple(recorded(record, order) for record in move.records)
    return BaseMotion(move.waves, records, deck)
