"""`flatrig example`: files to begin with, of the how-to pages and of what is in the catalogues."""

import sys
import textwrap
from contextlib import suppress
from pathlib import Path

from ...models import (
    CATALOGUE,
    HAND_CATALOGUE,
    default_hand_move,
    default_move,
    dumps,
    dumps_hand,
    make,
    make_hand,
)
from ...models.errors import RigError, did_you_mean
from ...models.reading import read_text
from ..options import Example
from .documents import ROOT


def examples() -> dict[str, Path]:
    """The files that are described on how-to pages, by name."""
    return {path.stem: path for path in sorted((ROOT / "docs" / "how-to").glob("*.toml"))}


def example(name: str) -> str:
    """The text of an example, or a crane or hand of the catalogue as a file.

    Raises
    ------
    RigError
        None has that name.
    """
    files = examples()
    plain = name.lower().replace("-", "_").removesuffix(".toml")
    for stem, path in files.items():
        if plain in (stem, stem.removesuffix("_crane")):
            return read_text(path, RigError)
    for catalogue in (CATALOGUE, HAND_CATALOGUE):
        with suppress(RigError):
            return _described(catalogue.full_name(name))
    known = dict.fromkeys((*files, *CATALOGUE, *HAND_CATALOGUE))
    short = {stem.removesuffix("_crane"): None for stem in known}
    raise RigError(f"there is no example {name!r}{did_you_mean(plain, short | known)}")


def _described(name: str) -> str:
    """A crane or hand of the catalogue as TOML."""
    if name in HAND_CATALOGUE:
        hand = make_hand(name)
        return dumps_hand(hand, default_hand_move(hand))
    rig = make(name)
    return dumps(rig, default_move(rig))


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
    print(
        textwrap.fill(
            f"and what is in the catalogue: {', '.join((*CATALOGUE, *HAND_CATALOGUE))}", 79
        )
    )


def _summary(path: Path) -> str:
    """The first sentence of the comment that a file begins with."""
    lines = read_text(path, RigError).splitlines()
    end = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    said = " ".join(line.lstrip("# ") for line in lines[:end])
    return said.partition(". ")[0].removesuffix(".")
