"""Programs in Python: for one sample with the numbers of `math`, or for many with arrays."""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import Literal

from ..exact.linear import WEAK
from ..exact.nonlinear import NEWTON_ITERATIONS, NEWTON_TOLERANCE, STALLED
from ..exact.taylor import SINGULAR
from .program import (
    QUADRATIC,
    Call,
    Factor,
    Nearest,
    Newton,
    Operation,
    Program,
    Regular,
    Root,
    Solve,
    Sum,
    Value,
)
from .words import number, rest_of, text_of

Dialect = Literal["scalar", "stepping", "numpy"]

HEADERS = {
    "scalar": "from math import atan2, cos, pi, sin, sqrt\n",
    "stepping": "from math import atan2, cos, pi, sin, sqrt\n",
    "numpy": "from numpy import abs, arctan2 as atan2, cos, maximum, pi, round, sin, sqrt, where\n",
}


def python_source(program: Program, dialect: Dialect) -> str:
    """The source of a module with the function `step`.

    `step(r, g, side)` takes the Taylor coefficients of the reference, order by order and column by
    column, the guesses and the sides of the blocks.  It returns what `rows` lists and what guesses
    follow from, or None where the program has no solution to offer; "stepping" adds the length and
    the vector of each span.  With arrays it takes a mask in addition, from which it removes samples
    without a solution, and returns what `rows` lists anyway.
    """
    return _Printer(program, dialect).source()


def rows(program: Program) -> tuple[Value, ...]:
    """What the function returns: motion, multipliers, inputs, tensions, determinants."""
    kinematics = [value for values in program.kinematics for value in values]
    return (
        *kinematics, *program.multipliers, *program.inputs, *program.tensions,
        *program.determinants,
    )  # fmt: skip


NAME = re.compile(r"\b[a-z]\d+(?:_\d+)?\b")
"""What the names in a program look like."""


def forgetting(lines: Sequence[str], wanted: Collection[str]) -> Iterator[str]:
    """Lines that forget each array after its last use, so that its memory serves again at once.

    Without this a program touches new memory with every line, which takes longer than its sums.
    A loop's lines, which are indented, are one in this respect.
    """
    ends: list[int] = []
    inside = False
    for i, line in enumerate(lines):
        if line.startswith(" ") and inside:
            ends[-1] = i
        else:
            ends.append(i)
        inside = line.startswith((" ", "for "))
    last: dict[str, int] = {}
    start = 0
    for end in ends:
        last |= dict.fromkeys(NAME.findall("\n".join(lines[start : end + 1])), end)
        start = end + 1
    dead: dict[int, list[str]] = {}
    for name, end in last.items():
        if name not in wanted:
            dead.setdefault(end, []).append(name)
    for i, line in enumerate(lines):
        yield line
        if i in dead:
            yield f"del {', '.join(dead[i])}"


