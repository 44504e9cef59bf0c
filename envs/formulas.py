"""Arithmetic on rows of n simulations, written once: NumPy for many, plain floats for one.

NumPy takes a third of a microsecond for an operation on a few numbers, a float ten times less.  So
what happens in every step is written down once and made into either, with the same bits: both add,
multiply and divide in the order that is written here.

    step = Formulas(num)
    planned, measured = step.see(plan), step.see(encoders)      # live arrays (n, width)
    step.keep(errors, planned - measured)                       # what to write where
    run = step.made()
    run()                                                       # brings `errors` up to date

All that is seen is read before anything is kept.  The second operand of `largest` and `least` must
be a number; where the first is none, neither is the result.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import pairwise

import numpy as np

from ..models.types import Array
from .float_source import Function, Operation, Source, pick_where_less

LANES = 8
"""NumPy adds rows of so many numbers or more up in as many sums beside each other."""


class Value:
    """A row of numbers of each simulation, from formulas that are not carried out yet."""

    def __init__(self, of: "Formulas", index: int, width: int) -> None:
        self.of, self.index, self.width = of, index, width

    def __add__(self, other: "Value") -> "Value":
        return self.of.operation(np.add, self, other)

    def __sub__(self, other: "Value") -> "Value":
        return self.of.operation(np.subtract, self, other)

    def __mul__(self, other: "Value") -> "Value":
        return self.of.operation(np.multiply, self, other)

    def __truediv__(self, other: "Value") -> "Value":
        return self.of.operation(np.divide, self, other)

    def __neg__(self) -> "Value":
        return self.of.operation(np.negative, self)

    def __getitem__(self, columns: Sequence[int] | slice) -> "Value":
        return self.of.take(self, columns)

    def largest(self, other: "Value") -> "Value":
        """The larger of each two."""
        return self.of.operation(np.maximum, self, other)

    def least(self, other: "Value") -> "Value":
        """The smaller of each two."""
        return self.of.operation(np.minimum, self, other)

    def size(self) -> "Value":
        """Magnitudes."""
        return self.of.operation(np.abs, self)

    def where_less(self, one: "Value", other: "Value", otherwise: "Value") -> "Value":
        """These numbers where one is less than another, else others."""
        return self.of.operation(pick_where_less, self, one, other, otherwise)

    def root(self) -> "Value":
        """Square roots of numbers that are not negative."""
        return self.of.operation(np.sqrt, self)


class Formulas:
    """What to do with rows of `num` simulations, one after the other."""

    def __init__(self, num: int) -> None:
        self._num = num
        self._arrays: list[Array] = []
        """Where each value is, (n, width), when NumPy does it."""
        self._calls: list[Callable[[], object]] = []
        self._kept: list[tuple[Array, Array]] = []
        self._seen: dict[object, Value] = {}
        self._source = Source()

    def see(self, array: Array, columns: Sequence[int] | slice = slice(None)) -> Value:
        """Some columns of a live array (n, ...), behind each other."""
        flat = array.reshape(self._num, -1)
        assert np.shares_memory(flat, array) or not flat.size
        every = np.arange(flat.shape[1])[columns].tolist()
        key = flat.ctypes.data, flat.strides, tuple(every)
        if key not in self._seen:
            self._source.see(flat, every)
            self._seen[key] = self._picked(flat, every)
        return self._seen[key]

    def constant(self, numbers: object) -> Value:
        """The same numbers in all simulations, (width,) or one."""
        row = np.atleast_1d(np.asarray(numbers, float))
        self._source.constant(row.tolist())
        # NumPy is fastest where all operands have the same shape: constants are repeated.
        return self._new(np.tile(row, (self._num, 1)))

    def operation(self, function: Operation, *of: Value) -> Value:
        """An operation on each number; one number goes with many."""
        array = np.empty((self._num, max(value.width for value in of)))
        arrays = (self._arrays[value.index] for value in of)
        self._calls.append(partial(function, *arrays, out=array))
        self._source.operation(function, [value.index for value in of])
        return self._new(array)

    def take(self, value: Value, columns: Sequence[int] | slice) -> Value:
        """Some of a value's numbers."""
        every = np.arange(value.width)[columns].tolist()
        self._source.take(value.index, every)
        return self._picked(self._arrays[value.index], every)

    def join(self, values: Sequence[Value]) -> Value:
        """Values behind each other."""
        array = np.empty((self._num, sum(value.width for value in values)))
        parts = [self._arrays[value.index] for value in values]
        self._calls.append(partial(np.concatenate, parts, 1, array))
        self._source.join([value.index for value in values])
        return self._new(array)

    def apply(self, function: Function, value: Value, width: int) -> Value:
        """What a function of rows makes, the same with floats."""
        array = np.empty((self._num, width))
        self._calls.append(partial(function, self._arrays[value.index], array))
        self._source.apply(function, value.index, width)
        return self._new(array)

    def keep(self, array: Array, value: Value) -> None:
        """Write a value into a live array (n, width) when everything is known."""
        self._kept.append((array, self._arrays[value.index]))
        self._source.keep(array, value.index)

    def made(self) -> Callable[[], None]:
        """What carries all of it out."""
        calls: list[Callable[[], object]] = list(self._calls)
        calls += [partial(np.copyto, *pair) for pair in self._kept]

        def run() -> None:
            for call in calls:
                call()

        return self._source.made(run) if self._num == 1 else run

    def _picked(self, array: Array, columns: list[int]) -> Value:
        """Columns of an array, a view of it where one will do."""
        even = evenly(columns)
        if isinstance(even, slice):
            return self._new(array[:, even])
        taken = np.empty((self._num, len(columns)))
        self._calls.append(partial(np.take, array, np.array(columns, int), 1, taken, "clip"))
        return self._new(taken)

    def _new(self, array: Array) -> Value:
        self._arrays.append(array)
        return Value(self, len(self._arrays) - 1, array.shape[1])


def in_order(terms: Sequence[Value]) -> Value:
    """The sum of values, from the first to the last."""
    total, *others = terms
    for term in others:
        total = total + term
    return total


def row_sum(terms: Mapping[int, Value], size: int) -> Value:
    """The sum of a row of `size` entries, zero but for some, in NumPy's order of adding it up."""
    lanes: list[list[Value]] = [[] for _ in range(LANES)]
    whole = size - size % LANES if size >= LANES else 0
    for column, term in sorted(terms.items()):
        if column < whole:
            lanes[column % LANES].append(term)
    sums = [in_order(lane) if lane else None for lane in lanes]
    while len(sums) > 1:
        sums = [_both(*pair) for pair in zip(sums[::2], sums[1::2], strict=True)]
    left = [term for column, term in sorted(terms.items()) if column >= whole]
    return in_order([value for value in (*sums, *left) if value is not None])


def _both(one: Value | None, other: Value | None) -> Value | None:
    return one + other if one is not None and other is not None else one or other


def evenly(columns: list[int]) -> slice | list[int]:
    """The slice that picks these columns, so that a view will do; themselves if there is none."""
    steps = {after - before for before, after in pairwise(columns)}
    if len(steps) > 1 or min(steps, default=1) < 1:
        return columns
    step = steps.pop() if steps else 1
    return slice(columns[0], columns[-1] + 1, step) if columns else columns
