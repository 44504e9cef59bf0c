"""US Navy cranes: a load on a pulley that ropes hold in the air, in a plane and in space.

Sources: Y = Yang 2016, K = Kiss 2001.  Limits of the drives are not in the sources; they follow
from the weights and leave a third above what the default moves need.
"""

import math

from ..arguments import of_numbers
from .catalogue import CATALOGUE
from .move import Move
from .rig import Anchor, Drive, Frame, Load, Rig, Rope
from .trolley_cranes import GRAVITY

_ROOT3 = math.sqrt(3.0)
_PLANE_START, _SPACE_START = (-2.5 * _ROOT3, -22.5, -12.5), (5.0 * _ROOT3, 0.0, -15.0, 2.5)


@CATALOGUE.add(
    move=Move(_PLANE_START, goal=(-7.0, -17.5, -10.5), duration=5.0),
    # Y 6.22, 6.23: its tagline would have to push.
    printed=Move(_PLANE_START, goal=(-1.0, -17.5, -10.5), duration=3.0),
    # Y 6.9, 6.10, the default in 5 s instead of the printed 3, in which the tagline would push.
    without_pulley_mass=(
        Move(start=(0.0, -15.0), goal=(-5.0, -12.0), duration=5.0),
        Move(start=(0.0, -15.0), goal=(-5.0, -12.0), duration=3.0),
    ),
    environment="NavyCrane2D",
)
@of_numbers
def navy_crane_2d(
    *,
    load_mass: float = 100.0,
    pulley_mass: float = 150.0,
    winch_inertia: float = 0.1,
    drum_radius: float = 0.1,
    boom_angle: float = math.pi / 3,
    tagline_distance: float = 10.0,
    suspension_distance: float = 5.0,
    gravity: float = GRAVITY,
) -> Rig:
    """US Navy crane in a plane: a load on a free pulley (K 3.1.1; Y 6.1.1, 6.1.2).

    The hoist rope runs from winch P over the pulley to the load; the tagline holds the pulley from
    winch A, `tagline_distance` below P on the boom.  A pulley with a mass also hangs on the
    suspension rope from winch S, `suspension_distance` above P.  `boom_angle` is the boom's, from
    the vertical [rad].  The origin is S, or P if the pulley has no mass, as in the source.

    Inputs: torques of tagline, hoist and suspension winch (u1, u2, u3) [N m].
    Outputs: load.x, load.z, pulley.z [m].
    A pulley without mass has neither suspension rope nor third input and output.
    """
    heavy = pulley_mass != 0
    along = (-math.sin(boom_angle), -math.cos(boom_angle))
    below = suspension_distance if heavy else 0.0
    tagline, hoist = ((d * along[0], 0.0, d * along[1]) for d in (below + tagline_distance, below))
    torque = load_mass * gravity * drum_radius
    # Home hangs straight below P, halfway down.
    drop = tagline_distance if heavy else 0.5 * tagline_distance
    place = (hoist[0], 0.0, hoist[2] - drop)
    drives = (
        Drive("tagline", on="tagline", limit=2.0 * torque),
        Drive("hoist", on="hoist", limit=2.0 * torque),
        Drive("suspension", on="suspension", limit=torque + pulley_mass * gravity * drum_radius),
    )
    return Rig(
        name="navy_crane_2d",
        dimensions=2,
        gravity=gravity,
        anchors=(
            Anchor("A", tagline),
            Anchor("P", hoist),
            *((Anchor("S", (0.0, 0.0, 0.0)),) if heavy else ()),
        ),
        masses=(Load("pulley", pulley_mass), Load("load", load_mass)),
        ropes=_navy_ropes(drum_radius, winch_inertia, ("tagline", "hoist", "suspension"), heavy),
        drives=drives if heavy else drives[:2],
        outputs=("load.x", "load.z", "pulley.z") if heavy else ("load.x", "load.z"),
        home={"pulley": place, "load": (place[0], 0.0, place[2] - 10.0)},
    )


