"""A rig's own program, compiled once, and its results along a branch.

For a few samples the program runs on plain numbers, sample by sample; for many on arrays, in pieces
that stay in the processor's cache.  Where it has no solution to offer, as past a singular place or
at a pulley without mass that hangs straight, the caller asks `exact.taylor`, which knows why.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from types import CodeType
from typing import Any

import numpy as np

from ...models.rig.frames import UPRIGHT
from ...models.rig.open_tensions import TENSION
from ...models.rig.rig import WORLD, Frame
from ...models.types import Array, Mask
from ..exact.branch import Branch
from ..exact.home import home_outputs, home_unknowns
from ..exact.problem import Problem
from ..exact.taylor import SINGULAR, expand
from ..generated.elimination import Singular
from ..generated.generator import generate
from ..generated.program import Program
from ..generated.python_source import Dialect, python_source, rows
from ..series.products import factorials

FEW = 24
"""Up to so many samples plain numbers are faster than arrays."""
PIECE = 4096
"""Samples treated at once."""
SAMPLES = 48
"""Places about a rig's home from which the order of pivots is chosen."""
ABOUT = 0.1
"""How far from home these are, over the size of its outputs, or in rad."""
PUSH = 0.5
"""Accelerations there [m/s2] or [rad/s2]."""
RESTING = 8
"""So many of the places are looked at in rest, too."""

Step = Callable[..., Any]


@dataclass(frozen=True, eq=False)
class Compiled:
    """The program of one rig as functions; each is made when it is first used."""

    program: Program

    def __reduce__(self) -> tuple[Any, ...]:
        """Functions that were made here are made anew elsewhere."""
        return Compiled, (self.program,)

    def __deepcopy__(self, memo: object) -> "Compiled":
        return self

    @cached_property
    def scalar(self) -> Step:
        """For one sample."""
        return _function(self.program, "scalar")

    @cached_property
    def arrays(self) -> Step:
        """For many samples."""
        return _function(self.program, "numpy")

    @cached_property
    def stepping(self) -> Step:
        """For one sample, with the ropes' spans."""
        return _function(self.program, "stepping")

    @cached_property
    def size(self) -> int:
        """Number of results."""
        return len(rows(self.program))

    @cached_property
    def _slices(self) -> tuple[slice, ...]:
        program = self.program
        sizes = [len(values) for values in program.kinematics]
        sizes += [len(program.multipliers), len(program.inputs), len(program.tensions)]
        ends = np.cumsum(sizes).tolist()
        return tuple(slice(end - size, end) for size, end in zip(sizes, ends, strict=True))

    def parts(self, result: Array) -> list[Array]:
        """Positions, velocities, accelerations, multipliers, inputs and tensions in a result."""
        return [result[part] for part in self._slices]


def _function(program: Program, dialect: Dialect) -> Step:
    code: CodeType = compile(python_source(program, dialect), f"<{dialect} program>", "exec")
    space: dict[str, Any] = {}
    exec(code, space)
    return space["step"]  # type: ignore[no-any-return]


@lru_cache(maxsize=256)
def compiled(problem: Problem) -> Compiled | None:
    """The program of a flat rig; none of one whose equations are singular everywhere."""
    try:
        return Compiled(generate(problem, samples_about(problem)))
    except Singular:
        return None


def samples_about(problem: Problem) -> list[list[Array]]:
    """Values of the unknowns at places about home, each as a series of one coefficient.

    Every path begins and ends in rest, where ropes hang straight: what vanishes there, such as how
    far a load is to the side of what it hangs from, is no pivot, however large it is in motion.
    """
    outputs = home_outputs(problem.equations)
    random = np.random.default_rng(0)
    taylor = np.zeros((problem.order + 1, SAMPLES, len(outputs)))
    places = [not name.endswith(TENSION) for name in problem.rig.outputs]
    size = max(1.0, float(np.abs(outputs[places]).max(initial=0.0)))
    scales = dict.fromkeys(problem.rig.angles, 1.0)
    scales |= {name + TENSION: problem.rig.weight for name in problem.rig.tension_names}
    scale = [scales.get(name, size) for name in problem.rig.outputs]
    taylor[0] = outputs + ABOUT * random.uniform(-1.0, 1.0, taylor[0].shape) * scale
    taylor[2] = PUSH * random.uniform(-1.0, 1.0, taylor[0].shape)
    values, good = _unknowns(problem, taylor)
    moving = values[:, good] if good.any() else np.nan_to_num(values)
    taylor[2] = 0.0
    values, good = _unknowns(problem, taylor[:, :RESTING])
    seen = [_turned(problem, part, random) for part in (moving, values[:, good])]
    return [[row] for row in np.hstack(seen)]


def _unknowns(problem: Problem, taylor: Array) -> tuple[Array, Mask]:
    """Unknowns (unknowns, N) for a reference's coefficients, and where they have values."""
    solution = expand(problem, taylor, home_unknowns(problem.equations), follow=False)
    return solution.values, solution.solved


