"""Elimination without a search for pivots: their order is chosen beforehand, for few operations.

A block's matrix is mostly zeros, and of what is not zero most never changes.  The pivots are chosen
once, from samples of the matrix, by Markowitz's rule: that of the fewest operations, among those
that are not small in their column at any sample.  Where no entry is, as of a cosine and a sine that
change places as a frame turns, two rows and two columns are eliminated at once.  Away from the
samples a pivot may be small all the same; so the multipliers are bounded, and a matrix that exceeds
a bound is to be factored with pivoting.
"""

from collections.abc import Iterable
from itertools import combinations

import numpy as np

from ...models.types import Array, Mask
from .builder import Builder, Polynomial, add
from .program import Factor, Operation, Value

SMALL = 0.1
"""A pivot is at least this fraction of the largest entry in its column, at every sample."""
MULTIPLIER = 1e3
"""Bound of a multiplier of equilibrated rows; digits that it may cost are its own."""

Pivot = tuple[tuple[int, ...], tuple[int, ...]]
"""Rows and columns of an entry, or of two by two of them."""
Matrix = tuple[tuple[Value, ...], ...]


def choose(
    present: Mask, samples: Array, first: Iterable[tuple[int, int]] = ()
) -> tuple[tuple[Pivot, ...], Array]:
    """Pivots in their order, and scales of the rows.

    Parameters
    ----------
    present
        Which entries are not always zero, shape (k, k).
    samples
        Matrices, shape (k, k, N).
    first
        Rows and columns of pivots to begin with: unknowns that others say, with a factor 1.

    Returns
    -------
    tuple[tuple[Pivot, ...], Array]
        The pivots, and the powers of two, shape (k,), that bring the rows to like sizes once the
        columns are.
    """
    size = len(present)
    matrix, full = np.array(samples, dtype=float), np.array(present, dtype=bool)
    left, over = list(range(size)), list(range(size))
    pivots: list[Pivot] = []
    for i, j in first:
        pivots.append(((i,), (j,)))
        left.remove(i)
        over.remove(j)
        matrix -= matrix[:, j, None] * matrix[i] * (np.arange(size) != i)[:, None, None]
        full |= full[:, [j]] & full[i]
    rest = matrix[np.ix_(left, over)]
    with np.errstate(all="ignore"):
        rest /= np.abs(rest).max(axis=0, keepdims=True)
        scale = np.abs(rest).max(axis=1, keepdims=True)
        rest = np.nan_to_num(rest / scale, nan=0.0, posinf=0.0, neginf=0.0)
    scales = np.ones(size)
    scales[left] = 2.0 ** -np.round(np.log2(np.median(scale[:, 0], axis=-1)))
    matrix[np.ix_(left, over)] = rest
    while left:
        rows, columns = _next(full, matrix, left, over)
        pivots.append((rows, columns))
        left = [i for i in left if i not in rows]
        over = [j for j in over if j not in columns]
        block = np.moveaxis(matrix[np.ix_(rows, columns)], -1, 0)
        inverse = np.moveaxis(np.nan_to_num(np.linalg.pinv(block)), 0, -1)
        shares = np.einsum("kin,ijn->kjn", matrix[np.ix_(left, columns)], inverse)
        change = np.einsum("kin,icn->kcn", shares, matrix[np.ix_(rows, over)])
        matrix[np.ix_(left, over)] -= change
        fill = full[np.ix_(left, columns)].any(axis=1, keepdims=True)
        full[np.ix_(left, over)] |= fill & full[np.ix_(rows, over)].any(axis=0)
    return tuple(pivots), scales


def _next(present: Mask, matrix: Array, left: list[int], over: list[int]) -> Pivot:
    """The next pivot in what is left of a matrix: a single entry if one is good."""
    rest, full = matrix[np.ix_(left, over)], present[np.ix_(left, over)]
    with np.errstate(all="ignore"):
        sizes = np.nan_to_num(np.abs(rest) / np.abs(rest).max(axis=0))
    share = np.where(full, sizes.min(axis=-1), -1.0)
    work = (full.sum(axis=1) - 1)[:, None] * (full.sum(axis=0) - 1)[None]
    if (share >= SMALL).any():
        cost = np.where(share >= SMALL, work - 0.5 * share, np.inf)
        i, j = np.unravel_index(int(cost.argmin()), cost.shape)
        return (left[i],), (over[j],)
    best: tuple[float, Pivot] | None = None
    for rows in combinations(range(len(left)), 2):
        for columns in combinations(range(len(over)), 2):
            (a, b), (c, d) = (_sizes(rest, i, columns) for i in rows)
            regular = float(np.abs(a * d - b * c).min())
            count = full[:, columns].any(axis=1).sum() * full[list(rows)].any(axis=0).sum()
            if regular >= SMALL and (best is None or count - regular < best[0]):
                places = tuple(left[i] for i in rows), tuple(over[j] for j in columns)
                best = float(count - regular), places
    if best is not None:
        return best[1]
    i, j = np.unravel_index(int(share.argmax()), share.shape)
    return (left[i],), (over[j],)


def _sizes(rest: Array, row: int, columns: tuple[int, int]) -> tuple[Array, Array]:
    """Two entries of a row over the largest ones of their columns."""
    with np.errstate(all="ignore"):
        first, second = (
            np.nan_to_num(rest[row, j] / np.abs(rest[:, j]).max(axis=0)) for j in columns
        )
    return first, second


