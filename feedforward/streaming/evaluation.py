"""Everything about a rig at many instants of several courses, as fast as it can be had.

The rig's own program does it, see `solving.programs`.  A rig without one, and one with a pulley
without mass, which may hang straight where the program has no answer, is expanded step by step.
"""

from typing import NamedTuple

import numpy as np

from ...models.types import Array, Mask
from ..exact.branch import turning_angles
from ..exact.losses import losses_of
from ..exact.naming import named_motion, platform_angles
from ..exact.problem import Problem
from ..exact.pulleys import has_light_pulley
from ..exact.taylor import SINGULAR, Solution, expand
from ..solving.programs import Compiled, compiled

SINGLE = 2
"""Up to so many samples plain numbers are faster than arrays."""


class Evaluated(NamedTuple):
    """A rig at N samples."""

    rows: tuple[Array, ...]
    """Positions, velocities and accelerations of the coordinates, multipliers, inputs and tensions,
    as a `Motion` has them but transposed."""
    near: Array
    """Guesses for samples close by, shape (unknowns + turning frames, N)."""
    solved: Mask
    """Where there is a solution on the branch, shape (N,)."""

    @property
    def positions(self) -> Array:
        """Shape (coordinates, N)."""
        return self.rows[0]

    @property
    def inputs(self) -> Array:
        """Shape (inputs, N)."""
        return self.rows[4]

    @property
    def tensions(self) -> Array:
        """Shape (ropes, N)."""
        return self.rows[5]


class Evaluator:
    """Evaluates one rig on one branch."""

    def __init__(self, problem: Problem, signs: dict[int, float]) -> None:
        self.problem, self.signs = problem, signs
        found = None if has_light_pulley(problem) else compiled(problem)
        self._places: list[int] = []
        if found is not None:
            places = [_place(problem, found, j) for j in found.program.newton]
            self._places = [place for place in places if place is not None]
            if len(self._places) < len(places):
                found = None
        self._found = found
        if found is not None:
            self._sides = [signs.get(block, 1.0) for block in found.program.blocks]
            count = len(problem.analysis.unknowns)
            turning = range(count, count + len(found.program.angles))
            self._given = [*found.program.newton, *turning]

    def __call__(self, taylor: Array, near: Array) -> Evaluated:
        """The rig at Taylor coefficients (orders, N, outputs), with guesses as in `Evaluated`."""
        if self._found is None:
            return self.interpreted(taylor, near)
        return self._programmed(self._found, taylor, near)

    def near(self, unknowns: Array, angles: dict[str, Array]) -> Array:
        """Guesses from unknowns (unknowns, N) and continuous angles (N,)."""
        return np.vstack((unknowns, *angles.values()))

    def interpreted(self, taylor: Array, near: Array, *, follow: bool = False) -> Evaluated:
        """The same, step by step of the expansion; guesses of the first sample if `follow`."""
        return self.named(taylor, self.expanded(taylor, near, follow=follow), near)

    def expanded(self, taylor: Array, near: Array, *, follow: bool = False) -> Solution:
        """The expansion from guesses."""
        guess = near[: len(self.problem.analysis.unknowns)]
        return expand(self.problem, taylor, guess, follow=follow, sides=self.signs)

    def named(self, taylor: Array, solution: Solution, near: Array) -> Evaluated:
        """What an expansion says, with angles near a guess of the first sample."""
        equations = self.problem.equations
        n, m = len(equations.names), len(equations.constraint_names)
        values, solved = solution.values, solution.solved
        for block, sign in solution.signs.items():
            solved = solved & (sign == self.signs[block])
        names = [name for name, _, _ in equations.turning]
        first = near[len(values) :, 0].tolist()
        with np.errstate(invalid="ignore"):
            angles = turning_angles(equations, values, dict(zip(names, first, strict=True)))
            state = np.array([[w[0], w[1], 2.0 * w[2]] for w in solution.series[:n]])
            platforms = platform_angles(equations, state, taylor)
            forces, times = values[n:].T, np.arange(float(values.shape[1]))
            last = m + len(equations.rig.drives)
            motion = named_motion(
                equations, times, state, angles, platforms, forces[:, :m], forces[:, m:last]
            )
        rows = (
            motion.positions.T, motion.velocities.T, motion.accelerations.T,
            motion.multipliers.T, motion.inputs.T, motion.tensions.T,
        )  # fmt: skip
        return Evaluated(rows, self.near(values, angles), solved)

    def _programmed(self, found: Compiled, taylor: Array, near: Array) -> Evaluated:
        samples = taylor.shape[1]
        guesses = near[self._given]
        good = np.ones(samples, dtype=bool)
        result = np.full((found.size, samples), np.nan)
        if samples <= SINGLE:
            reference = taylor.transpose(1, 0, 2).reshape(samples, -1).tolist()
            for i in range(samples):
                try:
                    answer = found.scalar(reference[i], guesses[:, i].tolist(), self._sides)
                except (ValueError, ZeroDivisionError, OverflowError):
                    continue
                if answer is not None:
                    result[:, i] = answer[0]
        else:
            columns = np.ascontiguousarray(taylor.transpose(0, 2, 1)).reshape(-1, samples)
            with np.errstate(all="ignore"):  # what fails is found by its value
                answer = found.arrays(columns, list(guesses), self._sides, good)
                for row, value in zip(result, answer, strict=True):
                    row[:] = value
        good &= np.isfinite(result.sum(axis=0))
        for determinant in np.abs(result[found.size - len(found.program.determinants) :]):
            good &= determinant > SINGULAR * determinant.max(where=good, initial=0.0)
        ahead = np.zeros((len(near), samples))
        unknowns = len(self.problem.analysis.unknowns)
        for j, place in zip(found.program.newton, self._places, strict=True):
            ahead[j] = result[place] if place >= 0 else self._component(result, j)
        ahead[unknowns:] = result[list(found.program.angles)]
        return Evaluated(tuple(found.parts(result)), ahead, good)

    def _component(self, result: Array, unknown: int) -> Array:
        """The cosine or sine of a turning frame."""
        assert self._found is not None
        for (_, cos, sin), column in zip(
            self.problem.equations.turning, self._found.program.angles, strict=True
        ):
            if unknown == cos:
                return np.asarray(np.cos(result[column]))
            if unknown == sin:
                return np.asarray(np.sin(result[column]))
        raise AssertionError(f"unknown {unknown} is no frame's")


def _place(problem: Problem, found: Compiled, unknown: int) -> int | None:
    """Row of an unknown among a program's results; -1 of a turning frame's, None if it has none."""
    equations, names = problem.equations, found.program.names
    n, k = len(equations.names), len(names)
    multipliers = n + len(equations.constraint_names)
    inputs = multipliers + len(problem.rig.drives)
    if unknown >= inputs or (unknown >= multipliers and losses_of(problem.rig) is not None):
        return None  # no result, or one that has the losses, too
    if unknown >= n:  # multipliers and inputs stand one after the other here as there
        return 3 * k + unknown - n
    if any(unknown in (cos, sin) for _, cos, sin in equations.turning):
        return -1
    name = equations.names[unknown]
    return names.index(name) if name in names else None
