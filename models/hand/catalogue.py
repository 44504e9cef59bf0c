"""The hands of K's chapter 2 by name, and a move for each.

    hand = ball_in_corner(radius=0.02)
    hand, move = make_hand("three-finger-hand"), default_hand_move("three-finger-hand")

Numbers that K prints are the defaults; masses, friction and sizes that K leaves open are chosen
for objects of a hand's size.
"""

import inspect
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from ..errors import RigError, did_you_mean
from ..values import Vector, of_numbers, word
from .hand import IN_PLANE, SOLID, Finger, Hand, HeldObject, Plate, Tip, unit
from .move import HandMove

_PI = math.pi
_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_DOWN = (0.0, 0.0, -1.0)


def on_sphere(azimuth: float, latitude: float) -> Vector:
    """The unit vector at an azimuth and a latitude [rad].

    K 2.109 prints the two the other way round; only so do K's forces press (figure 2.19).
    """
    return (
        math.cos(latitude) * math.cos(azimuth),
        math.cos(latitude) * math.sin(azimuth),
        math.sin(latitude),
    )


def _ball(radius: float, mass: float) -> HeldObject:
    return HeldObject("sphere", radius, mass)


@of_numbers
def _one_plate(*, radius: float, mass: float, friction: float, plate_radius: float) -> Hand:
    plate = Finger("plate", Plate(_Z, plate_radius))
    return Hand("ball_on_plate", _ball(radius, mass), (plate,), friction, position=(0, 0, radius))


def ball_on_plate(
    *,
    radius: float = 0.05,
    mass: float = 0.2,
    friction: float = 1.0,
    plate_radius: float = 0.4,
    spin: bool = True,
) -> Hand:
    """A ball on a plate that moves every way (K example 1)."""
    sizes = {"radius": radius, "mass": mass, "friction": friction, "plate_radius": plate_radius}
    return replace(_one_plate(**sizes), spin=spin)


def _two_plates(name: str, lower: Hand, normal: Vector) -> Hand:
    """A hand of one plate with a second one, which moves along its normal only."""
    below = lower.fingers[0]
    size = below.surface.radius
    fingers = (
        replace(below, name="lower"),
        Finger("upper", Plate(normal, size), slides=(normal,)),
    )
    return replace(lower, name=name, fingers=fingers)


def ball_between_plates(
    *,
    radius: float = 0.05,
    mass: float = 0.2,
    friction: float = 1.0,
    plate_radius: float = 0.4,
    spin: bool = True,
) -> Hand:
    """A ball between parallel plates, of which the upper one only presses (K example 2)."""
    sizes = {"radius": radius, "mass": mass, "friction": friction, "plate_radius": plate_radius}
    return _two_plates("ball_between_plates", replace(_one_plate(**sizes), spin=spin), _DOWN)


def ball_between_oblique_plates(
    *,
    radius: float = 0.05,
    mass: float = 0.2,
    friction: float = 1.0,
    plate_radius: float = 0.4,
    tilt: float = _PI / 6,
) -> Hand:
    """A ball between plates of which the upper one is tilted by `tilt` [rad] (K example 3).

    Raises
    ------
    RigError
        The plates are parallel, or the upper one does not face the lower one.
    """
    sizes = {"radius": radius, "mass": mass, "friction": friction, "plate_radius": plate_radius}
    lower = _one_plate(**sizes)
    if not 0.0 < abs(tilt) < _PI / 2:
        raise RigError(f"tilt is {tilt:g} rad, it must be between 0 and pi/2 in size")
    normal = (math.sin(tilt), 0.0, -math.cos(tilt))
    return _two_plates("ball_between_oblique_plates", lower, normal)


@of_numbers
def ball_in_corner(
    *,
    radius: float = 0.01,
    mass: float = 0.03,
    friction: float = 1.0,
    plate_radius: float = 0.1,
) -> Hand:
    """A ball in the corner of three perpendicular plates (K example 4)."""
    normals = {"plate_y": _Y, "plate_x": _X, "plate_z": _Z}
    fingers = tuple(Finger(name, Plate(normal, plate_radius)) for name, normal in normals.items())
    return Hand(
        "ball_in_corner", _ball(radius, mass), fingers, friction, position=(radius, radius, radius)
    )


@of_numbers
def two_finger_hand(
    *,
    radius: float = 0.05,
    tip_radius: float = 0.02,
    mass: float = 0.5,
    friction: float = 1.0,
) -> Hand:
    """A disc between two round tips in a vertical plane (K examples 5 and 7)."""
    fingers = tuple(
        Finger(name, Tip(tip_radius), contact, IN_PLANE, (0.2, 0.4))
        for name, contact in (("left", (-1.0, 0.0, 0.0)), ("right", _X))
    )
    held = HeldObject("disc", radius, mass)
    return Hand("two_finger_hand", held, fingers, friction, planar=True, position=(0, 0, 0.2))


@of_numbers
def three_finger_hand(
    *,
    radius: float = 0.1,
    tip_radius: float = 0.02,
    mass: float = 0.2,
    friction: float = 1.0,
) -> Hand:
    """A ball on three round tips that turn about x and y (K examples 6 and 8)."""
    tip = Tip(tip_radius, axes=(_X, _Y))
    fingers = tuple(
        Finger(f"finger{i}", tip, unit("contact", on_sphere(*place)))
        for i, place in enumerate(HAND_MOVES["three_finger_hand"].start_contacts, start=1)
    )
    return Hand("three_finger_hand", _ball(radius, mass), fingers, friction, position=(0.1,) * 3)


