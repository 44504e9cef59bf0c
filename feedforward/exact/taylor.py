"""Taylor coefficients of every unknown along a prescribed path, stage by stage.

Stage k = -max(d), ..., 0 determines the coefficient of order k + d_j of every unknown w_j
from the coefficient of order k + c_i of every equation, block after block.  All equations
are polynomials of degree two, so only the stage in which an unknown itself appears is
nonlinear; there a scalar block is a quadratic, and a larger one is solved by Newton's method.
All samples are treated at once.

Which root of the quadratic, or which solution, is a matter of continuity from the start of
the path.  A block's determinant keeps its sign along a path that the rig can follow, so that
sign picks the root, and a change of it marks a place that the rig cannot pass.

A pulley without mass is the exception.  Where its two ropes are in line the third one is without
tension and the pulley's height along them undetermined (Y 6.1.1); the motion goes on through such
a place, and the limit is followed by steps of least norm from the guess.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...models.types import Array
from .linear import least_norm, solve_many
from .problem import Problem
from .steps import Series, Step, plan
from .structure import Row

Flags = NDArray[np.bool_]

NEWTON_ITERATIONS = 25
NEWTON_TOLERANCE = 1e-13
"""Newton's method ends when a step is below this fraction of the unknowns' size."""
SOLVED = 1e-9
"""Largest residual of a solution found by steps of least norm, over the size of its terms."""
FLOOR = 1e-3
"""An equation's terms count as no smaller than this fraction of the largest equation's."""
SINGULAR = 1e-11
"""A determinant below this fraction of its largest possible value counts as zero."""
SAME = 1e-6
"""Solutions closer than this fraction of their size are the same one."""

Solved = tuple[Array, Array | None]
"""A step's determinants (N,) or one for all, and its matrices (k, k, N) unless it is scalar."""


@dataclass
class Solution:
    """Taylor coefficients of all unknowns at N samples, not finite where there is no solution."""

    series: Series
    signs: dict[int, Array]
    """Per block the determinant's sign at each sample, 0 where it is singular, shape (N,); blocks
    that the reference gives or that place a pulley without mass have none."""
    straight: Flags
    """Where a pulley without mass hangs straight and its place is undetermined, shape (N,)."""

    @property
    def solved(self) -> Flags:
        """Where everything has a value, shape (N,)."""
        finite = np.isfinite([values for known in self.series for values in known])
        return np.asarray(finite.all(axis=0))

    @property
    def values(self) -> Array:
        """The unknowns themselves, shape (unknowns, N)."""
        return np.array([coefficients[0] for coefficients in self.series])


def expand(
    problem: Problem,
    taylor: Array,
    guess: Array,
    *,
    follow: bool,
    sides: Mapping[int, float] | None = None,
    further: int = 0,
) -> Solution:
    """Taylor coefficients of all unknowns at N samples.

    Parameters
    ----------
    problem
        Of a flat rig.
    taylor
        Taylor coefficients of the reference, shape (orders, N, outputs).
    guess
        Of the unknowns themselves at each sample, shape (unknowns, N); at the first
        sample alone, shape (unknowns, 1), if `follow`.
    follow
        Whether each sample continues the one before it, so that nonlinear blocks are
        solved by continuation from the first.
    sides
        Signs of the blocks' determinants, if they are known; without them the guess picks
        the roots of quadratics.
    further
        How many more derivatives of every unknown are wanted.
    """
    reference = problem.servo.prescribe(taylor)
    steps = plan(problem.analysis, further) if further else problem.steps
    zero = np.zeros(reference.shape[1])
    series: Series = [[] for _ in guess]
    signs: dict[int, Array] = {}
    straight = np.zeros(len(zero), dtype=bool)
    with np.errstate(all="ignore"):  # what fails is found by its value
        for step in steps:
            for j, _ in step.columns:
                series[j].append(zero)
            if step.kind == "given":
                ((row, order),), ((j, _),) = step.rows, step.columns
                series[j][order] = reference[order, :, row.output]
                continue
            side = sides.get(step.block) if sides else None
            determinant, matrix = _solve(step, series, reference, guess, follow, side)
            if step.loose:
                straight |= _sign(determinant, matrix) == 0
            elif step.block not in signs:
                sign = _sign(determinant, matrix)
                same = sign.shape == zero.shape
                signs[step.block] = sign if same else np.broadcast_to(sign, zero.shape)
    return Solution(series, signs, straight)


