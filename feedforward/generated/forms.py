"""Equations as sums of products of linear forms, with as few multiplications as there are.

A span's constraint is a sum of squares of differences, which the expanded equations hide; and its
multiplier pulls at both ends, and at every director of a platform, with the same products of
multiplier and difference.  Squares are completed and forces taken out here, so that what several
equations share is seen to be the same.
"""

from typing import Any, NamedTuple

from ..exact.structure import Row

ZERO = 1e-13
"""A coefficient below this fraction of what it is the difference of is zero, but for rounding."""


class Form(NamedTuple):
    """A constant and a weighted sum of unknowns."""

    constant: float
    terms: tuple[tuple[float, int], ...]


class Product(NamedTuple):
    """A number times the product of two forms."""

    factor: float
    left: Form
    right: Form


class Factored(NamedTuple):
    """A row's terms without derivatives and without what is prescribed."""

    constant: float
    linear: tuple[tuple[float, int], ...]
    products: tuple[Product, ...]


def factored(row: Row) -> Factored:
    """An equation with products of forms in place of its quadratic terms."""
    if row.kind == "motion":
        return _forces_apart(row)
    return _squares(row)


def _forces_apart(row: Row) -> Factored:
    """A multiplier or an input stands with every coordinate that it depends on."""
    linear = {j: a for a, j in row.linear}
    forms: dict[int, dict[int, float]] = {}
    for a, force, coordinate in row.quadratic:
        form = forms.setdefault(force, {})
        form[coordinate] = form.get(coordinate, 0.0) + a
    products = []
    for force, form in forms.items():
        _, lead = min(form.items())
        terms = tuple((a / lead, j) for j, a in sorted(form.items()))
        arm = Form(linear.pop(force, 0.0) / lead, terms)
        products.append(Product(lead, Form(0.0, ((1.0, force),)), arm))
    return Factored(row.constant, tuple((a, j) for j, a in linear.items()), tuple(products))


def _squares(row: Row) -> Factored:
    """Squares completed as long as that makes the rest shorter."""
    constant = row.constant
    linear = {j: a for a, j in row.linear}
    pairs: dict[tuple[int, int], float] = {}
    for a, j, k in row.quadratic:
        key = (min(j, k), max(j, k))
        pairs[key] = pairs.get(key, 0.0) + a
    products = []
    for j in sorted({j for j, k in pairs if j == k}):
        a = pairs.get((j, j), 0.0)
        beside = {k + i - j: b for (i, k), b in pairs.items() if j in (i, k) and i != k}
        if not a or not (beside or j in linear):
            continue
        terms = {j: 1.0, **{k: b / (2.0 * a) for k, b in beside.items()}}
        form = Form(linear.pop(j, 0.0) / (2.0 * a), tuple((b, k) for k, b in sorted(terms.items())))
        products.append(Product(a, form, form))
        for i in terms:
            for k in terms:
                if i <= k:
                    taken = a * terms[i] * terms[k] * (1.0 if i == k else 2.0)
                    _subtract(pairs, (i, k), taken)
        for k, b in beside.items():
            _subtract(linear, k, b * form.constant)
        constant -= a * form.constant**2
        if abs(constant) <= ZERO * a * form.constant**2:
            constant = 0.0
    for (j, k), a in pairs.items():
        products.append(Product(a, Form(0.0, ((1.0, j),)), Form(0.0, ((1.0, k),))))
    return Factored(constant, tuple((a, j) for j, a in linear.items()), tuple(products))


def _subtract(table: dict[Any, float], key: Any, amount: float) -> None:
    rest = table.pop(key, 0.0) - amount
    if abs(rest) > ZERO * abs(amount):
        table[key] = rest
