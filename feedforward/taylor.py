"""Taylor coefficients of every unknown along a prescribed path, stage by stage.

Stage k = -max(d), ..., 0 determines the coefficient of order k + d_j of every unknown w_j
from the coefficient of order k + c_i of every equation, block after block.  All equations
are polynomials of degree two, so only the stage in which an unknown itself appears is
nonlinear; there a scalar block is a quadratic, and a larger one is solved by Newton's method.
All samples are treated at once.

Which root of the quadratic, or which solution, is a matter of continuity from the start of
the path.  A block's determinant keeps its sign along a path that the rig can follow, so that
sign picks the root, and a change of it marks a place that the rig cannot pass.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .linear import solve_many
from .steps import Array, Series, Step
from .structure import Row

Flags = NDArray[np.bool_]

NEWTON_ITERATIONS = 25
NEWTON_TOLERANCE = 1e-13
"""Newton's method ends when a step is below this fraction of the unknowns' size."""
SINGULAR = 1e-11
"""A determinant below this fraction of its largest possible value counts as zero."""
SAME = 1e-6
"""Solutions closer than this fraction of their size are the same one."""

Solved = tuple[Array, Array | None, Flags]
"""A step's determinants (N,), its matrices (k, k, N) unless scalar, and where it failed (N,)."""


@dataclass
class Solution:
    """Taylor coefficients of all unknowns at N samples of a path."""

    series: Series
    signs: dict[int, Array]
    """Per block the determinant's sign at each sample, 0 where it is singular, shape (N,)."""
    failed: Flags
    """True where some block has no solution, shape (N,)."""
    culprit: dict[int, Flags]
    """Per block where it is the reason, shape (N,)."""


def expand(
    steps: Sequence[Step],
    unknowns: int,
    reference: Array,
    guess: Array,
    *,
    follow: bool,
) -> Solution:
    """Taylor coefficients of all unknowns at N samples.

    Args:
        steps: from `plan`.
        unknowns: number of unknowns.
        reference: Taylor coefficients of the outputs, shape (orders, N, outputs).
        guess: of the unknowns themselves at each sample, shape (unknowns, N); at the first
            sample alone, shape (unknowns, 1), if `follow`.
        follow: whether each sample continues the one before it, so that nonlinear blocks are
            solved by continuation from the first.
    """
    samples = reference.shape[1]
    series: Series = [[] for _ in range(unknowns)]
    solution = Solution(series, {}, np.zeros(samples, bool), {})
    with np.errstate(all="ignore"):  # what fails is found by its value
        for step in steps:
            for j, _ in step.columns:
                series[j].append(np.zeros(samples))
            scalar = len(step.rows) == 1
            if scalar and not step.nonlinear:
                determinant, matrix, bad = _scalar(step, series, reference)
            elif not step.nonlinear:
                determinant, matrix, bad = _linear(step, series, reference)
            elif scalar:
                determinant, matrix, bad = _quadratic(step, series, reference, guess)
            elif follow:
                determinant, matrix, bad = _continuation(step, series, reference, guess)
            else:
                determinant, matrix, bad = _newton(step, series, reference, guess)
            if step.block not in solution.signs:
                solution.signs[step.block] = _sign(determinant, matrix)
            if bad.any():
                solution.culprit.setdefault(step.block, bad & ~solution.failed)
                solution.failed |= bad
    return solution


