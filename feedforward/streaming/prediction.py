"""What follows from a command: it is held for a moment, then the rig comes to rest."""

import math
from typing import NamedTuple

import numpy as np

from ...models.types import Array, Mask
from ..exact.problem import Problem
from ..paths.base_motion import BaseMotion
from ..series.products import factorials
from .command_filter import CommandFilter
from .evaluation import Evaluated, Evaluator

SPACING = 0.06
"""Of samples after the command has ended, over the lag and the time since: what it leaves behind
in the inputs peaks within half a lag, and slower later on."""
RESTED = 1e-3
"""Of a speed in full, below which the rig rests for a prediction."""


class Courses(NamedTuple):
    """What follows from several commands, at the same N instants."""

    taylor: Array
    """Of the outputs, shape (orders, courses, N, outputs)."""
    found: Evaluated
    """The rig at courses times N samples, course by course."""

    @property
    def solved(self) -> Mask:
        """Where there is a solution on the branch, shape (courses, N)."""
        return self.found.solved.reshape(self.taylor.shape[1:3])

    def near(self, course: int) -> Array:
        """Guesses for what is close to a course, shape (unknowns + turning frames, N)."""
        samples = self.taylor.shape[2]
        return self.found.near[:, course * samples : (course + 1) * samples]

    def part(self, course: int, samples: int) -> tuple[Array, Evaluated]:
        """Taylor coefficients and the rig at the first samples of one course."""
        first = course * self.taylor.shape[2]
        cut = slice(first, first + samples)
        rows = tuple(row[:, cut] for row in self.found.rows)
        found = Evaluated(rows, self.found.near[:, cut], self.found.solved[cut])
        return self.taylor[:, course, :samples], found


class Prediction:
    """The outputs at some instants after a command.

    Parameters
    ----------
    problem
        Of the rig.
    filter
        From commands to outputs.
    held
        Instants at which the command is held [s], shape (H,); it ends at the last.
    after
        Steps from there to later instants [s].
    base
        How a base moves, if one does, from a time 0 of its own on.
    """

    def __init__(
        self,
        problem: Problem,
        filter: CommandFilter,
        held: list[float],
        after: list[float],
        base: BaseMotion | None = None,
    ) -> None:
        self.problem, self.base = problem, base
        self.offsets = np.array([*held, *(held[-1] + np.cumsum(after))])
        """Instants after the command [s], shape (N,)."""
        states = [filter.step(offset) for offset in held]
        for step in after:
            states.append(filter.step(step) @ filter.released @ states[-1])
        scale = factorials(problem.order + 1)[:, None]
        readout = filter.readout(problem.order) / scale
        self._readouts = np.array([readout @ state for state in states]).swapaxes(0, 1)

    def taylor(self, state: Array, commands: Array, now: float) -> Array:
        """Of the outputs after commands (courses, size), shape (orders, courses, N, size).

        The base is where it is at the time `now` of its own [s], and after it.
        """
        common = self._readouts[..., :-1] @ state[:-1]
        held = self._readouts[:, None, :, -1, None] * commands[None, :, None, :]
        found = np.asarray(common[:, None] + held)
        if self.base is None:
            return found
        scale = factorials(len(found))[:, None, None]
        times = np.tile(now + self.offsets, len(commands))
        flat = found.reshape(len(found), len(times), -1) * scale
        return np.asarray(self.base.added(flat, times) / scale).reshape(found.shape)

    def courses(
        self, evaluator: Evaluator, state: Array, commands: Array, near: Array, now: float
    ) -> Courses:
        """What follows from some commands.

        Parameters
        ----------
        evaluator
            Of the rig.
        state
            Of the filter, shape (n+2, size).
        commands
            Shape (courses, size).
        near
            Guesses at the instants, shape (unknowns + turning frames, N).
        now
            The base's time [s].
        """
        taylor = self.taylor(state, commands, now)
        orders, courses, samples, size = taylor.shape
        flat = taylor.reshape(orders, courses * samples, size)
        return Courses(taylor, evaluator(flat, np.tile(near, courses)))


def of_stops(
    problem: Problem,
    filter: CommandFilter,
    period: float,
    moment: float,
    base: BaseMotion | None = None,
) -> Prediction:
    """A command held for a moment, then the stop; the second instant is the middle of a tick.

    All times are in s.
    """
    parts = math.ceil(moment / (SPACING * filter.lag))
    held = [0.0, 0.5 * period, *(moment * np.arange(1, parts + 1) / parts)]
    after: list[float] = []
    rest = filter.resting(RESTED)
    while sum(after) < rest:
        after.append(SPACING * (filter.lag + sum(after)))
    return Prediction(problem, filter, held, after, base)
