"""The result folder of a training run: how a run begins there, and how it goes on."""

import json
import os
import platform
import shlex
import sys
from dataclasses import asdict, fields, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from ...models import dumps, loads
from ...models.errors import OptionError
from ...models.files import OutputError, write_text
from ...models.reading import read_json, read_text
from .. import options
from .settings import VALIDATION_EPISODES, VALIDATION_SEED, Settings

TABLES = ("progress.csv", "evaluation.csv")
"""Files to which a run adds rows."""
FREE = ("minutes", "iterations", "threads", "every", "tensorboard")
"""Options in which the rest of a resumed run may differ from its beginning."""
OF_THE_CALL = ("rig", "output", "resume", "seeds", "on", "processes")
"""Options that a run does not go on with."""
PACKAGES = ("flatrig", "numpy", "mujoco", "gymnasium", "torch", "stable-baselines3")
"""Packages whose versions a result depends on."""


def check_run(folder: Path, *, resume: bool) -> None:
    """Refuse to resume a run where there is none, and to begin one where there is.

    Raises
    ------
    OptionError
        Saying which.
    """
    there = os.path.exists(folder / "checkpoint.json")
    if resume and not there:
        raise OptionError(f"there is no checkpoint in {folder} to resume from")
    if there and not resume:
        raise OptionError(f"{folder} holds a run already; add --resume, or choose another --output")


def read_config(
    folder: Path, command: options.Train
) -> tuple[options.Train, Settings, dict[str, Any]]:
    """What a run to resume was begun with: options, settings, and all of its config.json.

    An option that `command` leaves at its default is the run's own, the budget that of the last
    resumption.

    Raises
    ------
    OptionError
        Its file cannot be read, or `command` asks for another run.
    """
    path = folder / "config.json"
    config = read_json(path, OptionError)
    try:
        settings = Settings(**_tuples(config["settings"]))
        begun_with = _tuples(config["options"])
        for resumption in config.get("resumed", []):
            begun_with |= {"minutes": resumption["minutes"], "iterations": resumption["iterations"]}
        rig = config["rig"]
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise OptionError(f"{path} is of no run that this version can resume: {error}") from None
    mismatch = f"{command.rig} is not the rig with the move in {path}, which the run is about"
    if command.target()[0].name != loads(rig)[0].name:
        raise OptionError(mismatch)
    command = _with_options(command, begun_with, folder)
    if dumps(*command.target()) != dumps(*loads(rig)):
        raise OptionError(mismatch)
    return command, settings, config


def _with_options(
    command: options.Train, begun_with: dict[str, Any], folder: Path
) -> options.Train:
    """The command with the run's own options where it has none; refuses another run's."""
    values: dict[str, Any] = {}
    for item in fields(command):
        name, value = item.name, getattr(command, item.name)
        if name in OF_THE_CALL or name not in begun_with:
            continue
        if value == item.default:
            values[name] = begun_with[name]
        elif name not in FREE and value != begun_with[name]:
            raise OptionError(
                f"--{name} is {_text(value)}, but the run in {folder} was begun with "
                f"{_text(begun_with[name])}; leave it out to go on with that run"
            )
    if command.minutes is not None or command.iterations is not None:
        values |= {"minutes": command.minutes, "iterations": command.iterations}
    return replace(command, **values)


def _tuples(entries: dict[str, Any]) -> dict[str, Any]:
    """JSON's lists as the tuples that they were."""
    return {k: tuple(v) if isinstance(v, list) else v for k, v in entries.items()}


def _text(value: Any) -> str:
    return " ".join(map(str, value)) or "none" if isinstance(value, tuple) else str(value)


def make_run_folder(folder: Path) -> None:
    """Make the result folder, without what a run before its first checkpoint put there.

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


def cut_tables(folder: Path, iteration: int) -> None:
    """Take from the tables of a run what it has noted after its checkpoint.

    Parameters
    ----------
    folder
        Result folder of the run.
    iteration
        That of the checkpoint.

    Raises
    ------
    OptionError
        What should be a table is none.
    OutputError
        It cannot be written.
    """
    for path in (folder / name for name in TABLES):
        if not path.exists():
            continue
        text = read_text(path, OptionError)
        kept = _until(path, text.splitlines(keepends=True), iteration)
        if kept != text:
            write_text(path, kept)


def _until(path: Path, lines: list[str], iteration: int) -> str:
    """Lines of a table up to an iteration, without a last one that was cut off."""
    kept = lines[:1]
    names = "".join(kept).strip().split(",")
    if kept and "iteration" not in names:
        raise OptionError(f"{path} is no table of a training run, it has no column 'iteration'")
    for line in lines[1:]:
        row = dict(zip(names, line.split(","), strict=False))
        whole = line.endswith("\n") and len(row) == len(names) and row["iteration"].isdecimal()
        if not whole or int(row["iteration"]) > iteration:
            break
        kept.append(line)
    return "".join(kept)


def write_config(
    folder: Path,
    command: options.Train,
    settings: Settings,
    rig: str,
    config: dict[str, Any],
    iteration: int,
) -> None:
    """Write config.json: what runs, or added to the `config` of a run, that it goes on.

    Parameters
    ----------
    folder
        Result folder of the run.
    command, settings
        What the run is begun with.
    rig
        Rig and move as TOML.
    config
        What config.json holds, empty for a new run.
    iteration
        That of the checkpoint.

    Raises
    ------
    OutputError
        It cannot be written.
    """
    if config:
        resumption = {"command": command_line(), "from": iteration}
        resumption |= {"minutes": command.minutes, "iterations": command.iterations}
        config = config | {"resumed": [*config.get("resumed", []), resumption]}
    else:
        config = {
            "command": command_line(),
            "options": asdict(command),
            "settings": asdict(settings),
            "validation": {"seed": VALIDATION_SEED, "episodes": VALIDATION_EPISODES},
            "versions": versions(),
            "machine": {"system": platform.platform(), "processors": os.cpu_count()},
            "rig": rig,
        }
    write_text(folder / "config.json", json.dumps(config, indent=2) + "\n")


def command_line() -> str:
    """The command that runs, ready to paste."""
    return shlex.join(["flatrig", *sys.argv[1:]])


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that a result depends on."""
    numbers = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            numbers[name] = version(name)
        except PackageNotFoundError:
            numbers[name] = "not installed as a package"
    return numbers
