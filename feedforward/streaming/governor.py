"""Commands that a rig can always be stopped from.

Each command is looked at together with what follows if it is held for a moment and then the rig
stopped.  It is let through if that stays within all bounds; otherwise the largest share of it that
was found to do so: of some shares of its axes the best one, and then one axis of it raised, twice.

To stop is what was looked at a moment before, so that there is always something that can be done;
but for a base that moves as given, which is looked at no further ahead than a stop takes.
A load may rest beyond a bound, or come there by rounding; then commands are let through as well
that lead no further beyond that bound than stopping does.  Bounds are compared one by one, or what
is beyond one would free the way beyond the others.
"""

from typing import NamedTuple

import numpy as np

from ...models.types import Array, Mask
from .bounds import Bounds
from .evaluation import Evaluator
from .prediction import Courses, Prediction

PARTS = 6
"""Into which a command's axes are cut to find how much of them can be let through."""
ROUNDS = 2
"""Of raising one axis further."""
WORSE = 0.003
"""How far beyond a bound a command may lead at most, if a stop leads there as well."""


class Decision(NamedTuple):
    """What was let through."""

    velocity: Array
    """Shape (outputs,)."""
    courses: Courses
    chosen: int
    """Course of what was let through."""


class Governor:
    """Lets commands through as far as a rig can be stopped from them."""

    def __init__(self, prediction: Prediction, bounds: Bounds, evaluator: Evaluator) -> None:
        self.prediction, self.bounds, self.evaluator = prediction, bounds, evaluator

    def decide(self, state: Array, command: Array, near: Array, now: float) -> Decision:
        """What is let through of a command.

        Parameters
        ----------
        state
            Of the filter, shape (n+2, size).
        command
            Shape (size,).
        near
            Guesses at the prediction's instants, shape (unknowns + turning frames, N).
        now
            When that is, for a base that moves [s].
        """
        whole = self._after(state, command[None], near, now)
        if not command.any() or self._within(whole, 0.0)[0]:
            return Decision(command, whole, 0)
        axes = command != 0.0
        shares = _guesses(axes)
        courses = self._after(state, shares * command, near, now)
        floor = self._floor(courses)
        share, best = shares[0], Decision(np.zeros(len(command)), courses, 0)
        for left in reversed(range(1 + ROUNDS)):
            sums = np.where(self._within(courses, floor), shares.sum(axis=1), 0.0)
            chosen = int(sums.argmax())
            if sums[chosen] <= share.sum():
                break
            share, best = shares[chosen], Decision(shares[chosen] * command, courses, chosen)
            shares = _more(share, axes)
            if not left or not len(shares):
                break
            courses = self._after(state, shares * command, near, now)
        return best

    def _floor(self, courses: Courses) -> Array:
        """Spare that each bound has to keep, (bounds, 1): what the first course, a stop, keeps.

        At most none, and no less than that the stop is a little beyond a bound on its way, or ends
        beyond it.
        """
        way = np.clip(np.nan_to_num(self._spare(courses)[:, :1], nan=-WORSE), -WORSE, 0.0)
        samples = courses.solved.shape[1]
        times = self.prediction.offsets
        end = self.bounds.spare(courses.part(0, samples)[1], times)[:, -1:]
        return np.minimum(way, np.nan_to_num(end, nan=0.0))

    def _after(self, state: Array, commands: Array, near: Array, now: float) -> Courses:
        return self.prediction.courses(self.evaluator, state, commands, near, now)

    def _spare(self, courses: Courses) -> Array:
        """Least spare of each bound along each course, shape (bounds, courses).

        Between samples it may be less, by an eighth of their second difference where that is bent
        upwards: how far the lowest point of a parabola lies below the samples at most.
        """
        with np.errstate(invalid="ignore", over="ignore"):
            spare = self.bounds.spare(courses.found, self.prediction.offsets)
        spare = spare.reshape(len(spare), *courses.solved.shape)
        lowest = spare.min(axis=2)
        first, middle, last = spare[..., 2:-2], spare[..., 3:-1], spare[..., 4:]
        bent = np.maximum(first - 2.0 * middle + last, 0.0)
        return np.asarray(np.minimum(lowest, (middle - bent / 8.0).min(axis=2)))

    def _within(self, courses: Courses, floor: Array | float) -> Array:
        """Which courses have a solution on the branch within all bounds, shape (courses,)."""
        whole = courses.solved.all(axis=1) & self.bounds.continuous(
            courses.found, len(courses.solved)
        )
        return np.asarray(whole & (self._spare(courses) >= floor).all(axis=0))


def _guesses(axes: Mask) -> Array:
    """Shares of a command's axes to begin with, the first of which is nothing: (courses, size).

    All axes in equal part, each axis alone, and all but one.
    """
    each = np.eye(len(axes))[axes]
    equal = np.arange(PARTS)[:, None] / PARTS * axes
    return np.vstack((equal, each, axes - each))


def _more(share: Array, axes: Mask) -> Array:
    """Shares with one axis raised, none if all are in full, shape (courses, size)."""
    raised = []
    for axis in np.flatnonzero(axes):
        for part in np.arange(1, PARTS + 1) / PARTS:
            if part > share[axis]:
                raised.append(share.copy())
                raised[-1][axis] = part
    return np.array(raised)
