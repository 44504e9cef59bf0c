"""Moves for any rig, drawn at random.

Two in three are tame: about half as far as the shortest rope is long, in no less than the time of
a swing, as smooth as most rigs need.  The others are wild, and many cannot be followed.
"""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from ...feedforward.exact.problem import problem_of
from ...feedforward.streaming.symmetric import free_outputs
from ...models import Frame, Move, Rig, Wave
from ...models.rig.open_tensions import TENSION
from ...models.types import Array

WILD = 1 / 3
"""Share of the moves that are wild."""

TURNING = 0.5
"""Share of a platform's moves that turn it about one axis."""

WAVY, ON_DECK = 0.8, 0.4
"""Share of a base's frames that go up and down with waves, and of the moves that lead on it."""


def random_move(rig: Rig, rng: np.random.Generator) -> Move:
    """A move of the rig's outputs from and to somewhere about home."""
    at_home = rig.home_coordinates
    at_home |= {name + TENSION: rig.weight for name in rig.tension_names}
    home = np.array([sum(a * at_home[name] for a, name in rig.terms(o)) for o in rig.outputs])
    spans = [
        math.dist(rig.home_point(a), rig.home_point(b))
        for rope in rig.ropes
        for a, b in pairwise(rope.path)
    ]
    spans += [rig.link_length(link) for link in rig.links]
    size = float(np.median(spans))
    angles = rig.platform_angles
    reaches = dict.fromkeys(rig.angles, 0.4)
    reaches |= {name + TENSION: 0.5 * rig.weight for name in rig.tension_names}
    reach = np.array([reaches.get(name, 0.5 * min(spans)) for name in rig.outputs])
    swing = 2.0 * math.pi * math.sqrt(size / rig.gravity)
    order = int(rng.integers(4, 9))
    duration = swing * 10.0 ** rng.uniform(0.0, 2.0)
    if rng.random() < WILD:
        reach = reach * 10.0 ** rng.uniform(-1.0, 2.0)
        duration = swing * 10.0 ** rng.uniform(-3.0, 0.5)
        order = int(rng.integers(0, 9))
    start, goal = (home + reach * rng.uniform(-1.0, 1.0, len(home)) for _ in range(2))
    if rig.held:  # symmetric moves only
        free = np.array(free_outputs(problem_of(rig)))
        start, goal = np.where(free, start, home), np.where(free, goal, home)
    three = order > 0 and rng.random() < 0.3
    columns = tuple(rig.outputs.index(name) for name in angles)
    move = Move(
        start=tuple(start.tolist()),
        goal=tuple(goal.tolist()),
        duration=float(duration),
        profile="three_phase" if three else "polynomial",
        order=order,
        blend=float(duration * rng.uniform(0.05, 0.5)),
        turning=columns if rng.random() < TURNING and len(columns) == 3 else (),
    )
    given = [frame for frame in rig.frames if frame.given]
    return _at_sea(rig, given, move, reach, swing, rng) if given else move


def _at_sea(
    rig: Rig, given: list[Frame], move: Move, reach: Array, swing: float, rng: np.random.Generator
) -> Move:
    """A move whose base goes up and down as well, and may carry what is led."""
    waves = []
    for column in (rig.outputs.index(frame.coordinate) for frame in given):
        if rng.random() < WAVY:
            size, period = 0.3 * reach[column] * rng.random(), swing * 10.0 ** rng.uniform(0.3, 1.5)
            waves.append(Wave(column, float(size), float(period), float(rng.uniform(0.0, 6.0))))
    whole = all(f"{load.name}.{axis}" in rig.outputs for load in rig.loads for axis in rig.axes)
    on_deck = whole and not rig.platforms and rng.random() < ON_DECK
    return replace(move, waves=tuple(waves), frame=given[-1].name if on_deck else "")
