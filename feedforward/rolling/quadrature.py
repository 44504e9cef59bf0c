"""Integrals over time with a stated error, for the integral variables of Liouvillian plans."""

import math
from collections.abc import Callable

import numpy as np

from ...models.types import Array

PANELS = 32
"""Least number of panels over a whole motion."""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
"""Gauss's rule of eight nodes on a panel, exact for polynomials of degree 15."""


def integrate(
    function: Callable[[Array], Array], times: Array, duration: float, judged: bool = True
) -> tuple[Array, float]:
    """Integrals of a function from 0 to each time, and a bound of their error.

    Parameters
    ----------
    function
        From times (M,) to values (M, size).
    times
        Shape (N,), in any order; before 0 and after `duration` the function is taken as 0.
    duration
        Where the last panel ends.
    judged
        Whether to look for the error, which costs half as much again; without, it is not a number.

    Returns
    -------
    tuple[Array, float]
        Shape (N, size), and the largest error: what halving all panels changes, which is the error
        of the coarser rule and so far above that of the integrals given.
    """
    times = np.clip(times, 0.0, duration)
    edges = np.unique(np.concatenate((times, np.linspace(0.0, duration, PANELS + 1))))
    middle = (edges[:-1] + edges[1:]) / 2
    halves = _panels(function, edges[:-1], middle) + _panels(function, middle, edges[1:])
    error = math.nan
    if judged:
        whole = _panels(function, edges[:-1], edges[1:])
        error = float(np.abs(whole - halves).sum(axis=0).max(initial=0.0))
    sums = np.concatenate((np.zeros((1, halves.shape[1])), np.cumsum(halves, axis=0)))
    return sums[np.searchsorted(edges, times)], error


def _panels(function: Callable[[Array], Array], left: Array, right: Array) -> Array:
    """Integrals over panels, (panels, size)."""
    half = (right - left) / 2
    points = (left + right)[:, None] / 2 + half[:, None] * NODES
    values = function(points.ravel()).reshape(*points.shape, -1)
    return np.asarray(np.einsum("pns,n,p->ps", values, WEIGHTS, half))
