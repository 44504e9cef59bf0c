"""`flatrig example`: files to begin with, those of the how-to pages and the catalogue's cranes."""

import sys
import textwrap
from pathlib import Path

from ...models import CATALOGUE, default_move, dumps, make
from ...models.errors import RigError, did_you_mean
from ...models.reading import read_text
from ..options import Example
from .documents import ROOT


def examples() -> dict[str, Path]:
    """The files that are described on how-to pages, by name."""
    return {path.stem: path for path in sorted((ROOT / "docs" / "how-to").glob("*.toml"))}


def example(name: str) -> str:
    """The text of an example, or a crane of the catalogue as a file.

    Raises
    ------
    RigError
        Neither has that name.
    """
    files = examples()
    plain = name.lower().replace("-", "_").removesuffix(".toml")
    for known, path in files.items():
        if plain in (known, known.removesuffix("_crane")):
            return read_text(path, RigError)
    short = [full.removesuffix("_crane") for full in (*files, *CATALOGUE)]
    if plain not in (*CATALOGUE, *short):
        known = dict.fromkeys((*short, *files, *CATALOGUE))
        raise RigError(f"there is no example {name!r}{did_you_mean(plain, known)}")
    return dumps(make(plain), default_move(CATALOGUE.full_name(plain)))


def show(command: Example) -> None:
    """Print an example, or the list of them.

    Raises
    ------
    RigError
        There is none of that name.
    """
    if command.name:
        sys.stdout.write(example(command.name))
        return
    for name, path in examples().items():
        print(textwrap.fill(f"{name:<16} {_summary(path)}", 79, subsequent_indent=" " * 17))
    print()
    print(textwrap.fill(f"and every crane of the catalogue: {', '.join(CATALOGUE)}", 79))


def _summary(path: Path) -> str:
    """The first sentence of the comment that a file begins with."""
    lines = read_text(path, RigError).splitlines()
    end = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    said = " ".join(line.lstrip("# ") for line in lines[:end])
    return said.partition(". ")[0].removesuffix(".")
