"""What options of several commands have in common: their types, and what numbers they may be."""

import math
from pathlib import Path
from typing import Annotated

from tyro.conf import arg

from ..models.errors import OptionError
from ..models.files import is_standard_output

Output = Annotated[str, arg(aliases=("-o",), metavar="PATH")]
"""A file if it ends as one of `FILES` does, else a folder: see `output_file`, `output_folder`."""
FILES = (
    ".csv", ".gif", ".html", ".json", ".md", ".mp4", ".npz", ".pdf", ".png", ".svg", ".toml",
    ".xml",
)  # fmt: skip
"""Ends of names of files."""
Target = Annotated[str, arg(metavar="PATH")]
"""A file that has an option of its own, beside or instead of the output."""
Json = Annotated[bool, arg(name="json", help="Print JSON for scripts instead of tables.")]
"""Its keys are described in docs/reference/command_line.md."""


On = Annotated[str, arg(metavar="{local,ray,slurm}")]
"""Where the work is done, by the names in `flatrig.training.jobs.choice`."""


def check_number(
    name: str, value: float, *, lowest: float = 0.0, open_end: bool = True, unit: str = ""
) -> None:
    """Refuse an option that is not a finite number above (or at) its lowest value.

    Raises
    ------
    OptionError
        With the value and what would be right.
    """
    good = math.isfinite(value) and (value > lowest if open_end else value >= lowest)
    if not good:
        text = f"{value:g} {unit}".strip()
        raise OptionError(f"{name} is {text}, it must be {'>' if open_end else '>='} {lowest:g}")


def output_file(output: str, name: str) -> str:
    """Where a command writes its one file.

    Parameters
    ----------
    output
        What was asked for: a file, "-" for standard output, or a folder.
    name
        Of the file in that folder.
    """
    if not output or is_standard_output(output) or Path(output).suffix:
        return output
    return str(Path(output) / name)


def output_folder(output: str, otherwise: str) -> Path:
    """Where a command writes its files, `otherwise` if nothing is said.

    Raises
    ------
    OptionError
        A file is named.
    """
    if Path(output).suffix.lower() in FILES:
        raise OptionError(f"--output {output}: several files are written, name a folder for them")
    return Path(output or otherwise)
