"""Chains of frames about and along any axis, drawn at random, with a load on a rope from the last.

A load in space takes two frames and a winch; what further frames do is prescribed.  The axes of the
first are drawn so that together they can move the rope's upper end in any horizontal direction.
"""

import math
from dataclasses import replace

import numpy as np

from ...models import WORLD, Anchor, Frame, Load, Rail, Rig, Trolley
from ...models.rig.frames import outwards
from ...models.types import Array
from ...models.values import Vector
from .random_parts import Dice, drives

DEEPEST = 4
"""Frames on one another, at most."""
TRIES = 200
"""Chains that are drawn until one can move its load in all directions."""
APART = 0.2
"""Least part of the larger of two horizontal directions that the other is across it."""
SHORT = 1e-6
"""Step of a difference, over the crane's length [1], [rad]."""


def boom_crane(dice: Dice) -> Rig:
    """One to four frames on one another, the load on a rope from a tip or from a trolley."""
    planar = dice.maybe(0.25)
    count = int(dice.rng.integers(1, (2 if planar else DEEPEST) + 1))
    trolley = not planar and (count == 1 or dice.maybe(0.3))
    for _ in range(TRIES):
        rig = _drawn(dice, count, planar=planar, trolley=trolley)
        if _moves_all_ways(rig):
            return rig
    raise AssertionError("no chain of frames was drawn that moves its load in all directions")


def _drawn(dice: Dice, count: int, *, planar: bool, trolley: bool) -> Rig:
    frames = _base(dice, planar) if dice.maybe(0.2) else []
    base = len(frames)
    for k in range(count):
        frames.append(_frame(dice, f"frame_{k}", frames[-1].name if frames else WORLD, planar))
    home = {frame.name: 0.0 if frame.given else _home(dice, frame) for frame in frames}
    last, tip = frames[-1], _vector(dice, planar, 0.3, 1.5)
    rails: tuple[Rail, ...] = ()
    trolleys: tuple[Trolley, ...] = ()
    above, upper = "tip", tip
    if trolley:
        out = dice.length(-1.0, 1.0)
        rails = (Rail("rail", _unit(dice, planar), tip, last.name, *dice.ends(out)),)
        trolleys, above = (Trolley("trolley", dice.mass(), "rail"),), "trolley"
        home["trolley"] = out
        x, y, z = (a + out * b for a, b in zip(tip, rails[0].direction, strict=True))
        upper = (x, y, z)
    hung = outwards(frames, last, lambda frame: home[frame.name], upper)
    # with a trolley one frame is enough in space
    free = (1 if planar else 2) - trolley
    axes = ("load.x", "load.z") if planar else ("load.x", "load.y", "load.z")
    return Rig(
        name="boom_crane",
        dimensions=2 if planar else 3,
        frames=tuple(frames),
        anchors=() if trolley else (Anchor("tip", tip, last.name),),
        rails=rails,
        masses=(*trolleys, Load("load", dice.mass())),
        ropes=(dice.rope("hoist", above, "load"),),
        drives=drives(*(f.name for f in frames), *(t.name for t in trolleys), "hoist"),
        outputs=(*axes, *(f.coordinate for f in (*frames[:base], *frames[base + free :]))),
        home={**home, "load": (hung[0], hung[1], hung[2] - dice.length(0.3, 3.0))},
    )


def _base(dice: Dice, planar: bool) -> list[Frame]:
    """Frames whose motion is given: one that turns, perhaps on one that slides."""
    axis: Vector = (0.0, 1.0, 0.0) if planar else _unit(dice, planar)
    base = Frame("base", "turning", axis=axis, origin=_vector(dice, planar, 0.0, 1.0), given=True)
    if dice.maybe():
        return [base]
    return [
        Frame("sea", "sliding", axis=_unit(dice, planar), given=True),
        replace(base, parent="sea"),
    ]


def _frame(dice: Dice, name: str, parent: str, planar: bool) -> Frame:
    turning = dice.maybe(0.7)
    if planar and turning:
        axis: Vector = (0.0, 1.0 if dice.maybe() else -1.0, 0.0)
    else:
        axis = _unit(dice, planar)
    origin = _vector(dice, planar, 0.0, 1.0)
    mass, kind = dice.mass(), "turning" if turning else "sliding"
    if dice.maybe(0.3):  # a number alone
        inertia = mass * dice.size**2 if turning else mass
        return Frame(name, kind, inertia, axis, origin, parent)  # type: ignore[arg-type]
    size = mass * dice.size**2
    tensor = _tensor(dice, size)
    centre = _vector(dice, planar, 0.0, 0.7)
    return Frame(name, kind, tensor, axis, origin, parent, mass, centre)  # type: ignore[arg-type]


def _tensor(dice: Dice, size: float) -> tuple[float, ...]:
    """Of a few masses about their centre, along axes or askew, thin or thick."""
    places = dice.rng.normal(size=(4, 3)) * (dice.rng.random(3) < 0.7)
    second = size * (places.T @ places) / 12.0 + 1e-3 * size * np.eye(3)
    tensor = np.trace(second) * np.eye(3) - second
    if dice.maybe(0.3):
        return tuple(np.diag(tensor).tolist())
    return tuple(tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist())


def _unit(dice: Dice, planar: bool) -> Vector:
    """A direction, often along an axis."""
    if dice.maybe(0.4):
        unit = np.eye(3)[2 * int(dice.rng.integers(2)) if planar else int(dice.rng.integers(3))]
    else:
        unit = dice.rng.normal(size=3) * (1.0, 0.0 if planar else 1.0, 1.0)
        unit = unit / np.linalg.norm(unit)
    return (float(unit[0]), float(unit[1]), float(unit[2]))


def _vector(dice: Dice, planar: bool, low: float, high: float) -> Vector:
    x, y, z = (dice.length(low, high) * part for part in _unit(dice, planar))
    return (x, y, z)


def _home(dice: Dice, frame: Frame) -> float:
    return dice.rng.uniform(-1.0, 1.0) * (1.0 if frame.kind == "turning" else dice.size)


def _moves_all_ways(rig: Rig) -> bool:
    """Whether what is not prescribed can move the load's rope sideways in all directions."""
    free = [f for f in rig.frames if f.coordinate not in rig.outputs]
    upper = rig.ropes[0].path[0]
    size = max(abs(value) for value in rig.home_point("load")) or 1.0
    steps: list[Array] = []
    moved: list[Frame | Trolley] = [*free, *rig.trolleys]
    for part in moved:
        change = SHORT * (size if part.coordinate.endswith("position") else 1.0)
        steps.append(_moved(rig, upper, part.name, change) / (SHORT * size))
    level = np.array(steps)[:, : rig.dimensions - 1]
    return bool(np.linalg.svd(level)[1][-1] > APART) and math.isfinite(size)


def _moved(rig: Rig, point: str, part: str, change: float) -> Array:
    """How a point moves when a part does."""
    home = dict(rig.home)
    home[part] = float(home[part]) + change  # type: ignore[arg-type]
    rails = tuple(replace(rail, start=-math.inf, end=math.inf) for rail in rig.rails)
    other = replace(rig, rails=rails, home=home)
    pairs = zip(other.home_point(point), rig.home_point(point), strict=True)
    return np.array([after - before for after, before in pairs])
