"""CABLEV: a platform on three ropes from three trolleys on a gantry (Y 6.3)."""

import math

from ..arguments import of_numbers
from ..values import Vector
from .catalogue import CATALOGUE
from .move import Move
from .rig import Anchor, Combination, Drive, Frame, Platform, Rail, Rig, Rope, Trolley
from .trolley_cranes import GRAVITY

ROOT3 = math.sqrt(3.0)
_PLACE, _LEVEL, _SPREAD = (1.0 + 0.2 * ROOT3, 1.2, -3.0), (0.0, 0.0, 0.0), 0.6 * ROOT3
_TURNED = (-math.pi / 6, -math.pi / 4, math.pi / 3)
_FAR = (3.0 + 0.2 * ROOT3, 5.0, -1.0)


def _move(place: Vector, angles: Vector, turning: tuple[int, ...] = ()) -> Move:
    """From the source's initial place, level, to another place and other Bryant angles."""
    return Move(
        start=(*_PLACE, *_LEVEL, _SPREAD),
        goal=(*place, *angles, _SPREAD),
        duration=20.0,
        profile="three_phase",
        turning=turning,
    )


MANIPULATOR_MOVES: dict[str, Move] = {
    "turn": _move(_PLACE, (0.0, 0.0, math.pi / 3)),
    "line": _move(_FAR, _LEVEL),
    "line and turn": _move(_FAR, _TURNED, turning=(3, 4, 5)),
}
"""CABLEV's moves (a), (b), (c) of Y 6.3.7, seen with z up: alpha and beta change their signs."""


@CATALOGUE.add(move=MANIPULATOR_MOVES["line"], environment="CableManipulator")
@of_numbers
def cable_manipulator(
    *,
    platform_mass: float = 12.5,
    platform_side: float = 1.2,
    platform_inertia_x: float = 0.75,
    platform_inertia_y: float = 0.75,
    platform_inertia_z: float = 1.5,
    gantry_mass: float = 380.0,
    trolley_mass: float = 35.0,
    rail_distance: float = 0.6,
    winch_inertia_1: float = 0.75,
    winch_inertia_2: float = 0.75,
    winch_inertia_3: float = 1.5,
    drum_radius: float = 0.1,
    gravity: float = GRAVITY,
) -> Rig:
    """Cable suspension manipulator CABLEV (Y 6.3).

    A gantry slides along y; it carries three rails along x, `rail_distance` apart, with a trolley
    and a winch on each; ropes 1, 2, 3 go to the corners of a platform, an equilateral triangle
    of side `platform_side`.  `gantry_mass` is all that moves along y, trolleys included (Y 6.86).
    The printed J_1 = J_2 = 0.75, J_3 = 1.5 kg m2 are the platform's principal inertias to the last
    digit and stand for it; the winches' own are not printed and get the same numbers.  The side is
    not printed either: it follows from the initial configuration.

    Inputs: force on the gantry, forces on the trolleys [N], torques of the winches [N m].
    Outputs: platform.x, .y, .z [m], Bryant angles platform.alpha, .beta, .gamma [rad], and
    spread, how far trolley 1 is ahead of the middle of the others [m] (Y 6.81, 6.82).  Y has z
    down: seen from here the signs of z, alpha and beta are the other ones.
    """
    frame, numbers = "gantry", "123"
    offsets = (0.0, rail_distance, -rail_distance)
    winch_inertias = (winch_inertia_1, winch_inertia_2, winch_inertia_3)
    weight = platform_mass * gravity
    corners = (
        (platform_side * ROOT3 / 3, 0.0, 0.0),
        (-platform_side * ROOT3 / 6, 0.5 * platform_side, 0.0),
        (-platform_side * ROOT3 / 6, -0.5 * platform_side, 0.0),
    )
    ahead = rail_distance * ROOT3
    return Rig(
        name="cable_manipulator",
        gravity=gravity,
        frames=(Frame(frame, "sliding", gantry_mass - 3 * trolley_mass, (0.0, 1.0, 0.0)),),
        anchors=tuple(
            Anchor(f"corner_{n}", corner, "platform")
            for n, corner in zip(numbers, corners, strict=True)
        ),
        rails=tuple(
            Rail(f"rail_{n}", (1.0, 0.0, 0.0), (0.0, offset, 0.0), frame)
            for n, offset in zip(numbers, offsets, strict=True)
        ),
        masses=(
            *(Trolley(f"trolley_{n}", trolley_mass, f"rail_{n}") for n in numbers),
            Platform(
                "platform",
                platform_mass,
                (platform_inertia_x, platform_inertia_y, platform_inertia_z),
            ),
        ),
        ropes=tuple(
            Rope(f"hoist_{n}", (f"trolley_{n}", f"corner_{n}"), drum_radius, inertia)
            for n, inertia in zip(numbers, winch_inertias, strict=True)
        ),
        drives=(
            Drive("gantry", on=frame, limit=weight),
            *(Drive(f"trolley_{n}", on=f"trolley_{n}", limit=0.5 * weight) for n in numbers),
            *(Drive(f"winch_{n}", on=f"hoist_{n}", limit=weight * drum_radius) for n in numbers),
        ),
        combinations=(
            Combination("spread", tuple(f"trolley_{n}.position" for n in numbers), (1, -0.5, -0.5)),
        ),
        outputs=(
            *(f"platform.{axis}" for axis in ("x", "y", "z", "alpha", "beta", "gamma")),
            "spread",
        ),
        home={
            "gantry": 1.2,
            "trolley_1": 1.0 + ahead,
            "trolley_2": 1.0,
            "trolley_3": 1.0,
            "platform": (1.0 + ahead / 3, 1.2, -3.0),
        },
    )
