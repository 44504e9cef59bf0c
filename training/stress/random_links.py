"""Rigs with links, held freedoms and planar platforms, drawn at random.

Hooks with one or two loads on slings, trolleys that a rod or a cylinder pushes, beams in a plane,
and spreaders on four ropes.
"""

from dataclasses import replace
from itertools import pairwise

from ...models import WORLD, Anchor, Frame, Link, Load, Platform, Rail, Rig, Trolley
from .random_parts import Dice, drives, frame


def hook_crane(dice: Dice) -> Rig:
    """A hook below a trolley, and below it one load or two, each on a link from the one above.

    Some links are rods with a mass.
    """
    frames = () if dice.maybe(0.4) else (frame(dice),)
    owner = frames[0].name if frames else WORLD
    out = dice.length(0.5, 2.0)
    names = ["hook", "upper", "load"] if dice.maybe(0.3) else ["hook", "load"]
    heights: list[float] = []
    for _ in names:
        heights.append((heights or [0.0])[-1] - dice.length(0.3, 2.0))
    links = tuple(
        _sling(dice, Link(f"sling_{k}", (above, below)), heights[k] - heights[k + 1])
        for k, (above, below) in enumerate(pairwise(names))
    )
    return Rig(
        name="hook_crane",
        dimensions=3 if frames else 2,
        frames=frames,
        rails=(Rail("rail", (1.0, 0.0, 0.0), frame=owner),),
        masses=(
            Trolley("trolley", dice.mass(), "rail"),
            *(Load(name, dice.mass()) for name in names),
        ),
        ropes=(dice.rope("hoist", "trolley", "hook"),),
        links=links,
        drives=drives(*(part.name for part in frames), "trolley", "hoist"),
        outputs=("load.x", "load.y", "load.z") if frames else ("load.x", "load.z"),
        home={
            "trolley": out,
            **{n: (out, 0.0, z) for n, z in zip(names, heights, strict=True)},
        },
    )


def _sling(dice: Dice, link: Link, length: float) -> Link:
    """The link, or in its place a rod whose lower end is its centre of oscillation, and flat."""
    if dice.maybe(0.7):
        return link
    mass, share = dice.mass(), dice.rng.uniform(0.1, 0.9)
    inertia = mass * length**2 * share * (1.0 - share)
    return replace(link, mass=mass, centre=length * share, inertia=inertia)


def _heavy(dice: Dice, link: Link, length: float) -> Link:
    """The link as a beam, uniform or not."""
    mass, share = dice.mass(), dice.rng.uniform(0.1, 0.9)
    if dice.maybe():
        return replace(link, mass=mass)
    inertia = mass * length**2 * dice.rng.uniform(0.0, 0.2)
    return replace(link, mass=mass, centre=length * share, inertia=inertia)


def pushed_crane(dice: Dice) -> Rig:
    """A trolley with a hoist that a rod from another trolley, or a cylinder, pushes and pulls."""
    out, down = dice.length(0.5, 2.0), dice.length(0.3, 3.0)
    by_rod = dice.maybe()
    cylinder = replace(dice.rope("cylinder", "wall", "trolley"), sheaves=(), pushes=True)
    tug = (Trolley("tug", dice.mass(), "rail"),) if by_rod else ()
    hoist = dice.rope("hoist", "trolley", "load")
    driver = "tug" if by_rod else "cylinder"
    return Rig(
        name="pushed_crane",
        dimensions=2,
        anchors=(Anchor("wall", (-dice.length(1.0, 3.0), 0.0, 0.0)),),
        rails=(Rail("rail", (1.0, 0.0, 0.0)),),
        masses=(Trolley("trolley", dice.mass(), "rail"), *tug, Load("load", dice.mass())),
        ropes=(hoist,) if by_rod else (cylinder, hoist),
        links=(Link("rod", ("tug", "trolley"), pushes=True),) if by_rod else (),
        drives=drives(driver, "hoist"),
        outputs=("load.x", "load.z"),
        home={
            "trolley": out,
            "load": (out, 0.0, -down),
            **({"tug": out - dice.length(0.3, 1.0)} if by_rod else {}),
        },
    )


def held_crane(dice: Dice) -> Rig:
    """A body of which some freedoms are not there: a beam in a plane, or a box on four ropes."""
    if dice.maybe(0.25):
        return _spreader(dice)
    return _bar(dice) if dice.maybe(0.3) else _beam(dice)


