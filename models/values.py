"""Turn what a user gives into plain numbers, vectors and names, or say what is wrong with it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from numbers import Real
from typing import Any, Literal, TypeGuard, get_origin

import numpy as np
from numpy.typing import ArrayLike

from .errors import FlatrigError, ModelError, OptionError, RigError
from .types import Array

Vector = tuple[float, float, float]

LARGEST = 1e12
"""Numbers beyond it are taken for a mistake in units."""

LONGEST_SHOWN = 80
"""Characters of a wrong value that a message shows."""

LONGEST_NAME = 64
"""Characters of a name; files are called after it."""

ENDLESS = {"endless": True}
"""Metadata of a dataclass's field that may be infinite."""


def is_number(value: object) -> TypeGuard[float]:
    """Whether it is a real number: int, float, Fraction or NumPy scalar, but no truth value."""
    if type(value) is float:  # mostly, and faster
        return True
    return isinstance(value, Real) and not isinstance(value, bool)


def as_number(value: object) -> float:
    """A real number as a float, and NaN for anything else, which then passes no comparison."""
    if not is_number(value):
        return math.nan
    try:
        return float(value)
    except OverflowError:  # an integer of hundreds of digits
        return math.inf if value > 0 else -math.inf


def shown(value: object) -> str:
    """What somebody gave, for a message: on one line, and cut off where it is long."""
    try:
        text = " ".join(repr(value).split())
    except RecursionError:  # tables in tables in tables
        return f"a deeply nested {type(value).__name__}"
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 4]} ..."


def reals(label: str, value: ArrayLike, *, error: type[FlatrigError] = ModelError) -> Array:
    """An array of floats from real numbers as `is_number` has them, in any array-like.

    They may be infinite or NaN.  An array of floats comes back as it is, not as a copy.

    Raises
    ------
    FlatrigError
        An entry is something else, or rows differ in length; of class `error`.
    """
    try:
        array = np.asarray(value)
    except (TypeError, ValueError, RuntimeError):  # ragged rows, or a tensor that says no
        raise error(f"{label} is {shown(value)}, it must be numbers, as many in each row") from None
    if array.dtype.kind == "O" and all(is_number(entry) for entry in array.flat):
        flat = [as_number(entry) for entry in array.flat]
        array = np.array(flat, dtype=np.float64).reshape(array.shape)
    if array.dtype.kind not in "iuf":
        raise error(f"{label} is {shown(value)}, it must be finite numbers")
    return np.asarray(array, dtype=np.float64)


def bounded(
    label: str,
    value: object,
    *,
    above: float = -math.inf,
    least: float = -math.inf,
    most: float = math.inf,
    whole: bool = False,
    unit: str = "",
    rule: str = "",
    error: type[FlatrigError] = OptionError,
) -> float:
    """A finite number > `above`, >= `least` and <= `most`.

    Parameters
    ----------
    whole
        Whether it has to be a whole number, which may be written as 4.0.
    unit
        Unit of the value, for the message.
    rule
        What it must be, for the message; made from the bounds if left out.

    Raises
    ------
    FlatrigError
        It is none; of class `error`.
    """
    plain = as_number(value)
    fits = above < plain and least <= plain <= most
    if math.isfinite(plain) and fits and not (whole and plain % 1.0):
        return plain
    limits = {f"> {above:g}": above, f">= {least:g}": least, f"at most {most:g}": most}
    bounds = " and ".join(bound for bound, limit in limits.items() if math.isfinite(limit))
    rule = rule or f"a {'whole' if whole else 'finite'} number {bounds}".rstrip()
    text = f"{value} {unit}".rstrip() if is_number(value) else shown(value)
    raise error(f"{label} is {text}, it must be {rule}")


def number(label: str, value: object, *, endless: bool = False) -> float:
    """A number of a rig or a hand, finite and not absurdly large; also infinite if `endless`.

    Raises
    ------
    RigError
        It is none.
    """
    if not is_number(value):
        raise RigError(f"{label} is {shown(value)}, it must be a number")
    plain = as_number(value)
    if math.isinf(plain) and endless:
        return plain
    if not abs(plain) <= LARGEST:
        raise RigError(f"{label} is {plain:g}, it must be finite and at most {LARGEST:g} in size")
    return plain


def whole(label: str, value: object) -> int:
    """A whole number, also one written as 4.0.

    Raises
    ------
    RigError
        It is not a whole number.
    """
    plain = number(label, value)
    if not plain.is_integer():
        raise RigError(f"{label} is {plain:g}, it must be a whole number")
    return int(plain)


