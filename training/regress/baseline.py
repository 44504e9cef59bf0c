"""Stored numbers of `flatrig regress` with their bands, and which of a run's have left them.

A band is what rounding can do to its number, measured when the number was stored: see
`quantities.bands`.  Times are not stored.
"""

import csv
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import mujoco

from ...models.errors import OptionError
from ...models.files import write_text
from ..tables import csv_text
from .quantities import QUANTITIES

FILE = Path(__file__).parents[1] / "baselines" / "regress.csv"
"""The baseline that is shipped."""

HEAD = "# MuJoCo "
"""How its first line begins, before MuJoCo's version."""

CEILINGS = {("rotary_crane", "RK4", 1e-2, "energy"): 1e-7}
"""What must hold whatever is stored: energy [J] of the free rotary crane, at the step of Y 2.10."""

Key = tuple[str, str, float, str]
"""Model, integrator, time step [s] and quantity."""


class Stored(NamedTuple):
    """A number with its band."""

    value: float
    """The number; infinite if the run is lost."""
    band: float
    """How far another run's may be from it; infinite if it does not repeat at all."""

    def holds(self, value: float) -> bool:
        """Whether a run's number is in the band."""
        if math.isinf(self.band):
            return True
        return value == self.value or abs(value - self.value) <= self.band


class Departure(NamedTuple):
    """A number out of its band."""

    key: Key
    value: float | None
    """Number of the run; None if it has none."""
    stored: Stored | None
    """Stored number; None if a ceiling is exceeded."""

    def __str__(self) -> str:
        """One line that names it."""
        where, unit = name(self.key), QUANTITIES[self.key[3]].unit
        unit = f" {unit}" if unit else ""
        if self.stored is None:
            return f"{where} {self.value:.4g}{unit} is not below {CEILINGS[self.key]:g}{unit}"
        if self.value is None:
            return f"{where} is missing, stored is {self.stored.value:.9g}{unit}"
        band = f" +- {self.stored.band:.2g}" if self.stored.band else ""
        return f"{where} {self.value:.9g}{unit}, stored is {self.stored.value:.9g}{band}{unit}"

    @property
    def size(self) -> float:
        """How far it is out, over the stored number; infinite if there is nothing to compare."""
        if self.value is None or self.stored is None:
            return math.inf
        away = abs(self.value - self.stored.value)
        return away / abs(self.stored.value) if self.stored.value else math.inf


def name(key: Key) -> str:
    """Where a number stands, in words."""
    model, integrator, step, quantity = key
    return f"{model}, {integrator}, {1e3 * step:g} ms: {quantity}"


def departures(
    numbers: Mapping[Key, float], stored: Mapping[Key, Stored], models: Iterable[str]
) -> list[Departure]:
    """Numbers of the models that left their band, in the stored order; new ones have none."""
    left = []
    for key, old in stored.items():
        new = numbers.get(key)
        if key[0] in models and (new is None or not old.holds(new)):
            left.append(Departure(key, new, old))
    for key, ceiling in CEILINGS.items():
        if key in numbers and not numbers[key] < ceiling:
            left.append(Departure(key, numbers[key], None))
    return left


def read(path: str | Path = FILE) -> tuple[dict[Key, Stored], str]:
    """Stored numbers, and the version of MuJoCo that made them.

    Raises
    ------
    OptionError
        There is no such file, or it is none.
    """
    try:
        first, *lines = Path(path).read_text(encoding="utf-8").splitlines()
        stored = dict(map(_entry, csv.DictReader(lines)))
        if not (first.startswith(HEAD) and stored):
            raise ValueError
    except OSError as error:
        raise OptionError(
            f"--baseline {path}: {error.strerror or error}; --update makes it"
        ) from None
    except (KeyError, ValueError, TypeError, AttributeError, csv.Error):
        raise OptionError(
            f"--baseline {path}: not a table of flatrig regress; --update to another file makes one"
        ) from None
    return stored, first.removeprefix(HEAD)


def write(path: str | Path, numbers: Mapping[Key, Stored]) -> None:
    """Store a run's numbers, those of other models in the file kept.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    models = {key[0] for key in numbers}
    old = read(path)[0] if Path(path).exists() else {}
    table = {key: value for key, value in old.items() if key[0] not in models} | dict(numbers)
    rows = (
        (model, integrator, f"{step:g}", quantity, f"{value:.9g}", f"{band:.2g}")
        for (model, integrator, step, quantity), (value, band) in table.items()
    )
    text = csv_text(("model", "integrator", "step", "quantity", "value", "band"), rows)
    write_text(path, f"{HEAD}{mujoco.__version__}\n{text}")


def _entry(row: Mapping[str, str]) -> tuple[Key, Stored]:
    """A line of the file; a ValueError, KeyError or TypeError if it is none."""
    value, band = float(row["value"]), float(row["band"])
    if row["quantity"] not in QUANTITIES or math.isnan(value) or not band >= 0:
        raise ValueError
    key = row["model"], row["integrator"], float(row["step"]), row["quantity"]
    return key, Stored(value, band)
