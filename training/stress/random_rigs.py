"""Valid rigs of every kind that a description knows, drawn at random.

    rng = np.random.default_rng(7)
    rig = random_rig(rng)
    move = random_move(rig, rng)           # flatrig.training.stress.wild_moves

Lengths go over four decades, masses over six, the winches' J/r^2 over twelve.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...models import WORLD, Anchor, Combination, Frame, Load, Platform, Rail, Rig, Trolley
from .random_frames import boom_crane
from .random_limits import limited
from .random_links import held_crane, hook_crane, pushed_crane
from .random_parts import Dice, drives, frame
from .random_ropes import redundant_robot, rope_robot


def random_rig(rng: np.random.Generator) -> Rig:
    """A rig of one of the kinds in `KINDS`."""
    dice = Dice(rng, float(10.0 ** rng.uniform(-2, 2)))
    kind = KINDS[int(rng.integers(len(KINDS)))]
    return limited(kind(dice), dice)


def trolley_crane(dice: Dice) -> Rig:
    """A load below a trolley with a winch, in a plane or on a frame."""
    frames = () if dice.maybe(0.4) else (frame(dice),)
    owner = frames[0].name if frames else WORLD
    out, down = dice.length(0.5, 2.0), dice.length(0.3, 3.0)
    slope = dice.rng.uniform(-0.4, 0.4) if dice.maybe(0.2) else 0.0
    direction = (math.cos(slope), 0.0, math.sin(slope))
    hung = out * direction[0], 0.0, out * direction[2] - down
    return Rig(
        name="trolley_crane",
        dimensions=3 if frames else 2,
        frames=frames,
        rails=(Rail("rail", direction, (0.0, 0.0, 0.0), owner, *dice.ends(out)),),
        masses=(Trolley("trolley", dice.mass(), "rail"), Load("load", dice.mass())),
        ropes=(dice.rope("hoist", "trolley", "load"),),
        drives=drives(*(part.name for part in frames), "trolley", "hoist"),
        outputs=("load.x", "load.y", "load.z") if frames else ("load.x", "load.z"),
        home={"trolley": out, "load": hung},
    )


def roped_crane(dice: Dice) -> Rig:
    """A trolley between two ropes, one of which runs on to the load."""
    frames = () if dice.maybe(0.4) else (frame(dice),)
    owner = frames[0].name if frames else WORLD
    end, out, down = dice.length(2.0, 4.0), dice.length(0.5, 1.5), dice.length(0.3, 3.0)
    return Rig(
        name="roped_crane",
        dimensions=3 if frames else 2,
        frames=frames,
        anchors=(
            Anchor("inner", (-dice.length(0.1, 1.0), 0.0, 0.0), owner),
            Anchor("outer", (end, 0.0, 0.0), owner),
        ),
        rails=(Rail("rail", (1.0, 0.0, 0.0), frame=owner, start=0.0, end=end),),
        masses=(Trolley("trolley", dice.mass(), "rail"), Load("load", dice.mass())),
        ropes=(
            dice.rope("pull", "outer", "trolley"),
            dice.rope("hoist", "inner", "trolley", "load"),
        ),
        drives=drives("pull", "hoist", *(part.name for part in frames)),
        outputs=("load.x", "load.y", "load.z") if frames else ("load.x", "load.z"),
        home={"trolley": out, "load": (out, 0.0, -down)},
    )


def jib_crane(dice: Dice) -> Rig:
    """A load on a rope from the end of a jib that slides along x or a slope."""
    out, down, reach = dice.length(-1.0, 1.0), dice.length(0.3, 3.0), dice.length(0.0, 2.0)
    rise = dice.slope() if dice.maybe() else 0.0
    axis = (math.cos(rise), 0.0, math.sin(rise))
    hung = reach + out * axis[0], 0.0, out * axis[2] - down
    return Rig(
        name="jib_crane",
        dimensions=2,
        frames=(Frame("jib", "sliding", dice.mass(), axis),),
        anchors=(Anchor("tip", (reach, 0.0, 0.0), "jib"),),
        masses=(Load("load", dice.mass()),),
        ropes=(dice.rope("hoist", "tip", "load"),),
        drives=drives("jib", "hoist"),
        outputs=("load.x", "load.z"),
        home={"jib": out, "load": hung},
    )


def deck_crane(dice: Dice) -> Rig:
    """A trolley on a deck whose motion is prescribed: it heaves, slides, or hangs on a rope."""
    hung = dice.maybe()
    rise = 0.5 * math.pi if hung or dice.maybe() else dice.rng.uniform(-math.pi, math.pi)
    axis = (math.cos(rise), 0.0, math.sin(rise))
    slope = dice.rng.uniform(-0.4, 0.4) if dice.maybe(0.2) else 0.0
    along = (math.cos(slope), 0.0, math.sin(slope))
    out, moved = dice.length(-1.0, 1.0), dice.length(-0.3, 0.3)
    foot = [moved * a + out * b for a, b in zip(axis, along, strict=True)]
    top = Anchor("top", (0.0, 0.0, dice.length(1.0, 3.0)))
    lift = (dice.rope("lift", "top", "lug"),) if hung else ()
    return Rig(
        name="deck_crane",
        dimensions=2,
        frames=(Frame("deck", "sliding", dice.mass(), axis),),
        anchors=(top, Anchor("lug", (0.0, 0.0, 0.0), "deck")) if hung else (),
        rails=(Rail("rail", along, (0.0, 0.0, 0.0), "deck", *dice.ends(out)),),
        masses=(Trolley("trolley", dice.mass(), "rail"), Load("load", dice.mass())),
        ropes=(*lift, dice.rope("hoist", "trolley", "load")),
        drives=drives("lift" if hung else "deck", "trolley", "hoist"),
        outputs=("load.x", "load.z", "deck.position"),
        home={
            "deck": moved,
            "trolley": out,
            "load": (foot[0], 0.0, foot[2] - dice.length(0.3, 3.0)),
        },
    )


def pulley_crane(dice: Dice) -> Rig:
    """A load on a free pulley, perhaps without mass, that three ropes hold from a boom."""
    turning = dice.maybe()
    low, middle, high = np.cumsum([dice.length(0.2, 1.0) for _ in range(3)]).tolist()
    angle = dice.rng.uniform(0.1, 1.4)
    along = (math.sin(angle), 0.0, math.cos(angle))
    places = {"low": low, "middle": middle, "high": high}
    tip = middle * along[0] + dice.length(-0.2, 0.2)
    drop = middle * along[2] - dice.length(0.2, 1.0)
    frames = (Frame("boom", "turning", dice.mass() * dice.size**2),) if turning else ()
    mass = 0.0 if dice.maybe(0.25) else dice.decades(1e-4, 1e3)
    hoist = dice.rope("hoist", "middle", "pulley", "load")
    if not mass:  # then its sheave has no inertia either
        hoist = replace(hoist, sheaves=())
    return Rig(
        name="pulley_crane",
        dimensions=3 if turning else 2,
        frames=frames,
        anchors=tuple(
            Anchor(
                name,
                (place * along[0], 0.0, place * along[2]),
                "boom" if turning else WORLD,
            )
            for name, place in places.items()
        ),
        masses=(
            Load("pulley", mass),
            Load("load", dice.mass()),
        ),
        ropes=(
            dice.rope("tagline", "low", "pulley"),
            hoist,
            dice.rope("suspension", "high", "pulley"),
        ),
        drives=drives("tagline", "hoist", "suspension", *(part.name for part in frames)),
        outputs=("load.x", "load.y", "load.z", "pulley.z")
        if turning
        else ("load.x", "load.z", "pulley.z"),
        home={
            "pulley": (tip, 0.0, drop),
            "load": (tip, 0.0, drop - dice.length(0.3, 3.0)),
        },
    )


def tandem_crane(dice: Dice) -> Rig:
    """Two trolleys on one line that hold a load between them."""
    left, right, down = -dice.length(0.2, 1.0), dice.length(0.2, 1.0), dice.length(0.3, 2.0)
    return Rig(
        name="tandem_crane",
        dimensions=2,
        rails=(Rail("rail", (1.0, 0.0, 0.0)),),
        masses=(
            Trolley("left", dice.mass(), "rail"),
            Trolley("right", dice.mass(), "rail"),
            Load("load", dice.mass()),
        ),
        ropes=(dice.rope("hoist_left", "left", "load"), dice.rope("hoist_right", "right", "load")),
        drives=drives("left", "right", "hoist_left", "hoist_right"),
        combinations=(
            Combination("middle", ("left.position", "right.position"), (0.5, 0.5)),
            Combination("spread", ("left.position", "right.position"), (-1.0, 1.0)),
        ),
        outputs=("load.x", "load.z", "middle", "spread"),
        home={"left": left, "right": right, "load": (0.0, 0.0, -down)},
    )


def platform_crane(dice: Dice) -> Rig:
    """A platform on three ropes from trolleys on a gantry, or on six from fixed winches."""
    side, down = dice.length(0.3, 1.0), dice.length(1.0, 4.0)
    mass = dice.mass()
    first, second = (mass * side**2 * dice.rng.uniform(0.05, 0.2) for _ in range(2))
    third = dice.rng.uniform(abs(first - second), first + second)
    platform = Platform("platform", mass, (first, second, third))
    return (_gantry if dice.maybe() else _six_ropes)(dice, platform, side, down)


def _corners(side: float) -> tuple[Anchor, ...]:
    angles = [2 * math.pi * k / 3 for k in range(3)]
    return tuple(
        Anchor(f"corner_{k}", (side * math.cos(a), side * math.sin(a), 0.0), "platform")
        for k, a in enumerate(angles)
    )


def _gantry(dice: Dice, platform: Platform, side: float, down: float) -> Rig:
    corners = _corners(side)
    numbers = range(3)
    return Rig(
        name="gantry_platform",
        frames=(Frame("gantry", "sliding", dice.mass(), (0.0, 1.0, 0.0)),),
        anchors=corners,
        rails=tuple(
            Rail(f"rail_{k}", (1.0, 0.0, 0.0), (0.0, corners[k].position[1], 0.0), "gantry")
            for k in numbers
        ),
        masses=(*(Trolley(f"trolley_{k}", dice.mass(), f"rail_{k}") for k in numbers), platform),
        ropes=tuple(dice.rope(f"hoist_{k}", f"trolley_{k}", f"corner_{k}") for k in numbers),
        drives=drives(
            "gantry", *(f"trolley_{k}" for k in numbers), *(f"hoist_{k}" for k in numbers)
        ),
        combinations=(
            Combination("spread", tuple(f"trolley_{k}.position" for k in numbers), (1, -0.5, -0.5)),
        ),
        outputs=(*_pose(), "spread"),
        home={
            **{f"trolley_{k}": corners[k].position[0] for k in numbers},
            "platform": (0.0, 0.0, -down),
        },
    )


def _six_ropes(dice: Dice, platform: Platform, side: float, down: float) -> Rig:
    wide = side * dice.rng.uniform(1.5, 4.0)
    angles = [2 * math.pi * k / 3 + turn for k in range(3) for turn in (-0.5, 0.5)]
    ropes = range(6)
    return Rig(
        name="six_rope_platform",
        anchors=(
            *_corners(side),
            *(
                Anchor(f"mast_{k}", (wide * math.cos(a), wide * math.sin(a), 0.0))
                for k, a in enumerate(angles)
            ),
        ),
        masses=(platform,),
        ropes=tuple(dice.rope(f"rope_{k}", f"mast_{k}", f"corner_{k // 2}") for k in ropes),
        drives=drives(*(f"rope_{k}" for k in ropes)),
        outputs=_pose(),
        home={"platform": (0.0, 0.0, -down)},
    )


def _pose() -> tuple[str, ...]:
    return tuple(f"platform.{name}" for name in ("x", "y", "z", "alpha", "beta", "gamma"))


KINDS: tuple[Callable[[Dice], Rig], ...] = (
    trolley_crane,
    roped_crane,
    jib_crane,
    deck_crane,
    pulley_crane,
    rope_robot,
    tandem_crane,
    platform_crane,
    hook_crane,
    pushed_crane,
    held_crane,
    boom_crane,
    redundant_robot,
)
"""Functions that draw a rig, one for each kind."""
