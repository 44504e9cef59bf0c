"""The splines along points that a sampled path chooses from, coarse and fine.

B-splines of degree 2n+1 on clamped knots have n vanishing derivatives at an end exactly when the
first, or last, n+1 coefficients are equal.  With those put in place, m pieces leave m-1 unknown
coefficients: none for the rest-to-rest polynomial, and as many as inner points when every point is
a knot, where the least-squares spline becomes the interpolating one.  Without rest at its ends all
coefficients are unknown.
"""

from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ...models.errors import PathError
from ...models.types import Array

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

REFINEMENTS = 2
"""Corrections of the normal equations' solution: they square the B-splines' condition number,
up to 1e4 for degree 9, and each correction takes that back."""


def interpolate(times: Array, points: Array, order: int, *, rest: bool = True) -> "BSpline":
    """The spline of degree 2 `order` + 1 through all points, a knot at each.

    From rest to rest, or else with no knot next to its ends.

    Raises
    ------
    PathError
        The times are too uneven for it.
    """
    end = [(k, np.zeros(points.shape[1])) for k in range(1, order + 1)]
    ends = (end, end) if end and rest else None
    spline = None
    # A collocation matrix may be singular or overflow.
    with suppress(np.linalg.LinAlgError, ValueError):
        spline = scipy.interpolate.make_interp_spline(times, points, k=2 * order + 1, bc_type=ends)
    if spline is None or not np.isfinite(spline.c).all():
        raise PathError(
            f"the points are too unevenly spaced in time for a path of order {order}: the steps "
            f"differ by a factor of {np.diff(times).max() / np.diff(times).min():.1g}"
        )
    return spline


def least_squares(
    times: Array, points: Array, order: int, pieces: int, *, rest: bool = True
) -> "BSpline | None":
    """The spline of least squares with knots at every so many points; None where it is singular."""
    degree = 2 * order + 1
    chosen = np.round(np.linspace(0, len(times) - 1, pieces + 1)).astype(int)
    knots = np.concatenate([np.full(degree, times[0]), times[chosen], np.full(degree, times[-1])])
    first, count = (order + 1, pieces - 1) if rest else (0, pieces + degree)
    unknown = slice(first, first + count)
    coefficients = np.zeros((pieces + degree, points.shape[1]))
    coefficients[:first] = points[0]
    coefficients[first + count :] = points[-1]
    if count > len(times):
        return None
    if count:
        design = scipy.interpolate.BSpline.design_matrix(times, knots, degree)
        inner = design[:, unknown]
        normal = inner.T @ inner
        bands = np.zeros((min(degree, count - 1) + 1, count))
        for i in range(len(bands)):
            bands[i, : count - i] = normal.diagonal(-i)
        try:
            factor = scipy.linalg.cholesky_banded(bands, lower=True)
        except np.linalg.LinAlgError:
            return None
        for _ in range(1 + REFINEMENTS):
            residual = points - design @ coefficients
            coefficients[unknown] += scipy.linalg.cho_solve_banded(
                (factor, True), inner.T @ residual
            )
    return scipy.interpolate.BSpline(knots, coefficients, degree)
