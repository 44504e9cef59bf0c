"""Source text of formulas for one simulation, in plain floats; see `flatrig.envs.formulas`."""

from collections.abc import Callable
from math import inf, nan, sqrt
from struct import Struct
from typing import Any

import numpy as np

from ..models.types import Array

Operation = Callable[..., object]
"""Writes what it makes of each number of some rows into its last argument: an ufunc."""

Function = Callable[[Array, Array], object]
"""Makes of rows (n, width) others, which it writes into its second argument."""

DENSE = 4
"""Numbers of an array are read at once where so many or fewer lie there for each that is needed."""

SIGNS = {np.add: "+", np.subtract: "-", np.multiply: "*", np.divide: "/"}
"""How operations are written with floats."""
CALLS = {np.negative: "-", np.sqrt: "sqrt", np.abs: "abs"}


def pick_where_less(these: Array, one: Array, other: Array, otherwise: Array, out: Array) -> None:
    """Write some numbers where one is less than another, else others."""
    np.copyto(out, otherwise)
    np.copyto(out, these, where=one < other)


class Source:
    """The same formulas for one simulation, as source text of Python with plain floats."""

    def __init__(self) -> None:
        self._names: list[list[str]] = []
        """Of each value's numbers, or these themselves."""
        self._lines: list[str] = []
        self._last: list[str] = []
        self._seen: list[tuple[Array, dict[str, int]]] = []
        self._used: set[str] = set()
        self._outer: dict[str, object] = {}

    def see(self, flat: Array, columns: list[int]) -> None:
        """Numbers of a live array (1, width)."""
        names = self._fresh(len(columns))
        self._seen.append((flat[0], dict(zip(names, columns, strict=True))))

    def constant(self, numbers: list[float]) -> None:
        """Numbers as they are."""
        self._names.append([f"({number!r})" for number in numbers])

    def operation(self, function: Operation, of: list[int]) -> None:
        """A line for each number."""
        width = max(len(self._names[index]) for index in of)
        rows = [self._names[index] * (width if len(self._names[index]) == 1 else 1) for index in of]
        for name, operands in zip(self._fresh(width), zip(*rows, strict=True), strict=True):
            self._lines.append(f"{name} = {_written(function, *operands)}")
            self._used.update(operands)

    def take(self, index: int, columns: list[int]) -> None:
        """No line at all."""
        self._names.append([self._names[index][column] for column in columns])

    def join(self, indices: list[int]) -> None:
        """No line at all."""
        self._names.append([name for index in indices for name in self._names[index]])

    def apply(self, function: Function, index: int, width: int) -> None:
        """A call with NumPy's arrays."""
        before, after = np.empty((1, len(self._names[index]))), np.empty((1, width))
        self._lines += self._write(before[0], self._names[index])
        call, *arrays = (self._bind(item) for item in (function, before, after))
        self._lines.append(f"{call}({', '.join(arrays)})")
        names = self._fresh(width)
        self._lines += self._read(after[0], dict(zip(names, range(width), strict=True)))

    def keep(self, array: Array, index: int) -> None:
        """Numbers into a live array (1, width)."""
        self._last += self._write(array[0], self._names[index])

    def made(self, otherwise: Callable[[], None]) -> Callable[[], None]:
        """A function; `otherwise` is called in its place where it would divide by zero."""
        first = []
        for row, names in self._seen:
            used = {name: column for name, column in names.items() if name in self._used}
            first += self._read(row, used)
        other = self._bind(otherwise)
        text = [
            f"def make({', '.join(self._outer)}):", " def run():", "  try:",
            *(f"   {line}" for line in (*first, *self._lines, "pass")),
            "  except ZeroDivisionError:", f"   return {other}()",
            *(f"  {line}" for line in self._last), " return run",
        ]  # fmt: skip
        scope: dict[str, Any] = {"inf": inf, "nan": nan, "sqrt": sqrt}
        exec(compile("\n".join(text), "<formulas>", "exec"), scope)
        made: Callable[[], None] = scope["make"](*self._outer.values())
        return made

    def _read(self, row: Array, names: dict[str, int]) -> list[str]:
        """Lines that give numbers of a row names, by column."""
        if not names:
            return []
        first, last = min(names.values()), max(names.values())
        if last - first < DENSE * len(names) and row.flags.c_contiguous and len(names) > 1:
            of = {column: name for name, column in names.items()}
            every = [of.get(column, "_") for column in range(first, last + 1)]
            unpack = self._bind(Struct(f"{len(every)}d").unpack_from)
            return [f"{', '.join(every)} = {unpack}({self._bind(row.data)}, {8 * first})"]
        memory = self._bind(row.data)
        return [f"{name} = {memory}[{column}]" for name, column in names.items()]

    def _write(self, row: Array, names: list[str]) -> list[str]:
        """Lines that write numbers into a row."""
        self._used.update(names)
        if not names:
            return []
        memory = self._bind(row.data)
        if row.flags.c_contiguous:
            pack = self._bind(Struct(f"{len(names)}d").pack_into)
            return [f"{pack}({memory}, 0, {', '.join(names)})"]
        return [f"{memory}[{column}] = {name}" for column, name in enumerate(names)]

    def _bind(self, item: object) -> str:
        """A name for a thing from outside."""
        name = f"o{len(self._outer)}"
        self._outer[name] = item
        return name

    def _fresh(self, width: int) -> list[str]:
        """Names for the numbers of a new value."""
        self._names.append([f"x{len(self._names)}_{column}" for column in range(width)])
        return self._names[-1]


def _written(function: Operation, *operands: str) -> str:
    """An operation on floats."""
    if function in SIGNS:
        return f" {SIGNS[function]} ".join(operands)
    if function in CALLS:
        return f"{CALLS[function]}({operands[0]})"
    if function is pick_where_less:
        return "{} if {} < {} else {}".format(*operands)
    a, b = operands
    return f"{b} if {a} {'<' if function is np.maximum else '>'} {b} else {a}"
