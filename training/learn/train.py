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
from dataclasses import asdict, dataclass, fields, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from ...models import dumps, loads
from ...models.errors import OptionError
from ...models.files import OutputError, write_text
from .. import options
from ..console import console

VALIDATION_SEED = 2001_2016
"""Of the scenarios on which policies are judged during training."""
VALIDATION_SCENARIOS = 50
TABLES = ("progress.csv", "evaluation.csv")
FREE = ("minutes", "steps", "threads", "evaluations")
"""Options in which the rest of a resumed run may differ from its beginning."""
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
    check(command)
    check_extra()
    folder = Path(command.output or f"runs/{command.label()}-seed{command.seed}")
    settings = Settings(fraction=command.fraction) if command.fraction else Settings()
    facts: dict[str, Any] = {}
    if command.resume:
        command, settings, facts = begun(folder, command)
    elif (folder / "checkpoint.json").exists():
        raise OptionError(f"{folder} holds a run already; add --resume, or choose another --output")
    elif command.minutes is None and command.steps is None:
        command = replace(command, minutes=options.MINUTES)
    rig, move = command.target()
    from .ppo import Training

    training = Training(rig, move, command, settings, folder, console())
    if not command.resume:
        start(folder)
    describe(folder, command, settings, dumps(rig, move), facts, training.steps)
    training.run()


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


def begun(folder: Path, command: options.Train) -> tuple[options.Train, Settings, dict[str, Any]]:
    """What a run to resume was begun with: options, settings, and all of its config.json.

    An option that `command` leaves at its default is the run's own, the budget that of the last
    resumption.

    Raises
    ------
    OptionError
        There is no run, or `command` asks for another one.
    """
    config = folder / "config.json"
    if not (folder / "checkpoint.json").exists():
        raise OptionError(f"there is no checkpoint in {folder} to resume from")
    try:
        facts = json.loads(config.read_text(encoding="utf-8"))
        settings = Settings(**_tuples(facts["settings"]))
        held = _tuples(facts["options"])
        for later in facts.get("resumed", []):
            held |= {"minutes": later["minutes"], "steps": later["steps"]}
        rig = facts["rig"]
    except OSError as error:
        raise OptionError(f"cannot read {config}: {error.strerror}") from None
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise OptionError(f"{config} is of no run that this version can resume: {error}") from None
    values: dict[str, Any] = {}
    other = f"{command.rig} is not the rig with the move in {config}, which the run is about"
    if command.target()[0].name != loads(rig)[0].name:
        raise OptionError(other)
    for item in fields(command):
        name, given = item.name, getattr(command, item.name)
        if name in ("rig", "output", "resume") or name not in held:
            continue
        if given == item.default:
            values[name] = held[name]
        elif name not in FREE and given != held[name]:
            raise OptionError(
                f"--{name} is {_text(given)}, but the run in {folder} was begun with "
                f"{_text(held[name])}; leave it out to go on with that run"
            )
    if command.minutes is not None or command.steps is not None:
        values |= {"minutes": command.minutes, "steps": command.steps}
    command = replace(command, **values)
    check(replace(command, steps=command.steps or None))
    if dumps(*command.target()) != rig:
        raise OptionError(other)
    return command, settings, facts


def _tuples(entries: dict[str, Any]) -> dict[str, Any]:
    return {k: tuple(v) if isinstance(v, list) else v for k, v in entries.items()}


def _text(value: Any) -> str:
    return " ".join(map(str, value)) or "none" if isinstance(value, tuple) else str(value)


def start(folder: Path) -> None:
    """Make the result folder; what a run that stopped before its first checkpoint left goes.

    Raises
    ------
    OutputError
        The folder cannot be written, or holds tables that are not of a run.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        unfinished = (folder / "config.json").exists()
        for table in (folder / name for name in TABLES):
            if unfinished and not table.is_dir():
                table.unlink(missing_ok=True)
            elif table.exists():
                raise OutputError(f"cannot write {table}: it is there already")
    except OSError as error:
        raise OutputError(f"cannot write {folder}: {error.strerror}") from None


def describe(
    folder: Path,
    command: options.Train,
    settings: Settings,
    rig: str,
    facts: dict[str, Any],
    steps: int,
) -> None:
    """Write config.json: what runs, or with the `facts` of a run, that it goes on at `steps`.

    Raises
    ------
    OutputError
        It cannot be written.
    """
    if facts:
        later = {"command": command_line(), "from": steps}
        later |= {"minutes": command.minutes, "steps": command.steps}
        facts = facts | {"resumed": [*facts.get("resumed", []), later]}
    else:
        facts = {
            "command": command_line(),
            "options": asdict(command),
            "settings": asdict(settings),
            "validation": {"seed": VALIDATION_SEED, "scenarios": VALIDATION_SCENARIOS},
            "versions": versions(),
            "machine": {"system": platform.platform(), "processors": os.cpu_count()},
            "rig": rig,
        }
    write_text(folder / "config.json", json.dumps(facts, indent=2) + "\n")


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
