"""What every reference path asks of its numbers, with one clear line where they fail."""

import math
import operator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..models.errors import PathError
from ..models.types import Array, Mask
from ..models.values import as_number, reals

SHORTEST, LONGEST = 1e-6, 1e9
"""Durations [s] whose powers, by which derivatives are divided, stay far from overflow."""

LARGEST = 1e12
"""Magnitude of a coordinate ([m], [rad]) beyond which nothing is known to a millimetre."""

FEW = 32
"""Up to so many truths Python is faster than NumPy."""

HIGHEST_DERIVATIVE = 30
"""That may be asked of a path, far more than any rig needs; its factors still do not overflow."""


def check_order(name: str, order: object, *, lowest: int = 0, highest: int | None = None) -> int:
    """The order of a path, or of the derivatives wanted from it.

    Raises
    ------
    PathError
        It is not a whole number, or out of range.
    """
    limits = f">= {lowest}" if highest is None else f"from {lowest} to {highest}"
    try:
        number = operator.index(order)  # type: ignore[arg-type]
    except TypeError:
        number = lowest - 1
    if isinstance(order, bool) or number < lowest or (highest is not None and number > highest):
        raise PathError(f"{name} is {order!r}, it must be a whole number {limits}")
    return number


def check_derivative(order: object) -> int:
    """The order of the highest derivative wanted from a path.

    Raises
    ------
    PathError
        It is not a whole number from 0 to 30.
    """
    return check_order("order of the derivatives", order, highest=HIGHEST_DERIVATIVE)


def check_duration(duration: object, name: str = "duration") -> float:
    """A time that something takes, in s.

    Raises
    ------
    PathError
        It is not a number > 0, or absurdly small or large.
    """
    number = as_number(duration)
    if not SHORTEST <= number <= LONGEST:
        strange = math.isnan(number) and not isinstance(duration, float)
        text = repr(duration) if strange else f"{number:g} s"
        raise PathError(f"{name} is {text}, it must be > 0 ({SHORTEST:g} s to {LONGEST:g} s)")
    return number


def check_point(name: str, point: Any) -> tuple[float, ...]:
    """A point of the path, one finite coordinate or more, none absurdly large.

    Raises
    ------
    PathError
        It is something else.
    """
    array = np.atleast_1d(reals(name, point, error=PathError))
    if array.ndim != 1 or array.size == 0 or not np.isfinite(array).all():
        value = point.tolist() if isinstance(point, np.ndarray) else point
        raise PathError(f"{name} is {value!r}, it must be one finite number for each output")
    if np.abs(array).max() > LARGEST:
        raise PathError(f"{name} is {tuple(array.tolist())}, it must be within +-{LARGEST:g}")
    return tuple(array.tolist())


def check_times(times: ArrayLike) -> Array:
    """Times as an array of shape (N,).

    Raises
    ------
    PathError
        A time is NaN or not a number, or they have another shape.
    """
    try:
        if isinstance(times, np.ndarray) and times.dtype == float and times.ndim == 1:
            array = times
        else:
            array = np.atleast_1d(reals("times", times, error=PathError))
    except PathError:
        raise PathError("times must be numbers in s, of shape (N,)") from None
    if array.ndim != 1:
        raise PathError(f"times have shape {array.shape}, they must have shape (N,)")
    if not every(array == array):
        missing = np.isnan(array)
        raise PathError(f"times[{int(missing.argmax())}] is NaN, it must be a time in s")
    return array


def every(mask: Mask) -> bool:
    """Whether all of a mask holds; of a few faster than NumPy's own."""
    return all(mask.ravel().tolist()) if mask.size <= FEW else bool(mask.all())
