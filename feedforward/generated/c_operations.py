"""The operations of a program in C99."""

import textwrap
from collections.abc import Iterable, Iterator

from ..exact.linear import WEAK
from ..exact.nonlinear import NEWTON_ITERATIONS, NEWTON_TOLERANCE
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

WIDTH = 100
"""Columns of a line."""


class Operations:
    """Prints operations as statements; refusals are of the constants NAME_..."""

    def __init__(self, program: Program, upper: str) -> None:
        self.upper = upper
        self.sides = {block: f"state->side[{i}]" for i, block in enumerate(program.blocks)}
        self.guarded: set[int] = set()
        self.checked = set(_checked(program.operations))

    def statements(self, operations: Iterable[Operation], indent: int = 1) -> Iterator[str]:
        """Lines of C, wrapped."""
        for operation in operations:
            for line in getattr(self, f"_{type(operation).__name__.lower()}")(operation):
                yield from wrapped(line, indent)

    def _let(self, name: str, text: str) -> str:
        return f"const double {name} = {text};"

    def _refuse(self, good: str, status: str) -> str:
        return f"if (!({good})) return {self.upper}_{status};"

    def _sum(self, operation: Sum) -> Iterator[str]:
        yield self._let(operation.name, text_of(operation))

    def _call(self, operation: Call) -> Iterator[str]:
        arguments = ", ".join(operation.arguments)
        text = f"{operation.function}({arguments})"
        if operation.function == "inverse":
            text = f"1.0/{arguments}"
        elif operation.function in ("sign", "direction"):
            rest = rest_of(operation.function)
            text = f"(double)(({arguments} > {rest}) - ({arguments} < -{rest}))"
        yield self._let(operation.name, text)

    def _nearest(self, operation: Nearest) -> Iterator[str]:
        name, principal, near = operation
        turns = f"floor(({near} - {principal})/TURN + 0.5)"
        yield self._let(name, f"{principal} + TURN*{turns}")

    def _root(self, operation: Root) -> Iterator[str]:
        name, determinant, a, b, c, block = operation
        side, b, c = self.sides[block], text_of(b), text_of(c)
        if b == "0.0":
            yield self._let(determinant, f"{side}*sqrt({number(-4.0 * a)}*{c})")
            yield self._let(name, f"{number(0.5 / a)}*{determinant}")
            return
        yield self._let(determinant, f"{side}*sqrt({b}*{b} - {number(4.0 * a)}*{c})")
        near, far = f"-2.0*{c}/({b} + {determinant})", f"{number(0.5 / a)}*({determinant} - {b})"
        yield self._let(name, f"{side}*{b} > 0.0 ? {near} : {far}")

    def _factor(self, operation: Factor) -> Iterator[str]:
        for inner in operation.operations:
            yield from getattr(self, f"_{type(inner).__name__.lower()}")(inner)
        k, size, matrix = operation.number, len(operation.matrix), operation.matrix
        checked, determinant = k in self.checked, text_of(operation.determinant)
        if not operation.guards:
            if checked:
                yield self._let(f"det{k}", determinant)
            return
        self.guarded.add(k)
        good = " && ".join(f"fabs({name}) < {number(bound)}" for name, bound in operation.guards)
        yield f"const int weak{k} = !({good});"
        if checked:
            yield f"double det{k} = {determinant};"
        yield f"double lu{k}[{size * size}];"
        yield f"int row{k}[{size}];"
        yield f"if (weak{k}) {{"
        for i, values in enumerate(matrix):
            for j, value in enumerate(values):
                yield f"    lu{k}[{i * size + j}] = {text_of(value)};"
        yield f"    {f'det{k} = ' if checked else ''}factor({size}, lu{k}, row{k});"
        yield "}"

    def _solve(self, operation: Solve) -> Iterator[str]:
        k, size = operation.factor, len(operation.right)
        inner = [
            line
            for o in operation.operations
            for line in getattr(self, f"_{type(o).__name__.lower()}")(o)
        ]
        names = [name for name in operation.names if name]
        pairs = [p for p in zip(operation.names, operation.values, strict=True) if p[0]]
        if k not in self.guarded:
            yield from inner
            yield from (self._let(name, text_of(value)) for name, value in pairs)
            return
        yield f"double {', '.join(names)};"
        yield f"if (weak{k}) {{"
        yield f"    double b[{size}] = {{{', '.join(map(text_of, operation.right))}}};"
        yield f"    solve({size}, lu{k}, row{k}, b);"
        yield from (f"    {name} = b[{i}];" for i, name in enumerate(operation.names) if name)
        yield "} else {"
        yield from ("    " + line for line in inner)
        yield from (f"    {name} = {text_of(value)};" for name, value in pairs)
        yield "}"

    def _regular(self, operation: Regular) -> Iterator[str]:
        """See `exact.taylor`, of a loose block `exact.linear`."""
        matrix, determinant = operation.matrix, f"det{operation.factor}"
        if operation.loose:
            sizes = [self._largest([v for v in row if v]) for row in matrix]
            bound = "*".join([number(WEAK), *sizes])
            yield self._refuse(f"fabs({determinant}) > {bound}", "STRAIGHT")
            return
        columns = []
        for j, column in enumerate(zip(*matrix, strict=True)):
            columns.append(f"size{operation.factor}_{j}")
            yield self._let(columns[-1], self._largest([value for value in column if value]))
        whole = f"least{operation.factor}"
        yield self._let(whole, "*".join([number(SINGULAR), *columns]))
        shares = []
        for row in matrix:
            present = [(text_of(v), columns[j]) for j, v in enumerate(row) if v]
            shares.append(self._most([f"fabs({v})/{column}" for v, column in present]))
        left = f"{determinant}*{self.sides[operation.block]}"
        # The product of the columns' sizes is the larger bound, and mostly enough.
        yield self._refuse(f"{left} > {whole} || {left} > {whole}*{'*'.join(shares)}", "SINGULAR")

    def _largest(self, values: list[Value]) -> str:
        """The largest magnitude of some values."""
        names = list(dict.fromkeys(value for value in values if isinstance(value, str)))
        known = [abs(value) for value in values if not isinstance(value, str)]
        texts = [f"fabs({name})" for name in names]
        if known:
            texts.append(number(max(known)))
        return self._most(texts)

    def _most(self, texts: list[str]) -> str:
        whole = texts[0]
        for other in texts[1:]:
            whole = f"larger({whole}, {other})"
        return whole

    def _newton(self, operation: Newton) -> Iterator[str]:
        names, changes = operation.names, operation.changes
        for name, start in zip(names, operation.starts, strict=True):
            yield f"double {name} = {text_of(start)};"
        close = NEWTON_TOLERANCE if operation.loose else QUADRATIC
        yield "for (int i = 1;; ++i) {"
        for inner in operation.operations:
            lines = getattr(self, f"_{type(inner).__name__.lower()}")(inner)
            yield from ("    " + line for line in lines)
        for name, change in zip(names, changes, strict=True):
            yield f"    {name} += {change};"
        yield f"    const double moved = {self._largest(list(changes))};"
        yield f"    const double size = {self._largest(list(names))};"
        yield f"    if (moved <= {number(close)}*size) break;"
        yield f"    if (i == {NEWTON_ITERATIONS}) return {self.upper}_LOST;"
        yield "}"


def wrapped(line: str, indent: int) -> Iterator[str]:
    """A statement on as many lines as it needs."""
    inner = len(line) - len(line.lstrip())
    margin = " " * (4 * indent + inner)
    yield from textwrap.wrap(
        line.strip(),
        WIDTH,
        initial_indent=margin,
        subsequent_indent=margin + "    ",
        break_long_words=False,
        break_on_hyphens=False,
    )


def _checked(operations: Iterable[Operation]) -> Iterator[int]:
    """Numbers of the factors whose determinants are looked at."""
    for operation in operations:
        if isinstance(operation, Regular):
            yield operation.factor
        elif isinstance(operation, Newton):
            yield from _checked(operation.operations)
