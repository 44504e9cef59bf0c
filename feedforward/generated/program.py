"""What a straight-line program is made of, whatever language it is printed in.

A program is a list of operations on named numbers.  It has no branch but its checks, and no loop
but that of Newton's method, for one block at a time.  `python_source` and `c_source` print it.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

QUADRATIC = 1e-9
"""Newton's method ends after a step below this fraction of the unknowns' size: the next one, about
its square, is lost in rounding.  A block that places a pulley without mass goes on, for it
converges slowly where its determinant vanishes."""

Value = str | float
"""The name of a number that an operation gives, or a number that is known beforehand."""

Function = Literal["sin", "cos", "sqrt", "atan2", "inverse", "sign", "direction"]


class Term(NamedTuple):
    """A number times a product of named numbers."""

    factor: float
    names: tuple[str, ...]


class Sum(NamedTuple):
    """name = constant + the terms."""

    name: str
    constant: float
    terms: tuple[Term, ...]


class Call(NamedTuple):
    """name = function(arguments); "inverse" is one over its argument, and "direction" its
    sign, which is zero near zero, see `models.friction`.
    """

    name: str
    function: Function
    arguments: tuple[str, ...]


class Nearest(NamedTuple):
    """name = the principal angle and as many whole turns as bring it nearest to another."""

    name: str
    principal: str
    near: str


class Root(NamedTuple):
    """name = the root of a w^2 + b w + c on a known side of the vertex.

    The determinant, the block's side times the square root of b^2 - 4ac, is a result, too.
    """

    name: str
    determinant: str
    a: float
    b: Value
    c: Value
    block: int


class Factor(NamedTuple):
    """The factors of a block's matrix by static elimination.

    The operations are for the order of pivots chosen beforehand.  Where a multiplier exceeds its
    bound that order loses digits there; then the same matrix is to be factored with pivoting.
    """

    number: int
    matrix: tuple[tuple[Value, ...], ...]
    operations: tuple["Operation", ...]
    guards: tuple[tuple[str, float], ...]
    """Multipliers and the bounds of their magnitudes."""
    determinant: Value


class Solve(NamedTuple):
    """names = the solution of factored equations for a right-hand side, by the operations.

    What nothing needs of it has no name, "".
    """

    factor: int
    right: tuple[Value, ...]
    names: tuple[str, ...]
    operations: tuple["Operation", ...]
    values: tuple[Value, ...]
    """What the operations give for each of the names."""


class Regular(NamedTuple):
    """The determinant of a block's matrix must be on the block's side, and not near zero.

    The share of its largest possible value below which it counts as zero is that of `taylor`; that
    of a loose block, which places a pulley without mass and has no side, is that of
    `linear.least_norm`.
    """

    block: int
    factor: int
    determinant: Value
    matrix: tuple[tuple[Value, ...], ...]
    loose: bool


class Newton(NamedTuple):
    """names = the solution of a nonlinear block, by Newton's method from its starts."""

    names: tuple[str, ...]
    starts: tuple[Value, ...]
    operations: tuple["Operation", ...]
    changes: tuple[Value, ...]
    loose: bool
    """Whether it places a pulley without mass."""


Operation = Sum | Call | Nearest | Root | Factor | Solve | Regular | Newton


@dataclass(frozen=True)
class Program:
    """Operations, what they start from, and which of their results mean what.

    Inputs are named r{k}_{c}, the Taylor coefficient of order k of the reference's column c, and
    g{i}, guesses: of Newton's unknowns first, then of the turning frames' angles.
    """

    order: int
    """Taylor coefficients of the reference beyond the value."""
    columns: int
    """Of the reference."""
    operations: tuple[Operation, ...]
    blocks: tuple[int, ...]
    """Those whose determinant changes along a path; sides are given in this order."""
    determinants: tuple[str, ...]
    """Of those of `blocks` that are scalar, which are measured by their largest value on a path."""
    scalar: tuple[int, ...]
    """Places of these among `blocks`."""
    newton: tuple[int, ...]
    """Unknowns that Newton's method needs guesses of."""
    carried: tuple[tuple[Value, Value, Value], ...]
    """Their Taylor coefficients, from which the next sample's guesses follow."""
    names: tuple[str, ...]
    """Of the coordinates, as in `Motion.coordinate_names`."""
    kinematics: tuple[tuple[Value, ...], ...]
    """Coordinates, their rates and their accelerations."""
    multipliers: tuple[Value, ...]
    inputs: tuple[Value, ...]
    tensions: tuple[Value, ...]
    angles: tuple[int, ...]
    """Columns of the turning frames' angles among the coordinates."""
    spans: tuple[tuple[str, tuple[Value, ...], Value], ...]
    """For each span its rope, its vector and its length."""
    extra: tuple[Operation, ...] = field(default=())
    """Operations for `spans` alone."""


def results(operation: Operation) -> tuple[str, ...]:
    """Names that an operation defines for those after it."""
    if isinstance(operation, (Newton, Solve)):
        return operation.names
    if isinstance(operation, Root):
        return operation.name, operation.determinant
    if isinstance(operation, Factor):
        return tuple(name for inner in operation.operations for name in results(inner))
    return () if isinstance(operation, Regular) else (operation.name,)


def needs(operation: Operation) -> Iterator[Value]:
    """What an operation itself, without its inner ones, is computed from."""
    match operation:
        case Sum():
            for term in operation.terms:
                yield from term.names
        case Call():
            yield from operation.arguments
        case Nearest():
            yield from (operation.principal, operation.near)
        case Root():
            yield from (operation.b, operation.c)
        case Regular():
            yield operation.determinant
            yield from (value for row in operation.matrix for value in row)
        case Factor():
            yield from (value for row in operation.matrix for value in row)
        case Solve():
            yield from (*operation.right, *operation.values)
        case Newton():
            yield from (*operation.starts, *operation.changes)


def live(operations: Iterable[Operation], wanted: Iterable[Value]) -> tuple[Operation, ...]:
    """The operations without those whose results nothing needs, inner ones included."""
    return _Living(wanted).of(operations)


class _Living:
    """What is needed by operations later than those looked at, which are taken from the end."""

    def __init__(self, wanted: Iterable[Value]) -> None:
        self.needed = set(wanted)
        self.factors: set[int] = set()
        self.determinants: set[int] = set()

    def of(self, operations: Iterable[Operation]) -> tuple[Operation, ...]:
        kept = [self._kept(operation) for operation in reversed(tuple(operations))]
        return tuple(operation for operation in reversed(kept) if operation is not None)

    def _kept(self, operation: Operation) -> Operation | None:
        match operation:
            case Factor():
                if operation.number not in self.factors:
                    return None
                if operation.number in self.determinants:
                    self.needed.add(operation.determinant)
                self.needed |= {name for name, _ in operation.guards}
            case Regular():
                self.factors.add(operation.factor)
                self.determinants.add(operation.factor)
            case _ if self.needed.isdisjoint(results(operation)):
                return None
        if isinstance(operation, Solve):
            self.factors.add(operation.factor)
            pairs = zip(operation.names, operation.values, strict=True)
            wanted = [(n, v) if n in self.needed else ("", 0.0) for n, v in pairs]
            names, values = zip(*wanted, strict=True)
            operation = operation._replace(names=names, values=values)
        self.needed |= set(needs(operation))
        if isinstance(operation, (Factor, Solve, Newton)):
            return operation._replace(operations=self.of(operation.operations))
        return operation
