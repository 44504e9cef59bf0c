"""What can be reproduced: each figure or claim is registered where it is made.

    @entry("K3.19", "tracking and fixed set point: the boom", "The small crane along ...")
    def boom() -> Sheet:
        figure, axes = plots.figure(6.0, 4.0)
        sheets.panel(axes, "Boom", times, [angle], "[deg]", xlabel="time [s]")
        return Sheet(table("Boom", "", "largest"), figure, {"time": times, "angle": angle})

The function stands in any file of this folder.
"""

import importlib
import pkgutil
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rich.table import Table

from ...models.types import Array
from .. import plots
from ..tables import write_csv


@dataclass(frozen=True)
class Sheet:
    """What comes of reproducing something."""

    table: Table
    """Summary for the console."""
    figure: Any = None
    """Matplotlib's figure; None if nothing is drawn."""
    columns: Mapping[str, Array | Sequence[str]] = field(default_factory=dict)
    """Numbers of the figure by name, (N,) each; without any no CSV is written."""


@dataclass(frozen=True)
class Entry:
    """One thing that can be reproduced."""

    name: str
    """Source (K = Kiss 2001, Y = Yang 2016) and number of the figure, or what it is about."""
    title: str
    """What it shows, for the list."""
    make: Callable[[], Sheet]
    """Function that computes and draws it."""
    caption: str = ""
    """Machine, path, what is compared, and where and why the result differs from print."""

    def run(self, folder: Path) -> tuple[Table, list[Path]]:
        """Make it, and write `NAME.png` and `NAME.csv` as far as there is something to write.

        Returns
        -------
        Table
            Summary.
        list of Path
            Files that were written.

        Raises
        ------
        OutputError
            A file cannot be written.
        """
        sheet, files = self.make(), []
        if sheet.figure is not None:
            files.append(folder / f"{self.name}.png")
            plots.save(sheet.figure, files[-1])
        if sheet.columns:
            files.append(folder / f"{self.name}.csv")
            write_csv(files[-1], sheet.columns, zip(*sheet.columns.values(), strict=True), ".8g")
        return sheet.table, files


_REGISTERED: dict[str, Entry] = {}


def entry(
    name: str, title: str, caption: str = ""
) -> Callable[[Callable[[], Sheet]], Callable[[], Sheet]]:
    """Register the function below as what makes an entry."""

    def register(make: Callable[[], Sheet]) -> Callable[[], Sheet]:
        _REGISTERED[name] = Entry(name, title, make, caption)
        return make

    return register


def entries() -> dict[str, Entry]:
    """All entries by name in the order of their chapters and numbers."""
    for module in pkgutil.iter_modules([str(Path(__file__).parent)]):
        importlib.import_module(f".{module.name}", __package__)
    return {name: _REGISTERED[name] for name in sorted(_REGISTERED, key=_order)}


def _order(name: str) -> list[tuple[str, int]]:
    """What to sort by, so that K2.9 comes before K2.13."""
    return [(text, int(digits or 0)) for text, digits in re.findall(r"(\D+)(\d*)", name)]
