"""Terminal output that all subcommands share."""

import os

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

WIDE = 130
"""Columns to use where the output is not a terminal, whose width would be unknown."""


def console() -> Console:
    """A console on the present stdout."""
    plain = Console(highlight=False, markup=False)
    if plain.is_terminal or "COLUMNS" in os.environ:
        return plain
    return Console(highlight=False, markup=False, width=WIDE)


def table(title: str, *columns: str, right: bool = True) -> Table:
    """An empty table; all columns but the first are flush right if `right`."""
    made = Table(title=title, box=SIMPLE_HEAD, title_justify="left", title_style="bold")
    for i, column in enumerate(columns):
        made.add_column(column, justify="right" if i and right else "left")
    return made


def warning(text: str) -> Text:
    """Text to catch the eye."""
    return Text(text, style="bold red")
