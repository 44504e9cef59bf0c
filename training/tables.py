"""Tables, written as CSV files and shown on the console.

    write_csv("runs.csv", ("run", "error [m]"), [("Euler, 1 ms", 1e-3), ("RK4, 1 ms", None)], ".6g")
    console().print(table("Runs", "run", "error [m]", rows=[("Euler, 1 ms", "1e-3")]))

A text with a comma or a quotation mark stands in quotation marks.
"""

import csv
import io
import math
from collections.abc import Iterable, Mapping
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from ..models.files import append_text, write_text


def write_csv(
    path: str | Path, columns: Iterable[str], rows: Iterable[Iterable[object]], form: str = ""
) -> None:
    """Write a table with a line of column names; nothing half-written is left behind.

    Parameters
    ----------
    path
        File to write; its folder is made.
    columns
        Names of the columns.
    rows
        Cells of each row.
    form
        Format of floating-point numbers (".6g"); all their digits if left out.  None and NaN make
        empty cells.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    write_text(path, csv_text(columns, rows, form))


def csv_text(columns: Iterable[str], rows: Iterable[Iterable[object]], form: str = "") -> str:
    """A table as `write_csv` writes it."""
    return _lines([columns, *([_cell(value, form) for value in row] for row in rows)])


def append_csv(path: Path, row: Mapping[str, object]) -> None:
    """Add a row to a file, its column names first if the file is new or empty.

    Raises
    ------
    OutputError
        It cannot be written.
    """
    columns = [] if path.exists() and path.stat().st_size else [row.keys()]
    append_text(path, _lines([*columns, row.values()]))


def _lines(rows: Iterable[Iterable[object]]) -> str:
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def _cell(value: object, form: str) -> object:
    if isinstance(value, float):
        return "" if math.isnan(value) else format(value, form)
    return value  # the writer leaves the cell of None empty


def table(
    title: str, *columns: str, rows: Iterable[Iterable[str | Text]] = (), right: bool = True
) -> Table:
    """A table for the console; all columns but the first are flush right if `right`."""
    result = Table(title=title, box=SIMPLE_HEAD, title_justify="left", title_style="bold")
    for i, column in enumerate(columns):
        result.add_column(column, justify="right" if i and right else "left")
    for row in rows:
        result.add_row(*row)
    return result
