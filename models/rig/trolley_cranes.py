"""Cranes with a trolley: overhead, rotary, extended rotary, cantilever and gantry crane.

Sources: Y = Yang 2016, K = Kiss 2001.  Limits of the drives are not in the sources: they follow
from the load's weight, leave a third above what the default move needs, and hold the rotary
crane against a wind of 5 % of that weight.
"""

from dataclasses import replace
from functools import partial
from typing import Any

from ..arguments import of_numbers
from .catalogue import CATALOGUE
from .move import Move
from .rig import Anchor, Drive, Frame, Load, Rail, Rig, Rope, Sheave, Trolley

GRAVITY = 9.81

_BEAM_MOVE = Move(start=(0.0, -4.0), goal=(5.0, -1.0), duration=3.0)
"""The source's move of the overhead crane (Y 4.107)."""
_GIRDER_MOVE = Move(
    start=(5.0, 0.0, -5.0), goal=(-2.0, 2.0, -2.0), duration=20.0, profile="three_phase"
)
"""The source's move of the rotary crane (Y 4.123 to 4.128, 5.142)."""


@CATALOGUE.add(move=_BEAM_MOVE, environment="OverheadCrane")
@of_numbers
def overhead_crane(
    *,
    load_mass: float = 100.0,
    trolley_mass: float = 10.0,
    winch_inertia: float = 0.1,
    drum_radius: float = 0.1,
    gravity: float = GRAVITY,
) -> Rig:
    """Planar overhead crane with the winch in the trolley (Y 4.4.1, 5.3.1).

    Inputs: force on the trolley [N], torque of the winch [N m].  Outputs: load.x, load.z [m].
    """
    weight = load_mass * gravity
    return Rig(
        name="overhead_crane",
        dimensions=2,
        gravity=gravity,
        rails=(Rail("beam", direction=(1.0, 0.0, 0.0), start=-2.0, end=8.0),),
        masses=(Trolley("trolley", trolley_mass, rail="beam"), Load("load", load_mass)),
        ropes=(Rope("hoist", ("trolley", "load"), drum_radius, winch_inertia),),
        drives=(
            Drive("trolley", on="trolley", limit=weight + trolley_mass * gravity),
            Drive("winch", on="hoist", limit=2.0 * weight * drum_radius),
        ),
        outputs=("load.x", "load.z"),
        home={"trolley": 0.0, "load": (0.0, 0.0, -4.0)},
    )


@CATALOGUE.add(move=_BEAM_MOVE, environment="RopedOverheadCrane")
@of_numbers
def roped_overhead_crane(
    *,
    load_mass: float = 100.0,
    trolley_mass: float = 10.0,
    winch_inertia: float = 0.1,
    drum_radius: float = 0.1,
    gravity: float = GRAVITY,
) -> Rig:
    """Planar overhead crane whose trolley is pulled by a rope (K 3.2 with p = 2, c = 1).

    The hoist rope runs from a winch at the beam's right end over the trolley to the load and
    pulls the trolley to the right; the other rope holds it from the left end.

    Inputs: torque of the pulling winch, torque of the hoisting winch [N m].
    Outputs: load.x, load.z [m].
    """
    plain = overhead_crane(load_mass=load_mass, trolley_mass=trolley_mass, gravity=gravity)
    weight = load_mass * gravity
    return replace(
        plain,
        name="roped_overhead_crane",
        anchors=(Anchor("left", (-2.0, 0.0, 0.0)), Anchor("right", (8.0, 0.0, 0.0))),
        ropes=(
            Rope("pull", ("left", "trolley"), drum_radius, winch_inertia),
            Rope("hoist", ("right", "trolley", "load"), drum_radius, winch_inertia),
        ),
        drives=(
            Drive("pull", on="pull", limit=2.5 * weight * drum_radius),
            Drive("hoist", on="hoist", limit=2.0 * weight * drum_radius),
        ),
    )


@CATALOGUE.add(move=_GIRDER_MOVE, environment="RotaryCrane")
@of_numbers
def rotary_crane(
    *,
    load_mass: float = 100.0,
    trolley_mass: float = 10.0,
    bridge_inertia: float = 480.0,
    winch_inertia: float = 0.1,
    drum_radius: float = 0.1,
    gravity: float = GRAVITY,
) -> Rig:
    """Rotary crane: a girder turning about a tower, a trolley with a winch on it (Y 4.4.2, 5.3.2).

    Inputs: torque on the bridge [N m], force on the trolley [N], torque of the winch [N m].
    Outputs: load.x, load.y, load.z [m].
    """
    weight = load_mass * gravity
    return Rig(
        name="rotary_crane",
        gravity=gravity,
        frames=(Frame("bridge", "turning", bridge_inertia),),
        rails=(Rail("girder", direction=(1.0, 0.0, 0.0), frame="bridge", start=0.5, end=8.0),),
        masses=(Trolley("trolley", trolley_mass, rail="girder"), Load("load", load_mass)),
        ropes=(Rope("hoist", ("trolley", "load"), drum_radius, winch_inertia),),
        drives=(
            Drive("bridge", on="bridge", limit=0.5 * weight),
            Drive("trolley", on="trolley", limit=0.2 * weight),
            Drive("winch", on="hoist", limit=2.0 * weight * drum_radius),
        ),
        outputs=("load.x", "load.y", "load.z"),
        home={"bridge": 0.0, "trolley": 5.0, "load": (5.0, 0.0, -5.0)},
    )


rotary_crane_small = partial(
    rotary_crane, load_mass=10.0, trolley_mass=53.0, bridge_inertia=19.01, winch_inertia=0.02
)
rotary_crane_small.__doc__ = "The rotary crane with the data of Y table 4.1, used in Y 2.4."


