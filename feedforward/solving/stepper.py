"""Exact feedforward one sample after another, for what runs in real time.

    stepper = Stepper(rig, motion.at(0.0))
    step = stepper.step(reference.derivatives([t], stepper.order)[:, 0], h=1e-3)
    step.inputs, step.tensions, step.positions

A step starts from the one before: from its unknowns follow guesses for Newton's method, and what
one instant cannot show is kept, such as how far a frame has turned, and which way the ropes ran.
"""

import ctypes
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import PathError, RigError
from ...models.rig.rig import Rig
from ...models.types import Array
from ...models.values import as_number, reals, shown
from ..checks import every
from ..exact.branch import branch_of
from ..exact.naming import motion_of
from ..exact.problem import Problem, problem_of
from ..exact.state import State
from ..exact.taylor import SINGULAR, expand
from ..generated.c_words import Words
from ..generated.statuses import MESSAGES, RAIL_TOLERANCE, SLACK, TURNED, Status
from ..paths.straight import hold
from ..series.products import factorials
from .compiling import Library
from .inverse import rows_of
from .programs import compiled
from .source import program_of, start_of, words_of

Numbers = list[float]


class Step(NamedTuple):
    """Everything about a rig at one instant, in SI units, see `Motion`."""

    inputs: Array
    """[N] or [N m], shape (inputs,)."""
    tensions: Array
    """[N], shape (ropes,)."""
    positions: Array
    """Coordinates [m] or [rad], shape (coordinates,)."""
    velocities: Array
    """Their first derivatives, of that shape."""
    accelerations: Array
    """Their second derivatives, of that shape."""
    slack: bool
    """Whether a rope would have to push."""


class Stepper:
    """A rig's inverse dynamics, sample by sample.

    Parameters
    ----------
    rig
        A flat rig.
    start
        Where it starts: a state of a motion, as `Motion.at` gives it, or outputs at which it rests,
        shape (outputs,).
    in_c
        Whether its C file is compiled for it, which takes a second at the first time, and needs a
        compiler.

    Raises
    ------
    RigError
        The rig is not flat, or the state is another rig's.
    PathError
        It cannot rest there.
    OptionError
        There is no C compiler, or it fails.
    """

    def __init__(self, rig: Rig, start: State | ArrayLike, *, in_c: bool = False) -> None:
        self.rig = rig
        program, problem = program_of(rig), problem_of(rig)
        if not isinstance(start, State):
            start = branch_of(problem, hold(reals("start", start, error=PathError))).at(0.0)
        elif start.problem.rig != rig:
            raise RigError(
                f"start is a state of rig {start.problem.rig.name}, not of this {rig.name}"
            )
        self.order = problem.order
        """Derivatives of the reference that a step takes."""
        self.coordinate_names = program.names
        """Columns of the coordinates, as of `Motion`."""
        self._shape = self.order + 1, len(rig.outputs)
        words = words_of(rig, program)
        kind = _InC if in_c else _InPython
        self._kernel: _InC | _InPython = kind(problem, start, words)

    def step(self, derivatives: ArrayLike, h: float) -> Step:
        """One sample.

        Parameters
        ----------
        derivatives
            The reference and its derivatives, shape (order + 1, outputs).
        h
            Time since the sample before [s], 0 for the first one.

        Returns
        -------
        Step
            What follows from it; ropes that would have to push are said, not refused.

        Raises
        ------
        PathError
            The rig cannot be there, or not on this branch, or not so soon; the next sample still
            follows the one before.
        """
        values = reals("derivatives", derivatives, error=PathError)
        if values.shape != self._shape:
            raise PathError(f"derivatives have shape {values.shape}, they must have {self._shape}")
        gap = as_number(h)
        if not (every(np.isfinite(values)) and 0.0 <= gap < math.inf):
            raise PathError(
                f"derivatives are {shown(values.tolist())} and h is {h}; they must be finite, and "
                "h >= 0"
            )
        status, step = self._kernel.step(values, gap)
        if status > Status.SLACK:
            if not np.isfinite(values).all() or not math.isfinite(as_number(h)):
                raise PathError(
                    f"derivatives are {shown(values.tolist())} and h is {h}, they must be finite"
                )
            places = zip(self.rig.outputs, values[0].tolist(), strict=True)
            where = ", ".join(f"{name} = {value:.4g}" for name, value in places)
            raise PathError(f"rig {self.rig.name} cannot go on at {where}: {MESSAGES[status]}")
        assert step is not None
        return step


class Answer(NamedTuple):
    """What a sample gives, and what the next one needs of it."""

    row: Array
    """Results as of `python_source.rows`."""
    carried: list[tuple[float, ...]]
    """Taylor coefficients of Newton's unknowns."""
    spans: list[Numbers]
    """Length and vector of each."""