_BY_ROLLING = HandMove(
    start=(_PI / 3, _PI / 4, 0.0), goal=(_PI / 4, 0.0, _PI / 3), duration=10.0, turning="rolling"
)
_BY_ANGLES = HandMove(goal=(_PI / 3, _PI / 6, _PI / 4), duration=10.0)


def _between_oblique(tilt: float, lean: float, angle: float) -> HandMove:
    """A turn that two contacts can give: they have no moment about the line between them.

    About that line, the rate of turning and the sideways force it costs must cancel: with k =
    J / (m R^2) this is (k c + s sin(tilt)) w.z = s (k - cos(tilt)) w.x, s and c of half the tilt.
    """
    share, sine, cosine = SOLID["sphere"], math.sin(tilt / 2), math.cos(tilt / 2)
    x, z = share * cosine + sine * math.sin(tilt), sine * (share - math.cos(tilt))
    level = math.cos(lean) / math.hypot(x, z)
    goal = _rpy((level * x, math.sin(lean), level * z), angle)
    return HandMove(goal=goal, duration=10.0, turning="axis")


def _rpy(axis: Vector, angle: float) -> Vector:
    """RPY angles of a turn about a unit vector, from Rodrigues' first column and last row."""
    (x, y, z), sine, rest = axis, math.sin(angle), 1.0 - math.cos(angle)
    first = (1.0 - rest * (y * y + z * z), rest * x * y + sine * z, rest * x * z - sine * y)
    last = (rest * y * z + sine * x, 1.0 - rest * (x * x + y * y))
    return (math.atan2(first[1], first[0]), -math.asin(first[2]), math.atan2(*last))


HAND_MOVES: dict[str, HandMove] = {
    "ball_on_plate": _BY_ROLLING,
    "ball_between_plates": _BY_ROLLING,
    "ball_between_oblique_plates": _between_oblique(_PI / 6, _PI / 4, _PI / 3),
    "ball_in_corner": _BY_ANGLES,
    "two_finger_hand": HandMove(
        goal=(_PI / 6,), shift=(0.1, 0.0, 0.1), duration=2.0, order=2, turning="axis"
    ),
    "three_finger_hand": HandMove(
        goal=(_PI / 6, _PI / 6, -_PI / 6),
        shift=(0.05, 0.05, 0.1),
        duration=1.0,
        start_contacts=(
            (7 * _PI / 6, -_PI / 4),
            (11 * _PI / 6, -_PI / 4),
            (_PI / 2, -_PI / 4),
        ),
        contacts=(
            (17 * _PI / 18, -_PI / 3),
            (11 * _PI / 6, -_PI / 4),
            (13 * _PI / 36, -5 * _PI / 36),
        ),
    ),
}
"""A move for each hand whose forces fit into its friction cones.

The balls' on plates is K's (figure 2.15); between oblique plates the object turns as point
contacts allow.  The three fingers' is K's but for where the contacts end, see
`PRINTED_HAND_MOVES`.
"""

PRINTED_HAND_MOVES: dict[str, HandMove] = {
    "three_finger_hand": replace(
        HAND_MOVES["three_finger_hand"],
        contacts=((2 * _PI / 3, -_PI / 2), (11 * _PI / 6, -_PI / 4), (_PI / 2, -_PI / 4)),
    ),
}
"""K's example 8, which no forces inside friction cones can make: at its end a finger has to pull.

K prints 13 pi/6 for where the second contact begins; with 11 pi/6, as at the end, the three are
spread evenly and K's figure 2.19 comes out, with 13 pi/6 it does not.
"""

HAND_CATALOGUE: dict[str, Callable[..., Hand]] = {
    "ball_on_plate": ball_on_plate,
    "ball_between_plates": ball_between_plates,
    "ball_between_oblique_plates": ball_between_oblique_plates,
    "ball_in_corner": ball_in_corner,
    "two_finger_hand": two_finger_hand,
    "three_finger_hand": three_finger_hand,
}
"""Every hand by its name."""


def full_hand_name(name: str) -> str:
    """The catalogue's name for a name that may be short or hyphenated ("two-finger").

    Raises
    ------
    RigError
        No hand of the catalogue is called so.
    """
    plain = word("the name of a hand", name).replace("-", "_").lower()
    for known in HAND_CATALOGUE:
        if plain in (known, known.replace("_hand", "")):
            return known
    raise RigError(f"there is no hand {name!r}{did_you_mean(plain, HAND_CATALOGUE)}")


def make_hand(name: str, **overrides: Any) -> Hand:
    """A hand of the catalogue by name, with some of its numbers replaced.

    Raises
    ------
    RigError
        The name or an override is unknown, or a number is wrong.
    """
    full = full_hand_name(name)
    known = inspect.signature(HAND_CATALOGUE[full]).parameters
    for key in overrides:
        if key not in known:
            raise RigError(f"{full} has no parameter {key!r}{did_you_mean(key, known)}")
    return HAND_CATALOGUE[full](**overrides)


def default_hand_move(hand: Hand | str) -> HandMove:
    """The catalogue's move for a hand.

    Raises
    ------
    RigError
        No hand of the catalogue is called so.
    """
    return HAND_MOVES[full_hand_name(hand.name if isinstance(hand, Hand) else hand)]
