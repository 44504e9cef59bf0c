"""Collects the operations of a program: sums of products, each formed once."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import numpy as np

from ...models.friction import direction
from .program import Call, Function, Operation, Sum, Term, Value, needs

Polynomial = dict[tuple[str, ...], float]
"""A sum of products: factors by the names multiplied, in alphabetical order; () is the constant."""


def add(polynomial: Polynomial, factor: float, *values: Value) -> None:
    """Add a number times a product of values to a polynomial."""
    names = []
    for value in values:
        if isinstance(value, str):
            names.append(value)
        else:
            factor *= value
    if factor:
        key = tuple(sorted(names))
        polynomial[key] = polynomial.get(key, 0.0) + factor


def scaled(polynomial: Polynomial, factor: float) -> Polynomial:
    """A polynomial times a number."""
    return {names: factor * a for names, a in polynomial.items()}


class Builder:
    """Operations so far, and the values that are known by what they were formed from."""

    def __init__(self) -> None:
        self.operations: list[Operation] = []
        self._formed: dict[object, tuple[str, float]] = {}  # a value, and what it is a multiple by
        self._count = 0
        self._before: list[Operation] | None = (
            None  # where operations stand that a loop repeats not
        )
        self._moving: set[str] = set()

    def fresh(self, letter: str = "t") -> str:
        """A name that is not used yet."""
        self._count += 1
        return f"{letter}{self._count}"

    def let(self, polynomial: Polynomial, name: str | None = None) -> Value:
        """The value of a polynomial: a number, a name that stands for it, or that of a new sum."""
        terms = {names: a for names, a in polynomial.items() if a != 0.0}
        constant = terms.pop((), 0.0)
        if not terms:
            return constant
        if not constant and len(terms) == 1:
            ((names, a),) = terms.items()
            if a == 1.0 and len(names) == 1:
                return names[0]
        # What is a multiple of something formed before is formed from that.
        lead = terms[min(terms)]
        key = (constant / lead, frozenset((names, a / lead) for names, a in terms.items()))
        if key in self._formed:
            formed, factor = self._formed[key]
            if factor == lead:
                return formed
            return self.let({(formed,): lead / factor}, name)
        name = name or self.fresh()
        parts = tuple(Term(a, names) for names, a in terms.items())
        self._put(Sum(name, constant, parts), name)
        self._formed[key] = name, lead
        return name

    def total(self, *terms: tuple[float, Value], name: str | None = None) -> Value:
        """The value of a weighted sum."""
        polynomial: Polynomial = {}
        for factor, value in terms:
            add(polynomial, factor, value)
        return self.let(polynomial, name)

    def product(self, *values: Value, name: str | None = None) -> Value:
        """The value of a product."""
        polynomial: Polynomial = {}
        add(polynomial, 1.0, *values)
        return self.let(polynomial, name)

    def call(self, function: Function, *arguments: Value) -> Value:
        """The value of a function of named values, or one over a number."""
        if function == "inverse" and not isinstance(arguments[0], str):
            return 1.0 / arguments[0]
        key = (function, arguments)
        if key not in self._formed:
            name = self.fresh()
            self._put(Call(name, function, tuple(map(str, arguments))), name)
            self._formed[key] = name, 1.0
        return self._formed[key][0]

    def direction(self, value: Value) -> Value:
        """The sign of a speed, see `models.friction`."""
        if isinstance(value, str):
            return self.call("direction", value)
        return float(direction(np.asarray(value)))

    def sign(self, value: Value) -> Value:
        """The sign of a value."""
        return self.call("sign", value) if isinstance(value, str) else float(np.sign(value))

    def _put(self, operation: Sum | Call, name: str) -> None:
        if self._before is None:
            self.operations.append(operation)
        elif self._moving.isdisjoint(needs(operation)):
            self._before.append(operation)
        else:
            self.operations.append(operation)
            self._moving.add(name)

    def moves(self, value: Value) -> bool:
        """Whether a value changes from one round of a loop to the next."""
        return value in self._moving

    @contextmanager
    def loop(self, names: Iterable[str]) -> Iterator[list[Operation]]:
        """Collect operations that a loop repeats, which changes what has these names.

        Those that depend on none of them are left before the loop.
        """
        outer, self.operations = self.operations, []
        self._before, self._moving = outer, set(names)
        try:
            yield self.operations
        finally:
            moving = self._moving
            self._formed = {k: v for k, v in self._formed.items() if v[0] not in moving}
            self.operations, self._before, self._moving = outer, None, set()

    @contextmanager
    def apart(self) -> Iterator[list[Operation]]:
        """Collect operations whose results are not known after them."""
        outer, formed = self.operations, self._formed
        self.operations, self._formed = [], dict(formed)
        try:
            yield self.operations
        finally:
            self.operations, self._formed = outer, formed

    @contextmanager
    def together(self) -> Iterator[list[Operation]]:
        """Collect operations whose results are known after them."""
        outer, self.operations = self.operations, []
        try:
            yield self.operations
        finally:
            self.operations = outer


def series_product(
    builder: Builder, left: list[Value], right: list[Value], sign: float = 1.0
) -> list[Value]:
    """Taylor coefficients of a product."""
    return [builder.let(convolution(left, right, order, sign)) for order in range(len(left))]


def convolution(
    left: Iterable[Value], right: Iterable[Value], order: int, factor: float = 1.0
) -> Polynomial:
    """The coefficient of an order of a product, times a number."""
    left, right = list(left), list(right)
    polynomial: Polynomial = {}
    for i in range(order + 1):
        add(polynomial, factor, left[i], right[order - i])
    return polynomial