def _solve(
    step: Step,
    series: Series,
    reference: Array,
    guess: Array,
    follow: bool,
    side: float | None,
) -> Solved:
    """Replace the zeros that stand for a step's coefficients by their values."""
    if step.kind == "scalar":
        return _scalar(step, series, reference)
    if step.kind == "linear":
        return _linear(step, series, reference)
    if step.kind == "quadratic":
        return _quadratic(step, series, reference, guess, follow, side)
    values, determinant, matrix = (_continuation if follow else _newton)(
        step, series, reference, guess
    )
    for (j, order), value in zip(step.columns, values, strict=True):
        series[j][order] = value
    return determinant, matrix


def residual(row: Row, order: int, series: Series, reference: Array) -> Array:
    """The coefficient of the given order of one equation, shape (N,)."""
    total: Array | float = row.constant if order == 0 else 0.0
    for a, j in row.linear:
        total = total + a * series[j][order]
    for a, j in row.second:
        total = total + a * (order + 1) * (order + 2) * series[j][order + 2]
    for a, j, k in row.quadratic:
        left, right = series[j], series[k]
        product = left[0] * right[order]
        for i in range(1, order + 1):
            product += left[i] * right[order - i]
        total = total + (product if a == 1.0 else a * product)
    if row.output is not None:
        total = total - reference[order, :, row.output]
    return np.asarray(total)


def _jacobian(step: Step, series: Series) -> Array:
    """Shape (equations, unknowns, N)."""
    size, samples = len(step.rows), len(series[step.columns[0][0]][0])
    matrix = np.empty((size, size, samples))
    for i, slopes in enumerate(step.slopes):
        for j, slope in enumerate(slopes):
            matrix[i, j] = slope.at(series)
    return matrix


def _residuals(step: Step, series: Series, reference: Array) -> Array:
    return np.array([residual(row, order, series, reference) for row, order in step.rows])


def _sign(determinant: Array, matrix: Array | None) -> Array:
    """Sign of the determinants (N,) of a block, 0 where it is singular to rounding.

    A matrix (k, k, N) is measured by the product of its columns' sizes and of its rows' after
    division by them, whatever the units of unknowns and equations; a scalar, which has no size of
    its own, by its largest value along the path.
    """
    if matrix is None:
        finite = np.abs(determinant[np.isfinite(determinant)])
        bound = finite.max(initial=0.0)
    else:
        size = np.abs(matrix)
        columns = size.max(axis=0)
        bound = np.prod(columns, axis=0) * np.prod((size / columns).max(axis=1), axis=0)
    regular = np.isfinite(determinant) & (np.abs(determinant) > SINGULAR * bound)
    return np.where(regular, np.sign(determinant), 0.0)


def _linear(step: Step, series: Series, reference: Array) -> Solved:
    matrix, right = _jacobian(step, series), -_residuals(step, series, reference)
    values, determinant = solve_many(matrix.copy(), right.copy())
    if step.loose:
        values, unsolved = least_norm(matrix, right, values, determinant)
        values = np.where(unsolved, np.nan, values)
    for (j, order), value in zip(step.columns, values, strict=True):
        series[j][order] = value
    return determinant, matrix


def _scalar(step: Step, series: Series, reference: Array) -> Solved:
    ((row, order),), ((j, highest),) = step.rows, step.columns
    slope = step.slopes[0][0].at(series)
    series[j][highest] = residual(row, order, series, reference) / -slope
    return np.atleast_1d(slope), None


