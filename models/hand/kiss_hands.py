"""The hands of K's chapter 2, and a move for each whose forces fit into its friction cones.

    hand = ball_in_corner(radius=0.02)

Numbers that K prints are the defaults; masses, friction and sizes that K leaves open are chosen
for objects of a hand's size.
"""

import math
from dataclasses import replace

from ..arguments import of_numbers
from ..errors import RigError
from ..values import Vector
from .catalogue import HAND_CATALOGUE
from .hand import IN_PLANE, SOLID, Finger, Hand, HeldObject, Plate, Tip, unit
from .move import HandMove

_PI = math.pi
_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_DOWN = (0.0, 0.0, -1.0)


_BY_ROLLING = HandMove(
    start=(_PI / 3, _PI / 4, 0.0), goal=(_PI / 4, 0.0, _PI / 3), duration=10.0, turning="rolling"
)
"""K's move of the balls on plates (figure 2.15)."""


def on_sphere(azimuth: float, latitude: float) -> Vector:
    """The unit vector at an azimuth and a latitude [rad].

    K 2.109 prints the two the other way round; only so do K's forces press (figure 2.19).
    """
    return (
        math.cos(latitude) * math.cos(azimuth),
        math.cos(latitude) * math.sin(azimuth),
        math.sin(latitude),
    )


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


_PRESSED_UP = ((7 * _PI / 6, -_PI / 4), (11 * _PI / 6, -_PI / 4), (_PI / 2, -_PI / 4))
"""Where three fingers touch at the start, azimuth and latitude [rad].

K prints 13 pi/6 for where the second contact begins; with 11 pi/6, as at the end, the three are
spread evenly and K's figure 2.19 comes out, with 13 pi/6 it does not.
"""
_THREE_FINGERS = HandMove(
    goal=(_PI / 6, _PI / 6, -_PI / 6),
    shift=(0.05, 0.05, 0.1),
    duration=1.0,
    start_contacts=_PRESSED_UP,
    contacts=(
        (17 * _PI / 18, -_PI / 3),
        (11 * _PI / 6, -_PI / 4),
        (13 * _PI / 36, -5 * _PI / 36),
    ),
)
"""K's example 8 but for where the contacts end."""


def _ball(radius: float, mass: float) -> HeldObject:
    return HeldObject("sphere", radius, mass)


@HAND_CATALOGUE.add(move=_BY_ROLLING, environment="BallOnPlate")
@of_numbers
def ball_on_plate(
    *,
    radius: float = 0.05,
    mass: float = 0.2,
    friction: float = 1.0,
    plate_radius: float = 0.4,
    spin: bool = True,
) -> Hand:
    """A ball on a plate that moves every way (K example 1)."""
    plate = Finger("plate", Plate(_Z, plate_radius))
    held, place = _ball(radius, mass), (0.0, 0.0, radius)
    return Hand("ball_on_plate", held, (plate,), friction, spin=spin, position=place)


def _two_plates(name: str, lower: Hand, normal: Vector) -> Hand:
    """A hand of one plate with a second one, which moves along its normal only."""
    below = lower.fingers[0]
    size = below.surface.radius
    fingers = (
        replace(below, name="lower"),
        Finger("upper", Plate(normal, size), slides=(normal,)),
    )
    return replace(lower, name=name, fingers=fingers)


@HAND_CATALOGUE.add(move=_BY_ROLLING, environment="BallBetweenPlates")
@of_numbers
def ball_between_plates(
    *,
    radius: float = 0.05,
    mass: float = 0.2,
    friction: float = 1.0,
    plate_radius: float = 0.4,
    spin: bool = True,
) -> Hand:
    """A ball between parallel plates, of which the upper one only presses (K example 2)."""
    lower = ball_on_plate(
        radius=radius, mass=mass, friction=friction, plate_radius=plate_radius, spin=spin
    )
    return _two_plates("ball_between_plates", lower, _DOWN)


@HAND_CATALOGUE.add(move=_between_oblique(_PI / 6, _PI / 4, _PI / 3))
@of_numbers
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
    lower = ball_on_plate(radius=radius, mass=mass, friction=friction, plate_radius=plate_radius)
    if not 0.0 < abs(tilt) < _PI / 2:
        raise RigError(f"tilt is {tilt:g} rad, it must be between 0 and pi/2 in size")
    normal = (math.sin(tilt), 0.0, -math.cos(tilt))
    return _two_plates("ball_between_oblique_plates", lower, normal)


@HAND_CATALOGUE.add(
    move=HandMove(goal=(_PI / 3, _PI / 6, _PI / 4), duration=10.0), environment="BallInCorner"
)
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


@HAND_CATALOGUE.add(
    move=HandMove(goal=(_PI / 6,), shift=(0.1, 0.0, 0.1), duration=2.0, order=2, turning="axis"),
    environment="TwoFingerHand",
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


@HAND_CATALOGUE.add(
    move=_THREE_FINGERS,
    # No forces inside friction cones can make K's example 8: at its end a finger has to pull.
    printed=replace(
        _THREE_FINGERS,
        contacts=((2 * _PI / 3, -_PI / 2), (11 * _PI / 6, -_PI / 4), (_PI / 2, -_PI / 4)),
    ),
    environment="ThreeFingerHand",
)
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
        for i, place in enumerate(_PRESSED_UP, start=1)
    )
    return Hand("three_finger_hand", _ball(radius, mass), fingers, friction, position=(0.1,) * 3)