def _turned(problem: Problem, values: Array, random: np.random.Generator) -> Array:
    """Unknowns (unknowns, N) with frames, points and directors turned about the vertical.

    What a frame that turns about it carries is seen from all sides in this way, wherever home is.
    """
    equations = problem.equations
    upright = [f.coordinate for f in problem.rig.frames if f.kind == "turning" and _upright(f)]
    if not upright:
        return values
    angles = random.permutation(np.linspace(0.0, 2.0 * np.pi, values.shape[1], endpoint=False))
    pairs = [(cos, sin) for name, cos, sin in equations.turning if name in upright]
    names = equations.names
    pairs += [
        (i, names.index(f"{name[:-1]}y"))
        for i, name in enumerate(names)
        if name.endswith("x") and f"{name[:-1]}y" in names
    ]
    turned = values.copy()
    for x, y in pairs:
        turned[x] = np.cos(angles) * values[x] - np.sin(angles) * values[y]
        turned[y] = np.sin(angles) * values[x] + np.cos(angles) * values[y]
    return turned


def _upright(frame: Frame) -> bool:
    """Whether it turns about the vertical, and with it all that it carries."""
    return frame.parent == WORLD and frame.axis == UPRIGHT


def evaluate(
    found: Compiled, branch: Branch, times: Array, derivatives: Array
) -> tuple[Array, Mask]:
    """Results of a program along a branch.

    Parameters
    ----------
    found
        Of the branch's rig.
    branch
        It picks among solutions and says where they are near.
    times
        Instants [s], shape (N,).
    derivatives
        Of the reference, shape (orders, N, outputs).

    Returns
    -------
    tuple[Array, Mask]
        Results (rows, N), and at which of the samples (N,) they are good.
    """
    program = found.program
    sides = [branch.signs.get(block, 1.0) for block in program.blocks]
    # Taylor coefficients, row by row in memory.
    taylor = np.empty((len(derivatives), derivatives.shape[2], len(times)))
    scale = factorials(len(derivatives))[:, None, None]
    np.divide(derivatives.transpose(0, 2, 1), scale, out=taylor)
    if not len(times):
        return np.zeros((found.size, 0)), np.ones(0, dtype=bool)
    if len(times) <= FEW:
        result, good = _one_by_one(found, branch, times, taylor, sides)
    else:
        result, good = _in_pieces(found, branch, times, taylor, sides)
    if len(times) > 1:
        for determinants in result[found.size - len(program.determinants) :]:
            sizes = np.abs(determinants)
            good &= sizes > SINGULAR * sizes.max(where=good, initial=0.0)
    return result, good


def _one_by_one(
    found: Compiled, branch: Branch, times: Array, taylor: Array, sides: Sequence[float]
) -> tuple[Array, Mask]:
    result = np.zeros((len(times), found.size))
    good = np.zeros(len(times), dtype=bool)
    reference = taylor.reshape(-1, len(times)).T.tolist()
    for i, time in enumerate(times.tolist()):
        try:
            answer = found.scalar(reference[i], guesses_at(found.program, branch, time), sides)
        except (ValueError, ZeroDivisionError, OverflowError):
            continue  # the root of a negative number, and the like
        if answer is not None and math.isfinite(sum(answer[0])):
            result[i] = answer[0]
            good[i] = True
    return result.T, good


def guesses_at(program: Program, branch: Branch, time: float) -> list[float]:
    """Guesses at one sample, see `Branch.near` and `Branch.turned`."""
    if not program.newton and not program.angles:
        return []
    last, step = len(branch.times) - 1, float(branch.times[1])
    place = min(max(time / step, 0.0), float(last))
    below = min(int(place), last - 1)
    share = place - below
    bend = share * (1.0 - share)
    guesses = []
    for left, right, leaving, arriving in branch.ends(below, program.newton):
        drop = left - right
        start, end = step * leaving + drop, step * arriving + drop
        guesses.append(left - share * drop + bend * ((1.0 - share) * start - share * end))
    for angle in branch.angles.values():
        left, right = angle[below : below + 2].tolist()
        guesses.append(left + share * (right - left))
    return guesses


def _in_pieces(
    found: Compiled, branch: Branch, times: Array, taylor: Array, sides: Sequence[float]
) -> tuple[Array, Mask]:
    program = found.program
    result, good = np.empty((found.size, len(times))), np.ones(len(times), dtype=bool)
    reference = taylor.reshape(-1, len(times))
    guesses = list(branch.turned(times).values())
    if program.newton:
        guesses = [*branch.near(times, program.newton), *guesses]
    with np.errstate(all="ignore"):  # what fails is found by its value
        for first in range(0, len(times), PIECE):
            piece = slice(first, first + PIECE)
            starts = [values[piece] for values in guesses]
            answer = found.arrays(reference[:, piece], starts, sides, good[piece])
            for row, values in zip(result, answer, strict=True):
                row[piece] = values
        good &= np.isfinite(result.sum(axis=0))
    return result, good