def truth(label: str, value: object) -> bool:
    """A truth value.

    Raises
    ------
    RigError
        It is none.
    """
    if not isinstance(value, bool | np.bool_):
        raise RigError(f"{label} is {shown(value)}, it must be true or false")
    return bool(value)


def word(label: str, value: object) -> str:
    """A name.

    Raises
    ------
    RigError
        It is not a text.
    """
    if not isinstance(value, str):
        raise RigError(f"{label} is {shown(value)}, it must be a name")
    return value


def plain_name(label: str, value: object) -> str:
    """A name that files, columns and models can carry: `LONGEST_NAME` plain characters at most.

    Raises
    ------
    RigError
        It is none.
    """
    text = word(label, value)
    if not text.replace("_", "a").replace("-", "a").isalnum() or len(text) > LONGEST_NAME:
        rule = f"1 to {LONGEST_NAME} letters, digits, '-' and '_' only"
        raise RigError(f"{label} is {shown(text)}, it must be {rule}")
    return text


def sequence(label: str, value: object) -> tuple[Any, ...]:
    """A tuple from a list, tuple or array.

    Raises
    ------
    RigError
        It is something else.
    """
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise RigError(f"{label} is {shown(value)}, it must be a list")
    return tuple(value)


def vector(label: str, value: object) -> Vector:
    """Three finite numbers.

    Raises
    ------
    RigError
        They are not three finite numbers.
    """
    values = sequence(label, value)
    if len(values) != 3:
        raise RigError(f"{label} has {len(values)} numbers, it needs 3")
    x, y, z = (number(label, item) for item in values)
    return (x, y, z)


def clean(part: Any) -> None:
    """Make the fields of a frozen dataclass what their annotations say.

    Raises
    ------
    RigError
        A value is not what its field needs.
    """
    kind_of_part = type(part).__name__.lower()
    if hasattr(part, "name"):
        plain_name(f"{kind_of_part}: name", part.name)  # before any message takes it up
    owner = f"{kind_of_part} {getattr(part, 'name', getattr(part, 'at', ''))}"
    for item in fields(part):
        kind: Any = item.type
        value = getattr(part, item.name)
        if value is item.default or (type(value) is kind is float and abs(value) <= LARGEST):
            continue  # as most are
        label = f"{owner}: {item.name}"
        if kind is float:
            plain: object = number(label, value, endless="endless" in item.metadata)
        elif kind == float | None:
            plain = None if value is None else number(label, value)
        elif kind is bool:
            plain = truth(label, value)
        elif kind == Vector:
            plain = vector(label, value)
        elif kind is str or (get_origin(kind) is Literal and isinstance(kind.__args__[0], str)):
            plain = word(label, value)
        elif kind == tuple[str, ...]:
            plain = tuple(word(label, entry) for entry in sequence(label, value))
        elif kind == tuple[float, ...]:
            plain = tuple(number(label, entry) for entry in sequence(label, value))
        elif kind == float | tuple[float, ...]:
            many = isinstance(value, Sequence | np.ndarray) and not isinstance(value, str)
            entries = sequence(label, value) if many else (value,)
            numbers = tuple(number(label, entry) for entry in entries)
            plain = numbers if many else numbers[0]
        elif get_origin(kind) is tuple:  # of parts
            plain = sequence(label, value)
            for entry in plain:
                if not isinstance(entry, kind.__args__[0]):
                    needed = getattr(kind.__args__[0], "__name__", str(kind.__args__[0]))
                    raise RigError(f"{label} holds {shown(entry)}, it must be a {needed}")
        elif isinstance(kind, type) and is_dataclass(kind):
            if not isinstance(value, kind):
                raise RigError(f"{label} is {shown(value)}, it must be a {kind.__name__}")
            plain = value
        elif kind is int:
            plain = whole(label, value)
        elif kind == Literal[2, 3]:
            plain = value
        else:
            plain = Home(value, item.name)
        object.__setattr__(part, item.name, plain)


class Home(Mapping[str, float | Vector]):
    """An immutable mapping from names of parts to a position or (x, y, z), or to numbers."""

    def __init__(self, values: Mapping[str, object], what: str = "home") -> None:
        kind = "positions" if what == "home" else "numbers"
        if not isinstance(values, Mapping):
            raise RigError(f"{what} is {shown(values)}, it must map names to {kind}")
        self._values: dict[str, float | Vector] = {}
        for name, value in values.items():
            label = f"{what} of {word(f'a name in {what}', name)}"
            read = number if is_number(value) else vector
            self._values[name] = read(label, value)

    def __getitem__(self, name: str) -> float | Vector:
        return self._values[name]

    def __iter__(self) -> Any:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __hash__(self) -> int:
        return hash(frozenset(self._values.items()))

    def __repr__(self) -> str:
        return repr(self._values)
