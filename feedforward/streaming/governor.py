"""Commands that a rig can always be stopped from.

Each command is looked at together with what follows if it is held for a moment and then the rig
stopped.  It is let through if that stays within all bounds; otherwise each axis of it, one after
the other, to the largest part that does.

To stop is what was looked at a moment before, so that there is always something that can be done.
A load may rest beyond a bound, or come there by rounding; then commands are let through as well
that lead no further beyond that bound than stopping does.  Bounds are compared one by one, or what
is beyond one would free the way beyond the others.
"""

from typing import NamedTuple

import numpy as np

from ...models.types import Array
from .bounds import Bounds
from .evaluation import Evaluator
from .prediction import Courses, Prediction

PARTS = 8
"""Into which a command is cut to find how much of it can be let through."""
WORSE = 0.01
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

    def decide(self, state: Array, command: Array, near: Array) -> Decision:
        """What is let through of a command.

        Parameters
        ----------
        state
            Of the filter, shape (n+2, size).
        command
            Shape (size,).
        near
            Guesses at the prediction's instants, shape (unknowns + turning frames, N).
        """

        def after(commands: Array) -> Courses:
            return self.prediction.courses(self.evaluator, state, commands, near)

        whole = after(command[None])
        if not command.any() or self._within(whole, 0.0)[0]:
            return Decision(command, whole, 0)
        commands = np.zeros((1 + PARTS, len(command)))
        axes = np.flatnonzero(command)
        best, floor = None, np.zeros(())
        for axis in axes:
            commands[1:, axis] = command[axis] * np.arange(1, PARTS + 1) / PARTS
            courses = after(commands)
            if best is None:
                stop = np.nan_to_num(self._spare(courses)[:, :1], nan=-WORSE)
                floor = np.clip(stop, -WORSE, 0.0)
                best = Decision(commands[0].copy(), courses, 0)
            passed = np.flatnonzero(self._within(courses, floor)[1:])
            if passed.size:
                chosen = 1 + int(passed[-1])
                best = Decision(commands[chosen].copy(), courses, chosen)
                commands[:] = commands[chosen]
        assert best is not None  # a command without axes is let through above
        return best

    def _spare(self, courses: Courses) -> Array:
        """Least spare of each bound along each course, shape (bounds, courses).

        Between samples it may be less, by an eighth of their second difference where that is bent
        upwards: how far the lowest point of a parabola lies below the samples at most.
        """
        with np.errstate(invalid="ignore", over="ignore"):
            spare = self.bounds.spare(courses.found)
        spare = spare.reshape(len(spare), *courses.solved.shape)
        lowest = spare.min(axis=2)
        first, middle, last = spare[..., 2:-2], spare[..., 3:-1], spare[..., 4:]
        bent = np.maximum(first - 2.0 * middle + last, 0.0)
        return np.asarray(np.minimum(lowest, (middle - bent / 8.0).min(axis=2)))

    def _within(self, courses: Courses, floor: Array | float) -> Array:
        """Which courses have a solution on the branch within all bounds, shape (courses,)."""
        whole = courses.solved.all(axis=1)
        whole &= self.bounds.continuous(courses.found, len(whole))
        return np.asarray(whole & (self._spare(courses) >= floor).all(axis=0))
