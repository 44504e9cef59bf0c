"""`flatrig train`: a residual policy on top of feedforward, PD and the estimated mass.

    flatrig train overhead --sensors sway --minutes 10

The result folder holds config.json (what exactly ran), progress.csv (the learning), evaluation.csv
(tracking errors along moves that it does not train on), checkpoint.* for `--resume`, and the policy
with the lowest error in these evaluations as policy.safetensors and policy.json.
"""

import importlib.util
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from ...models import dumps
from ...models.errors import OptionError
from .. import options
from ..console import console
from ..describe.feasible import INFEASIBLE, problems_of
from ..exits import DONE, refuse
from ..lock import locked
from ..option_values import output_folder
from .run_folder import check_run, cut_tables, make_run_folder, read_config, write_config
from .seeds import in_turn, seeds_of, train_seeds
from .settings import Settings

if TYPE_CHECKING:
    from .loop import Run


def main(command: options.Train) -> int:
    """Train, with a result folder for each seed."""
    check(command)
    check_extra(command)
    if not in_turn(command):
        return train_one(replace(command, seed=seeds_of(command)[0]))
    if status := refuse(INFEASIBLE, problems_of(*command.target())):
        return status
    label = f"{command.label()}-{command.sensors}"
    return train_seeds(command, label, train_one, partial(check_run, resume=False))


def train_one(command: options.Train) -> int:
    """One run."""
    folder = output_folder(
        command.output, f"runs/{command.label()}-{command.sensors}-seed{command.seed}"
    )
    check_run(folder, resume=command.resume)
    if command.resume:
        with locked(folder):
            return _go_on(folder, command)
    return _begin(folder, command)


def _begin(folder: Path, command: options.Train) -> int:
    """Train from nothing, in a folder that is made once the run is known to be possible."""
    settings = Settings.of(command.sensors, episodes=command.episodes)
    if command.minutes is None and command.iterations is None:
        command = replace(command, minutes=options.MINUTES)
    if status := refuse(INFEASIBLE, problems_of(*command.target())):
        return status
    run = _run(folder, command, settings)
    with locked(folder):
        check_run(folder, resume=False)
        make_run_folder(folder)
        write_config(folder, command, settings, dumps(*command.target()), {}, 0)
        run.run()
    return DONE


def _go_on(folder: Path, command: options.Train) -> int:
    """Train from the checkpoint, and forget what was noted after it."""
    command, settings, config = read_config(folder, command)
    check(command)
    if status := refuse(INFEASIBLE, problems_of(*command.target())):
        return status
    run = _run(folder, command, settings)
    iteration = run.training.iteration
    cut_tables(folder, iteration)
    write_config(folder, command, settings, dumps(*command.target()), config, iteration)
    run.run()
    return DONE


def _run(folder: Path, command: options.Train, settings: Settings) -> "Run":
    from .loop import Run  # loads torch

    return Run(*command.target(), command, settings, folder, console())


def check(command: options.Train) -> None:
    """Refuse numbers that no run can have.

    Raises
    ------
    OptionError
        Naming the option.
    """
    for name in ("minutes", "iterations", "episodes", "threads", "every", "processes"):
        value = getattr(command, name)
        if value is not None:
            options.check_number(f"--{name}", value)
    for seed in (seeds_of(command)[0], seeds_of(command)[-1]):
        if not 0 <= seed < 2**32:
            raise OptionError(f"--seed is {seed}, it must be in 0 .. {2**32 - 1}")


def check_extra(command: options.Train) -> None:
    """Refuse to train without the packages for it.

    Raises
    ------
    OptionError
        Naming what to install.
    """
    if not importlib.util.find_spec("torch"):
        raise OptionError("training needs torch: pip install 'flatrig[train]' (or make train)")
    if command.tensorboard and not importlib.util.find_spec("tensorboard"):
        raise OptionError("--tensorboard needs the package tensorboard: pip install tensorboard")
