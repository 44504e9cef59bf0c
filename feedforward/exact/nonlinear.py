"""Blocks that are nonlinear in their unknowns: a quadratic, or a system for Newton's method."""

import numpy as np

from ...models.types import Array
from .linear import least_norm
from .steps import Series, Step, coefficient

NEWTON_ITERATIONS = 25
"""Quadratic convergence takes a few; one that takes more started from a guess of no use."""
NEWTON_TOLERANCE = 1e-13
"""Newton's method ends when a step is below this fraction of the unknowns' size: the next one,
about its square, is lost in rounding, and the last digits of a smaller step are rounding
themselves."""
STALLED = 1e-10
"""Steps that stay below this fraction of the unknowns' size, with no end, are rounding in an
ill-conditioned block, such as that of a platform on ropes far longer than it is wide."""
SOLVED = 1e-9
"""Largest residual of a solution found by steps of least norm, over the size of its terms: where a
pulley without mass hangs straight its place is undetermined (Y 6.1.1) and steps do not vanish."""
FLOOR = 1e-3
"""An equation's terms count as no smaller than this fraction of the largest equation's: those of an
unloaded rope vanish, and rounding in them must not count as an error."""
SAME = 1e-6
"""Solutions closer than this fraction of their size are the same one; other solutions, mirror
images on the other side of a rope, lie far beyond it except next to the place where they meet."""


def solve_quadratic(
    step: Step, series: Series, reference: Array, guess: Array, follow: bool, known: float | None
) -> tuple[Array, None]:
    """Solve a w^2 + b w + c = 0 for the root on the known side of the vertex, or the guess's.

    The vertex moves along a path, past the guess even; the side stays the first sample's.
    """
    ((row, order),), ((j, _),) = step.rows, step.columns
    c = coefficient(row, order, series, reference)
    a = np.zeros_like(c)
    b = np.zeros_like(c)
    for factor, i, k in row.quadratic:
        if i == k == j:
            a += factor
        elif j in (i, k):
            b += factor * series[k if i == j else i][0]
    for factor, i in row.linear:
        if i == j:
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


def newton(
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
        matrix, right = step.jacobian(local), -step.residuals(local, part)
        change, determinant = step.solve(matrix, right)
        if step.loose:
            change, _ = least_norm(matrix, right, change, determinant)
        for (j, order), delta in zip(step.columns, change, strict=True):
            local[j][order] = local[j][order] + delta
        values = np.array([local[j][order] for j, order in step.columns])
        moved, largest = np.abs(change).max(axis=0), np.abs(values).max(axis=0)
        converged = moved <= NEWTON_TOLERANCE * largest
        if step.loose:  # near a singular place the last digits of a solution are undetermined
            size = (np.abs(matrix) * np.abs(values)).sum(axis=1)
            wrong = (np.abs(right) / np.maximum(size, FLOOR * size.max(axis=0))).max(axis=0)
            converged = (wrong <= NEWTON_TOLERANCE) | (converged & (wrong <= SOLVED))
        if converged.all():
            break
    else:
        if not step.loose:
            converged |= moved <= STALLED * largest
    return np.where(converged, values, np.nan), determinant, matrix


def continue_along(
    step: Step, series: Series, reference: Array, guess: Array
) -> tuple[Array, Array, Array]:
    """Newton's method along the samples, each solution continuing the one before it.

    A first try starts every sample from the first one's solution.  A sample continues its
    predecessor if Newton's method started there ends at the same solution; from the first
    that does not, the rest is solved anew.  Returns as `newton`.
    """
    values, determinant, matrix = newton(step, series, reference, guess)
    samples = values.shape[1]
    columns = [j for j, _ in step.columns]
    front = 0
    while True:
        window = slice(front, samples)
        before = np.zeros((len(guess), samples - front))
        before[columns] = values[:, [front, *range(front, samples - 1)]]
        again, *_ = newton(step, series, reference, before, window)
        distance = np.abs(again - values[:, window]).max(axis=0)
        apart = ~(distance <= SAME * np.abs(again).max(axis=0))
        if not apart[1:].any() or apart[0]:
            return values, determinant, matrix
        front += 1 + int(apart[1:].argmax())
        start = np.zeros((len(guess), 1))
        start[columns, 0] = values[:, front - 1]
        window = slice(front, samples)
        values[:, window], determinant[window], matrix[..., window] = newton(
            step, series, reference, start, window
        )
