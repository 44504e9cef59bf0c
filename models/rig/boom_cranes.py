"""Cranes whose boom rises and falls: a luffing tower crane and a knuckle boom crane.

Their numbers are not of one machine but round ones of the size of such machines: a luffing-jib
tower crane of about 300 t m, and a knuckle boom crane as it stands on ships that work at sea.
Booms are slender rods with their mass spread evenly, of moment m L^2 / 12.  Drives have 1.4
(luffing) and 1.9 times (knuckle) what the default move needs: in its box a boom reaches further.
"""

from math import cos

from ..arguments import of_numbers
from .catalogue import CATALOGUE
from .move import Move
from .rig import Anchor, Drive, Frame, Load, Rig, Rope
from .trolley_cranes import GRAVITY

_LIFTS: tuple[float, float, float] = (0.0, -1.0, 0.0)
"""Axis about which a boom along x rises when its angle grows."""

_LUFFING_MOVE = Move(
    start=(1.5 + 40.0 * cos(0.78), 0.0, 8.0), goal=(16.0, 18.0, 14.0), duration=25.0
)
_KNUCKLE_MOVE = Move(
    start=(38.0 * cos(0.6), 0.0, 2.0, -1.2), goal=(22.0, 14.0, 6.0, -1.4), duration=12.0
)


@CATALOGUE.add(move=_LUFFING_MOVE, environment="LuffingCrane")
@of_numbers
def luffing_crane(
    *,
    load_mass: float = 5e3,
    jib_mass: float = 8e3,
    jib_length: float = 40.0,
    slewing_inertia: float = 1.5e6,
    height: float = 40.0,
    luffing_inertia: float = 200.0,
    hoisting_inertia: float = 60.0,
    drum_radius: float = 0.3,
    gravity: float = GRAVITY,
) -> Rig:
    """Luffing-jib tower crane: a slewing tower head, a jib that a rope from the A-frame luffs.

    The hoisting rope comes from a winch on the head and runs over the jib's tip to a block on two
    falls; the luffing tackle has eight.  A winch's moment of inertia is that of its drum with the
    geared motor.

    Inputs: torque on the tower [N m], torques of the luffing and of the hoisting winch [N m].
    Outputs: load.x, load.y, load.z [m].
    """
    weight, jib_weight = load_mass * gravity, jib_mass * gravity
    moment = jib_mass * jib_length**2 / 12.0
    return Rig(
        name="luffing_crane",
        gravity=gravity,
        frames=(
            Frame("tower", "turning", slewing_inertia),
            Frame(
                "jib",
                "turning",
                (0.0, moment, moment),
                axis=_LIFTS,
                origin=(1.5, 0.0, height),
                parent="tower",
                mass=jib_mass,
                centre=(0.5 * jib_length, 0.0, 0.0),
            ),
        ),
        anchors=(
            Anchor("winch", (-4.0, 0.0, height + 1.0), "tower"),
            Anchor("a_frame", (-4.0, 0.0, height + 12.0), "tower"),
            Anchor("pendant", (0.9 * jib_length, 0.0, 0.0), "jib"),
            Anchor("tip", (jib_length, 0.0, 0.0), "jib"),
        ),
        masses=(Load("load", load_mass),),
        ropes=(
            Rope("luffing", ("a_frame", "pendant"), drum_radius, luffing_inertia, falls=8),
            Rope("hoist", ("winch", "tip", "load"), drum_radius, hoisting_inertia, falls=2),
        ),
        drives=(
            Drive("slew", on="tower", limit=0.04 * weight * jib_length),
            Drive("luff", on="luffing", limit=0.4 * drum_radius * (weight + 0.5 * jib_weight)),
            Drive("winch", on="hoist", limit=0.7 * drum_radius * weight),
        ),
        outputs=("load.x", "load.y", "load.z"),
        home={"tower": 0.0, "jib": 0.78, "load": (1.5 + jib_length * cos(0.78), 0.0, 8.0)},
    )


@CATALOGUE.add(move=_KNUCKLE_MOVE, environment="KnuckleCrane")
@of_numbers
def knuckle_crane(
    *,
    load_mass: float = 15e3,
    boom_mass: float = 25e3,
    boom_length: float = 24.0,
    jib_mass: float = 9e3,
    jib_length: float = 14.0,
    column_inertia: float = 5e5,
    height: float = 10.0,
    winch_inertia: float = 400.0,
    drum_radius: float = 0.5,
    gravity: float = GRAVITY,
) -> Rig:
    """Knuckle boom crane: a slewing column, a boom, a jib hinged to its end, a winch at the tip.

    Inputs: torques on column, boom and jib, torque of the winch [N m].
    Outputs: load.x, load.y, load.z [m], jib.angle [rad] against the boom.
    """
    weight = load_mass * gravity
    reach = boom_length + jib_length
    boom_moment, jib_moment = (
        mass * length**2 / 12.0
        for mass, length in ((boom_mass, boom_length), (jib_mass, jib_length))
    )
    boom_torque = gravity * (boom_mass + 2.0 * jib_mass) * 0.5 * boom_length
    boom_torque += gravity * jib_mass * 0.5 * jib_length  # both outstretched and level
    return Rig(
        name="knuckle_crane",
        gravity=gravity,
        frames=(
            Frame("column", "turning", column_inertia),
            Frame(
                "boom",
                "turning",
                (0.0, boom_moment, boom_moment),
                axis=_LIFTS,
                origin=(0.0, 0.0, height),
                parent="column",
                mass=boom_mass,
                centre=(0.5 * boom_length, 0.0, 0.0),
            ),
            Frame(
                "jib",
                "turning",
                (0.0, jib_moment, jib_moment),
                axis=_LIFTS,
                origin=(boom_length, 0.0, 0.0),
                parent="boom",
                mass=jib_mass,
                centre=(0.5 * jib_length, 0.0, 0.0),
            ),
        ),
        anchors=(Anchor("tip", (jib_length, 0.0, 0.0), "jib"),),
        masses=(Load("load", load_mass),),
        ropes=(Rope("hoist", ("tip", "load"), drum_radius, winch_inertia),),
        drives=(
            Drive("slew", on="column", limit=0.16 * reach * weight),
            Drive("boom", on="boom", limit=1.65 * (reach * weight + boom_torque)),
            Drive("jib", on="jib", limit=1.75 * jib_length * (weight + 0.5 * jib_mass * gravity)),
            Drive("winch", on="hoist", limit=1.9 * drum_radius * weight),
        ),
        outputs=("load.x", "load.y", "load.z", "jib.angle"),
        home={"column": 0.0, "boom": 0.6, "jib": -1.2, "load": (reach * cos(0.6), 0.0, 2.0)},
    )
