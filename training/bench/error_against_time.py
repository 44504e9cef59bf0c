"""`flatrig bench feedforward`: what an error costs, by every formulation, scheme and step.

    flatrig bench feedforward                                     # every rig; some ten minutes
    flatrig bench feedforward --rig rotary --scheme "BDF 3"       # cut to what is wanted
    flatrig bench feedforward --resume                            # go on after an interruption
    flatrig bench feedforward -o error_against_time.png           # one figure of one rig

The exact solution is the truth, and is timed in the same run; so are the integrators of others, if
they are installed (`peers`).  Every run goes to `runs.csv`, those that failed with their reason,
every measured order of convergence beside the theoretical one to `orders.csv`, and each rig gets a
figure.  Ratios to the exact solution are medians of runs timed in turns, one at a time.

Two processes work side by side, each on one core: other load on the machine shows in the times.
"""

import json
import os
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, astuple, fields
from multiprocessing import get_context
from pathlib import Path

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from ...feedforward import dae
from ...models import full_name
from ...models.errors import OptionError, did_you_mean
from ...models.files import write_text
from .. import options
from ..console import console
from ..tables import write_csv
from . import trial_figures as bench_figures
from . import trial_tables as bench_tables
from .peers import PEERS
from .trials import BY_NAME, CASES, COUNTS, EXACT, LONGEST, ORDER, STRETCH, Run, Unit

FOLDER = "results/bench"
ONE_RIG, ONE_FORMULATION = "rotary_crane", "minimal extension"
"""What the single figure shows, if nothing else is said."""


def main(command: options.Bench) -> None:
    """Run what is asked for, write CSV and figures, print the tables."""
    options.check_number("--processes", command.processes)
    out, picture = console(), command.output.endswith(".png")
    chosen = units(command, picture)
    for name in absent(chosen):
        out.print(f"{name} is not installed (pip install 'flatrig[peers]'), it is left out")
    chosen = [unit for unit in chosen if unit.name not in BY_NAME or BY_NAME[unit.name].present]
    folder = Path(command.output or FOLDER)
    parts = None if picture else folder / "parts"
    runs = measure(chosen, parts, command.resume, command.processes)
    cases = list(dict.fromkeys(run.case for run in runs))
    if picture:
        bench_figures.one(folder, runs, chosen[0].case, _formulation(chosen))
        out.print(bench_tables.of_case(chosen[0].case, runs))
        out.print(f"wrote {folder}", soft_wrap=True)
        return
    for case in cases:
        out.print(bench_tables.of_case(case, runs))
    written = [folder / "runs.csv", folder / "orders.csv"]
    write_csv(written[0], [field.name for field in fields(Run)], map(astuple, runs), ".6g")
    orders = (row.values() for row in bench_tables.orders(runs))
    write_csv(written[1], bench_tables.ORDERS, orders, ".6g")
    for case in cases:
        written.append(folder / f"{case.replace(', ', '_')}.png")
        bench_figures.case(written[-1], runs, case)
    for shown in bench_tables.against_exact(runs):
        out.print(shown)
    if not command.formulation and not command.scheme:
        out.print(bench_tables.along_catalogue_moves(cases))
        if not command.rig:
            out.print(bench_tables.at_printed_steps())
    for path in written:
        out.print(f"wrote {path}", soft_wrap=True)


def units(command: options.Bench, picture: bool = False) -> list[Unit]:
    """What to run; peers unless a formulation is chosen, or if they are among the schemes.

    Raises
    ------
    RigError, OptionError
        A name means nothing.
    """
    wanted = command.rig or ((ONE_RIG,) if picture else ())
    names = {full_name(name) for name in wanted}
    cases = [label for label, case in CASES.items() if not names or case.name in names]
    known = (*dae.SCHEMES, *BY_NAME)
    chosen = [_known("scheme", name, known) for name in command.scheme] or list(known)
    schemes = tuple(name for name in chosen if name in dae.SCHEMES)
    formulations = [_known("formulation", name, dae.FORMULATIONS) for name in command.formulation]
    peers = [name for name in chosen if name in BY_NAME]
    if picture:
        cases, formulations = cases[:1], formulations[:1] or [ONE_FORMULATION]
    elif formulations and not command.scheme:
        peers = []
    formulations = (formulations or list(dae.FORMULATIONS)) if schemes else []
    return [Unit(case, name, schemes) for case in cases for name in (EXACT, *formulations, *peers)]


def _known(what: str, name: str, known: Iterable[str]) -> str:
    if name not in known:
        raise OptionError(f"there is no {what} {name!r}{did_you_mean(name, known)}")
    return name


def _formulation(chosen: Sequence[Unit]) -> str:
    return next((unit.name for unit in chosen if unit.name in dae.FORMULATIONS), "")


def absent(chosen: Iterable[Unit]) -> list[str]:
    """Peers that are asked for and not installed."""
    asked = {unit.name for unit in chosen}
    return [peer.name for peer in PEERS if peer.name in asked and not peer.present]


def measure(
    chosen: Sequence[Unit], parts: Path | None, resume: bool = False, processes: int = 1
) -> list[Run]:
    """Runs of the units, in their order; each unit leaves a file in the folder `parts`.

    Raises
    ------
    OutputError
        The folder cannot be written to.
    """
    done: dict[Unit, list[Run]] = {}
    if parts is not None and resume:
        kept = {unit: _read(_part(parts, unit), unit) for unit in chosen}
        done = {unit: runs for unit, runs in kept.items() if runs is not None}
    left = [unit for unit in chosen if unit not in done]
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(),
               TimeElapsedColumn())  # fmt: skip
    with Progress(*columns, console=console(), transient=True) as bar:
        task = bar.add_task("Running", total=len(chosen), completed=len(done))
        for unit, runs in _measured(left, processes):
            done[unit] = runs
            bar.advance(task)
            if parts is not None:
                part = {"mark": _mark(unit), "runs": [asdict(run) for run in runs]}
                write_text(_part(parts, unit), json.dumps(part) + "\n")
    return [run for unit in chosen for run in done[unit]]


def _measured(left: Sequence[Unit], processes: int) -> Iterator[tuple[Unit, list[Run]]]:
    """Units with their runs as they come, from processes of their own if there are several."""
    if processes == 1:
        yield from ((unit, unit.runs()) for unit in left)
        return
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # one core for each process
    pool = ProcessPoolExecutor(processes, get_context("spawn"))
    try:
        asked = {pool.submit(unit.runs): unit for unit in left}
        for future in as_completed(asked):
            yield asked[future], future.result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _mark(unit: Unit) -> str:
    """The same for units that would run the same."""
    return repr((unit, CASES[unit.case].move, ORDER, STRETCH, COUNTS, LONGEST))


def _part(parts: Path, unit: Unit) -> Path:
    name = f"{unit.case}-{unit.name}".replace(", ", "_").replace(" ", "_")
    return parts / f"{name}.json"


def _read(file: Path, unit: Unit) -> list[Run] | None:
    """What an interrupted run has left; None if there is nothing, or of something else."""
    try:
        part = json.loads(file.read_text(encoding="utf-8"))
        return [Run(**run) for run in part["runs"]] if part["mark"] == _mark(unit) else None
    except (OSError, ValueError, KeyError, TypeError):
        return None
