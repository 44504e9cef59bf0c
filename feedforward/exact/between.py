"""What happens between the samples of a branch, where a narrow singular place may hide.

On a path that a rig can follow, the blocks' determinants and the lengths of the ropes' spans keep
away from zero.  They are smooth along it, so that one that comes to zero between two samples shows
in how steeply it falls before them and rises behind.  There the path is looked at more closely,
down to a millionth of its duration; and trolleys are where they turn back.  One that comes to zero
and rises again on the same side may do so too quickly to show: so does that of a load in space on a
rope from a frame and a trolley, at the instant in which it falls freely, where the rope would grow
beyond all bounds.  Then a tension changes its sign, and that instant is looked for.  So whether a
path is accepted does not depend on the instants that are asked for.
"""

import numpy as np

from ...models.types import Array, Mask
from ..paths.reference import Reference, taylor_of
from .problem import Problem
from .refusal import failure, first_wrong, passing, stay_on_rails
from .taylor import Solution, expand

STEEPER = 2.0
"""Times that a determinant may fall more steeply between samples than from one to the next."""
NARROWEST = 1e-6
"""Of the duration, below which nothing is looked for."""
AT_ONCE = 1e-12
"""The same where a tension changes its sign."""


def look_between(
    problem: Problem,
    reference: Reference,
    signs: dict[int, float],
    times: Array,
    solution: Solution,
) -> None:
    """Refuse a path on which a rig cannot get from one sample to the next.

    Parameters
    ----------
    problem
        Of the rig.
    reference
        Path of its outputs.
    signs
        Of the blocks' determinants on the branch.
    times
        Of the samples, ascending, shape (N,).
    solution
        At the samples, all of which are right.

    Raises
    ------
    PathError
        There is a singular place between two samples, or a trolley is off its rail.
    """
    look = _Look(problem, reference, signs)
    turns = look.turns(times, solution)
    if turns.size:
        found = look.at(turns, times, solution.values)
        stay_on_rails(problem.rig, problem.equations.names, found.values, turns)
    values, margins = solution.values, look.margins(solution)
    while True:
        new = np.union1d(
            _middles(times, _suspected(times, margins), NARROWEST),
            _middles(times, _changed(values[look.pulls]), AT_ONCE),
        )
        if not new.size:
            return
        found = look.at(new, times, values)
        order = np.argsort(np.concatenate((times, new)), kind="stable")
        times = np.concatenate((times, new))[order]
        values = np.hstack((values, found.values))[:, order]
        margins = np.hstack((margins, look.margins(found)))[:, order]


class _Look:
    """Closer looks at one path."""

    def __init__(self, problem: Problem, reference: Reference, signs: dict[int, float]) -> None:
        self.problem, self.reference, self.signs = problem, reference, signs
        self._lengths = np.vstack(problem.equations.span_lengths)
        self.pulls = _deciding(problem)
        """Unknowns that are tensions on which a determinant depends."""

    def at(self, new: Array, times: Array, values: Array) -> Solution:
        """The solution at new instants (M,), from values (unknowns, N) at those around them.

        Raises
        ------
        PathError
            There is none, or it does not continue that before.
        """
        solution = self._expanded(new, times, values)
        if first_wrong(solution, self.signs, new) is not None:
            instants = np.sort(np.concatenate((times, new)))
            whole = self._expanded(instants, times, values)
            outputs = self.reference(instants)
            error = failure(self.problem, whole, self.signs, instants, outputs)
            if error is not None:
                raise error
        both = np.concatenate((times, new))
        order = np.argsort(both, kind="stable")
        path = np.hstack((values, solution.values))[:, order]
        reverse = passing(self.problem.equations, path, both[order], self.reference(both[order]))
        if reverse is not None:
            raise reverse
        return solution

    def _expanded(self, new: Array, times: Array, values: Array) -> Solution:
        guess = np.array([np.interp(new, times, row) for row in values])
        taylor = taylor_of(self.reference, new, self.problem.order)
        return expand(self.problem, taylor, guess, follow=False, sides=self.signs)

    def margins(self, solution: Solution) -> Array:
        """What must keep above zero, shape (blocks + spans, N)."""
        n = len(self.problem.equations.names)
        lengths = self._lengths[:, :n] @ solution.values[:n] + self._lengths[:, n:]
        shares = [self.signs[block] * share for block, share in solution.determinants.items()]
        return np.vstack((*shares, lengths))

    def turns(self, times: Array, solution: Solution) -> Array:
        """Where trolleys turn back between samples (N,), shape (M,)."""
        found = []
        for trolley in self.problem.rig.trolleys:
            speed = solution.series[self.problem.equations.names.index(trolley.coordinate)][1]
            before = np.flatnonzero(speed[1:] * speed[:-1] < 0.0)
            share = speed[before] / (speed[before] - speed[before + 1])
            found.append(times[before] + share * (times[before + 1] - times[before]))
        return np.unique(np.concatenate(found)) if found else np.zeros(0)


def _deciding(problem: Problem) -> list[int]:
    """Multipliers of spans and links that stand in the matrix of a block.

    A pulley without mass may hang straight for an instant, where its own block has no solution but
    a limit (Y 6.1.1).
    """
    equations = problem.equations
    first = len(equations.names)
    pulls = {first + row for row in equations.with_role("span", "link")}
    steps = (step for step in problem.steps if not step.loose)
    slopes = [slope for step in steps for row in step.slopes for slope in row]
    return sorted(pulls & {j for slope in slopes for _, j in slope.terms})


def _middles(times: Array, intervals: Mask, narrowest: float) -> Array:
    """Middles of some of the intervals (N - 1,), but of those that are narrow enough."""
    wide = np.diff(times) > narrowest * times[-1]
    return np.asarray(0.5 * (times[1:] + times[:-1])[intervals & wide])


def _changed(pulls: Array) -> Mask:
    """Intervals (N - 1,) in which a tension (K, N) changes its sign."""
    return np.asarray((pulls[:, 1:] * pulls[:, :-1] < 0.0).any(axis=0))


def _suspected(times: Array, margins: Array) -> Mask:
    """Intervals (N - 1,) in which one of the margins (K, N) may come to zero."""
    steps = np.diff(times)
    slopes = np.abs(np.diff(margins, axis=1)) / steps
    steepest = np.maximum(slopes, np.pad(slopes[:, 1:], ((0, 0), (0, 1))))
    steepest = np.maximum(steepest, np.pad(slopes[:, :-1], ((0, 0), (1, 0))))
    reached = margins[:, 1:] + margins[:, :-1] < STEEPER * steepest * steps
    return np.asarray(reached.any(axis=0))
