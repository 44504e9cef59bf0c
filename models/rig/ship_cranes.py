"""Cranes on ships that heave, roll and pitch as they are told to, while loads keep their way.

A ship is a chain of frames whose motion is given: it heaves, rolls about its long axis and pitches,
both axes through the waterline amidships.  The sea is a sinusoid in each, so that a move starts and
ends in motion, without a jump.
"""

import math
from dataclasses import replace

from ..arguments import of_numbers
from .catalogue import CATALOGUE
from .move import Move
from .navy_cranes import navy_crane_3d
from .rig import Drive, Frame, Load, Rail, Rig, Rope, Trolley, Vector
from .sea import Wave
from .trolley_cranes import GRAVITY

SHIP = "ship"
"""The frame that pitches, and carries the crane."""
SEA = ((1.0, 8.0, 0.3), (math.radians(3.0), 10.0, 1.1), (math.radians(2.0), 7.0, 2.0))
"""Amplitude [m], [rad], period [s] and phase [rad] of heave, roll and pitch: a rough sea."""
CALM = 1.0 / 3.0
"""Share of that sea in which the Navy crane works: in the whole one its suspension rope would have
to push 150 N."""
X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def _ship(along: Vector, across: Vector) -> tuple[Frame, ...]:
    """Heave, roll about the ship's long axis, pitch about the one across."""
    return (
        Frame("heave", "sliding", given=True),
        Frame("roll", "turning", axis=along, parent="heave", given=True),
        Frame(SHIP, "turning", axis=across, parent="roll", given=True),
    )


def _engines() -> tuple[Drive, ...]:
    """Their inputs are accelerations [m/s2], [rad/s2]."""
    limits = {"heave": 5.0, "roll": 1.0, SHIP: 1.0}
    return tuple(Drive(name, on=name, limit=limit) for name, limit in limits.items())


def _waves(first: int, share: float = 1.0) -> tuple[Wave, ...]:
    """The sea in the columns from `first` on."""
    return tuple(
        Wave(first + i, share * amplitude, period, phase)
        for i, (amplitude, period, phase) in enumerate(SEA)
    )


_STILL = (0.0, 0.0, 0.0)


@CATALOGUE.add(
    move=Move(
        start=(22.0, 0.0, 11.0, *_STILL),
        goal=(10.0, 15.0, 7.0, *_STILL),
        duration=30.0,
        waves=_waves(3),
    ),
    environment="ShipCrane",
)
@of_numbers
def ship_crane(
    *,
    load_mass: float = 8e3,
    trolley_mass: float = 2e3,
    girder_mass: float = 15e3,
    girder_length: float = 24.0,
    winch_inertia: float = 60.0,
    drum_radius: float = 0.3,
    gravity: float = GRAVITY,
) -> Rig:
    """Rotary crane on a ship at sea: a girder on a tower on deck, a trolley, a hoist on two falls.

    The numbers are of no one machine but round ones of a coaster of 80 m with an 8 t crane: the
    deck 6 m above the waterline, the girder 16 m above the deck.  The load is led through the
    world, from the hold to alongside, whatever the ship does.

    Inputs: torque on the girder [N m], force on the trolley [N], torque of the winch [N m],
    accelerations of heave [m/s2], roll and pitch [rad/s2].
    Outputs: load.x, load.y, load.z [m], heave.position [m], roll.angle, ship.angle [rad].
    """
    weight = load_mass * gravity
    moment = girder_mass * girder_length**2 / 12.0
    return Rig(
        name="ship_crane",
        gravity=gravity,
        frames=(
            *_ship(X, Y),
            Frame(
                "girder",
                "turning",
                (0.0, moment, moment),
                origin=(10.0, 0.0, 6.0),
                parent=SHIP,
                mass=girder_mass,
                centre=(0.25 * girder_length, 0.0, 16.0),
            ),
        ),
        rails=(
            Rail(
                "rail",
                (1.0, 0.0, 0.0),
                (0.0, 0.0, 16.0),
                "girder",
                start=2.0,
                end=0.75 * girder_length,
            ),
        ),
        masses=(Trolley("trolley", trolley_mass, rail="rail"), Load("load", load_mass)),
        ropes=(Rope("hoist", ("trolley", "load"), drum_radius, winch_inertia, falls=2),),
        drives=(
            Drive("girder", on="girder", limit=2.5 * weight),
            Drive("trolley", on="trolley", limit=0.25 * weight),
            Drive("winch", on="hoist", limit=0.8 * weight * drum_radius),
            *_engines(),
        ),
        outputs=("load.x", "load.y", "load.z", "heave.position", "roll.angle", "ship.angle"),
        home={"girder": 0.0, "trolley": 12.0, "load": (22.0, 0.0, 11.0)},
    )


_FOOT = 10.0
"""Height of the foot of the Navy crane's boom above the waterline [m]."""


@CATALOGUE.add(
    move=Move(
        start=(8.0, 0.0, _FOOT - 5.0, _FOOT + 2.5, *_STILL),
        goal=(1.0, 7.8, _FOOT - 3.0, _FOOT + 2.5, *_STILL),
        duration=20.0,
        order=6,
        waves=_waves(4, CALM),
    ),
    environment="NavyShipCrane",
)
@of_numbers
def navy_ship_crane(
    *,
    load_mass: float = 100.0,
    pulley_mass: float = 5.0,
    platform_mass: float = 6.4,
    height: float = _FOOT,
    gravity: float = GRAVITY,
) -> Rig:
    """US Navy crane on a ship at sea (K 3.1.2, Y 6.2, of which the sources hold the ship still).

    `navy_crane_3d` whose platform turns on a pedestal amidships, its boom's foot `height` above
    the waterline.  The ship's bow is at +y; the load comes aboard over its side.  Its drives are
    stronger by 60 %: to hold the load on the way while the ship moves takes that.

    Inputs: as there, then accelerations of heave [m/s2], roll and pitch [rad/s2].
    Outputs: as there, then heave.position [m], roll.angle, ship.angle [rad].
    """
    crane = navy_crane_3d(
        load_mass=load_mass, pulley_mass=pulley_mass, platform_mass=platform_mass, gravity=gravity
    )
    (boom,), ship = crane.frames, _ship(Y, X)
    x, y, z = crane.home_point("pulley")
    pulley, load = (x, y, z + height), (x, y, z + height - 7.5)
    return replace(
        crane,
        name="navy_ship_crane",
        frames=(*ship, replace(boom, parent=SHIP, origin=(0.0, 0.0, height))),
        drives=(*(replace(d, limit=1.6 * d.limit) for d in crane.drives), *_engines()),
        outputs=(*crane.outputs, *(frame.coordinate for frame in ship)),
        home={"pulley": pulley, "load": load},
    )
