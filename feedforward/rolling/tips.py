"""Where round tips touch the object while it turns, and how the tips have to turn for it."""

import math
from dataclasses import dataclass

import numpy as np

from ...models.errors import PathError
from ...models.hand.hand import Hand, Tip
from ...models.hand.kiss_hands import on_sphere
from ...models.hand.move import HandMove
from ...models.types import Array
from ..series.products import apply, between, cross, derivative, dot, product, quotient
from ..series.rotation import rotation_of, sine_cosine
from .orientation import AboutAxis, Turning


@dataclass(frozen=True, eq=False)
class FixedTip:
    """A tip that does not turn; the contact goes round at R / (R + r) of the object's turn."""

    radius: float
    """Radius of the tip [m]."""
    object_radius: float
    """Radius of the object [m]."""
    start: Array
    """Direction from the object's centre to the contact at the beginning, in space, (3,)."""
    turning: AboutAxis
    """The object's turn."""

    def direction(self, part: Array, rotation: Array) -> Array:
        """Series (orders, N, 3) of the direction to the contact, in space.

        Takes the series of the share of the move that is done, and of the object's rotation.
        """
        del rotation  # the turn itself is known
        factor = self.object_radius / (self.object_radius + self.radius)
        return self.turning.turned(part, factor) @ self.start


@dataclass(frozen=True, eq=False)
class TurningTip:
    """A tip turned by motors, so that its contact goes to any place on the object."""

    radius: float
    """Radius of the tip [m]."""
    object_radius: float
    """Radius of the object [m]."""
    start: tuple[float, float]
    """(azimuth, latitude) of the contact in the object's axes at the beginning [rad]."""
    goal: tuple[float, float]
    """The same at the end [rad]."""
    missing: Array | None
    """The direction about which a tip with two axes cannot turn, (3,); None with three axes."""

    def direction(self, part: Array, rotation: Array) -> Array:
        """Series (orders, N, 3) of the direction to the contact, in space; see `FixedTip`."""
        angles = between(np.array(self.start), np.array(self.goal), part)
        (sine, cosine), (height, level) = (sine_cosine(angles[..., i]) for i in (0, 1))
        own = np.stack((product(level, cosine), product(level, sine), height), axis=-1)
        return apply(rotation, own)

    def spinning(self, direction: Array, rate: Array) -> Array:
        """Series (orders - 1, N, 3) of the tip's angular velocity (K 2.100).

        Rolling fixes it up to a spin about the contact normal: none with three axes, with two
        what they need.  Takes the series of the direction and of the object's angular velocity.
        """
        moving = derivative(direction)
        at = direction[: len(moving)]
        reach = self.object_radius + self.radius
        across = reach * moving - self.object_radius * cross(rate, at)
        turn = cross(at, across) / self.radius
        if self.missing is None:
            return turn
        axis = np.zeros_like(at)
        axis[0] = self.missing
        spin = quotient(dot(turn, axis), dot(at, axis))
        return turn - product(np.broadcast_to(spin[..., None], at.shape), at)


def tip_paths(hand: Hand, move: HandMove, turning: Turning) -> dict[str, FixedTip | TurningTip]:
    """Paths of the contacts on a hand's round tips, by the finger's name.

    Raises
    ------
    PathError
        The move gives contacts for another number of fingers, or asks fixed tips for
        a turn about a changing axis, or for contacts of their own.
    """
    tips = [finger for finger in hand.fingers if isinstance(finger.surface, Tip)]
    for name in ("contacts", "start_contacts"):
        count = len(getattr(move, name))
        if count not in (0, len(tips)):
            raise PathError(f"the move has {count} {name}, hand {hand.name} has {len(tips)} tips")
    paths: dict[str, FixedTip | TurningTip] = {}
    radius = hand.held.radius
    for i, finger in enumerate(tips):
        surface = finger.surface
        assert isinstance(surface, Tip)
        own_start = move.start_contacts[i] if move.start_contacts else None
        if surface.axes:
            start = own_start or _angles(finger.contact)
            goal = move.contacts[i] if move.contacts else start
            missing = np.cross(*np.array(surface.axes)) if len(surface.axes) == 2 else None
            paths[finger.name] = TurningTip(surface.radius, radius, start, goal, missing)
            continue
        if not isinstance(turning, AboutAxis):
            raise PathError(
                f"hand {hand.name}: the tip of finger {finger.name} is fixed and its contact "
                f'goes where rolling takes it; turn the object with turning="axis", not '
                f"{move.turning!r}"
            )
        if move.contacts:
            raise PathError(f"hand {hand.name}: finger {finger.name} is fixed, give no contacts")
        first = np.array(finger.contact)
        if own_start is not None:
            first = rotation_of(move.start) @ on_sphere(*own_start)
        paths[finger.name] = FixedTip(surface.radius, radius, first, turning)
    return paths


def _angles(direction: tuple[float, float, float]) -> tuple[float, float]:
    """Azimuth and latitude of a unit vector [rad]."""
    x, y, z = direction
    return (math.atan2(y, x), math.asin(max(-1.0, min(1.0, z))))
