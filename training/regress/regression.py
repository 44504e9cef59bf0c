"""`flatrig regress`: every crane, every integrator of MuJoCo, a ladder of time steps.

    flatrig regress                 # all; exit status 1 if a number left its band
    flatrig regress rotary          # one
    flatrig regress --resume        # go on after an interruption
    flatrig regress --update        # store the numbers instead of comparing them

Two runs each, without a display: the crane's move under exact feedforward, nothing measured, whose
distance from the path is all error of the simulation; and its free motion, whose energy and
momentum ought to stay (`drift`).  What the runs cost stands beside it and is never compared.

A number that left its band says that MuJoCo computes something else than when it was stored, or
that a model, a move or the feedforward did change.  A run that breaks down, or ends further than
`LOST` from its path, has an infinite error, and must have one.
"""

import math
from collections.abc import Iterable
from dataclasses import astuple
from itertools import product
from pathlib import Path

import mujoco
import numpy as np
from rich.table import Table

from ...feedforward import Reference, from_move
from ...models import CATALOGUE, Rig, default_move, full_name, make
from ...models.errors import ModelError
from ...models.files import make_folder
from ...models.mjcf import rig_model as mjcf
from .. import options
from ..console import console, warning
from ..jobs import Jobs, record
from ..simulate.drift import DURATION, Drift, Free, drift, free_motion
from ..simulate.open_loop import Prepared, prepare
from ..tables import table, write_csv
from . import baseline, regression_figures
from .row import Row

STEPS = (1e-2, 5e-3, 2e-3, 1e-3, 5e-4)
"""Time steps [s]."""
SUMMARY_STEP = 1e-3
"""Time step whose numbers stand in the summary [s]."""
LOST = 1.0
"""Distance from the path beyond which a number says nothing [m]: runs that swing apart differ from
one processor to the next."""
ROUNDED = 1e-9
"""Error below which rounding decides and a slope shows no order [m]."""
FOLDER = "results/regress"


def main(command: options.Regress) -> int:
    """Run, write `regress.csv` and figures, and compare; 1 if a number left its band."""
    names = [full_name(name) for name in command.rig] or list(CATALOGUE)
    file = Path(command.baseline or baseline.FILE)
    stored, version = ({}, "") if command.update else baseline.read(file)
    folder, out = Path(command.output or FOLDER), console()
    make_folder(folder)
    rows = measure(names, folder, command.resume)
    write_rows(folder / "regress.csv", rows)
    regression_figures.draw(rows, folder)
    numbers = {key: value for row in rows for key, value in row.numbers().items()}
    departures = baseline.departures(numbers, stored, names)
    out.print(summary(rows, {departure.key[:2] for departure in departures}))
    for name in ("regress.csv", *regression_figures.FILES):
        out.print(f"wrote {folder / name}", soft_wrap=True)
    for key, ceiling in baseline.CEILINGS.items():
        if key in numbers:
            out.print(f"{baseline.name(key)} {numbers[key]:.2g}, must be below {ceiling:g}")
    for departure in departures:
        out.print(warning(str(departure)), soft_wrap=True)
    if command.update:
        baseline.write(file, numbers)
        out.print(f"wrote {file}; MuJoCo {mujoco.__version__}", soft_wrap=True)
        return 1 if departures else 0
    new = [key for key in numbers if key not in stored]
    if new:
        models = ", ".join(dict.fromkeys(key[0] for key in new))
        text = f"{len(new)} numbers of {models} have no stored ones; --update stores them"
        out.print(text, soft_wrap=True)
    verdict = f"{len(departures)} of {len(numbers)} numbers left their band"
    if not departures:
        compared = len(numbers) - len(new)
        verdict = f"all in band, {compared} numbers" if compared else "nothing was compared"
    out.print(f"{verdict}; MuJoCo {mujoco.__version__}, stored ones by {version}", soft_wrap=True)
    return 1 if departures else 0