class Singular(Exception):
    """A matrix is singular whatever the path."""


class Eliminated:
    """The factors of one matrix, among the operations of a builder."""

    def __init__(
        self,
        builder: Builder,
        number: int,
        matrix: Matrix,
        pivots: tuple[Pivot, ...],
        scales: Array,
        sure: int = 0,
    ) -> None:
        self.builder, self.number, self.pivots = builder, number, pivots
        self.sure = sure  # so many pivots at the beginning are 1
        self.size = len(matrix)
        self.lower: list[list[tuple[int, list[Value]]]] = []
        self.upper: list[list[list[tuple[int, Value]]]] = []
        self.inverse: list[Matrix] = []
        guards: list[tuple[str, float]] = []
        with builder.together() as operations:
            determinants = self._eliminate(matrix, scales, guards)
            self.determinant = builder.product(_parity(pivots), *determinants)
        builder.operations.append(
            Factor(number, matrix, tuple(operations), tuple(guards), self.determinant)
        )

    def _eliminate(
        self, matrix: Matrix, scales: Array, guards: list[tuple[str, float]]
    ) -> list[Value]:
        builder = self.builder
        entries = {
            (i, j): value for i, row in enumerate(matrix) for j, value in enumerate(row) if value
        }
        left, over = set(range(self.size)), set(range(self.size))
        determinants: list[Value] = []
        for place, (rows, columns) in enumerate(self.pivots):
            left -= set(rows)
            over -= set(columns)
            determinant, inverse = self._inverted(entries, rows, columns)
            upper = [[(j, entries[i, j]) for j in sorted(over) if (i, j) in entries] for i in rows]
            lower: list[tuple[int, list[Value]]] = []
            for k in sorted(left):
                here = [entries.get((k, j), 0.0) for j in columns]
                if not any(here):
                    continue
                shares = [_dot(builder, here, column) for column in zip(*inverse, strict=True)]
                lower.append((k, shares))
                for i, share in zip(rows, shares, strict=True):
                    if isinstance(share, str) and place >= self.sure:
                        guards.append((share, float(MULTIPLIER * scales[i] / scales[k])))
                for j in sorted({j for values in upper for j, _ in values}):
                    changed: Polynomial = {}
                    add(changed, 1.0, entries.get((k, j), 0.0))
                    for i, share in zip(rows, shares, strict=True):
                        add(changed, -1.0, share, entries.get((i, j), 0.0))
                    entries[k, j] = builder.let(changed)
                    if not entries[k, j]:
                        del entries[k, j]
            determinants.append(determinant)
            self.inverse.append(inverse)
            self.lower.append(lower)
            self.upper.append(upper)
        return determinants

    def _inverted(
        self, entries: dict[tuple[int, int], Value], rows: tuple[int, ...], columns: tuple[int, ...]
    ) -> tuple[Value, Matrix]:
        """The determinant of a pivot and its inverse."""
        builder = self.builder
        block = [[entries.get((i, j), 0.0) for j in columns] for i in rows]
        polynomial: Polynomial = {}
        if len(rows) == 1:
            add(polynomial, 1.0, block[0][0])
        else:
            add(polynomial, 1.0, block[0][0], block[1][1])
            add(polynomial, -1.0, block[0][1], block[1][0])
        determinant = builder.let(polynomial)
        if not determinant:
            raise Singular
        over = builder.call("inverse", determinant)
        if len(rows) == 1:
            return determinant, ((over,),)
        (a, b), (c, d) = block
        adjugate = ((1.0, d), (-1.0, b)), ((-1.0, c), (1.0, a))
        return determinant, tuple(
            tuple(builder.product(sign, value, over) for sign, value in row) for row in adjugate
        )

    def solve(self, right: list[Value]) -> tuple[tuple[Operation, ...], tuple[Value, ...]]:
        """Operations that solve for a right-hand side, and the solution."""
        builder, rest = self.builder, list(right)
        solution: dict[int, Value] = {}
        with builder.apart() as operations:
            for (rows, _), lower in zip(self.pivots, self.lower, strict=True):
                for k, shares in lower:
                    changed: Polynomial = {}
                    add(changed, 1.0, rest[k])
                    for i, share in zip(rows, shares, strict=True):
                        add(changed, -1.0, share, rest[i])
                    rest[k] = builder.let(changed)
            for place in reversed(range(len(self.pivots))):
                rows, columns = self.pivots[place]
                left = []
                for i, upper in zip(rows, self.upper[place], strict=True):
                    changed = {}
                    add(changed, 1.0, rest[i])
                    for j, value in upper:
                        add(changed, -1.0, value, solution[j])
                    left.append(builder.let(changed))
                for j, row in zip(columns, self.inverse[place], strict=True):
                    solution[j] = _dot(builder, row, left)
        return tuple(operations), tuple(solution[j] for j in range(self.size))


def _dot(builder: Builder, left: Iterable[Value], right: Iterable[Value]) -> Value:
    total: Polynomial = {}
    for a, b in zip(left, right, strict=True):
        add(total, 1.0, a, b)
    return builder.let(total)


def _parity(pivots: tuple[Pivot, ...]) -> float:
    """Sign of the permutation that the pivots are."""
    rows = [i for pivot, _ in pivots for i in pivot]
    columns = [j for _, pivot in pivots for j in pivot]
    permutation = np.zeros((len(rows), len(rows)))
    permutation[rows, columns] = 1.0
    return float(np.round(np.linalg.det(permutation)))
