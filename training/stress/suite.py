"""`flatrig stress`: stiff and extreme cases, each of which must end as it is told to.

    flatrig stress                        # all, 10 000 random rigs among them
    flatrig stress --only pulley          # rows of the table whose name has it
    flatrig stress --resume               # go on where a run was interrupted

A case is correct within its stated tolerance, refused with a named error, or stopped with a named
reason (`flatrig.training.stress.case`); the table counts them and says how near to its tolerance
one came at most, and beside the largest stable time step found stands the one in theory.  Every
case is a line of `stress.csv`.  The exit status is 1 if one of them was wrong.

To add a case: a function that returns what it found, and a line in `cases` of one of the files
`stress_cases_*.py`.
"""

import json
import os
import time
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, astuple, fields
from multiprocessing import get_context
from pathlib import Path

import mujoco
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from ...models.errors import FlatrigError, OptionError, did_you_mean
from ...models.files import write_text
from .. import options
from ..compare.report import make_folder
from ..console import console, warning
from ..tables import table, write_csv
from . import episode_cases as stress_cases_envs
from . import random_cases as stress_cases_random
from . import run_cases as stress_cases_runs
from . import solver_cases as stress_cases_solver
from . import stiff_cases as stress_cases_stiff
from .case import ENDINGS, WRONG, Case, Outcome, judge

FOLDER = "results/stress"
CHUNK = 20
"""Cases that a process takes at once."""
SAVED = 10.0
"""Seconds between two savings of what is done."""
TOLD = 10
"""Wrong cases that are told on the console; all are in the CSV."""
SHOWN = 4
"""A row with more step limits than these shows none; its tolerance covers them all."""


def main(command: options.Stress) -> int:
    """Run the cases, show the table and write `stress.csv`; 1 if a case was wrong."""
    for name, lowest in (("rigs", 1), ("processes", 1), ("seed", 0)):
        options.check_number(name, getattr(command, name), lowest=lowest, open_end=False)
    chosen = _chosen(list(cases(command.rigs, command.seed)), command.only)
    folder, out = Path(command.output or FOLDER), console()
    make_folder(folder)
    begin = time.perf_counter()
    outcomes = run(chosen, folder, command)
    columns = [item.name for item in fields(Outcome)]
    write_csv(folder / "stress.csv", columns, map(astuple, outcomes))
    out.print(summary(outcomes))
    wrong = [outcome for outcome in outcomes if outcome.ending == WRONG]
    for one in wrong[:TOLD]:
        out.print(warning(f"{one.row}, {one.label}: {_why(one)}"), soft_wrap=True)
    out.print(
        f"{len(wrong)} of {len(outcomes)} cases wrong; {time.perf_counter() - begin:.0f} s, "
        f"MuJoCo {mujoco.__version__}; wrote {folder}/stress.csv",
        soft_wrap=True,
    )
    return 1 if wrong else 0


def cases(rigs: int, seed: int) -> Iterator[Case]:
    """All cases, the long ones first."""
    yield from stress_cases_runs.cases()
    yield from stress_cases_stiff.cases()
    yield from stress_cases_solver.cases()
    yield from stress_cases_envs.cases()
    yield from stress_cases_random.cases(rigs, seed)


def _chosen(every: list[Case], only: str) -> list[Case]:
    """Those whose row is meant.

    Raises
    ------
    OptionError
        There are none.
    """
    found = [case for case in every if only.lower() in case.row.lower()]
    if not found:
        rows = dict.fromkeys(case.row for case in every)
        raise OptionError(f"no row of the table has {only!r} in its name{did_you_mean(only, rows)}")
    return found


