"""Tables as CSV: quoted where needed, written at once, and read back as they were."""

import csv
import math

import pytest

from flatrig.models.files import OutputError
from flatrig.training.tables import append_csv, csv_text, table, write_csv


def read(path):
    with path.open(newline="") as file:
        return list(csv.reader(file))


def test_cells_with_commas_and_quotes_come_back(tmp_path):
    path = tmp_path / "new" / "table.csv"
    write_csv(path, ("run, kind", "error"), [('a "good" one, fast', 0.1), ("two\nlines", 3)])
    assert read(path) == [
        ["run, kind", "error"],
        ['a "good" one, fast', "0.1"],
        ["two\nlines", "3"],
    ]
    assert [file.name for file in path.parent.iterdir()] == ["table.csv"]


def test_numbers_have_all_digits_or_the_form_and_none_is_empty():
    values = (1 / 3, None, math.nan, math.inf, 7, True)
    assert csv_text("abcdef", [values]) == f"a,b,c,d,e,f\n{1 / 3!r},,,inf,7,True\n"
    assert csv_text("abcdef", [values], ".3g") == "a,b,c,d,e,f\n0.333,,,inf,7,True\n"


def test_a_table_that_cannot_be_written_leaves_the_old_one(tmp_path):
    path = tmp_path / "table.csv"
    write_csv(path, ["a"], [[1]])
    with pytest.raises(ZeroDivisionError):
        write_csv(path, ["a"], ([1 / n] for n in (1, 0)))
    assert path.read_text() == "a\n1\n"
    with pytest.raises(OutputError):
        write_csv(path / "below", ["a"], [])


def test_rows_are_appended_below_one_line_of_names(tmp_path):
    for steps in (1, 2):
        append_csv(tmp_path / "log.csv", {"steps": steps, "note": "a, b"})
    assert read(tmp_path / "log.csv") == [["steps", "note"], ["1", "a, b"], ["2", "a, b"]]


def test_a_console_table_takes_its_rows():
    filled = table("Title", "name", "error", rows=[("a", "1"), ("b", "2")])
    assert [list(column.cells) for column in filled.columns] == [["a", "b"], ["1", "2"]]
    assert [column.justify for column in filled.columns] == ["left", "right"]
