"""`flatrig train`: a residual policy on top of feedforward + PD, with PPO from stable-baselines3.

    flatrig train overhead --seed 0 --minutes 10

The result folder holds config.json (what exactly ran), progress.csv (the learning), evaluation.csv
(tracking error over scenarios it does not train on), checkpoint.* for `--resume`, and the policy
with the lowest error in these evaluations as policy.safetensors and policy.json.
"""

import importlib.util
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ...models import dumps
from ...models.errors import OptionError
from .. import options
from ..console import console
from ..describe.feasible import INFEASIBLE, problems_of
from ..exits import DONE, refuse
from ..lock import locked
from .run_folder import check_run, cut_tables, make_run_folder, read_config, write_config
from .settings import Settings

if TYPE_CHECKING:
    from .ppo import Training


def main(command: options.Train) -> int:
    """Train, with a result folder."""
    check(command)
    check_extra()
    folder = Path(command.output or f"runs/{command.label()}-seed{command.seed}")
    check_run(folder, resume=command.resume)
    if command.resume:
        with locked(folder):
            return _go_on(folder, command)
    return _begin(folder, command)


def _begin(folder: Path, command: options.Train) -> int:
    """Train from nothing, in a folder that is made once the run is known to be possible."""
    settings = Settings(fraction=command.fraction) if command.fraction else Settings()
    if command.minutes is None and command.steps is None:
        command = replace(command, minutes=options.MINUTES)
    if status := refuse(INFEASIBLE, problems_of(*command.target())):
        return status
    training = _training(folder, command, settings)
    with locked(folder):
        check_run(folder, resume=False)
        make_run_folder(folder)
        write_config(folder, command, settings, dumps(*command.target()), {}, training.steps)
        training.run()
    return DONE


def _go_on(folder: Path, command: options.Train) -> int:
    """Train from the checkpoint, and forget what was noted after it."""
    command, settings, config = read_config(folder, command)
    check(replace(command, steps=command.steps or None))
    if status := refuse(INFEASIBLE, problems_of(*command.target())):
        return status
    training = _training(folder, command, settings)
    cut_tables(folder, training.steps)
    write_config(folder, command, settings, dumps(*command.target()), config, training.steps)
    training.run()
    return DONE


def _training(folder: Path, command: options.Train, settings: Settings) -> "Training":
    from .ppo import Training  # loads torch

    return Training(*command.target(), command, settings, folder, console())


def check(command: options.Train) -> None:
    """Refuse numbers that no run can have.

    Raises
    ------
    OptionError
        Naming the option.
    """
    for name in ("minutes", "steps", "envs", "threads", "evaluations"):
        value = getattr(command, name)
        if value is not None:
            options.check_number(f"--{name}", value)
    if not 0 <= command.seed < 2**32:
        raise OptionError(f"--seed is {command.seed}, it must be in 0 .. {2**32 - 1}")
    options.check_number("--fraction", command.fraction, open_end=False)
    if command.fraction > 1:
        raise OptionError(f"--fraction is {command.fraction:g}, it must be <= 1")


def check_extra() -> None:
    """Refuse to train without the packages for it.

    Raises
    ------
    OptionError
        Naming the extra to install.
    """
    missing = [
        name for name in ("torch", "stable_baselines3") if not importlib.util.find_spec(name)
    ]
    if missing:
        raise OptionError(
            f"training needs {' and '.join(missing)}: pip install 'flatrig[train]' (or make train)"
        )
