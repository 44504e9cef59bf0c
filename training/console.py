"""Terminal output that all subcommands share."""

import os

from rich.console import Console
from rich.text import Text

NARROW = 96
"""Columns below which a table of many numbers leaves some out."""
WIDE = 130
"""Columns to use where the output is not a terminal, whose width would be unknown."""


_silent = False


def silence(silent: bool) -> None:
    """Let consoles made from now on say nothing, or speak again."""
    global _silent
    _silent = silent


def console(*, stderr: bool = False) -> Console:
    """A console on the present stdout, or on stderr for what is not a command's result."""
    plain = Console(highlight=False, markup=False, stderr=stderr, quiet=_silent)
    if plain.is_terminal or "COLUMNS" in os.environ:
        return plain
    return Console(highlight=False, markup=False, width=WIDE, stderr=stderr, quiet=_silent)


def warning(text: str) -> Text:
    """Text to catch the eye."""
    return Text(text, style="bold red")


def verdict(good: bool) -> str | Text:
    """Cell of a table of goals: empty where the goal is reached."""
    return "" if good else warning("missed")
