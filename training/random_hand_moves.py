"""Moves of hands for training and judging controllers, drawn at random.

    plan = random_hand_plan(task, default_move(task.hand), np.random.default_rng(7))

Each turns the object about its own move's axis by a share of its angle and then by something more
about any axis, shifts it by that share and something more where it can be shifted, and takes a
duration of its own.  Every one is one that the hand can make.
"""

from contextlib import suppress
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from ..envs.hand.plan import HandPlan
from ..envs.hand.task import HandTask
from ..envs.plans import TRIES
from ..feedforward.rolling.carried import carried_by
from ..models.errors import FlatrigError, OptionError
from ..models.hand.hand import Hand
from ..models.hand.move import HandMove

SHARES = (0.4, 1.1)
"""Shares of its own move's turn and shift."""
AROUND = 0.3
"""Turn more about each axis, at most [rad]."""
ASIDE = 0.3
"""Shift more along each axis, at most, over the object's radius."""
PACES = (0.8, 2.0)
"""Durations over its own move's."""


def random_hand_move(hand: Hand, move: HandMove, rng: np.random.Generator) -> HandMove:
    """Draw one like `move`; whether the hand can make it is not known yet.

    A turn about one axis that is fixed in space keeps its axis: two oblique plates allow no other.
    """
    share, pace = rng.uniform(*SHARES), rng.uniform(*PACES)
    turn, aside = AROUND * rng.uniform(-1.0, 1.0, 3), ASIDE * rng.uniform(-1.0, 1.0, 3)
    if hand.planar:
        goal = (move.start[0] + share * (move.goal[0] - move.start[0]) + turn[0],)
    else:
        # RPY angles (phi, theta, psi) turn about z, then about the new y and x (K 2.15).
        start, end = (Rotation.from_euler("ZYX", angles) for angles in (move.start, move.goal))
        vector = share * (end * start.inv()).as_rotvec()
        if move.turning != "axis":
            vector += turn
        goal = tuple((Rotation.from_rotvec(vector) * start).as_euler("ZYX").tolist())
    free = carried_by(hand, move).free
    shift = share * np.array(move.shift) + hand.held.radius * free @ aside
    duration = pace * move.duration
    return replace(move, goal=goal, shift=tuple(shift.tolist()), duration=duration)


def random_hand_plan(task: HandTask, move: HandMove, rng: np.random.Generator) -> HandPlan:
    """The plan of a random move for a task's control period and hold.

    Raises
    ------
    OptionError
        The hand can make none of `TRIES` draws.
    """
    for _ in range(TRIES):
        with suppress(FlatrigError):
            return task.planner.plan(random_hand_move(task.hand, move, rng))
    raise OptionError(f"hand {task.hand.name} can make none of {TRIES} random moves like its own")
