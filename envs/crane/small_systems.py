"""Formulas that solve small systems of equations, simulation by simulation the same bits.

Up to `LARGEST` unknowns are eliminated one after the other, as LAPACK does: with partial pivoting,
and by sums of products.  More are left to LAPACK itself.
"""

from collections.abc import Sequence

import numpy as np

from ...models.types import Array
from ..formulas import Formulas, Value, in_order

LARGEST = 4
"""Unknowns for which LAPACK's blocks are of one column each."""


def solved(
    step: Formulas, matrix: Sequence[Sequence[Value]], sides: Sequence[Value]
) -> list[Value]:
    """The unknowns of a square system, from single numbers."""
    size = len(sides)
    if size > LARGEST:
        numbers = [value for row in matrix for value in row]
        every = step.apply(_by_lapack, step.join((*numbers, *sides)), size)
        return [every[[i]] for i in range(size)]
    one = step.constant(1.0)
    rows = [[*row, side] for row, side in zip(matrix, sides, strict=True)]
    for k in range(size):
        for i in range(1, k):
            rows[i][k] = _less_products(rows, i, k, i)
        for i in range(k, size):
            rows[i][k] = _less_products(rows, i, k, k)
        for i in range(k + 1, size):
            rows[k], rows[i] = _larger_first(k, rows[k], rows[i])
        over = one / rows[k][k]
        for i in range(k + 1, size):
            rows[i][k] = rows[i][k] * over
    for k in range(size):
        for i in range(k + 1, size):
            rows[i][-1] = rows[i][-1] - rows[k][-1] * rows[i][k]
    for k in reversed(range(size)):
        rows[k][-1] = rows[k][-1] / rows[k][k]
        for i in range(k):
            rows[i][-1] = rows[i][-1] - rows[k][-1] * rows[i][k]
    return [row[-1] for row in rows]


def _less_products(rows: list[list[Value]], i: int, k: int, known: int) -> Value:
    """An entry less what the unknowns before it have in it."""
    if known == 0:
        return rows[i][k]
    return rows[i][k] - in_order([rows[i][m] * rows[m][k] for m in range(known)])


def _larger_first(k: int, one: list[Value], other: list[Value]) -> tuple[list[Value], list[Value]]:
    """Two rows, that with the larger entry in column k first."""
    here, there = one[k].size(), other[k].size()
    pairs = list(zip(one, other, strict=True))
    return (
        [b.where_less(here, there, a) for a, b in pairs],
        [a.where_less(here, there, b) for a, b in pairs],
    )


def _by_lapack(values: Array, out: Array) -> None:
    size = out.shape[1]
    matrices, sides = values[:, : size**2], values[:, size**2 :, None]
    out[...] = np.linalg.solve(matrices.reshape(-1, size, size), sides)[..., 0]