def run(chosen: Sequence[Case], folder: Path, command: options.Stress) -> list[Outcome]:
    """Outcomes of the cases, in their order; what is done is kept in `FOLDER/progress.json`."""
    file = folder / "progress.json"
    mark = f"MuJoCo {mujoco.__version__}, seed {command.seed}"
    done = _read(file, mark) if command.resume else {}
    left = [case for case in chosen if (case.row, case.label) not in done]
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(),
               TimeElapsedColumn())  # fmt: skip
    saved = time.monotonic()
    try:
        with Progress(*columns, console=console(), transient=True) as bar:
            task = bar.add_task("Running", total=len(chosen), completed=len(chosen) - len(left))
            for outcomes in _judged(left, command.processes):
                done |= {(one.row, one.label): one for one in outcomes}
                bar.advance(task, len(outcomes))
                if time.monotonic() > saved + SAVED:
                    saved = time.monotonic()
                    _save(file, mark, done.values())
    finally:
        _save(file, mark, done.values())
    return [done[case.row, case.label] for case in chosen]


def _judged(left: Sequence[Case], processes: int) -> Iterator[list[Outcome]]:
    """Outcomes as they come, from processes of their own."""
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # one core for each process
    pool = ProcessPoolExecutor(processes, get_context("spawn"), quiet)
    try:
        chunks = [left[i : i + CHUNK] for i in range(0, len(left), CHUNK)]
        for future in as_completed([pool.submit(judge_all, chunk) for chunk in chunks]):
            yield future.result()
    except BrokenProcessPool:
        raise FlatrigError("a process was ended from outside; --resume goes on after it") from None
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def quiet() -> None:
    """Keep MuJoCo's warnings, each of which is an outcome here, off the console and the disk."""
    log = mujoco.MjLogConfig.get()
    log.logto_console = log.logto_file = False
    log.set()


def judge_all(some: Iterable[Case]) -> list[Outcome]:
    """Outcomes of some cases."""
    return [judge(case) for case in some]


def _save(file: Path, mark: str, outcomes: Iterable[Outcome]) -> None:
    rows = [list(asdict(outcome).values()) for outcome in outcomes]
    write_text(file, json.dumps({"mark": mark, "outcomes": rows}) + "\n")


def _read(file: Path, mark: str) -> dict[tuple[str, str], Outcome]:
    """What an interrupted run of the same kind has left, by row and label."""
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))
        outcomes = [Outcome(*row) for row in kept["outcomes"]] if kept["mark"] == mark else []
    except (OSError, ValueError, KeyError, TypeError):
        return {}
    return {(one.row, one.label): one for one in outcomes}


def summary(outcomes: Sequence[Outcome]) -> Table:
    """One line for each row, and one for all."""
    shown = table(
        "Stiff and extreme cases", "", "cases", *ENDINGS, "error over\ntolerance",
        "largest stable\nstep found [s]", "in theory\n[s]",
    )  # fmt: skip
    for row in dict.fromkeys(one.row for one in outcomes):
        shown.add_row(row, *_cells([one for one in outcomes if one.row == row]))
    shown.add_section()
    shown.add_row("all", *_cells(outcomes))
    return shown


def _cells(some: Sequence[Outcome]) -> list[str | Text]:
    counts = [sum(one.ending == ending for one in some) for ending in ENDINGS]
    cells: list[str | Text] = [str(len(some)), *(str(count) if count else "" for count in counts)]
    if counts[-1]:
        cells[-1] = warning(str(counts[-1]))
    shares = [one.error / one.tolerance for one in some if one.error is not None and one.tolerance]
    cells.append(f"{max(shares):.1e}" if shares else "")
    limits = [one for one in some if one.limit and one.theory]
    limits = limits if len(limits) <= SHOWN else []
    of = [one.label.rpartition(", ")[2] for one in limits]
    cells.append(
        "\n".join(f"{name}: {one.limit:.4g}" for name, one in zip(of, limits, strict=True))
    )
    cells.append("\n".join(f"{one.theory:.4g}" for one in limits))
    return cells


def _why(one: Outcome) -> str:
    if one.error is None or one.tolerance is None:
        return one.reason
    return f"{one.reason}: {one.error:.2g}, must be at most {one.tolerance:.2g}"
