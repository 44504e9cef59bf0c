"""How the centre of a rolling object moves: where it is sent, and where rolling carries it."""

from dataclasses import dataclass

import numpy as np

from ...models.errors import PathError
from ...models.hand.hand import Hand, Plate
from ...models.hand.move import HandMove
from ...models.types import Array
from ..series.products import between
from .kinematics import cross_matrix, projector
from .progress import share

TOLERANCE = 1e-9
"""Part of a shift that may get lost [m], and singular value of the plates' constraints that counts
as zero: both are rounding of numbers of order one."""


@dataclass(frozen=True, eq=False)
class Carried:
    """The centre's velocity is free @ (a velocity one chooses) + rolled @ (angular velocity)."""

    hand: Hand
    """The hand."""
    move: HandMove
    """The move, whose shift is the part that one chooses."""
    free: Array
    """Projector on the directions one chooses, (3, 3)."""
    rolled: Array
    """Velocity of the centre for each angular velocity of the object [m], (3, 3)."""

    def position(self, times: Array, swept: Array) -> Array:
        """Series (orders, N, 3), with the series of W, the integral of the angular velocity."""
        shift = self.free @ np.array(self.move.shift)
        series = between(np.zeros(3), shift, share(self.move, times)) + swept @ self.rolled.T
        series[0] += self.hand.position
        return series


def carried_by(hand: Hand, move: HandMove) -> Carried:
    """Derive it from the plates that cannot move every way.

    On a single plate nothing but friction moves the ball, so that m p'' and the rate of J w come
    from one force: along the plate the centre follows p' = J / (m R) n x w, and the plate moves
    under it accordingly.

    Raises
    ------
    PathError
        The move shifts the centre where rolling alone decides.
    """
    radius, fingers = hand.held.radius, hand.fingers
    if len(fingers) == 1 and isinstance(fingers[0].surface, Plate):
        normal = np.array(fingers[0].surface.normal)
        free = np.outer(normal, normal)
        rolled = hand.held.inertia / (hand.held.mass * radius) * cross_matrix(normal)
    else:
        blocked = [
            (np.eye(3) - projector(finger.slides), cross_matrix(np.array(finger.contact)))
            for finger in fingers
            if isinstance(finger.surface, Plate)
        ] or [(np.zeros((3, 3)), np.zeros((3, 3)))]
        stops = np.vstack([stop for stop, _ in blocked])
        turns = radius * np.vstack([stop @ turn for stop, turn in blocked])
        inverse = np.linalg.pinv(stops, rcond=TOLERANCE)
        free, rolled = np.eye(3) - inverse @ stops, inverse @ turns
    if hand.planar:
        free = free @ np.diag([1.0, 0.0, 1.0])
    lost = np.array(move.shift) - free @ np.array(move.shift)
    if np.abs(lost).max() > TOLERANCE:
        amount = ", ".join(f"{value:.4g}" for value in lost)
        raise PathError(
            f"hand {hand.name} cannot shift the object by ({amount}) m of the move's shift: there "
            "rolling decides where it goes; leave that part out"
        )
    return Carried(hand, move, free, rolled)
