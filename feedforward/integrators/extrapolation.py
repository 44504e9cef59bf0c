"""Extrapolation of runs to step zero.

The midpoint, energy-momentum and variational schemes are symmetric in time: their error is a
series in h^2, and runs with several steps together remove its first terms (Aitken and Neville).
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ...models.types import Array


def extrapolated(results: Sequence[ArrayLike], counts: Sequence[int]) -> tuple[Array, Array]:
    """The limit of results whose error is a series in the squared step, and how sure it is.

    Parameters
    ----------
    results
        Arrays of one shape, from runs over the same time.
    counts
        Numbers of steps of those runs, increasing.

    Returns
    -------
    tuple[Array, Array]
        The limit, and how far it is from that of all runs but the last.
    """
    column = [np.asarray(result, dtype=np.float64) for result in results]
    before = column[0]
    for level in range(1, len(results)):
        before = column[0]
        ratios = [(counts[i + level] / counts[i]) ** 2 for i in range(len(column) - 1)]
        column = [
            fine + (fine - coarse) / (ratio - 1)
            for (coarse, fine), ratio in zip(pairwise(column), ratios, strict=True)
        ]
    return column[0], np.abs(column[0] - before)
