"""Stored numbers of `flatrig regress`, and which of a run's are not within their band.

A number may differ from the stored one by a share of it, and by what rounding can do: another
processor adds in another order.  Times are not stored.
"""

import csv
import math
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import mujoco

from ...models.errors import OptionError
from ...models.files import write_text
from ..tables import csv_text

FILE = Path(__file__).parents[1] / "baselines" / "regress.csv"
"""The baseline that is shipped."""

HEAD = "# MuJoCo "
"""How its first line begins, before MuJoCo's version."""

SHARE = 0.05
"""Band about a stored number, as a share of it."""

ROUNDING = {"error": 2e-9, "arrival": 2e-9, "energy": 2e-9, "momentum": 2e-12}
"""Band about zero, for what another order of additions does: [m], [m], [J], and without unit."""

UNITS = {"error": " m", "arrival": " m", "energy": " J", "momentum": ""}

CEILINGS = {("rotary_crane", "RK4", 1e-2, "energy"): 1e-7}
"""What must hold whatever is stored: energy [J] of the free rotary crane, at the step of Y 2.10."""

Key = tuple[str, str, float, str]
"""Model, integrator, time step [s] and quantity."""


class Departure(NamedTuple):
    """A number out of its band."""

    key: Key
    value: float | None
    """Number of the run; None if it has none."""
    stored: float | None
    """Stored number; None if a ceiling is exceeded."""

    def __str__(self) -> str:
        """One line that names it."""
        quantity, where = self.key[3], name(self.key)
        unit = UNITS[quantity]
        if self.value is None:
            return f"{where} is missing, stored is {self.stored:.4g}{unit}"
        if self.stored is None:
            return f"{where} {self.value:.4g}{unit} is not below {CEILINGS[self.key]:g}{unit}"
        band = "" if math.isinf(self.stored) else f" +- {_band(quantity, self.stored):.1g}"
        return f"{where} {self.value:.4g}{unit}, stored is {self.stored:.4g}{band}{unit}"


def name(key: Key) -> str:
    """Where a number stands, in words."""
    model, integrator, step, quantity = key
    return f"{model}, {integrator}, {1e3 * step:g} ms: {quantity}"


def departures(
    numbers: dict[Key, float], stored: dict[Key, float], models: Iterable[str]
) -> list[Departure]:
    """Numbers of the models that left their band, in the stored order; new ones have none."""
    left = []
    for key, old in stored.items():
        new = numbers.get(key)
        if key[0] in models and (new is None or not _within(key[3], new, old)):
            left.append(Departure(key, new, old))
    for key, ceiling in CEILINGS.items():
        if key in numbers and not numbers[key] < ceiling:
            left.append(Departure(key, numbers[key], None))
    return left


def read(path: str | Path = FILE) -> tuple[dict[Key, float], str]:
    """Stored numbers, and the version of MuJoCo that made them.

    Raises
    ------
    OptionError
        There is no such file, or it is none.
    """
    try:
        first, *lines = Path(path).read_text(encoding="utf-8").splitlines()
        rows = list(csv.DictReader(lines))
        stored = {
            (row["model"], row["integrator"], float(row["step"]), quantity): float(row[quantity])
            for row in rows
            for quantity in ROUNDING
            if row[quantity]
        }
        if not (first.startswith(HEAD) and stored) or any(map(math.isnan, stored.values())):
            raise ValueError
    except OSError as error:
        raise OptionError(
            f"--baseline {path}: {error.strerror or error}; --update makes it"
        ) from None
    except (KeyError, ValueError, TypeError, AttributeError, csv.Error):
        raise OptionError(f"--baseline {path}: not a table of flatrig regress") from None
    return stored, first.removeprefix(HEAD)


def write(path: str | Path, numbers: dict[Key, float]) -> None:
    """Store a run's numbers, those of other models in the file kept.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    models = {key[0] for key in numbers}
    old = read(path)[0] if Path(path).exists() else {}
    table = {key: value for key, value in old.items() if key[0] not in models} | numbers
    rows = (
        (model, integrator, f"{step:g}",
         *(table.get((model, integrator, step, quantity)) for quantity in ROUNDING))
        for model, integrator, step in dict.fromkeys(key[:3] for key in table)
    )  # fmt: skip
    text = csv_text(("model", "integrator", "step", *ROUNDING), rows, ".4g")
    write_text(path, f"{HEAD}{mujoco.__version__}\n{text}")


def _within(quantity: str, new: float, old: float) -> bool:
    if math.isinf(old) or math.isinf(new):
        return new == old
    return abs(new - old) <= _band(quantity, old)


def _band(quantity: str, stored: float) -> float:
    return SHARE * abs(stored) + ROUNDING[quantity]
