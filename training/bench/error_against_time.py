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
With `--on` they are those of whatever machine worked on a line; ratios are of one machine each.
"""

from collections.abc import Iterable, Sequence
from dataclasses import astuple, fields
from pathlib import Path

from ...feedforward import dae
from ...models import full_name
from ...models.errors import OptionError, did_you_mean
from ...models.files import make_folder
from .. import options
from ..console import console
from ..jobs import Backend, Jobs, backend_for, record
from ..option_values import output_folder
from ..tables import write_csv
from . import trial_figures, trial_roads, trial_tables
from .peers import PEERS
from .smooth_moves import cases
from .trials import BY_NAME, EXACT, Run, Unit

FOLDER = "results/bench"
"""Where CSV and figures go, if nothing else is said."""
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
    folder = Path(command.output) if picture else output_folder(command.output, FOLDER)
    backend = backend_for(command.on, command.processes, folder.parent if picture else folder)
    if not picture:
        make_folder(folder)
    runs = measure(chosen, None if picture else folder, command.resume, backend)
    labels = list(dict.fromkeys(run.case for run in runs))
    if picture:
        trial_figures.formulation(folder, runs, chosen[0].case, _formulation(chosen))
        out.print(trial_tables.of_case(chosen[0].case, runs))
        out.print(f"wrote {folder}", soft_wrap=True)
        return
    for label in labels:
        out.print(trial_tables.of_case(label, runs))
    written = [folder / "runs.csv", folder / "orders.csv"]
    write_csv(written[0], [field.name for field in fields(Run)], map(astuple, runs), ".6g")
    orders = (row.values() for row in trial_tables.orders(runs))
    write_csv(written[1], trial_tables.ORDERS, orders, ".6g")
    for label in labels:
        written.append(folder / f"{label.replace(', ', '_')}.png")
        trial_figures.case(written[-1], runs, label)
    for comparison in (*trial_tables.against_exact(runs), trial_roads.beside_others(runs)):
        out.print(comparison)
    if not command.formulation and not command.scheme:
        out.print(trial_tables.along_catalogue_moves(labels))
        if not command.rig:
            out.print(trial_tables.at_printed_steps())
    for path in written:
        out.print(f"wrote {path}", soft_wrap=True)


def units(command: options.Bench, picture: bool = False) -> list[Unit]:
    """What to run; peers unless a formulation is chosen, or if they are among the schemes.

    Raises
    ------
    RigError, OptionError
        A name means nothing.
    """
    rigs = {full_name(name) for name in command.rig or ((ONE_RIG,) if picture else ())}
    labels = [label for label, case in cases().items() if not rigs or case.name in rigs]
    known = (*dae.SCHEMES, *BY_NAME)
    chosen = [_known("scheme", name, known) for name in command.scheme] or list(known)
    schemes = tuple(name for name in chosen if name in dae.SCHEMES)
    formulations = [_known("formulation", name, dae.FORMULATIONS) for name in command.formulation]
    peers = [name for name in chosen if name in BY_NAME]
    if picture:
        labels, formulations = labels[:1], formulations[:1] or [ONE_FORMULATION]
    elif formulations and not command.scheme:
        peers = []
    formulations = (formulations or list(dae.FORMULATIONS)) if schemes else []
    return [
        Unit(label, name, schemes) for label in labels for name in (EXACT, *formulations, *peers)
    ]


def _known(what: str, name: str, known: Iterable[str]) -> str:
    if name not in known:
        raise OptionError(f"there is no {what} {name!r}{did_you_mean(name, known)}")
    return name


def _formulation(chosen: Sequence[Unit]) -> str:
    return next((unit.name for unit in chosen if unit.name in dae.FORMULATIONS), "")


def absent(chosen: Iterable[Unit]) -> list[str]:
    """Peers that are asked for and not installed."""
    names = {unit.name for unit in chosen}
    return [peer.name for peer in PEERS if peer.name in names and not peer.present]


def measure(
    chosen: Sequence[Unit], folder: Path | None, resume: bool, backend: Backend
) -> list[Run]:
    """Runs of the units, in their order; `FOLDER/progress.jsonl` keeps what is done.

    Raises
    ------
    OutputError
        The folder cannot be written to.
    """
    jobs = Jobs(
        Unit.runs,
        backend,
        file=None if folder is None else folder / "progress.jsonl",
        resume=resume,
        decode=lambda runs: [record(Run, run) for run in runs],
        identity=lambda unit: (unit, cases()[unit.case].rig, cases()[unit.case].move),
    )
    return [run for runs in jobs.values(chosen) for run in runs]
