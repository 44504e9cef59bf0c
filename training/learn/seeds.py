"""`flatrig train --seeds 0:10`: the same run from several seeds, in turn or side by side.

Each seed has a result folder of its own, as if it were trained alone; which seeds are done stands
in `runs/NAME-SENSORS-seeds/progress.jsonl`, with the files of their folders, since a process on
another machine may not see ours.  A run that is interrupted goes on from its checkpoint.
"""

import io
import sys
from base64 import b64decode, b64encode
from collections.abc import Callable, Mapping
from contextlib import nullcontext, redirect_stdout
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from ...models.errors import FlatrigError, OptionError
from ...models.files import make_folder, replacing
from .. import options
from ..console import console, warning
from ..exits import DONE, NO
from ..jobs import Jobs, backend_for

NOT_OF_THE_RUN = ("seeds", "on", "processes", "resume", "output", "threads")
"""Options on which what is trained does not depend."""
HERE_ONLY = ("checkpoint", ".lock")
"""Beginnings of names of files that stay where they are."""

Train = Callable[[options.Train], int]


@dataclass(frozen=True)
class Seed:
    """One run of several."""

    train: Train
    """Function that trains with one seed; returns the exit status."""
    command: options.Train
    folder: str
    words: tuple[str, ...]
    """The command line, which result folders repeat."""
    aloud: bool
    """Whether it is trained in the process that has a console."""

    def run(self) -> dict[str, Any]:
        """Train, or go on from a checkpoint; what was said, and the files of the result folder.

        Raises
        ------
        FlatrigError
            The run is not possible.
        """
        folder, said = Path(self.folder), io.StringIO()
        sys.argv[1:] = self.words
        going_on = (folder / "checkpoint.json").exists()
        with nullcontext() if self.aloud else redirect_stdout(said):
            if self.train(replace(self.command, resume=going_on, output=self.folder)):
                raise OptionError(f"seed {self.command.seed} cannot be trained")
        files = {
            path.name: b64encode(path.read_bytes()).decode()
            for path in sorted(folder.iterdir())
            if path.is_file() and not path.name.startswith(HERE_ONLY)
        }
        return {"said": said.getvalue(), "files": files}

    def identity(self) -> object:
        """What is trained."""
        kept = {item.name: getattr(self.command, item.name) for item in fields(self.command)}
        return [kept[name] for name in sorted(kept) if name not in NOT_OF_THE_RUN]


def seeds_of(command: options.Train) -> range:
    """The seeds that `--seeds` asks for: a number of them from `--seed` on, or a range as 0:10.

    Raises
    ------
    OptionError
        It is neither, or holds none.
    """
    first, colon, end = command.seeds.partition(":")
    try:
        numbers = range(int(first), int(end)) if colon else range(int(first))
    except ValueError:
        raise OptionError(
            f"--seeds is {command.seeds!r}, it must be a number of runs, or seeds as in 0:10"
        ) from None
    if not numbers:
        must = "end after it begins" if colon else "be > 0"
        raise OptionError(f"--seeds is {command.seeds}, it must {must}")
    if colon and command.seed:
        raise OptionError(f"--seeds {command.seeds} says where to begin: no --seed")
    return numbers if colon else range(command.seed, command.seed + len(numbers))


def in_turn(command: options.Train) -> bool:
    """Whether there is more than one run, or one that is not of this process."""
    return len(seeds_of(command)) > 1 or command.on != "local"


def train_seeds(
    command: options.Train, label: str, train: Train, check: Callable[[Path], None]
) -> int:
    """Train with every seed; 1 if one could not be trained.

    Parameters
    ----------
    command
        What is asked for.
    label
        Beginning of the names of result folders, runs/LABEL-seedSEED.
    train
        Trains with one seed in the folder that is the output; returns the exit status.
    check
        Refuses a folder that holds a run already.

    Raises
    ------
    OptionError
        An option, or a back end, cannot be had.
    """
    if command.output:
        raise OptionError("--seeds names its own folders: no --output")
    folder = Path(f"runs/{label}-seeds")
    backend = backend_for(command.on, command.processes, folder, cores=command.threads)
    aloud = command.on == "local" and command.processes == 1
    items = []
    for seed in seeds_of(command):
        one = replace(command, seed=seed, seeds="1", on="local", processes=1, resume=False)
        items.append(Seed(train, one, f"runs/{label}-seed{seed}", tuple(sys.argv[1:]), aloud))
        if not command.resume:
            check(Path(items[-1].folder))
    jobs = Jobs(
        Seed.run,
        backend,
        file=folder / "progress.jsonl",
        resume=command.resume,
        bar=not aloud,
        identity=Seed.identity,
    )
    status, out = DONE, console()
    for result in jobs.results(items):
        if isinstance(result.failure, FlatrigError):
            text = f"seed {result.item.command.seed}: {result.failure}"
            console(stderr=True).print(warning(text), soft_wrap=True)
            status = NO
            continue
        _bring(Path(result.item.folder), result.value["files"])
        out.print(result.value["said"], end="", soft_wrap=True)
    return status


def _bring(folder: Path, files: Mapping[str, str]) -> None:
    """Write what a machine has trained that does not write to our folders."""
    make_folder(folder)
    for name, text in files.items():
        if not (folder / name).exists():
            with replacing(folder / name) as beside:
                beside.write_bytes(b64decode(text))
