"""`flatrig bench cranebench`: flatrig's controllers beside those of another's benchmark, there.

    flatrig bench cranebench                    # a hundred samples of each campaign; some minutes
    flatrig bench cranebench --samples 500      # as many as in cranebench's own paper

cranebench 0.1.2 (S. Podliesnyi, O. Sheremet and B. Vorobiov; extra `peers`) has a plant, wind, a
paired design and metrics of its own, and the controllers PD, LQR, ZVD, SMC and HSMC.  Every metric
of every sample goes to `samples.csv`, means and paired differences to `summary.json`, the swing
over time to `swing.png`.
"""

import importlib.util
from collections.abc import Sequence
from pathlib import Path

from ...models.errors import OptionError
from ...models.files import make_folder
from .. import options
from ..as_json import show_json
from ..console import console
from ..jobs import Backend, Jobs, backend_for
from ..option_values import output_folder
from . import cranebench_report as report
from .cranebench_runs import CAMPAIGNS, ENTRANTS, Run, Unit

FOLDER = "results/cranebench"
"""Where the files go, if nothing else is said."""


def main(command: options.Bench) -> None:
    """Run all controllers in all campaigns, write the files, print the tables.

    Raises
    ------
    OptionError
        cranebench is not installed, or an option has a value that it cannot have.
    OutputError
        A file cannot be written.
    """
    options.check_number("--samples", command.samples, lowest=2, open_end=False)
    options.check_number("--processes", command.processes)
    if importlib.util.find_spec("cranebench") is None:
        raise OptionError("cranebench is not installed; pip install 'flatrig[peers]'")
    folder = output_folder(command.output, FOLDER)
    backend = backend_for(command.on, command.processes, folder)
    make_folder(folder)
    runs = measure(command.samples, folder, command.resume, backend)
    report.write(runs, folder)
    if command.json:
        show_json(report.summary(runs))
        return
    out = console()
    for name in CAMPAIGNS:
        out.print(report.of_campaign(name, runs))
    out.print(report.NOTES, style="dim", soft_wrap=True)
    out.print(f"wrote {folder}/samples.csv, summary.json, swing.png", soft_wrap=True)


def measure(samples: int, folder: Path, resume: bool, backend: Backend) -> Sequence[Run]:
    """Every controller in every campaign; `FOLDER/progress.jsonl` keeps what is done.

    Raises
    ------
    OutputError
        The folder cannot be written to.
    """
    jobs = Jobs(
        Unit.run,
        backend,
        file=folder / "progress.jsonl",
        resume=resume,
        decode=lambda kept: Run(*kept),
    )
    return jobs.values([Unit(name, entrant, samples) for name in CAMPAIGNS for entrant in ENTRANTS])
