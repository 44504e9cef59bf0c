"""Random rigs with random moves, some of them wild; what is solved is judged by every road.

What is refused is judged, too, where there is a closed form: a load below a trolley or jib can
follow any path that stays below it and never falls freely, unless its foot meets the tower.
"""

from collections.abc import Iterator

import numpy as np

from ...feedforward import Reference, from_move
from ...models import PathError, Rail, Rig, SmoothnessError
from .case import EITHER, Case, Finding, case
from .random_moves import random_move
from .random_rigs import random_rig
from .solver_cases import followed

SAMPLES = 151
FINE = 4001
"""Samples by which the closed form judges a path."""
NEAR = 1e-3
"""Where the closed form leaves it open: lift over gravity, height and foot over the path's size."""

BELOW = ("trolley_crane", "roped_crane", "jib_crane")
"""Kinds whose load hangs from a trolley or jib that moves level."""
ENDLESS = Rail("endless", (1.0, 0.0, 0.0))
"""What a jib moves on."""


def cases(rigs: int, seed: int) -> Iterator[Case]:
    """So many rigs, each with a move of its own."""
    for number in range(rigs):
        row = "random rigs, random moves"
        yield case(row, f"{number}", random_case, seed, number, must=EITHER)


def random_case(seed: int, number: int) -> Finding:
    """Draw a rig and a move, and follow it."""
    rng = np.random.default_rng([seed, number])
    rig = random_rig(rng)
    reference = from_move(random_move(rig, rng))
    try:
        return followed(rig, reference, SAMPLES)
    except SmoothnessError:
        raise
    except PathError as error:
        if can_follow(rig, reference):
            return Finding(np.inf, 0.0, f"refused what can be followed: {error}")
        raise


def can_follow(rig: Rig, reference: Reference) -> bool:
    """Whether a load below a trolley or jib certainly can follow a path; False where unknown."""
    if rig.name not in BELOW or any(rail.direction[2] for rail in rig.rails):
        return False
    path, _, second = reference.derivatives(np.linspace(0.0, reference.duration, FINE), 2)
    size = np.ptp(path, axis=0).max() + np.abs(path).max()
    lift = second[:, -1] + rig.gravity
    if lift.min() <= NEAR * rig.gravity or path[:, -1].max() >= -NEAR * size:
        return False
    turning = any(frame.kind == "turning" for frame in rig.frames)
    foot = path[:, :-1] - path[:, -1:] / lift[:, None] * second[:, :-1]
    place = np.linalg.norm(foot, axis=1) if turning else foot[:, 0]
    rail = rig.rails[0] if rig.rails else ENDLESS
    start = max(rail.start, 0.0) if turning else rail.start
    return bool(place.min() > start + NEAR * size and place.max() < rail.end - NEAR * size)