@CATALOGUE.add(
    move=Move(_SPACE_START, goal=(-2.0, 4.0 * _ROOT3, -13.0, 2.5), duration=20.0, order=6),
    # Y 6.34 to 6.39 with z0 of 6.2.2: a rope would have to push, and the path is too rough.
    printed=Move(
        _SPACE_START,
        goal=(-2.0, 4.0 * _ROOT3, -13.0, 1.5),
        duration=20.0,
        profile="three_phase",
    ),
    # Y 6.34, 6.35
    without_pulley_mass=(
        Move(
            _SPACE_START[:3],
            goal=(-2.0, 4.0 * _ROOT3, -13.0),
            duration=20.0,
            profile="three_phase",
        ),
        None,
    ),
    environment="NavyCrane3D",
)
@of_numbers
def navy_crane_3d(
    *,
    load_mass: float = 100.0,
    pulley_mass: float = 5.0,
    platform_mass: float = 6.4,
    winch_inertia: float = 0.1,
    drum_radius: float = 0.1,
    boom_angle: float = math.pi / 3,
    tagline_distance: float = 5.0,
    hoist_distance: float = 10.0,
    suspension_distance: float = 15.0,
    gravity: float = GRAVITY,
) -> Rig:
    """US Navy crane on a turning platform (K 3.1.2, 3.2.4 example 11; Y 6.2).

    As `navy_crane_2d`, with the boom's foot at the origin and winches A, P and S at the given
    distances along it.  `platform_mass` counts at the radius of P: the inertia of the platform is
    `platform_mass` times that radius squared (Y 6.29).

    Inputs: torques of tagline, suspension and hoist winch (u1, u2, u3), torque on the boom (u4)
    [N m].  Outputs: load.x, load.y, load.z, pulley.z [m].
    A pulley without mass has neither suspension rope nor u2 and fourth output.
    """
    heavy = pulley_mass != 0
    radius, height = math.sin(boom_angle), math.cos(boom_angle)
    places = {"A": tagline_distance, "P": hoist_distance, "S": suspension_distance}
    weight = load_mass * gravity
    torque = weight * drum_radius
    tip = hoist_distance * radius
    # Home hangs straight below P, the pulley as high as A.
    pulley = (tip, 0.0, tagline_distance * height)
    drives = (
        Drive("tagline", on="tagline", limit=2.5 * torque),
        Drive("suspension", on="suspension", limit=2.0 * torque),
        Drive("hoist", on="hoist", limit=2.0 * torque),
        Drive("boom", on="boom", limit=0.5 * weight),
    )
    return Rig(
        name="navy_crane_3d",
        gravity=gravity,
        frames=(Frame("boom", "turning", platform_mass * tip**2),),
        anchors=tuple(
            Anchor(name, (distance * radius, 0.0, distance * height), "boom")
            for name, distance in places.items()
            if heavy or name != "S"
        ),
        masses=(Load("pulley", pulley_mass), Load("load", load_mass)),
        ropes=_navy_ropes(drum_radius, winch_inertia, ("tagline", "suspension", "hoist"), heavy),
        drives=drives if heavy else (drives[0], *drives[2:]),
        outputs=("load.x", "load.y", "load.z", *(("pulley.z",) if heavy else ())),
        home={"pulley": pulley, "load": (tip, 0.0, pulley[2] - 17.5)},
    )


def _navy_ropes(
    drum_radius: float, winch_inertia: float, order: tuple[str, ...], heavy: bool
) -> tuple[Rope, ...]:
    paths = {
        "tagline": ("A", "pulley"),
        "hoist": ("P", "pulley", "load"),
        "suspension": ("S", "pulley"),
    }
    return tuple(
        Rope(name, paths[name], drum_radius, winch_inertia)
        for name in order
        if heavy or name != "suspension"
    )
