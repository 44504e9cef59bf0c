"""`flatrig train`: a residual policy on top of feedforward + PD, with PPO from stable-baselines3.

    flatrig train overhead --seed 0 --minutes 10

The result folder holds config.json (what exactly ran), progress.csv (the learning), evaluation.csv
(tracking error over scenarios it does not train on), checkpoint.* for `--resume`, and the policy
with the lowest error in these evaluations as policy.safetensors and policy.json.
"""

import importlib.util
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...models import dumps
from ...models.errors import OptionError
from .. import options
from ..console import console
from ..describe.feasible import INFEASIBLE, problems_of
from ..exits import DONE, refuse
from .run_folder import make_run_folder, read_config, write_config
from .settings import Settings


def main(command: options.Train) -> int:
    """Train, with a result folder."""
    check(command)
    check_extra()
    folder = Path(command.output or f"runs/{command.label()}-seed{command.seed}")
    settings = Settings(fraction=command.fraction) if command.fraction else Settings()
    config: dict[str, Any] = {}
    if command.resume:
        command, settings, config = read_config(folder, command)
        check(replace(command, steps=command.steps or None))
    elif (folder / "checkpoint.json").exists():
        raise OptionError(f"{folder} holds a run already; add --resume, or choose another --output")
    elif command.minutes is None and command.steps is None:
        command = replace(command, minutes=options.MINUTES)
    rig, move = command.target()
    if status := refuse(INFEASIBLE, problems_of(rig, move)):
        return status
    from .ppo import Training  # loads torch

    training = Training(rig, move, command, settings, folder, console())
    if not command.resume:
        make_run_folder(folder)
    write_config(folder, command, settings, dumps(rig, move), config, training.steps)
    training.run()
    return DONE


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
