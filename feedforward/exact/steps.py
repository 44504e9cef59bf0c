"""The order of work of a Taylor expansion: which block is solved at which stage."""

from typing import Literal, NamedTuple

import numpy as np

from ...models.types import Array
from .linear import solve_many
from .structure import Analysis, Row

Series = list[list[Array]]
"""Per unknown its Taylor coefficients so far, each of shape (N,)."""


Kind = Literal["given", "scalar", "linear", "quadratic", "newton"]
"""How a block is solved at a stage: copied from the reference, as one linear equation or a system
of them, as one quadratic equation, or by Newton's method."""


class Slope(NamedTuple):
    """A derivative, constant + sum of a w_j over the terms (a, j)."""

    constant: float
    terms: tuple[tuple[float, int], ...]

    def at(self, series: Series) -> Array | float:
        """Its value at each sample."""
        total: Array | float = self.constant
        for a, j in self.terms:
            total = total + a * series[j][0]
        return total


class Step(NamedTuple):
    """What one block contributes to one stage."""

    rows: tuple[tuple[Row, int], ...]
    """Equations with the order of the coefficient that must vanish."""
    columns: tuple[tuple[int, int], ...]
    """Unknowns with the order of the coefficient to be found."""
    slopes: tuple[tuple[Slope, ...], ...]
    """How the coefficient of each equation depends on that of each unknown."""
    kind: Kind
    block: int
    loose: bool
    """Whether it places a pulley without mass, which has no place of its own where its ropes are
    straight; the limit does, and is followed by steps of least norm."""
    follows: tuple[tuple[int, int], ...] = ()
    """Equations and unknowns, by their places here, of which the one says the other by itself."""

    def reduced(self, matrix: Array) -> Array:
        """A matrix of slopes (k, k, N) without the unknowns that follow from others by themselves.

        Its determinant is the same but for the sign, and says more: what is left has comparable
        equations, where those of a chain of frames multiply the sizes of all its directions.
        """
        return self._apart(matrix, np.zeros(matrix.shape[1:]))[0] if self.follows else matrix

    def solve(self, matrix: Array, right: Array) -> tuple[Array, Array]:
        """As `linear.solve_many`, which does what does not follow; nothing is overwritten."""
        if not self.follows:
            return solve_many(matrix.copy(), right.copy())
        size = len(right)
        rest, ours, shares, theirs = self._apart(matrix, right)
        equations, unknowns = self._left(size)
        values = np.empty_like(right)
        values[unknowns], determinant = solve_many(rest.copy(), ours.copy())
        places = [j for _, j in self.follows]
        values[places] = theirs - np.einsum("ijn,jn->in", shares, values[unknowns])
        order = np.zeros((size, size))
        order[[i for i, _ in self.follows] + equations, places + unknowns] = 1.0
        return values, determinant * np.round(np.linalg.det(order))

    def _left(self, size: int) -> tuple[list[int], list[int]]:
        """Equations and unknowns of a block that are left without those that follow."""
        rows, columns = zip(*self.follows, strict=True)
        every = range(size)
        return [i for i in every if i not in rows], [j for j in every if j not in columns]

    def _apart(self, matrix: Array, right: Array) -> tuple[Array, Array, Array, Array]:
        """Matrix and right-hand side of what is left, and of what follows from it."""
        matrix, right = matrix.copy(), right.copy()
        for i, j in self.follows:
            share = matrix[:, j].copy()
            share[i] = 0.0
            matrix -= share[:, None] * matrix[i]
            right -= share * right[i]
        equations, unknowns = self._left(len(right))
        says = [i for i, _ in self.follows]
        matrix = matrix[:, unknowns]
        return matrix[equations], right[equations], matrix[says], right[says]

    def jacobian(self, series: Series) -> Array:
        """Slopes of the equations, shape (equations, unknowns, N)."""
        size, samples = len(self.rows), len(series[self.columns[0][0]][0])
        matrix = np.empty((size, size, samples))
        for i, slopes in enumerate(self.slopes):
            for j, slope in enumerate(slopes):
                matrix[i, j] = slope.at(series)
        return matrix

    def residuals(self, series: Series, reference: Array) -> Array:
        """What the equations' coefficients are, which must vanish, shape (equations, N)."""
        return np.array([coefficient(row, order, series, reference) for row, order in self.rows])


def coefficient(row: Row, order: int, series: Series, reference: Array) -> Array:
    """The coefficient of the given order of one equation, shape (N,)."""
    total: Array | float = row.constant if order == 0 else 0.0
    for a, j in row.linear:
        total = total + a * series[j][order]
    for a, j in row.first:
        total = total + a * (order + 1) * series[j][order + 1]
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


def plan(analysis: Analysis, further: int = 0) -> tuple[Step, ...]:
    """The steps that determine every unknown of a flat system, in order.

    Unknown j is determined up to its derivative d_j + `further`.
    """
    c, d = analysis.equation_offsets, analysis.unknown_offsets
    steps = []
    for stage in range(-max(d), 1 + further):
        for number, (equations, unknowns) in enumerate(analysis.blocks):
            rows = tuple((analysis.rows[i], stage + c[i]) for i in equations if stage + c[i] >= 0)
            columns = tuple((j, stage + d[j]) for j in unknowns if stage + d[j] >= 0)
            if rows:
                slopes = tuple(
                    tuple(_slope(row, order, *column) for column in columns) for row, order in rows
                )
                kind = _kind(rows, columns)
                loose = kind in ("linear", "newton") and not analysis.massless.isdisjoint(unknowns)
                places = {column: place for place, column in enumerate(columns)}
                follows = tuple(
                    (i, places[row.follows, order])
                    for i, (row, order) in enumerate(rows)
                    if row.follows is not None and (row.follows, order) in places
                )
                steps.append(Step(rows, columns, slopes, kind, number, loose, follows))
    return tuple(steps)


def _kind(rows: tuple[tuple[Row, int], ...], columns: tuple[tuple[int, int], ...]) -> Kind:
    if len(rows) == 1 and rows[0][0].output is not None and rows[0][0].plain:
        return "given"
    fresh = {j for j, order in columns if order == 0}
    nonlinear = any(
        order == 0 and j in fresh and k in fresh for row, order in rows for _, j, k in row.quadratic
    )
    if len(rows) == 1:
        return "quadratic" if nonlinear else "scalar"
    return "newton" if nonlinear else "linear"


def _slope(row: Row, order: int, unknown: int, highest: int) -> Slope:
    """Derivative of an equation's coefficient by an unknown's coefficient of order `highest`.

    A flat system determines nothing from a rate or an acceleration: its degrees of freedom, the sum
    of the orders on which equations and unknowns are paired, are none, so that each of them is 0.
    """
    constant = 0.0
    terms: list[tuple[float, int]] = []
    if highest == order:
        constant += sum(a for a, j in row.linear if j == unknown)
        for a, j, k in row.quadratic:
            terms += [(a, factor) for w, factor in ((j, k), (k, j)) if w == unknown]
    return Slope(constant, tuple(terms))