def _quadratic(
    step: Step,
    series: Series,
    reference: Array,
    guess: Array,
    follow: bool,
    known: float | None,
) -> Solved:
    """Solve a w^2 + b w + c = 0 for the root on the known side of the vertex, or the guess's.

    The vertex moves along a path, past the guess even; the side stays the first sample's.
    """
    ((row, order),), ((j, _),) = step.rows, step.columns
    c = residual(row, order, series, reference)
    a = np.zeros_like(c)
    b = np.zeros_like(c)
    for factor, one, other in row.quadratic:
        if one == other == j:
            a += factor
        elif j in (one, other):
            b += factor * series[other if one == j else one][0]
    for factor, one in row.linear:
        if one == j:
            b += factor
    side = np.sign(2.0 * a * guess[j] + b)
    if known is not None:
        side = np.array([known])
    elif follow:
        side = side[:1]
    determinant = side * np.sqrt(b * b - 4.0 * a * c)
    # Of the two forms of the root the one without cancellation.
    value = np.where(side * b > 0, -2.0 * c / (b + determinant), (determinant - b) / (2.0 * a))
    linear = a == 0
    if linear.any():
        value = np.where(linear, -c / b, value)
    series[j][order] = value
    return determinant, None


def _newton(
    step: Step, series: Series, reference: Array, guess: Array, window: slice = slice(None)
) -> tuple[Array, Array, Array]:
    """Newton's method from a guess, at the samples of a window.

    Returns the unknowns (k, N), NaN where the method does not converge, the determinants (N,)
    and the matrices (k, k, N).
    """
    local = [[values[window] for values in known] for known in series]
    part = reference[:, window]
    start = np.broadcast_to(guess, (len(guess), part.shape[1]))
    for j, order in step.columns:
        if order == 0:
            local[j][0] = start[j]
    for _ in range(NEWTON_ITERATIONS):
        matrix, right = _jacobian(step, local), -_residuals(step, local, part)
        change, determinant = solve_many(matrix.copy(), right.copy())
        if step.loose:
            change, _ = least_norm(matrix, right, change, determinant)
        for (j, order), delta in zip(step.columns, change, strict=True):
            local[j][order] = local[j][order] + delta
        values = np.array([local[j][order] for j, order in step.columns])
        done = np.abs(change).max(axis=0) <= NEWTON_TOLERANCE * np.abs(values).max(axis=0)
        if step.loose:  # near a singular place the last digits of a solution are undetermined
            size = (np.abs(matrix) * np.abs(values)).sum(axis=1)
            wrong = (np.abs(right) / np.maximum(size, FLOOR * size.max(axis=0))).max(axis=0)
            done = (wrong <= NEWTON_TOLERANCE) | (done & (wrong <= SOLVED))
        if done.all():
            break
    return np.where(done, values, np.nan), determinant, matrix


def _continuation(
    step: Step, series: Series, reference: Array, guess: Array
) -> tuple[Array, Array, Array]:
    """Newton's method along the samples, each solution continuing the one before it.

    A first try starts every sample from the first one's solution.  A sample continues its
    predecessor if Newton's method started there ends at the same solution; from the first
    that does not, the rest is solved anew.  Returns as `_newton`.
    """
    values, determinant, matrix = _newton(step, series, reference, guess)
    samples = values.shape[1]
    columns = [j for j, _ in step.columns]
    front = 0
    while True:
        window = slice(front, samples)
        before = np.zeros((len(guess), samples - front))
        before[columns] = values[:, [front, *range(front, samples - 1)]]
        again, *_ = _newton(step, series, reference, before, window)
        distance = np.abs(again - values[:, window]).max(axis=0)
        apart = ~(distance <= SAME * np.abs(again).max(axis=0))
        if not apart[1:].any() or apart[0]:
            return values, determinant, matrix
        front += 1 + int(apart[1:].argmax())
        start = np.zeros((len(guess), 1))
        start[columns, 0] = values[:, front - 1]
        window = slice(front, samples)
        values[:, window], determinant[window], matrix[..., window] = _newton(
            step, series, reference, start, window
        )
