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
from dataclasses import dataclass, field

import numpy as np

from ...models.types import Array, Mask
from .linear import least_norm
from .nonlinear import continue_along, newton, solve_quadratic
from .problem import Problem
from .steps import Series, Step, coefficient, plan

SINGULAR = 1e-11
"""A determinant below this fraction of its largest possible value counts as zero: it guards against
a sign that only rounding has chosen, at the places where two solutions meet (Y 6.1.1)."""

Solved = tuple[Array, Array | None]
"""A step's determinants (N,) or one for all, and its matrices (k, k, N) unless it is scalar."""


@dataclass
class Solution:
    """Taylor coefficients of all unknowns at N samples, not finite where there is no solution."""

    series: Series
    signs: dict[int, Array]
    """Per block the determinant's sign at each sample, 0 where it is singular, shape (N,); blocks
    that the reference gives or that place a pulley without mass have none."""
    straight: Mask
    """Where a pulley without mass hangs straight and its place is undetermined, shape (N,)."""
    determinants: dict[int, Array] = field(default_factory=dict)
    """Of the same blocks as the signs, as a share of the largest possible value, shape (N,)."""

    @property
    def solved(self) -> Mask:
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
    shares: dict[int, Array] = {}
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
            if matrix is not None:
                matrix = step.reduced(matrix)
            if step.loose:
                straight |= _sign(_share(determinant, matrix)) == 0
            elif step.block not in signs:
                share = _share(determinant, matrix)
                shares[step.block] = np.broadcast_to(share, zero.shape)
                signs[step.block] = np.broadcast_to(_sign(share), zero.shape)
    return Solution(series, signs, straight, shares)


def _solve(
    step: Step, series: Series, reference: Array, guess: Array, follow: bool, side: float | None
) -> Solved:
    """Replace the zeros that stand for a step's coefficients by their values."""
    if step.kind == "scalar":
        return _scalar(step, series, reference)
    if step.kind == "quadratic":
        return solve_quadratic(step, series, reference, guess, follow, side)
    if step.kind == "linear":
        values, determinant, matrix = _linear(step, series, reference)
    else:
        method = continue_along if follow else newton
        values, determinant, matrix = method(step, series, reference, guess)
    for (j, order), value in zip(step.columns, values, strict=True):
        series[j][order] = value
    return determinant, matrix


def _share(determinant: Array, matrix: Array | None) -> Array:
    """Determinants (N,) of a block over their largest possible value.

    A matrix (k, k, N) is measured by the product of its columns' sizes and of its rows' after
    division by them, whatever the units of unknowns and equations; a scalar, which has no size of
    its own, by its largest value along the path.
    """
    if matrix is None:
        finite = np.abs(determinant[np.isfinite(determinant)])
        return np.asarray(determinant / finite.max(initial=np.finfo(float).tiny))
    size = np.abs(matrix)
    columns = size.max(axis=0)
    bound = np.prod(columns, axis=0) * np.prod((size / columns).max(axis=1), axis=0)
    return np.asarray(determinant / bound)


def _sign(share: Array) -> Array:
    """Sign of determinants' shares (N,), 0 where they are singular to rounding."""
    regular = np.isfinite(share) & (np.abs(share) > SINGULAR)
    return np.where(regular, np.sign(share), 0.0)


def _linear(step: Step, series: Series, reference: Array) -> tuple[Array, Array, Array]:
    """The unknowns (k, N), the determinants (N,) and the matrices (k, k, N)."""
    matrix, right = step.jacobian(series), -step.residuals(series, reference)
    values, determinant = step.solve(matrix, right)
    if step.loose:
        values, unsolved = least_norm(matrix, right, values, determinant)
        values = np.where(unsolved, np.nan, values)
    return values, determinant, matrix


def _scalar(step: Step, series: Series, reference: Array) -> Solved:
    ((row, order),), ((j, highest),) = step.rows, step.columns
    slope = step.slopes[0][0].at(series)
    series[j][highest] = coefficient(row, order, series, reference) / -slope
    return np.atleast_1d(slope), None