class _InPython:
    """Steps by the rig's program in Python, and where it has no answer by the expansion."""

    def __init__(self, problem: Problem, start: State, words: Words) -> None:
        found = compiled(problem)
        assert found is not None
        self.problem, self.found = problem, found
        self.rails, self.rope_ends = words.rails, words.rope_ends
        program = found.program
        begin = start_of(program, start)
        self.signs, self.sides = start.signs, list(begin.sides)
        self.carried: list[tuple[float, ...]] = [(value, 0.0, 0.0) for value in begin.newton]
        self.angles = list(begin.angles)
        self.largest = [0.0] * len(program.determinants)
        self.spans: list[Numbers] | None = None
        self.scales = (1.0 / factorials(problem.order + 1))[:, None]

    def step(self, derivatives: Array, h: float) -> tuple[Status, Step | None]:
        """One sample: what became of it, and the results if it is a good one."""
        taylor = derivatives * self.scales
        guesses = [a + h * (b + h * c) for a, b, c in self.carried]
        answer = self._by_program(taylor, guesses) or self._by_expansion(taylor, guesses)
        if isinstance(answer, Status):
            return answer, None
        row, carried, spans = answer
        program = self.found.program
        largest = self.largest
        if program.determinants:
            sizes = [
                abs(value)
                for value in row[self.found.size - len(self.largest) : self.found.size].tolist()
            ]
            largest = [max(pair) for pair in zip(sizes, largest, strict=True)]
            if not all(s > SINGULAR * m for s, m in zip(sizes, largest, strict=True)):
                return Status.SINGULAR, None
        positions, velocities, accelerations, _, inputs, tensions = self.found.parts(row)
        for column, first, last in self.rails:
            if not first - RAIL_TOLERANCE <= positions[column] <= last + RAIL_TOLERANCE:
                return Status.OFF_RAIL, None
        for terms, low, high in self.rope_ends:
            length = sum(factor * positions[column] for factor, column in terms)
            if not low - RAIL_TOLERANCE <= length <= high + RAIL_TOLERANCE:
                return Status.ROPE_END, None
        angles = [float(positions[column]) for column in program.angles]
        if self.spans is not None and any(
            not abs(a - b) < TURNED for a, b in zip(angles, self.angles, strict=True)
        ):
            return Status.TURNED, None
        if not _kept_on(spans, self.spans):
            return Status.REVERSED, None
        self.carried, self.angles, self.spans, self.largest = carried, angles, spans, largest
        pulls = tensions[list(self.problem.rig.pulling)].tolist()
        slack = min(pulls, default=0.0) < -SLACK * max(map(abs, pulls), default=0.0)
        step = Step(inputs, tensions, positions, velocities, accelerations, slack)
        return Status.SLACK if slack else Status.OK, step

    def _by_program(self, taylor: Array, guesses: Numbers) -> Answer | None:
        try:
            answer = self.found.stepping(
                taylor.ravel().tolist(), [*guesses, *self.angles], self.sides
            )
        except (ValueError, ZeroDivisionError, OverflowError):
            return None
        if answer is None or not math.isfinite(sum(answer[0])):
            return None
        row, flat, spans = answer
        carried: list[tuple[float, ...]] = [*zip(flat[::3], flat[1::3], flat[2::3], strict=True)]
        return Answer(np.array(row), carried, [list(span) for span in spans])

    def _by_expansion(self, taylor: Array, guesses: Numbers) -> Answer | Status:
        """The same step by step, which knows weak pivots and pulleys without mass."""
        problem, program = self.problem, self.found.program
        equations = problem.equations
        guess = np.zeros((len(problem.analysis.unknowns), 1))
        guess[list(program.newton), 0] = guesses
        solution = expand(problem, taylor[:, None], guess, follow=False, sides=self.signs)
        if any(sign[0] != self.signs.get(b, sign[0]) for b, sign in solution.signs.items()):
            return Status.SINGULAR
        if not solution.solved.all():
            return Status.LOST
        names = (name for name, _, _ in equations.turning)
        angles = {name: np.array([angle]) for name, angle in zip(names, self.angles, strict=True)}
        motion = motion_of(problem, solution, np.zeros(1), taylor[:, None], angles)
        row = np.concatenate((rows_of(motion)[:, 0], np.ones(len(program.determinants))))
        series = [[float(c[0]) for c in known] for known in solution.series]
        carried = [tuple([*series[j], 0.0, 0.0][:3]) for j in program.newton]
        state = np.append(solution.values[: len(equations.names), 0], 1.0)
        spans = []
        for rope, lengths in zip(equations.rig.ropes, equations.span_lengths, strict=True):
            for k, (before, after) in enumerate(zip(rope.path, rope.path[1:], strict=False)):
                rows = equations.points[after] - equations.points[before]
                vector = [float(r @ state) for r in rows if r.any()]
                spans.append([float(lengths[k] @ state), *vector])
        return Answer(row, carried, spans)


def _kept_on(spans: list[Numbers], before: list[Numbers] | None) -> bool:
    """Whether no span is shorter than nothing or runs against where it ran."""
    if any(not length >= 0.0 for length, *_ in spans):
        return False
    return before is None or all(
        sum(a * b for a, b in zip(new[1:], old[1:], strict=True)) >= 0.0
        for new, old in zip(spans, before, strict=True)
    )


class _InC:
    """Steps by the rig's file in C."""

    def __init__(self, problem: Problem, start: State, words: Words) -> None:
        program = program_of(problem.rig)
        self.library = Library(program, words, start_of(program, start))
        pointer = ctypes.c_void_p
        self._step = self.library.function("step", pointer, pointer, ctypes.c_double, pointer)
        self.derivatives = np.zeros((problem.order + 1, len(problem.rig.outputs)))
        self.addresses = (
            ctypes.addressof(self.library.state),
            self.derivatives.ctypes.data,
            ctypes.addressof(self.library.motion),
        )
        members = ("input", "tension", "position", "velocity", "acceleration")
        motion = self.library.motion
        self.views = [np.ctypeslib.as_array(getattr(motion, member)) for member in members]

    def step(self, derivatives: Array, h: float) -> tuple[Status, Step | None]:
        """One sample: what became of it, and the results if it is a good one."""
        self.derivatives[...] = derivatives
        state, reference, motion = self.addresses
        status = Status(self._step(state, reference, h, motion))
        if status > Status.SLACK:
            return status, None
        results = [view.copy() for view in self.views]
        inputs, tensions, positions, velocities, accelerations = results
        slack = status == Status.SLACK
        return status, Step(inputs, tensions, positions, velocities, accelerations, slack)
