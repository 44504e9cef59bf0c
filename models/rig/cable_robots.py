"""Cable robots: platforms on more ropes than they have freedoms."""

from ..arguments import of_numbers
from .catalogue import CATALOGUE
from .move import Move
from .rig import Anchor, Drive, Platform, Rig, Rope
from .trolley_cranes import GRAVITY

EXITS = (
    (-7.1775, -5.4361, 5.3911),
    (-7.4594, -5.1504, 5.3999),
    (-7.3911, 5.1940, 5.3976),
    (-7.1026, 5.4753, 5.4094),
    (7.2398, 5.3759, 5.4093),
    (7.5208, 5.0851, 5.4200),
    (7.4461, -5.2539, 5.3874),
    (7.1608, -5.5342, 5.3973),
)
"""Where CoGiRo's ropes leave their last pulleys, seen from the middle of its floor [m]."""

CORNERS = (
    (0.5032, -0.4928, 0.0),
    (-0.5097, 0.3508, 0.9976),
    (-0.5032, -0.2700, 0.0),
    (0.4960, 0.3561, 0.9996),
    (-0.5032, 0.4928, 0.0),
    (0.4998, -0.3404, 0.9991),
    (0.5021, 0.2750, -0.0007),
    (-0.5045, -0.3463, 0.9976),
)
"""Where they are tied to its platform, in the platform's own frame of reference [m]."""

CENTRE = (-0.034, -0.013, 0.264)
"""Centre of mass of the platform in the same frame [m]."""

PRODUCTS = (-0.453, 3.012, -1.539)
"""The platform's products of inertia xy, xz, yz about its centre of mass [kg m2]."""

NUMBERS = "12345678"


@CATALOGUE.add(
    move=Move(
        start=(0.0, 0.0, 1.5, 0.0, 0.0, 0.0), goal=(2.5, 1.5, 2.5, 0.0, 0.0, 0.2), duration=5.0
    ),
    environment="CableRobot",
)
@of_numbers
def cable_robot(
    *,
    platform_mass: float = 91.058,
    platform_inertia_x: float = 36.598,
    platform_inertia_y: float = 35.982,
    platform_inertia_z: float = 25.439,
    drum_radius: float = 0.1,
    winch_inertia: float = 0.1,
    tension: float = 0.0,
    gravity: float = GRAVITY,
) -> Rig:
    """CoGiRo, a suspended cable robot of 15 m x 11 m x 6 m with eight ropes for six freedoms.

    Exits of the ropes, corners, mass, centre and inertia tensor of the empty platform are those
    of CASPR's model of it (Lau et al., IROS 2016), the robot is described by Gouttefarde et al.,
    IEEE Trans. Robotics 31 (2015) 1444.  Its ropes stand 5 kN; drums and winches are not in
    print, `drum_radius` and `winch_inertia` are chosen.  Ropes run from point to point here; the
    last pulleys have no radius.

    Inputs: torques of the winches [N m], two more than outputs: of all tensions that make a
    motion those are taken whose force densities are closest to those of `tension` [N] in each
    rope at home.  Outputs: platform.x, .y, .z of its centre of mass [m] and its Bryant angles.
    """
    products = (part * platform_inertia_x / 36.598 for part in PRODUCTS)
    inertia = (platform_inertia_x, platform_inertia_y, platform_inertia_z, *products)
    limit = 5000.0 * drum_radius
    return Rig(
        name="cable_robot",
        gravity=gravity,
        anchors=(
            *(Anchor(f"exit_{n}", place) for n, place in zip(NUMBERS, EXITS, strict=True)),
            *(
                Anchor(f"corner_{n}", _from_centre(place), "platform")
                for n, place in zip(NUMBERS, CORNERS, strict=True)
            ),
        ),
        masses=(Platform("platform", platform_mass, inertia),),
        ropes=tuple(
            Rope(f"rope_{n}", (f"exit_{n}", f"corner_{n}"), drum_radius, winch_inertia)
            for n in NUMBERS
        ),
        drives=tuple(Drive(f"winch_{n}", on=f"rope_{n}", limit=limit) for n in NUMBERS),
        outputs=tuple(f"platform.{axis}" for axis in ("x", "y", "z", "alpha", "beta", "gamma")),
        home={"platform": (0.0, 0.0, 1.5)},
        distribution={f"rope_{n}": tension for n in NUMBERS} if tension else {},
    )


def _from_centre(place: tuple[float, float, float]) -> tuple[float, float, float]:
    """A place on the platform from its centre of mass [m]."""
    x, y, z = (round(a - b, 6) for a, b in zip(place, CENTRE, strict=True))
    return (x, y, z)