class _Printer:
    def __init__(self, program: Program, dialect: Dialect) -> None:
        self.program, self.scalar = program, dialect != "numpy"
        self.stepping = dialect == "stepping"
        self.sides = {block: f"s{i}" for i, block in enumerate(program.blocks)}
        self.looping = False
        self.header = HEADERS[dialect]

    def source(self) -> str:
        program = self.program
        reference = [f"r{k}_{c}" for k in range(program.order + 1) for c in range(program.columns)]
        guesses = [f"g{i}" for i in range(len(program.newton) + len(program.angles))]
        lines = [
            "def step(r, g, side):" if self.scalar else "def step(r, g, side, good):",
            *(f"    {', '.join(names)}, = {given}" for names, given in (
                (reference, "r"), (guesses, "g"), (list(self.sides.values()), "side")
            ) if names),
        ]  # fmt: skip
        body = [*self.lines(program.operations), *self._sides()]
        if not self.scalar:
            body = list(forgetting(body, {str(value) for value in rows(program)}))
        lines += ["    " + line for line in body]
        if self.scalar:
            whole = ", ".join(text_of(value) for value in rows(program))
            carried = ", ".join(text_of(v) for group in program.carried for v in group)
            lines.append(f"    motion = ({whole},)")
            more = ""
            if self.stepping:
                lines += ["    " + line for line in self.lines(program.extra)]
                spans = ", ".join(
                    f"({text_of(length)}, {', '.join(map(text_of, vector))})"
                    for _, vector, length in program.spans
                )
                more = f", ({spans}{',' if spans else ''})"
            lines.append(f"    return motion, ({carried}{',' if carried else ''}){more}")
        else:
            lines.append(f"    return ({', '.join(text_of(value) for value in rows(program))},)")
        return self.header + "\n\n" + "\n".join(lines) + "\n"

    def lines(self, operations: Iterable[Operation]) -> Iterator[str]:
        for operation in operations:
            yield from getattr(self, f"_{type(operation).__name__.lower()}")(operation)

    def require(self, condition: str) -> str:
        """A check, which holds at a good sample and not where a number is NaN."""
        return f"if not {condition}: return None" if self.scalar else f"good &= {condition}"

    def largest(self, values: Iterable[Value]) -> str:
        """The largest magnitude of some values."""
        texts = list(dict.fromkeys(
            f"abs({value})" if isinstance(value, str) else number(abs(value)) for value in values
        ))  # fmt: skip
        if len(texts) == 1:
            return texts[0]
        return self._most(texts)

    def _sides(self) -> Iterator[str]:
        """Checks of the scalar blocks' sides; what counts as zero depends on the whole path."""
        for place, name in zip(self.program.scalar, self.program.determinants, strict=True):
            yield self.require(f"{name}*s{place} > 0.0")

    def _sum(self, operation: Sum) -> Iterator[str]:
        yield f"{operation.name} = {text_of(operation)}"

    def _call(self, operation: Call) -> Iterator[str]:
        if operation.function == "inverse":
            yield f"{operation.name} = 1.0/{operation.arguments[0]}"
        elif operation.function in ("sign", "direction"):
            value, rest = operation.arguments[0], rest_of(operation.function)
            yield f"{operation.name} = ({value} > {rest})*1.0 - ({value} < -{rest})*1.0"
        else:
            yield f"{operation.name} = {operation.function}({', '.join(operation.arguments)})"

    def _nearest(self, operation: Nearest) -> Iterator[str]:
        name, principal, near = operation
        yield f"{name} = {principal} + 2.0*pi*round(({near} - {principal})/(2.0*pi))"

    def _root(self, operation: Root) -> Iterator[str]:
        name, determinant, a, b, c, block = operation
        side, b, c = self.sides[block], text_of(b), text_of(c)
        yield f"{determinant} = {side}*sqrt({b}*{b} - {number(4.0 * a)}*({c}))"
        # Of the two forms of the root the one without cancellation.
        near, far = f"-2.0*{c}/({b} + {determinant})", f"({determinant} - {b})*{number(0.5 / a)}"
        if b == "0.0":
            yield f"{name} = {determinant}*{number(0.5 / a)}"
        elif self.scalar:
            yield f"{name} = {near} if {side}*{b} > 0.0 else {far}"
        else:
            yield f"{name} = where({side}*{b} > 0.0, {near}, {far})"

    def _factor(self, operation: Factor) -> Iterator[str]:
        yield from self.lines(operation.operations)
        if self.looping:  # what a weak pivot spoils there is seen by the steps
            return
        for name, bound in operation.guards:
            limit = number(bound)
            yield self.require(
                f"-{limit} < {name} < {limit}" if self.scalar else f"abs({name}) < {limit}"
            )

    def _solve(self, operation: Solve) -> Iterator[str]:
        yield from self.lines(operation.operations)
        for name, value in zip(operation.names, operation.values, strict=True):
            if name:
                yield f"{name} = {text_of(value)}"

    def _regular(self, operation: Regular) -> Iterator[str]:
        """See `exact.taylor`, of a loose block `exact.linear`."""
        matrix, determinant = operation.matrix, text_of(operation.determinant)
        if operation.loose:
            sizes = [self.largest(filter(None, row)) for row in matrix]
            yield self.require(f"abs({determinant}) > {'*'.join([number(WEAK), *sizes])}")
            return
        left = f"{determinant}*{self.sides[operation.block]}"
        columns = [self.largest(filter(None, column)) for column in zip(*matrix, strict=True)]
        whole = "*".join([number(SINGULAR), *columns])
        # The product of the columns' sizes is the larger bound, and mostly enough.
        shares = [
            self._most([f"abs({text_of(v)})/{columns[j]}" for j, v in enumerate(row) if v])
            for row in matrix
        ]
        bound = f"{whole}*{'*'.join(shares)}"
        if self.scalar:
            yield self.require(f"({left} > {whole} or {left} > {bound})")
        else:
            yield f"regular = {left} > {whole}"
            yield f"if not regular.all(): regular |= {left} > {bound}"
            yield "good &= regular"

    def _most(self, texts: list[str]) -> str:
        whole = texts[0]
        for other in texts[1:]:
            whole = f"maximum({whole}, {other})"
        return f"max({', '.join(texts)})" if self.scalar and len(texts) > 1 else whole

    def _newton(self, operation: Newton) -> Iterator[str]:
        names, changes = operation.names, operation.changes
        close = NEWTON_TOLERANCE if operation.loose else QUADRATIC
        for name, start in zip(names, operation.starts, strict=True):
            yield f"{name} = {text_of(start)}"
        yield f"for _ in range({NEWTON_ITERATIONS}):"
        self.looping = True
        for line in self.lines(operation.operations):
            yield "    " + line
        self.looping = False
        for name, change in zip(names, changes, strict=True):
            yield f"    {name} = {name} + {change}"
        yield f"    moved, size = {self.largest(changes)}, {self.largest(names)}"
        if self.scalar:
            yield f"    if moved <= {number(close)}*size: break"
            yield "else:"
            yield f"    if not moved <= {number(max(close, STALLED))}*size: return None"
        else:
            yield f"    if not ((moved > {number(close)}*size) & good).any(): break"
            yield f"good &= moved <= {number(max(close, STALLED))}*size"
