"""Cranes whose load hangs below a hook or a spreader: double pendulum and container crane.

Sources are named at each crane; limits of drives are not in them: they leave a third above what the
default move needs.
"""

from ..arguments import of_numbers
from ..values import Vector
from .catalogue import CATALOGUE
from .link import Link
from .move import Move
from .payload import two_masses
from .rig import Anchor, Drive, Frame, Load, Platform, Rail, Rig, Rope, Trolley
from .trolley_cranes import GRAVITY

TROLLEY_SPEED, HOIST_SPEED = 4.06, 1.17
"""Largest speeds of the container crane's trolley and load, 800 and 230 ft/min [m/s]."""
FALLS = 2
"""Parts of rope on each of its four blocks."""
CONTAINER: Vector = (2.438, 12.192, 2.591)
"""Width, length and height of a container 1AA (ISO 668) [m]; its length lies along the quay."""


@CATALOGUE.add(
    move=Move(start=(3.0, 2.0, -7.0), goal=(12.0, 7.0, -5.0), duration=12.0, order=6),
    environment="DoublePendulumCrane",
)
@of_numbers
def double_pendulum_crane(
    *,
    payload_mass: float = 2000.0,
    payload_below: float = 3.0,
    payload_inertia: float = 0.0,
    hook_mass: float = 200.0,
    trolley_mass: float = 500.0,
    bridge_mass: float = 2000.0,
    winch_inertia: float = 5.0,
    drum_radius: float = 0.2,
    gravity: float = GRAVITY,
) -> Rig:
    """Bridge crane with a heavy hook, and a payload on a sling below it.

    Hook and payload swing as a double pendulum (Singhose, Kim, Kenison, J. Dyn. Syst. Meas. Control
    130, 2008); the numbers are those of a small workshop crane.  With a `payload_inertia` the
    payload is a rigid body fixed to the hook, its centre of mass `payload_below` it; "payload" is
    then its centre of oscillation, see `flatrig.models.two_masses`.

    Inputs: forces on bridge and trolley [N], torque of the winch [N m].
    Outputs: payload.x, payload.y, payload.z [m].
    """
    upper, lower, length = two_masses(payload_mass, payload_below, payload_inertia)
    weight = (payload_mass + hook_mass) * gravity
    place = (3.0, 2.0, -4.0)
    return Rig(
        name="double_pendulum_crane",
        gravity=gravity,
        frames=(Frame("bridge", "sliding", bridge_mass, (0.0, 1.0, 0.0)),),
        rails=(Rail("girder", (1.0, 0.0, 0.0), frame="bridge", start=0.0, end=15.0),),
        masses=(
            Trolley("trolley", trolley_mass, rail="girder"),
            Load("hook", hook_mass + upper),
            Load("payload", lower),
        ),
        ropes=(Rope("hoist", ("trolley", "hook"), drum_radius, winch_inertia),),
        links=(Link("sling", ("hook", "payload"), length),),
        drives=(
            Drive("bridge", on="bridge", limit=0.2 * weight),
            Drive("trolley", on="trolley", limit=0.2 * weight),
            Drive("winch", on="hoist", limit=1.5 * weight * drum_radius),
        ),
        outputs=("payload.x", "payload.y", "payload.z"),
        home={
            "bridge": place[1],
            "trolley": place[0],
            "hook": place,
            "payload": (place[0], place[1], place[2] - length),
        },
    )


@CATALOGUE.add(
    move=Move(
        start=(45.0, -16.0, 0.0, 0.0, 0.0),
        goal=(-15.0, -28.0, 0.0, 0.0, 0.0),
        duration=23.0,
        profile="three_phase",
        blend=7.0,
    ),
    environment="ContainerCrane",
)
@of_numbers
def container_crane(
    *,
    container_mass: float = 30480.0,
    spreader_mass: float = 11000.0,
    trolley_mass: float = 25000.0,
    winch_inertia: float = 400.0,
    drum_radius: float = 0.5,
    gravity: float = GRAVITY,
) -> Rig:
    """Ship-to-shore crane: a trolley that runs out over the ship, and a spreader on four ropes.

    The trolley runs at 4.06 m/s (800 ft/min) at most, from 48 m behind the waterside rail, where x
    counts from, to 65 m in front of it, and lifts 35 m at 1.17 m/s (230 ft/min): Bhimani,
    Considerations for Large Cranes (Liftech, 1999), the crane for ships 22 containers wide.  The
    container is a full one of 40 ft (1AA of ISO 668).  Masses of trolley and spreader, rope points,
    drums and inertias are common ones and not from there.  Each rope ends at a block of two falls.

    `spreader` is the centre of mass of spreader and container.  The crane is the same on both sides
    of the boom, so spreader.y is held: moves that turn the container about the vertical on the way
    would swing it along the quay, and are refused.

    Inputs: force on the trolley [N], torques of the four winches [N m].
    Outputs: spreader.x, .z [m], Bryant angles spreader.alpha, .beta, .gamma [rad].
    """
    weight = (container_mass + spreader_mass) * gravity
    height, inertia = _loaded(container_mass, spreader_mass)
    sides = [(x, y) for x in (1.0, -1.0) for y in (1.0, -1.0)]
    names = [f"{way}_{side}" for way in ("sea", "land") for side in ("left", "right")]
    places = list(zip(names, sides, strict=True))
    return Rig(
        name="container_crane",
        gravity=gravity,
        frames=(Frame("trolley", "sliding", trolley_mass, (1.0, 0.0, 0.0)),),
        anchors=(
            *(Anchor(f"drum_{n}", (2.0 * x, 3.2 * y, 0.0), "trolley") for n, (x, y) in places),
            *(Anchor(f"block_{n}", (0.9 * x, 2.8 * y, height), "spreader") for n, (x, y) in places),
        ),
        masses=(Platform("spreader", container_mass + spreader_mass, inertia),),
        ropes=tuple(
            Rope(f"hoist_{n}", (f"drum_{n}", f"block_{n}"), drum_radius, winch_inertia, falls=FALLS)
            for n in names
        ),
        drives=(
            Drive("trolley", on="trolley", limit=0.3 * weight, speed=TROLLEY_SPEED),
            *(
                Drive(
                    f"winch_{n}",
                    on=f"hoist_{n}",
                    limit=0.23 * weight * drum_radius,
                    speed=FALLS * HOIST_SPEED / drum_radius,
                )
                for n in names
            ),
        ),
        outputs=("spreader.x", *(f"spreader.{c}" for c in ("z", "alpha", "beta", "gamma"))),
        held=("spreader.y",),
        home={"trolley": 10.0, "spreader": (10.0, 0.0, -24.0)},
    )


def _loaded(container: float, spreader: float) -> tuple[float, Vector]:
    """Blocks above the centre of a spreader with its container [m], and its moments [kg m2].

    The container is a homogeneous box, the spreader a beam as long and 0.8 m high on top of it; the
    blocks are 0.7 m above the beam's middle.
    """
    width, length, height = CONTAINER
    high = 0.8
    apart = 0.5 * (height + high)
    reduced = container * spreader / (container + spreader) * apart**2
    x, y, z = (
        sum(mass * (a**2 + b**2) / 12.0 for mass, a, b in pairs)
        for pairs in (
            ((container, length, height), (spreader, length, high)),
            ((container, width, height), (spreader, width, high)),
            ((container, width, length), (spreader, width, length)),
        )
    )
    return 0.7 + container / (container + spreader) * apart, (x + reduced, y + reduced, z)
