"""The page of all reproduced figures: small pictures, tables, and what differs from print.

    flatrig reproduce all --page docs/reference/reproduced.md

Pictures go into a folder beside the page, named like it.
"""

import io
import tempfile
from collections.abc import Iterable
from pathlib import Path

from rich.console import Console
from rich.progress import track
from rich.table import Table

from ...models.files import replacing, write_text
from ..console import console
from .entry import Entry

WIDTH, COLOURS = 720, 64
"""Width of the pictures [pixels], and number of colours of their palette."""
COLUMNS = 110
"""Width of the tables in characters."""

INTRODUCTION = """# The sources' figures, computed anew

Y is Y. Yang's thesis (2016), K is B. Kiss's (2001). `flatrig reproduce NAME` makes a figure
large, with its numbers as CSV; `flatrig reproduce all --page docs/reference/reproduced.md` makes
this page.

A caption names the machine of the catalogue with all its numbers in SI units, the path, what is
compared, and where the result differs from print and why. Headings of panels have the source's
symbol first and the name in the code after it. Numerical curves of Y chapters 4 to 6 are implicit
Euler's, as in print, with the exact solution dotted. Curves that coincide are told apart by their
errors, on logarithmic axes. Rope multipliers are shown as tension over length, positive in a rope
that pulls; a sign or factor before the symbol says how the source counts it. Wall times are those
of one run on two cores.
"""


def write_page(path: Path, chosen: Iterable[Entry]) -> None:
    """Make entries, and write the page and its pictures.

    Raises
    ------
    OutputError
        A file cannot be written.
    """
    parts = [INTRODUCTION]
    with tempfile.TemporaryDirectory() as folder:
        for entry in track([*chosen], "Computing", transient=True, console=console()):
            summary, files = entry.run(Path(folder))
            heading = f"{entry.name}: {entry.title}"
            parts.append(f"## {heading}\n")
            parts += [f"{entry.caption}\n"] if entry.caption else []
            for picture in (file for file in files if file.suffix == ".png"):
                small = path.with_suffix("") / picture.name
                _shrink(picture, small)
                parts.append(f"![{heading}]({small.parent.name}/{small.name})\n")
            parts.append(f"```text\n{_text(summary)}\n```\n")
    write_text(path, "\n".join(parts))


def _shrink(large: Path, small: Path) -> None:
    from PIL import Image

    with Image.open(large) as picture, replacing(small) as beside:
        height = round(picture.height * WIDTH / picture.width)
        plain = picture.convert("RGB").resize((WIDTH, height), Image.Resampling.LANCZOS)
        reduced = plain.quantize(COLOURS, Image.Quantize.FASTOCTREE)  # others merge blue and green
        reduced.save(beside, "PNG", optimize=True)


def _text(summary: Table) -> str:
    paper = Console(file=io.StringIO(), width=COLUMNS, highlight=False, markup=False)
    paper.print(summary)
    lines = paper.file.getvalue().splitlines()  # type: ignore[attr-defined]
    return "\n".join(line.rstrip() for line in lines if line.strip())
