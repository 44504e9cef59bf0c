"""The points of a sampled path: rows of a CSV file, and what any table of points must be."""

import csv
import io
import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import PathError
from ...models.reading import read_text
from ...models.types import Array
from ...models.values import reals, shown
from ..checks import LARGEST, check_times

LARGEST_FILE = 256 * 2**20
"""Size beyond which a CSV file is no recording of a move [bytes]."""


def table_of(name: str, size: int | None) -> tuple[Array, Array]:
    """Times (N,) and points (N, size) of a CSV file, which may have to have so many columns.

    Raises
    ------
    PathError
        The file cannot be read, or a row or column of it cannot be used.
    """
    lines, rows = read_rows(name)
    if len(rows) < 2:
        raise PathError(f"{name} has {len(rows)} point(s), a path needs 2 or more")
    width = len(rows[0])
    if width < 2 or (size is not None and width != size + 1):
        needed = "at least one output" if size is None else f"{size} outputs"
        raise PathError(f"{name} has {width} columns, it needs a time and {needed}")
    for line, row in zip(lines, rows, strict=True):
        if len(row) != width:
            raise PathError(f"{name} line {line} has {len(row)} columns, the first has {width}")
    table = np.array(rows)
    times, points = table[:, 0], table[:, 1:]
    check_table(times, points, lambda index: f"{name} line {lines[index]}")
    return times, points


def read_rows(name: str) -> tuple[list[int], list[list[float]]]:
    """Line numbers and rows of numbers, without header and empty lines."""
    lines: list[int] = []
    rows: list[list[float]] = []
    reader = csv.reader(io.StringIO(read_text(name, PathError, largest=LARGEST_FILE)))
    header_allowed = True
    try:
        for row in reader:
            cells = [cell.strip() for cell in row]
            if not any(cells):
                continue
            numbers = [_parse(cell) for cell in cells]
            first, header_allowed = header_allowed, False
            if first and all(number is None for number in numbers):
                continue
            for column, (cell, number) in enumerate(zip(cells, numbers, strict=True), 1):
                if number is None:
                    raise PathError(
                        f"{name} line {reader.line_num}, column {column} is {shown(cell)}, "
                        f"it must be a number{_separator(cells)}"
                    )
            lines.append(reader.line_num)
            rows.append([number for number in numbers if number is not None])
    except csv.Error:
        raise PathError(f"{name} is not a CSV file, its lines must be numbers and commas") from None
    return lines, rows


def _separator(cells: list[str]) -> str:
    """What to do about columns that something else than a comma parts, for a message."""
    marks = {";": "semicolons", "\t": "tabs", " ": "spaces"}
    for mark, name in marks.items():
        if any(mark in cell for cell in cells):
            return f"; its columns must be parted by commas, not by {name}"
    return ""


def _parse(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None


def as_table(times: ArrayLike, points: ArrayLike) -> tuple[Array, Array]:
    """Times (N,) and points (N, size) as arrays of these shapes."""
    row = check_times(times)
    try:
        table = reals("points", points, error=PathError)
    except PathError:
        raise PathError("points must be numbers, of shape (N, size)") from None
    if table.ndim != 2 or table.shape[0] != len(row) or table.shape[1] == 0:
        raise PathError(
            f"points have shape {table.shape}, for {len(row)} times they need shape "
            f"({len(row)}, number of outputs)"
        )
    return row, table


def check_table(times: Array, points: Array, label: Callable[[int], str]) -> None:
    """Two rows or more, no number infinite or absurdly large, times increasing.

    `label` names a row.
    """
    if len(times) < 2:
        raise PathError(f"the path has {len(times)} point(s), it needs 2 or more")
    table = np.column_stack([times, points])
    for index, column in np.argwhere(~(np.abs(table) <= LARGEST))[:1]:
        value = table[index, column]
        rule = f"within +-{LARGEST:g}" if math.isfinite(value) else "finite"
        raise PathError(f"{label(index)}, column {column + 1} is {value:g}, it must be {rule}")
    for index in np.flatnonzero(np.diff(times) <= 0)[:1] + 1:
        raise PathError(
            f"{label(index)}: time {times[index]:g} s follows {times[index - 1]:g} s, "
            "times must increase"
        )