def residual(row: Row, order: int, series: Series, reference: Array) -> Array:
    """The coefficient of the given order of one equation, shape (N,)."""
    total = np.full(reference.shape[1], row.constant if order == 0 else 0.0)
    for a, j in row.linear:
        total += a * series[j][order]
    for a, j in row.second:
        total += (a * (order + 1) * (order + 2)) * series[j][order + 2]
    for a, j, k in row.quadratic:
        left, right = series[j], series[k]
        product = left[0] * right[order]
        for i in range(1, order + 1):
            product += left[i] * right[order - i]
        total += product if a == 1.0 else a * product
    if row.output is not None:
        total -= reference[order, :, row.output]
    return total


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

    A matrix (k, k, N) is measured by the product of its rows' sizes; a scalar, which has no
    size of its own, by its largest value along the path.
    """
    if matrix is None:
        finite = np.abs(determinant[np.isfinite(determinant)])
        bound = finite.max(initial=0.0)
    else:
        bound = np.prod(np.abs(matrix).max(axis=1), axis=0)
    regular = np.isfinite(determinant) & (np.abs(determinant) > SINGULAR * bound)
    return np.where(regular, np.sign(determinant), 0.0)


def _linear(step: Step, series: Series, reference: Array) -> Solved:
    matrix = _jacobian(step, series)
    values, determinant = solve_many(matrix.copy(), -_residuals(step, series, reference))
    for (j, order), value in zip(step.columns, values, strict=True):
        series[j][order] = value
    return determinant, matrix, ~np.isfinite(values).all(axis=0)


def _scalar(step: Step, series: Series, reference: Array) -> Solved:
    ((row, order),), ((j, highest),) = step.rows, step.columns
    slope = np.asarray(step.slopes[0][0].at(series))
    value = residual(row, order, series, reference) / -slope
    series[j][highest] = value
    return slope + np.zeros_like(value), None, ~np.isfinite(value)


def _quadratic(step: Step, series: Series, reference: Array, guess: Array) -> Solved:
    """Solve a w^2 + b w + c = 0 for the root on the guess's side of the vertex."""
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
    determinant = side * np.sqrt(b * b - 4.0 * a * c)
    # Of the two forms of the root the one without cancellation.
    value = np.where(side * b > 0, -2.0 * c / (b + determinant), (determinant - b) / (2.0 * a))
    linear = a == 0
    if linear.any():
        value = np.where(linear, -c / b, value)
    series[j][order] = value
    return determinant, None, ~np.isfinite(value)


def _newton(
    step: Step, series: Series, reference: Array, guess: Array, window: slice = slice(None)
) -> Solved:
    """Newton's method from a guess, at the samples of a window."""
    local = [[values[window] for values in known] for known in series]
    part = reference[:, window]
    samples = part.shape[1]
    start = np.broadcast_to(guess, (len(guess), samples))
    for j, order in step.columns:
        if order == 0:
            local[j][0] = start[j].copy()
    for _ in range(NEWTON_ITERATIONS):
        matrix = _jacobian(step, local)
        change, determinant = solve_many(matrix.copy(), -_residuals(step, local, part))
        size = np.zeros(samples)
        for (j, order), delta in zip(step.columns, change, strict=True):
            local[j][order] = local[j][order] + delta
            size = np.maximum(size, np.abs(local[j][order]))
        done = np.abs(change).max(axis=0) <= NEWTON_TOLERANCE * size
        if done.all():
            break
    for j, order in step.columns:
        series[j][order][window] = local[j][order]
    return determinant, matrix, ~done


def _continuation(step: Step, series: Series, reference: Array, guess: Array) -> Solved:
    """Newton's method along the samples, each solution continuing the one before it.

    A first try starts every sample from the first one's solution.  A sample continues its
    predecessor if Newton's method started there ends at the same solution; from the first
    that does not, the rest is solved anew.
    """
    samples, size = reference.shape[1], len(step.rows)
    determinant, matrix = np.zeros(samples), np.zeros((size, size, samples))
    bad = np.ones(samples, bool)
    front, start = 0, guess
    while front < samples:
        window = slice(front, samples)
        determinant[window], matrix[..., window], bad[window] = _newton(
            step, series, reference, start, window
        )
        if bad[front]:
            break
        found = np.array([series[j][order] for j, order in step.columns])
        before = np.zeros((len(guess), samples - front))
        for (j, _), values in zip(step.columns, found, strict=True):
            before[j] = values[[front, *range(front, samples - 1)]]
        _, _, lost = _newton(step, series, reference, before, window)
        again = np.array([series[j][order] for j, order in step.columns])
        for (j, order), values in zip(step.columns, found, strict=True):
            series[j][order] = values
        distance = np.abs(again - found)[:, window].max(axis=0)
        extent = np.abs(found[:, window]).max(axis=0)
        apart = bad[window] | lost | ~(distance <= SAME * extent)
        if not apart.any():
            break
        if apart[0]:
            bad[front] = True
            break
        front += int(apart.argmax())
        start = np.zeros((len(guess), 1))
        for j, order in step.columns:
            start[j] = series[j][order][front - 1]
    return determinant, matrix, bad
