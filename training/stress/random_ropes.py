"""Loads and platforms that ropes alone hold, as many as they have freedoms or more."""

import math

import numpy as np

from ...models import Anchor, Load, Platform, Rig
from ...models.errors import RigError
from .random_parts import Dice, drives


def rope_robot(dice: Dice) -> Rig:
    """A load between three fixed winches, or two in a plane."""
    count = 2 if dice.maybe() else 3
    anchors = []
    for k in range(count):
        angle = 2 * math.pi * k / count + dice.rng.uniform(-0.3, 0.3) * (count == 3)
        y = 0.0 if count == 2 else dice.size * math.sin(angle)
        anchors.append(Anchor(f"mast_{k}", (dice.size * math.cos(angle), y, dice.length(0.0, 0.4))))
    names = [f"rope_{k}" for k in range(count)]
    return Rig(
        name="rope_robot",
        dimensions=3 if count == 3 else 2,
        anchors=tuple(anchors),
        masses=(Load("load", dice.mass()),),
        ropes=tuple(
            dice.rope(name, anchor.name, "load")
            for name, anchor in zip(names, anchors, strict=True)
        ),
        drives=drives(*names),
        outputs=("load.x", "load.y", "load.z") if count == 3 else ("load.x", "load.z"),
        home={"load": (dice.length(-0.2, 0.2), 0.0, -dice.length(0.2, 2.0))},
    )


def redundant_robot(dice: Dice) -> Rig:
    """A load or a platform on more ropes than it has freedoms, drawn until it is not singular."""
    while True:
        try:
            return _robot(dice, platform=dice.maybe())
        except RigError:
            continue


def _robot(dice: Dice, *, platform: bool) -> Rig:
    freedoms = 6 if platform else 3
    extra = int(dice.rng.integers(1, 3))
    names = [f"rope_{k}" for k in range(freedoms + extra)]
    masts = []
    for k in range(len(names)):
        angle = 2 * math.pi * k / len(names) + dice.rng.uniform(-0.3, 0.3)
        x, y = dice.size * math.cos(angle), dice.size * math.sin(angle)
        masts.append(Anchor(f"mast_{k}", (x, y, dice.length(-0.4, 0.4))))
    mass, side = dice.mass(), dice.length(0.05, 0.2)
    body = Platform("platform", mass, _tensor(dice, mass, side)) if platform else Load("load", mass)
    corners = [dice.rng.normal(size=3) for _ in names] if platform else []
    eyes = tuple(
        Anchor(f"corner_{k}", tuple((side * c / np.linalg.norm(c)).tolist()), "platform")
        for k, c in enumerate(corners)
    )
    turns = ("alpha", "beta", "gamma") if platform else ()
    said = [f"{name}.tension" for name in names[: int(dice.rng.integers(0, extra + 1))]]
    wanted = {name: mass * 9.81 * dice.decades(1e-2, 1e1) for name in names}
    return Rig(
        name="redundant_robot",
        anchors=(*masts, *eyes),
        masses=(body,),
        ropes=tuple(
            dice.rope(name, f"mast_{k}", f"corner_{k}" if platform else "load")
            for k, name in enumerate(names)
        ),
        drives=drives(*names),
        outputs=(*(f"{body.name}.{axis}" for axis in ("x", "y", "z", *turns)), *said),
        home={body.name: (dice.length(-0.2, 0.2), 0.0, -dice.length(0.5, 2.0))},
        distribution=wanted if dice.maybe() and len(said) < extra else {},
    )


def _tensor(dice: Dice, mass: float, side: float) -> tuple[float, ...]:
    """The full tensor of points at random places about their centre."""
    places = dice.rng.normal(size=(6, 3)) * side
    places -= places.mean(axis=0)
    second = mass / 6.0 * places.T @ places
    whole = np.trace(second) * np.eye(3) - second
    return tuple(whole[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist())
