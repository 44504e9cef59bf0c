"""`flatrig regress`: every crane and hand, every integrator of MuJoCo, a ladder of time steps.

    flatrig regress                 # all; exit status 1 if a number left its band
    flatrig regress rotary          # one
    flatrig regress --resume        # go on after an interruption
    flatrig regress --update        # store numbers and measured bands instead of comparing

A crane makes its move under exact feedforward, and then moves freely (`crane_rows`); a hand rolls
and holds its object (`hand_rows`); no display is needed.  What the runs cost stands beside it
and is never compared.

The same numbers come again on one machine; another one rounds differently, and what that does to a
number depends on how sensitive its run is.  So `--update` repeats every run with noise as large as
that rounding and stores with each number the band that follows (`quantities`).

A number that left its band says that MuJoCo computes something else than when it was stored, or
that a model, a move or the feedforward did change.  A run that breaks down, that loses its object,
or that ends further than `crane_rows.LOST` from its path, has infinite errors, and must have them.
"""

from collections.abc import Sequence
from pathlib import Path

import mujoco

from ...models import CATALOGUE, HAND_CATALOGUE, default_move, full_name, make
from ...models.files import make_folder
from ...models.hand.catalogue import default_hand_move, full_hand_name, make_hand
from ...models.mjcf.simulate import quiet
from .. import options
from ..console import console, warning
from ..jobs import Backend, Jobs, Processes, backend_for, record
from ..look_up import is_hand
from ..option_values import output_folder
from ..simulate.drift import free_motion
from ..tables import write_csv
from . import baseline, crane_rows, hand_rows, regression_figures, regression_tables
from .baseline import Departure, Key, Stored
from .quantities import QUANTITIES
from .row import Row

FOLDER = "results/regress"
MOST_NAMED = 20
"""Departures that are named on the console, the largest first; all are in the CSV."""

Unit = tuple[str, float, bool]
"""Name of a model, time step [s], and whether to repeat the runs with noise."""


def main(command: options.Regress) -> int:
    """Run, write `regress.csv` and figures, and compare; 1 if a number left its band."""
    options.check_number("processes", command.processes, lowest=1, open_end=False)
    names = [full_hand_name(name) if is_hand(name) else full_name(name) for name in command.rig]
    names = list(dict.fromkeys(names)) or [*CATALOGUE, *HAND_CATALOGUE]
    file = Path(command.baseline or baseline.FILE)
    stored: dict[Key, Stored] = {}
    version = ""
    if not command.update or file.exists():  # what cannot be added to is refused before the runs
        stored, version = baseline.read(file)
    folder, out = output_folder(command.output, FOLDER), console()
    backend = backend_for(command.on, command.processes, folder, begin=quiet)
    make_folder(folder)
    rows = measure(names, folder, command.resume, command.update, backend)
    numbers = {key: row[name] for row in rows for name, key in row.keys().items()}
    stored = {} if command.update else stored
    departures = baseline.departures(numbers, stored, names)
    write_rows(folder / "regress.csv", rows, stored)
    departed = {departure.key[:2] for departure in departures}
    for table in regression_tables.tables(rows, departed):
        out.print(table)
    for name in ("regress.csv", *regression_figures.draw(rows, folder)):
        out.print(f"wrote {folder / name}", soft_wrap=True)
    for key, ceiling in baseline.CEILINGS.items():
        if key in numbers:
            out.print(f"{baseline.name(key)} {numbers[key]:.2g}, must be below {ceiling:g}")
    largest = sorted(departures, key=lambda departure: -departure.size)
    for departure in largest[:MOST_NAMED]:
        out.print(warning(str(departure)), soft_wrap=True)
    if len(departures) > MOST_NAMED:
        out.print(f"and {len(departures) - MOST_NAMED} more, all in {folder / 'regress.csv'}")
    if command.update:
        baseline.write(file, _with_bands(rows))
        out.print(f"wrote {file}; MuJoCo {mujoco.__version__}", soft_wrap=True)
    else:
        for line in _verdict(numbers, stored, departures, version):
            out.print(line, soft_wrap=True)
    return 1 if departures else 0


def measure(
    names: Sequence[str],
    folder: Path,
    resume: bool = False,
    repeat: bool = False,
    backend: Backend | None = None,
) -> list[Row]:
    """All rows of these models; `FOLDER/progress.jsonl` keeps what is done.

    Raises
    ------
    OutputError
        The folder cannot be written to.
    """
    units: list[Unit] = []
    for name in names:
        steps = hand_rows.STEPS if name in HAND_CATALOGUE else crane_rows.STEPS
        units += [(name, step, repeat) for step in steps]
    jobs = Jobs(
        rows_of,
        backend or Processes(begin=quiet),
        file=folder / "progress.jsonl",
        resume=resume,
        decode=lambda rows: [record(Row, row) for row in rows],
        identity=_identity,
    )
    return [row for rows in jobs.values(units) for row in rows]


def rows_of(unit: Unit) -> list[Row]:
    """Rows of a model with a time step, one for each integrator."""
    make_rows = hand_rows.rows if unit[0] in HAND_CATALOGUE else crane_rows.rows
    return make_rows(*unit)


def _identity(unit: Unit) -> object:
    """Everything but the sources that rows depend on."""
    name = unit[0]
    if name in HAND_CATALOGUE:
        return unit, make_hand(name), default_hand_move(name)
    return unit, make(name), default_move(name), free_motion(name)


def write_rows(path: Path, rows: Sequence[Row], stored: dict[Key, Stored]) -> None:
    """Write all numbers, what is stored for them, and costs as CSV.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    columns = ("model", "integrator", "step [s]", "quantity", "unit", "value", "stored", "band",
               "in band")  # fmt: skip
    lines: list[tuple[object, ...]] = []
    for row in rows:
        place = (row.model, row.integrator, row.step)
        for name, key in row.keys().items():
            value, old = row[name], stored.get(key)
            band = old.band if old else row.bands.get(name)
            verdict = "" if old is None else "yes" if old.holds(value) else "no"
            unit = QUANTITIES[name].unit
            lines.append((*place, name, unit, value, old.value if old else None, band, verdict))
        lines.append((*place, "cost", "ms/s", row.cost, None, None, ""))
    write_csv(path, columns, lines, ".9g")


def _with_bands(rows: Sequence[Row]) -> dict[Key, Stored]:
    return {
        key: Stored(row[name], row.bands[name]) for row in rows for name, key in row.keys().items()
    }


def _verdict(
    numbers: dict[Key, float],
    stored: dict[Key, Stored],
    departures: Sequence[Departure],
    version: str,
) -> list[str]:
    """What a comparison comes to, in a line or two."""
    new, lines = [key for key in numbers if key not in stored], []
    if new:
        models = ", ".join(dict.fromkeys(key[0] for key in new))
        lines.append(f"{len(new)} numbers of {models} have no stored ones; --update stores them")
    verdict = f"{len(departures)} of {len(numbers)} numbers left their band"
    if not departures:
        compared = len(numbers) - len(new)
        verdict = f"all in band, {compared} numbers" if compared else "nothing was compared"
    return [*lines, f"{verdict}; MuJoCo {mujoco.__version__}, stored ones by {version}"]
