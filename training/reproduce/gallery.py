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
Numerical curves of Y chapters 4 to 6 are implicit Euler's, as in print, with the exact solution
dotted; wall times are those of one run on two shared cores.
"""

NOTES = {
    ("Y4.3", "Y4.4", "Y4.8", "Y4.9"): (
        "In print the formulation ALT is off by about 0.1. Here it equals GEN in the inputs, "
        "and to rounding in the coordinates. Y 4.106 has the wrong Coriolis signs of Y 5.75, "
        "but with them the inputs would be off by 4.7 N m and 3.4 N, so they do not explain "
        "the 0.1."
    ),
    ("Y4.6",): (
        "The printed coefficients 14/2 and 7/2 do not join the phases; 14 and 7 do, and the "
        "third phase has the opposite sign."
    ),
    ("Y5.12", "Y5.13", "Y5.14", "Y5.15"): (
        "In the printed layout winch 1 has to push with the load's weight all along; the "
        "catalogue's crane has it at the other end of the girder."
    ),
    ("Y6.2", "Y6.3", "Y6.4", "Y6.5"): (
        "The tagline has to push, down to -442 N at 2 s: pulling ropes need 4.06 s. The start "
        "is a singular place, taken here as the limit of the motion."
    ),
    ("Y6.7", "Y6.8", "Y6.9", "Y6.10"): (
        "The tagline has to push, down to -9177 N, and with 231 N even at rest at the goal. "
        "Coordinates do not depend on the step, inputs do."
    ),
    ("Y6.16", "Y6.17"): (
        "The index is 7 and the path would need six derivatives; the printed one has four. "
        "The boom's torque jumps where its pieces join, and the jump grows as the step "
        "shrinks. The suspension rope has to push, down to -405 N."
    ),
    ("Y6.21", "Y6.25", "Y6.27"): (
        "The platform's side is not printed and follows from the initial configuration (1.2 "
        "m); the winches' inertias are not printed either and are set to the printed J1, J2, "
        "J3, which are the platform's. z points up here: alpha and beta have the other sign."
    ),
    ("K3.13", "K3.15", "K3.17", "K3.21"): (
        "The pulley's mass and height, the boom's inertia, the gains and the duration of K "
        "3.13 are not printed; `training/reproduce/kiss_crane.py` says what is assumed."
    ),
}
"""What differs from print and why, for figures by name."""


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
            parts += [f"{note}\n" for names, note in NOTES.items() if entry.name in names]
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
