"""`flatrig train`: a residual policy on top of feedforward + PD, with PPO from stable-baselines3.

    flatrig train overhead --seed 0 --minutes 10

The result folder holds config.json (what exactly ran), progress.csv (the learning), evaluation.csv
(tracking error over scenarios it does not train on), checkpoint.* for `--resume`, and the policy
with the lowest error in these evaluations as policy.safetensors and policy.json.
"""

import importlib.util
import json
import os
import platform
import shlex
import sys
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from ..models import Move, Rig, dumps
from ..models.errors import OptionError
from ..models.files import OutputError, write_text
from . import options
from .console import console

VALIDATION_SEED = 2001_2016
"""Of the scenarios on which policies are judged during training."""
VALIDATION_SCENARIOS = 50
PACKAGES = ("flatrig", "numpy", "mujoco", "gymnasium", "torch", "stable-baselines3")


@dataclass(frozen=True)
class Settings:
    """How a policy learns; one set of numbers for all rigs."""

    hidden: tuple[int, ...] = (64, 64)
    """Widths of the layers, of actor and critic alike."""
    reach: float = 0.12
    """How far the largest residual can push the load against the feedback [m]."""
    fraction: float = 0.0
    """If > 0, the largest residual as a share of the inputs' limits, instead of what follows."""
    time_constants: tuple[float, ...] = (0.1, 0.4, 1.5, 5.0)
    """Of the policy's memory [s]."""
    smoothing: float = 0.5
    """Of the policy's action."""
    every: int = 5
    """Control periods from one decision to the next."""
    timestep: float = 5e-3
    """Of the simulation in training [s]; policies are judged with the environment's own."""
    imitation: float = 0.5
    """Share of the budget in which the policy learns from the teacher, before PPO."""
    lessons: int = 40
    """Updates' worth of what the teacher said that are kept."""
    decisions: int = 64
    """Of each simulation between two updates."""
    batch: int = 512
    """Samples for one gradient."""
    epochs: int = 5
    """Passes of PPO over the samples of one update."""
    gradients: int = 200
    """Gradients of one update of imitation."""
    imitation_rate: float = 1e-3
    """Learning rate of imitation."""
    learning_rate: float = 3e-4
    """Of PPO at its start; falls linearly to a tenth."""
    discount: float = 0.97
    """For one decision."""
    trace: float = 0.95
    """lambda of the generalised advantage estimate."""
    divergence: float = 0.03
    """PPO ends an update early where the policy has changed by 1.5 times this."""
    sharpness: float = 2.0
    """Distance at which the reward is 0, in tracking errors of feedforward + PD."""
    deviation: float = 0.2
    """Of the exploration at the start, as a share of the residual."""


def main(command: options.Train) -> None:
    """Train, with a result folder."""
    rig, move = command.target()
    options.check_number("--minutes", command.minutes)
    for name in ("envs", "threads", "evaluations"):
        options.check_number(f"--{name}", getattr(command, name))
    options.check_number("--fraction", command.fraction, open_end=False)
    if command.fraction > 1:
        raise OptionError(f"--fraction is {command.fraction:g}, it must be <= 1")
    check_extra()
    folder = Path(command.output or f"runs/{command.label()}-seed{command.seed}")
    settings = Settings(fraction=command.fraction) if command.fraction else Settings()
    prepare(folder, command, rig, move, settings)
    from .ppo import Training

    training = Training(rig, move, command, settings, folder, console())
    training.run()


def check_extra() -> None:
    """Refuse to train without the packages for it.

    Raises:
        OptionError: naming the extra to install.
    """
    missing = [
        name for name in ("torch", "stable_baselines3") if not importlib.util.find_spec(name)
    ]
    if missing:
        raise OptionError(
            f"training needs {' and '.join(missing)}: pip install 'flatrig[train]' (or make train)"
        )


def prepare(folder: Path, command: options.Train, rig: Rig, move: Move, settings: Settings) -> None:
    """Make the result folder and say in it what runs.

    Raises:
        OptionError: there is a run in it already and `--resume` is not given, or none to resume.
        OutputError: the folder cannot be written.
    """
    config = folder / "config.json"
    if command.resume:
        if not (folder / "checkpoint.json").exists():
            raise OptionError(f"there is no checkpoint in {folder} to resume from")
    elif config.exists():
        raise OptionError(f"{folder} holds a run already; add --resume, or choose another --output")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot write {folder}: {error.strerror}") from None
    facts = {
        "command": command_line(),
        "options": asdict(command),
        "settings": asdict(settings),
        "validation": {"seed": VALIDATION_SEED, "scenarios": VALIDATION_SCENARIOS},
        "versions": versions(),
        "machine": {"system": platform.platform(), "processors": os.cpu_count()},
        "rig": dumps(rig, move),
    }
    if not command.resume:
        write_text(config, json.dumps(facts, indent=2) + "\n")


def command_line() -> str:
    """The command that runs, ready to paste."""
    return shlex.join(["flatrig", *sys.argv[1:]])


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that a result depends on."""
    found = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed as a package"
    return found


def append_csv(path: Path, row: dict[str, Any]) -> None:
    """Add a row to a CSV, its header first."""
    new = not path.exists()
    with path.open("a", encoding="utf-8") as file:
        if new:
            file.write(",".join(row) + "\n")
        file.write(",".join(str(value) for value in row.values()) + "\n")