def measure(names: Iterable[str], folder: Path, resume: bool = False) -> list[Row]:
    """All rows of these models; `FOLDER/progress.jsonl` keeps what is done.

    Raises
    ------
    OutputError
        The folder cannot be written to.
    """
    jobs = Jobs(
        _rows,
        file=folder / "progress.jsonl",
        resume=resume,
        decode=lambda rows: [record(Row, row) for row in rows],
        identity=lambda unit: (unit, make(unit[0]), default_move(unit[0]), free_motion(unit[0])),
    )
    return [row for rows in jobs.values([*product(names, STEPS)]) for row in rows]


def _rows(unit: tuple[str, float]) -> list[Row]:
    """Rows of a model with a time step [s], one for each integrator."""
    name, step = unit
    rig = make(name)
    reference, free = from_move(default_move(rig)), free_motion(name)
    prepared = prepare(rig, reference, step)
    return [_row(rig, reference, prepared, free, kind, step) for kind in mjcf.INTEGRATORS]


def _row(
    rig: Rig, reference: Reference, prepared: Prepared, free: Free, integrator: str, step: float
) -> Row:
    model = mjcf.compile(rig, timestep=step, integrator=integrator, visuals=False)
    try:
        run = prepared.run(model)
        error, arrival = float(run.distance.max()), float(run.distance[-1])
        cost = 1e3 * run.seconds / reference.duration
    except ModelError:
        error, arrival, cost = math.inf, math.inf, math.nan
    if error > LOST:
        error = arrival = math.inf
    try:
        model = mjcf.compile(free.rig, timestep=step, integrator=integrator, visuals=False)
        energy, momentum = drift(model, free)
    except ModelError:
        energy, momentum = Drift(math.inf, math.inf)
    return Row(rig.name, integrator, step, error, arrival, energy, momentum, cost)


def write_rows(path: Path, rows: list[Row]) -> None:
    """Write all rows with their costs as CSV.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    columns = ("model", "integrator", "step [s]", "error [m]", "arrival [m]", "energy [J]",
               "momentum", "cost [ms/s]", "real-time factor")  # fmt: skip
    write_csv(path, columns, ((*astuple(row), row.real_time_factor) for row in rows), ".6g")


def summary(rows: list[Row], departed: set[tuple[str, ...]]) -> Table:
    """One line for each model and integrator; `departed` have a number out of its band."""
    lines = table(
        f"Exact feedforward, and {DURATION:g} s of free motion, in MuJoCo at "
        f"{1e3 * SUMMARY_STEP:g} ms "
        "(order: of the error over all steps, at most 2 with held inputs)",
        "model", "integrator", "error [m]", "arrival [m]", "order",
        "energy [J]", "momentum", "[ms/s]", "real time x", "",
    )  # fmt: skip
    for model in dict.fromkeys(row.model for row in rows):
        for kind in mjcf.INTEGRATORS:
            ladder = [row for row in rows if (row.model, row.integrator) == (model, kind)]
            row = next(row for row in ladder if row.step == SUMMARY_STEP)
            lines.add_row(
                model, kind, f"{row.error:.1e}", f"{row.arrival:.1e}", _order(ladder),
                f"{row.energy:.1e}", _cell(row.momentum, ".0e"),
                _cell(row.cost, ".2g"), _cell(row.real_time_factor, ".0f"),
                warning("out of band") if (model, kind) in departed else "",
            )  # fmt: skip
    return lines


def _cell(value: float, form: str) -> str:
    """A number; nothing where there is none."""
    return "" if math.isnan(value) else f"{value:{form}}"


def _order(ladder: list[Row]) -> str:
    """By how many powers of the step the error falls, median over the ladder."""
    pairs = [(row.step, row.error) for row in ladder if ROUNDED < row.error < LOST]
    if len(pairs) < 2:
        return ""
    steps, errors = np.log(np.array(pairs)).T
    return f"{np.median(np.diff(errors) / np.diff(steps)):.1f}"
