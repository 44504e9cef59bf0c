"""`flatrig stress`: stiff and extreme cases, each of which must end as it is told to.

    flatrig stress                        # all, 10 000 random rigs among them
    flatrig stress --only pulley          # rows of the table whose name has it
    flatrig stress --resume               # go on where a run was interrupted
    flatrig stress --on slurm --processes 50      # on many machines

A motion is judged by what the solver does not use: rates are integrated and compared with places
(`rates`), forces are balanced body by body and in MuJoCo (`forces`), what is refused is compared
with closed forms (`closed_forms`) and other homes (`homes`), and what `check` says with all of it.
`random_rigs` draws every kind of part, frames in any direction, pulleys without mass, sheaves,
several falls and rails that end.

A case is correct within its stated tolerance, refused with a named error, or stopped with a named
reason (`flatrig.training.stress.case`); the table counts them and says how near to its tolerance
one came at most, and beside the largest stable time step found stands the one in theory.  Every
case is a line of `stress.csv`.  The exit status is 1 if one of them was wrong.

To add a case: a function that returns a finding, and a line in `cases` of one of the files
`*_cases.py`.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import astuple, fields
from hashlib import sha256
from pathlib import Path

import mujoco
from rich.table import Table
from rich.text import Text

from ...models import CATALOGUE
from ...models.errors import OptionError, did_you_mean
from ...models.files import make_folder
from ...models.mjcf.simulate import quiet
from .. import options
from ..console import console, warning
from ..jobs import Jobs, Result, backend_for
from ..option_values import output_folder
from ..tables import table, write_csv
from . import (
    episode_cases,
    fuzz_cases,
    program_cases,
    random_cases,
    run_cases,
    solver_cases,
    stiff_cases,
)
from .case import ENDINGS, WRONG, Case, Outcome, attempt, kept, verdict

FOLDER = "results/stress"
MOST_NAMED = 10
"""Wrong cases that are named on the console; all are in the CSV."""
MOST_LIMITS = 4
"""A row with more step limits than these lists none; its tolerance covers them all."""


def main(command: options.Stress) -> int:
    """Run the cases, show the table and write `stress.csv`; 1 if a case was wrong."""
    for name, lowest in (("rigs", 1), ("processes", 1), ("seed", 0)):
        options.check_number(name, getattr(command, name), lowest=lowest, open_end=False)
    chosen = _chosen(list(cases(command.rigs, command.seed)), command.only)
    folder, out = output_folder(command.output, FOLDER), console()
    begin = time.perf_counter()
    outcomes = run(chosen, folder, command)
    columns = [item.name for item in fields(Outcome)]
    write_csv(folder / "stress.csv", columns, map(astuple, outcomes))
    out.print(summary(outcomes))
    wrong = [outcome for outcome in outcomes if outcome.ending == WRONG]
    for outcome in wrong[:MOST_NAMED]:
        text = f"{outcome.row}, {outcome.label}: {_why(outcome)}"
        out.print(warning(text), soft_wrap=True)
    out.print(
        f"{len(wrong)} of {len(outcomes)} cases wrong; {time.perf_counter() - begin:.0f} s, "
        f"MuJoCo {mujoco.__version__}; wrote {folder}/stress.csv",
        soft_wrap=True,
    )
    return 1 if wrong else 0


def cases(rigs: int, seed: int) -> Iterator[Case]:
    """All cases, the long ones first."""
    yield from run_cases.cases()
    yield from stiff_cases.cases()
    yield from solver_cases.cases()
    yield from episode_cases.cases()
    yield from program_cases.cases()
    yield from random_cases.cases(rigs, seed)
    yield from fuzz_cases.cases(rigs, seed)


def _chosen(known: list[Case], only: str) -> list[Case]:
    """Those whose row is meant.

    Raises
    ------
    OptionError
        There are none.
    """
    chosen = [case for case in known if only.lower() in case.row.lower()]
    if not chosen:
        rows = dict.fromkeys(case.row for case in known)
        raise OptionError(f"no row of the table has {only!r} in its name{did_you_mean(only, rows)}")
    return chosen


def run(chosen: Sequence[Case], folder: Path, command: options.Stress) -> list[Outcome]:
    """Outcomes of the cases, in their order; `FOLDER/progress.jsonl` keeps what is done."""
    backend = backend_for(command.on, command.processes, folder, begin=quiet)
    make_folder(folder)
    # Cases name rigs of the catalogue, in which others than the package's may be registered.
    rigs = sha256(repr({name: build() for name, build in CATALOGUE.items()}).encode()).hexdigest()
    jobs = Jobs(
        attempt,
        backend,
        file=folder / "progress.jsonl",
        resume=command.resume,
        decode=kept,
        identity=lambda case: (_identity(case), command.seed, rigs),
    )
    results = sorted(jobs.results(chosen), key=lambda result: result.number)
    return [_outcome(result) for result in results]


def _identity(case: Case) -> tuple[object, ...]:
    """What tells a case from others."""
    check, bound = getattr(case.check, "func", case.check), getattr(case.check, "args", ())
    name = f"{check.__module__}.{check.__qualname__}"
    return (case.row, case.label, name, *bound, *case.arguments)


def _outcome(result: Result[Case, Outcome]) -> Outcome:
    """How a case ended, judged also if it was kept; wrong if it took its process down."""
    if result.failure is None:
        return verdict(result.item, result.value)
    return Outcome(result.item.row, result.item.label, WRONG, str(result.failure))


def summary(outcomes: Sequence[Outcome]) -> Table:
    """One line for each row, and one for all."""
    lines = table(
        "Stiff and extreme cases", "", "cases", *ENDINGS, "error over\ntolerance",
        "largest stable\nstep found [s]", "in theory\n[s]",
    )  # fmt: skip
    for row in dict.fromkeys(outcome.row for outcome in outcomes):
        lines.add_row(row, *_cells([outcome for outcome in outcomes if outcome.row == row]))
    lines.add_section()
    lines.add_row("all", *_cells(outcomes))
    return lines


def _cells(outcomes: Sequence[Outcome]) -> list[str | Text]:
    counts = [sum(item.ending == ending for item in outcomes) for ending in ENDINGS]
    cells: list[str | Text] = [str(len(outcomes)), *(str(count or "") for count in counts)]
    if counts[-1]:
        cells[-1] = warning(str(counts[-1]))
    shares = [
        item.error / item.tolerance
        for item in outcomes
        if item.error is not None and item.tolerance
    ]
    cells.append(f"{max(shares):.1e}" if shares else "")
    limits = [item for item in outcomes if item.limit and item.theory]
    limits = limits if len(limits) <= MOST_LIMITS else []
    cells.append("\n".join(f"{item.label.split(', ')[-1]}: {item.limit:.4g}" for item in limits))
    cells.append("\n".join(f"{item.theory:.4g}" for item in limits))
    return cells


def _why(outcome: Outcome) -> str:
    if outcome.error is None or outcome.tolerance is None:
        return outcome.reason
    return f"{outcome.reason}: {outcome.error:.2g}, must be at most {outcome.tolerance:.2g}"
