"""What summaries of a move have in common, of a crane as of a hand."""

import math
from collections.abc import Iterable

import numpy as np
from rich.table import Table
from rich.text import Text

from ...models.errors import OptionError
from ...models.types import Array
from ..console import console, warning
from ..options import check_number
from ..tables import table

ROUNDED = 1e-12
"""Share by which a whole number of periods may be too large through rounding."""
RANGE = ("start", "end", "lowest", "highest")
"""Headings of the cells that `range_cells` makes."""


def sample_times(duration: float, rate: float, most: int) -> Array:
    """Instants from 0 to the end of a path [s], shape (N,), all one period apart.

    The last one is the first at which the goal is reached, to rounding: where the duration is not
    a whole number of periods it lies up to one of them beyond, where the path is at rest.

    Parameters
    ----------
    duration
        Duration of the path [s].
    rate
        Samples per second [Hz].
    most
        Largest N.

    Raises
    ------
    OptionError
        The rate is not a finite number > 0, or makes too many samples.
    """
    check_number("--rate", rate, unit="Hz")
    if duration * rate > most:
        raise OptionError(
            f"--rate is {rate:g} Hz, which makes {duration * rate:.3g} samples; "
            f"it must be <= {most / duration:g} Hz"
        )
    periods = math.ceil(duration * rate * (1.0 - ROUNDED))
    return np.arange(periods + 1) / rate


def facts(title: str, rows: Iterable[tuple[str, ...]], *, right: bool = False) -> Table:
    """A table without headings."""
    rows = list(rows)
    plain = table(title, *[""] * len(rows[0]), rows=rows, right=right)
    plain.show_header = False
    return plain


def range_cells(values: Array, digits: int = 5) -> tuple[str, ...]:
    """First, last, lowest and highest of some values (N,), without rounding's noise about 0."""
    numbers = (values[0], values[-1], values.min(), values.max())
    return tuple(f"{number + 0.0:.{digits}g}" for number in np.round(numbers, 9))  # no "-0"


def add_input(rows: Table, label: str, values: Array, low: float, high: float) -> bool:
    """Add the range of an input (N,) beside its limits; returns whether it stays within."""
    within = bool(low <= values.min() and values.max() <= high)
    limit = f"±{high:.5g}" if low == -high else f"{low:.5g} to {high:.5g}"
    note: Text | str = "" if within else warning("beyond its limit")
    rows.add_row(label, *range_cells(values), limit, note)
    return within


def point(values: Iterable[float], digits: int = 6) -> str:
    """Some numbers as a point, "(5, -1)"."""
    return f"({', '.join(f'{value:.{digits}g}' for value in values)})"


def show_verdict(feasible: bool, condition: str = "") -> None:
    """Print whether a move can be made, and on which condition that is said."""
    condition = f" {condition}" if condition else ""
    console().print(
        f"The move is feasible{condition}." if feasible else warning("The move is not feasible.")
    )
