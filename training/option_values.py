"""What options of several commands have in common: their types, and what numbers they may be."""

import math
from typing import Annotated

from tyro.conf import arg

from ..models.errors import OptionError

Output = Annotated[str, arg(aliases=("-o",), metavar="PATH")]
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