@CATALOGUE.add(move=_GIRDER_MOVE)
@of_numbers
def extended_rotary_crane(
    *,
    load_mass: float = 100.0,
    trolley_mass: float = 10.0,
    bridge_inertia: float = 480.0,
    winch_1_position: float = 8.0,
    winch_2_position: float = -4.0,
    winch_inertia: float = 0.1,
    drum_radius: float = 0.1,
    sheave_inertia: float = 0.1,
    sheave_radius: float = 0.1,
    gravity: float = GRAVITY,
) -> Rig:
    """The rotary crane with its winches on the bridge, a sheave in the trolley (Y 5.4.4).

    Winch 1 holds the trolley, winch 2 hoists over the sheave in it; both stand on the girder's
    line at the given positions along it.  The source has winch 1 at -2 m, on the same side as
    winch 2: its rope would have to push the trolley away with the load's whole weight, so here
    it stands at the girder's outer end and pulls.  The source's winches have no inertia.

    Inputs: torques of winch 1 and winch 2, torque on the bridge [N m].
    Outputs: load.x, load.y, load.z [m].
    """
    weight = load_mass * gravity
    return Rig(
        name="extended_rotary_crane",
        gravity=gravity,
        frames=(Frame("bridge", "turning", bridge_inertia),),
        drives=(
            *_roped_trolley_drives(weight, drum_radius),
            Drive("bridge", "bridge", 0.5 * weight),
        ),
        **_roped_trolley(
            "bridge",
            load_mass,
            trolley_mass,
            winch_inertia,
            drum_radius,
            inner=winch_2_position,
            outer=winch_1_position,
            sheaves=(Sheave("trolley", sheave_inertia, sheave_radius),),
        ),
    )


@CATALOGUE.add(
    move=Move(start=(5.0, 0.0, -5.0), goal=(2.0, 4.0, -2.0), duration=20.0, profile="three_phase"),
    environment="CantileverCrane",
)
@of_numbers
def cantilever_crane(
    *,
    load_mass: float = 100.0,
    trolley_mass: float = 10.0,
    boom_inertia: float = 480.0,
    winch_inertia: float = 0.1,
    drum_radius: float = 0.1,
    gravity: float = GRAVITY,
) -> Rig:
    """Cantilever crane: a turning boom with both winches on it (K 3.2.4, example 9).

    One rope holds the trolley from the boom's outer end, the other runs from its inner end over
    the trolley to the load.  The source gives no numbers; these are the rotary crane's.

    Inputs: torques of the pulling and the hoisting winch, torque on the boom [N m].
    Outputs: load.x, load.y, load.z [m].
    """
    weight = load_mass * gravity
    return Rig(
        name="cantilever_crane",
        gravity=gravity,
        frames=(Frame("boom", "turning", boom_inertia),),
        drives=(*_roped_trolley_drives(weight, drum_radius), Drive("boom", "boom", 0.5 * weight)),
        **_roped_trolley("boom", load_mass, trolley_mass, winch_inertia, drum_radius),
    )


@CATALOGUE.add(
    move=Move(start=(5.0, 0.0, -5.0), goal=(1.0, 2.0, -2.0), duration=20.0, profile="three_phase"),
    environment="GantryCrane",
)
@of_numbers
def gantry_crane(
    *,
    load_mass: float = 100.0,
    trolley_mass: float = 10.0,
    gantry_mass: float = 100.0,
    winch_inertia: float = 0.1,
    drum_radius: float = 0.1,
    gravity: float = GRAVITY,
) -> Rig:
    """Gantry crane, "3D overhead" in the source: a bridge along y, a roped trolley (K example 10).

    Ropes as in the cantilever crane, whose boom turns where this bridge slides.  The source gives
    no numbers; these are the rotary crane's.

    Inputs: torques of the pulling and the hoisting winch [N m], force on the gantry [N].
    Outputs: load.x, load.y, load.z [m].
    """
    weight = load_mass * gravity
    return Rig(
        name="gantry_crane",
        gravity=gravity,
        frames=(Frame("gantry", "sliding", gantry_mass, (0.0, 1.0, 0.0)),),
        drives=(
            *_roped_trolley_drives(weight, drum_radius),
            Drive("gantry", "gantry", 0.2 * (weight + gantry_mass * gravity)),
        ),
        **_roped_trolley("gantry", load_mass, trolley_mass, winch_inertia, drum_radius),
    )


def _roped_trolley(
    frame: str,
    load_mass: float,
    trolley_mass: float,
    winch_inertia: float,
    drum_radius: float,
    inner: float = 0.0,
    outer: float = 8.0,
    sheaves: tuple[Sheave, ...] = (),
) -> dict[str, Any]:
    """Rail, ropes and masses of a crane whose trolley is pulled along a moving beam."""
    return {
        "anchors": (
            Anchor("inner", (inner, 0.0, 0.0), frame),
            Anchor("outer", (outer, 0.0, 0.0), frame),
        ),
        "rails": (Rail("beam", (1.0, 0.0, 0.0), frame=frame, start=0.5, end=7.5),),
        "masses": (Trolley("trolley", trolley_mass, rail="beam"), Load("load", load_mass)),
        "ropes": (
            Rope("pull", ("outer", "trolley"), drum_radius, winch_inertia),
            Rope("hoist", ("inner", "trolley", "load"), drum_radius, winch_inertia, sheaves),
        ),
        "outputs": ("load.x", "load.y", "load.z"),
        "home": {"trolley": 5.0, "load": (5.0, 0.0, -5.0)},
    }


def _roped_trolley_drives(weight: float, drum_radius: float) -> tuple[Drive, Drive]:
    return (
        Drive("pull", on="pull", limit=2.5 * weight * drum_radius),
        Drive("hoist", on="hoist", limit=2.0 * weight * drum_radius),
    )
