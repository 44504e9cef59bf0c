"""Friction, gears, limits of drives and ends of ropes for a rig that is drawn at random.

Sizes are those of the rig: its weight, one crane's length, and the time in which that swings.
"""

import math
from dataclasses import replace
from itertools import pairwise

from ...models import Drive, Friction, Load, Rig, Rope
from ...models.rig.parts import Frame, Platform, Trolley
from .random_parts import Dice

SHARE = 0.3
"""Of rigs, those that get any of it."""


def limited(rig: Rig, dice: Dice) -> Rig:
    """The rig, in some cases with friction and limits."""
    if not dice.maybe(SHARE):
        return rig
    driven = {drive.on for drive in rig.drives}

    def rubbing(part: Frame | Trolley | Rope) -> Friction:
        force, speed = rig.weight, math.sqrt(rig.gravity * dice.size)
        if isinstance(part, Frame) and part.kind == "turning":
            force, speed = force * dice.size, speed / dice.size
        dry = force * dice.decades(1e-5, 1e-1) if part.name in driven and dice.maybe() else 0.0
        return Friction(dry, force / speed * dice.decades(1e-5, 1e-1) if dice.maybe() else 0.0)

    frames = tuple(
        part if part.given else replace(part, friction=rubbing(part)) for part in rig.frames
    )
    trolleys = tuple(replace(part, friction=rubbing(part)) for part in rig.trolleys)
    loads = tuple(_dragged(rig, part, dice) for part in rig.loads)
    ropes = tuple(_ended(rig, replace(part, friction=rubbing(part)), dice) for part in rig.ropes)
    drives = tuple(_driven(rig, drive, dice) for drive in rig.drives)
    masses: tuple[Trolley | Load | Platform, ...] = (*trolleys, *loads, *rig.platforms)
    return replace(rig, frames=frames, masses=masses, ropes=ropes, drives=drives)


def _dragged(rig: Rig, load: Load, dice: Dice) -> Load:
    """With drag, unless it is a pulley without mass."""
    if not (load.mass and dice.maybe(0.3)):
        return load
    speed = math.sqrt(rig.gravity * dice.size)
    return replace(load, drag=load.mass * rig.gravity / speed * dice.decades(1e-5, 1e-1))


def _ended(rig: Rig, rope: Rope, dice: Dice) -> Rope:
    """With ends about its lengths at home."""
    if not dice.maybe(0.2):
        return rope
    points = [rig.home_point(name) for name in rope.path]
    *before, last = (math.dist(a, b) for a, b in pairwise(points))
    whole = sum(before) + rope.falls * last
    return replace(
        rope,
        shortest=whole * dice.rng.uniform(0.0, 0.9),
        longest=whole * dice.rng.uniform(1.1, 4.0),
        two_block=last * dice.rng.uniform(0.0, 0.9) if dice.maybe() else 0.0,
    )


def _driven(rig: Rig, drive: Drive, dice: Dice) -> Drive:
    """With a gear, perhaps one that loses power, and limits that a move may pass."""
    part, swing = rig.driven(drive), math.sqrt(dice.size / rig.gravity)
    if isinstance(part, Frame) and part.given:  # its input is an acceleration
        return drive
    turning = isinstance(part, Frame) and part.kind == "turning"
    way = (1.0 if turning else dice.size) / rig.arm(drive)
    gear = dice.decades(1e-1, 1e2) if dice.maybe() else 1.0

    def some(usual: float) -> float:
        return usual * dice.decades(1e-1, 1e2) if dice.maybe(0.2) else math.inf

    return replace(
        drive,
        gear=gear,
        efficiency=float(dice.rng.uniform(0.5, 1.0)) if dice.maybe(0.3) else 1.0,
        lower=-drive.limit * dice.decades(1e-2, 1e2) if dice.maybe(0.3) else None,
        speed=some(gear * way / swing),
        acceleration=some(gear * way / swing**2),
        power=some(rig.weight * dice.size / swing),
    )
