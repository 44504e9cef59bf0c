"""The cranes of the sources, with their numbers as defaults.

Sources: Y = Yang 2016, K = Kiss 2001.  Limits of the drives are not in the sources: they follow
from the load's weight, leave a third above what the default move needs, and hold the rotary
crane against a wind of 5 % of that weight.
"""

import inspect
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from .errors import RigError, did_you_mean
from .move import Move
from .rig import Anchor, Drive, Frame, Load, Rail, Rig, Rope, Trolley
from .values import of_numbers, word

GRAVITY = 9.81


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

CATALOGUE: dict[str, Callable[..., Rig]] = {
    "overhead_crane": overhead_crane,
    "roped_overhead_crane": roped_overhead_crane,
    "rotary_crane": rotary_crane,
}
"""Every rig by its name."""

_OVERHEAD_MOVE = Move(start=(0.0, -4.0), goal=(5.0, -1.0), duration=3.0)

MOVES: dict[str, Move] = {
    "overhead_crane": _OVERHEAD_MOVE,
    "roped_overhead_crane": _OVERHEAD_MOVE,
    "rotary_crane": Move(
        start=(5.0, 0.0, -5.0), goal=(-2.0, 2.0, -2.0), duration=20.0, profile="three_phase"
    ),
}
"""The sources' move for each rig of the catalogue (Y 4.107, 4.123 to 4.128)."""


def full_name(name: str) -> str:
    """The catalogue's name for a name that may be short or hyphenated ("overhead").

    Raises:
        RigError: no rig of the catalogue is called so.
    """
    plain = word("the name of a rig", name).replace("-", "_").lower()
    for known in CATALOGUE:
        if plain in (known, known.removesuffix("_crane")):
            return known
    raise RigError(f"there is no rig {name!r} in the catalogue{did_you_mean(plain, CATALOGUE)}")


def make(name: str, **overrides: Any) -> Rig:
    """A rig of the catalogue by name, with some of its numbers replaced.

    Raises:
        RigError: the name or an override is unknown, or a number is wrong.
    """
    build = CATALOGUE[full_name(name)]
    known = inspect.signature(build).parameters
    for key in overrides:
        if key not in known:
            raise RigError(f"{full_name(name)} has no parameter {key!r}{did_you_mean(key, known)}")
    return build(**overrides)


def default_move(name: str) -> Move:
    """The move that the sources make with a rig of the catalogue.

    Raises:
        RigError: no rig of the catalogue is called so.
    """
    return MOVES[full_name(name)]
