"""The rotary crane of Y 2.4 by directors: 42 coordinates, 37 constraints, 5 degrees of freedom.

Girder, trolley and winch are rigid bodies, the load is a point mass.  The girder turns about the
tower, the trolley slides along the girder, the winch turns in the trolley and pays out the rope.
The girder's angle, the trolley's place and the winch's angle are coordinates beside the bodies'.
"""

from .bodies import (
    GROUND,
    Angle,
    Body,
    Mechanism,
    Point,
    Prismatic,
    Revolute,
    Rope,
    Slide,
    euler_of,
)

INERTIA = {
    "girder": (216.67, 216.67, 16.67),
    "trolley": (2.08, 2.08, 2.08),
    "winch": (0.26, 0.02, 0.26),
}
"""Principal inertias (Y table 2.1) [kg m^2]."""
MASS = {"girder": 100.0, "trolley": 50.0, "winch": 3.0, "load": 10.0}
"""Masses (Y tables 2.1 and 2.2) [kg]."""
DRUM_RADIUS = 0.1
"""Radius of the winch's drum [m]."""


def rotary_crane(
    *, place: float = 2.5, length: float = 5.0, spin: float = 1.0, gravity: float = 9.81
) -> Mechanism:
    """The crane turning freely, the load hanging at rest against it (Y 2.4).

    Parameters
    ----------
    place
        The trolley's distance from the tower [m]; 1.5 in Y 2.90, 2.5 in Y table 2.2.
    length
        Length of the rope [m].
    spin
        Angular velocity of the girder [rad/s].
    gravity
        Gravitational acceleration, downwards [m/s^2].
    """
    up, along, across = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    turning, moving = (0.0, 0.0, spin), (0.0, place * spin, 0.0)

    def body(name: str, position: tuple[float, ...], velocity: tuple[float, ...]) -> Body:
        inertia = INERTIA.get(name)
        euler = euler_of(inertia) if inertia else ()
        rotating = turning if inertia else ()
        return Body(name, MASS[name], euler, position, velocity=velocity, spin=rotating)

    return Mechanism(
        "rotary crane",
        bodies=(
            body("girder", (0.0, 0.0, 0.0), ()),
            body("trolley", (place, 0.0, 0.0), moving),
            body("winch", (place, 0.0, 0.0), moving),
            body("load", (place, 0.0, -length), moving),
        ),
        joints=(
            Revolute("tower", Point(GROUND), Point("girder"), axis=up),
            Prismatic("rail", Point("girder"), Point("trolley"), axis=along),
            Revolute("axle", Point("trolley"), Point("winch"), axis=across),
            Rope("hoist", Point("winch"), Point("load"), angle="winding", radius=DRUM_RADIUS),
        ),
        augmentations=(
            Angle("bridge", GROUND, "girder", axis=up),
            Slide("along", Point("girder"), Point("trolley"), axis=along),
            Angle("winding", "trolley", "winch", axis=across),
        ),
        gravity=(0.0, 0.0, -gravity),
    )