def _bar(dice: Dice) -> Rig:
    """A beam that is a link with a mass, on two ropes from two trolleys on one rail."""
    half, down = dice.length(0.3, 1.0), dice.length(0.5, 3.0)
    wide = half * dice.rng.uniform(0.8, 1.5)
    beam = _heavy(dice, Link("beam", ("a", "b")), 2 * half)
    return Rig(
        name="bar_crane",
        dimensions=2,
        rails=(Rail("rail", (1.0, 0.0, 0.0)),),
        masses=tuple(Trolley(n, dice.mass(), "rail") for n in ("left", "right"))
        + tuple(Load(n, dice.mass()) for n in ("a", "b")),
        ropes=(dice.rope("hoist_a", "left", "a"), dice.rope("hoist_b", "right", "b")),
        links=(beam,),
        drives=drives("left", "right", "hoist_a", "hoist_b"),
        outputs=("a.x", "a.z", "b.z", "left.position"),
        home={
            "left": -wide,
            "right": wide,
            "a": (-half, 0.0, -down),
            "b": (half, 0.0, -down),
        },
    )


def _beam(dice: Dice) -> Rig:
    """A beam in a plane on two ropes from two trolleys on one rail."""
    half, down = dice.length(0.3, 1.0), dice.length(0.5, 3.0)
    wide = half * dice.rng.uniform(0.8, 1.5)
    mass, above = dice.mass(), half * dice.rng.uniform(-0.1, 0.3)
    moment = mass * half**2 * dice.rng.uniform(0.1, 0.5)
    corners = [(side * half, 0.0, above) for side in (-1.0, 1.0)]
    return Rig(
        name="beam_crane",
        dimensions=2,
        anchors=tuple(Anchor(f"eye_{k}", place, "beam") for k, place in enumerate(corners)),
        rails=(Rail("rail", (1.0, 0.0, 0.0)),),
        masses=(
            Trolley("left", dice.mass(), "rail"),
            Trolley("right", dice.mass(), "rail"),
            Platform("beam", mass, (moment, moment, moment)),
        ),
        ropes=(
            dice.rope("hoist_left", "left", "eye_0"),
            dice.rope("hoist_right", "right", "eye_1"),
        ),
        drives=drives("left", "right", "hoist_left", "hoist_right"),
        outputs=("beam.x", "beam.z", "beam.beta", "left.position"),
        home={"left": -wide, "right": wide, "beam": (0.0, 0.0, -down)},
    )


def _spreader(dice: Dice) -> Rig:
    """A box on four ropes from a wide trolley; its place across is held, and it leans about y."""
    long, wide, down = dice.length(0.3, 1.0), dice.length(0.3, 1.0), dice.length(1.0, 4.0)
    spread = dice.rng.uniform(1.1, 2.0), dice.rng.uniform(1.0, 1.6)
    mass, above = dice.mass(), dice.length(0.05, 0.4)
    size = mass * max(long, wide) ** 2
    signs = [(x, y) for x in (-1.0, 1.0) for y in (-1.0, 1.0)]
    pair = [dice.rope("rope", "drum_0", "block_0") for _ in range(2)]  # the same on both sides
    ropes = [
        replace(pair[k // 2], name=f"rope_{k}", path=(f"drum_{k}", f"block_{k}")) for k in range(4)
    ]
    anchors = []
    for k, (x, y) in enumerate(signs):
        top = (spread[0] * long * x, spread[1] * wide * y, 0.0)
        anchors.append(Anchor(f"drum_{k}", top, "trolley"))
        anchors.append(Anchor(f"block_{k}", (long * x, wide * y, above), "box"))
    return Rig(
        name="spreader_crane",
        frames=(Frame("trolley", "sliding", dice.mass(), (1.0, 0.0, 0.0)),),
        anchors=tuple(anchors),
        masses=(Platform("box", mass, (0.1 * size, 0.12 * size, 0.15 * size)),),
        ropes=tuple(ropes),
        drives=drives("trolley", *(rope.name for rope in ropes)),
        outputs=("box.x", "box.z", "box.alpha", "box.beta", "box.gamma"),
        held=("box.y",),
        home={"box": (0.0, 0.0, -down)},
    )
