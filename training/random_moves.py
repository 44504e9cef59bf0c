"""Moves for training and judging controllers: drawn at random, and hard enough to tell them apart.

    move = random_move(rig, models.default_move(rig), np.random.default_rng(7))

The ends lie in the box of the rig's own move, half of them on its edges, where ropes are shortest
or longest and arms furthest out.  Every move is as smooth as the rig's own and has its profile; it
takes one to two times the shortest time in which no input leaves a share of its limit, so that
feedback has something left to give.  Every one can be planned.

A draw costs about seven coarse solutions of the feedforward: 25 to 130 ms of one core for most
cranes, 0.3 s for the cable manipulator and 1.2 s for the Navy crane in space.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial

import numpy as np

from .. import feedforward
from ..envs.crane.plan import make_plan
from ..envs.crane.references import as_profile, random_ends
from ..envs.plans import TRIES
from ..models.errors import FlatrigError, OptionError, PathError, SmoothnessError
from ..models.rig.move import Move
from ..models.rig.rig import Rig
from ..models.types import Array

SAMPLES = 65
"""Samples along a move at which inputs and tensions are looked at."""
TENSION = 0.4
"""Lowest tension of a rope over that at rest, at the end of the move where it is lower."""
RANGE = (0.2, 2.0)
"""Shortest durations are looked for between these, over the own move's scaled as the root of the
distance."""
HALVINGS = 5
"""Of that range, on a logarithmic scale; the result is at most 8 % above the shortest."""
PERIOD = 0.02
"""Control period of the plan with which a move proves that it can be followed, and the unit of
durations [s]."""


def random_move(
    rig: Rig,
    move: Move,
    rng: np.random.Generator,
    *,
    share: float = 0.65,
    edges: float = 0.5,
    slow: tuple[float, float] = (1.0, 2.0),
) -> Move:
    """Draw a move that an environment can plan.

    Parameters
    ----------
    rig
        A flat rig.
    move
        Its own move, whose box, profile and order the drawn one has.
    rng
        Draws it; the same state draws the same move.
    share
        Of every drive's limit, the most that the drawn move uses in its shortest time; that of its
        own move where this is more.
    edges
        How likely the ends lie on edges and corners of the box.
    slow
        Range of durations over the shortest.

    Raises
    ------
    OptionError
        None of `TRIES` draws can be followed, or the own move ends where it starts.
    RigError, SmoothnessError
        The rig is not flat, or its own move is not smooth enough for it.
    """
    own = as_profile(move)
    bounds = _bounds(rig, own, share)
    for _ in range(TRIES):
        start, goal, distance = random_ends(rig, own, rng, edges=edges)
        pace = rng.uniform(*slow)
        between = replace(own, start=start, goal=goal)
        shortest = _shortest(partial(_within, rig, between, bounds), distance**0.5)
        if shortest is not None:
            drawn = _paced(between, shortest * pace)
            if _planned(rig, drawn):
                return drawn
    raise OptionError(
        f"rig {rig.name} could follow none of {TRIES} random moves between {own.start} and "
        f"{own.goal} with at most {100 * share:g} % of its drives' limits"
    )


def _paced(move: Move, pace: float) -> Move:
    """The same move, in a time so many times as long, rounded up to whole periods."""
    duration = PERIOD * np.ceil(move.duration * pace / PERIOD - 1e-9)
    return replace(move, duration=round(duration, 9), blend=move.blend * duration / move.duration)


def _shortest(holds: Callable[[float], bool], typical: float) -> float | None:
    """The shortest pace that holds about a typical one, to the precision of `HALVINGS`."""
    fast, slow = (typical * end for end in RANGE)
    if not holds(slow):
        return None
    for _ in range(HALVINGS):
        middle = (fast * slow) ** 0.5
        if holds(middle):
            slow = middle
        else:
            fast = middle
    return slow


@lru_cache(maxsize=32)
def _bounds(rig: Rig, move: Move, share: float) -> Array:
    """The most of every input that a drawn move may use, shape (drives,) [N, N m]."""
    limits = np.array([drive.largest for drive in rig.drives])
    try:
        own = np.abs(_motion(rig, move).inputs).max(axis=0)
    except SmoothnessError:
        raise
    except PathError:  # what is drawn from its box may be possible all the same
        own = np.zeros(len(limits))
    return np.asarray(np.maximum(share * limits, np.minimum(own, limits)))


def _within(rig: Rig, move: Move, bounds: Array, pace: float) -> bool:
    """Whether a move keeps inputs within bounds at a pace, and ropes well taut."""
    try:
        motion = _motion(rig, _paced(move, pace))
    except PathError:
        return False
    pulls = motion.tensions[:, list(rig.pulling)]
    at_rest = np.minimum(pulls[0], pulls[-1])
    taut = (pulls >= TENSION * at_rest).all() and (at_rest > 0).all()
    return bool(taut and (np.abs(motion.inputs) <= bounds).all())


def _motion(rig: Rig, move: Move) -> feedforward.Motion:
    times = np.linspace(0.0, move.duration, SAMPLES)
    return feedforward.solve(rig, feedforward.from_move(move, rig), times)


def _planned(rig: Rig, move: Move) -> bool:
    try:
        make_plan(rig, feedforward.from_move(move, rig), PERIOD, 0.0)
    except FlatrigError:
        return False
    return True
