"""What the command line asks for: one dataclass for each subcommand, and the rig it is about.

Nothing heavy is imported here, so that `flatrig --help` answers at once.
"""

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from tyro.conf import Positional, arg

from ..models import Move, Rig, default_move, load, load_move, make, printed_move
from ..models.errors import OptionError, did_you_mean

MINUTES = 10.0
"""To train for, if nothing else is said."""

Output = Annotated[str, arg(aliases=("-o",), metavar="PATH")]


@dataclass(frozen=True)
class RigOptions:
    """The rig, and changes to it and to its move."""

    rig: Positional[str]
    """Name in the catalogue ("overhead" is short for overhead_crane), or a TOML file."""
    set: tuple[str, ...] = ()
    """Numbers of the rig to change: load_mass=80 as in the catalogue, or part.field=value."""
    move: str = ""
    """TOML file with another [move], or "printed" for the one of the source that cannot be made."""
    start: tuple[float, ...] = ()
    """Start of the move, one number for each output of the rig [m]."""
    goal: tuple[float, ...] = ()
    """End of the move [m]."""
    duration: float | None = None
    """Duration of the move [s]."""
    profile: Literal["polynomial", "three_phase"] | None = None
    """Shape of the move over time."""
    order: int | None = None
    """Continuous derivatives of a polynomial move."""
    blend: float | None = None
    """Duration of each blend of a three-phase move [s]."""

    def target(self) -> tuple[Rig, Move]:
        """The rig and its move, with the changes made.

        Raises:
            FlatrigError: something names what does not exist, or has a value it cannot have.
        """
        rig, move = _look_up(self.rig, _assignments(self.set))
        if self.move:
            move = printed_move(rig) if self.move == "printed" else load_move(self.move)
        names = ("start", "goal", "duration", "profile", "order", "blend")
        changes = {name: getattr(self, name) for name in names}
        changes = {name: value for name, value in changes.items() if value not in (None, ())}
        if move is None:
            return rig, Move(**changes)
        if move.profile == "sampled" and {"start", "goal", "duration"} <= set(changes):
            changes = {"profile": "polynomial"} | changes
        return rig, replace(move, **changes)

    def label(self) -> str:
        """A name for files about this rig."""
        return Path(self.rig).stem if _is_file(self.rig) else _look_up(self.rig, {})[0].name


@dataclass(frozen=True)
class List:
    """List the rigs of the catalogue with their inputs, outputs and moves."""


@dataclass(frozen=True)
class Analyse(RigOptions):
    """Say how often the equations must be differentiated, and whether the move is feasible."""

    equations: bool = False
    """Also list every equation and unknown with its offset."""
    shortest: bool = False
    """Also find the shortest duration in which the same path can be covered."""
    margin: float = 0.0
    """Lowest tension of any rope to allow in that duration [N]."""


@dataclass(frozen=True)
class Solve(RigOptions):
    """Compute the inputs that make the load follow its path exactly, and write them as CSV."""

    rate: float = 1000.0
    """Samples per second [Hz]."""
    output: Output = ""
    """CSV file to write; without one only a summary is printed."""


@dataclass(frozen=True)
class Compare(RigOptions):
    """Set PD, feedforward and residual side by side over many disturbed scenarios."""

    scenarios: int = 100
    """Number of scenarios."""
    nominal: bool = False
    """One undisturbed scenario instead."""
    policy: str = ""
    """Policy to use as residual (.json); the shipped one if left out."""
    output: Output = ""
    """Folder for the tables and the figure; results/compare-RIG if left out."""


@dataclass(frozen=True)
class Train(RigOptions):
    """Train a residual policy on top of feedforward + PD."""

    seed: int = 0
    """Seed of the network, the exploration and the training scenarios."""
    minutes: float | None = None
    """Wall-clock time to train for; 10 if left out."""
    steps: int | None = None
    """Decisions of the policy to train for, instead of `minutes`."""
    envs: int = 64
    """Simulations in parallel."""
    threads: int = 2
    """Processor threads."""
    fraction: float = 0.0
    """Largest residual as a share of the inputs' limits; chosen for the rig if 0."""
    evaluations: int = 10
    """Evaluations and checkpoints during training."""
    output: Output = ""
    """Result folder; runs/RIG-seedSEED if left out."""
    resume: bool = False
    """Continue from the last checkpoint in the result folder, with its options; only `minutes`,
    `steps`, `threads` and `evaluations` may be others."""

    def progress(self, steps: int, seconds: float) -> float:
        """Share of the budget that is spent after so many decisions and so much time."""
        if self.steps:
            return min(1.0, steps / self.steps)
        return min(1.0, seconds / (60.0 * (self.minutes or MINUTES)))


@dataclass(frozen=True)
class Bench:
    """Measure the solver, the environments and the accuracy in MuJoCo on this machine."""

    repetitions: int = 15
    """How often each timing is repeated."""


@dataclass(frozen=True)
class Accuracy:
    """Say how far exact feedforward lands from its path in MuJoCo, for every crane."""


@dataclass(frozen=True)
class Render(RigOptions):
    """Film the move, driven by exact feedforward, without a display."""

    output: Output = ""
    """GIF or MP4 to write, or PNG for three pictures in a row; results/RIG.gif if left out."""
    camera: str = "overview"
    """Camera of the scene."""
    width: int = 640
    """[pixels]"""
    height: int = 480
    """[pixels]"""
    fps: float = 25.0
    """Frames per second."""


@dataclass(frozen=True)
class Scenes:
    """Write the MuJoCo scenes of the catalogue as XML."""

    output: Output = ""
    """Folder to write to; the package's own models/ if left out."""


@dataclass(frozen=True)
class Reproduce:
    """Compute figures and claims of the sources anew; without a name, list them."""

    name: Positional[str] = ""
    """Name of the figure ("K3.21"), or "all"."""
    list: bool = False
    """List what there is instead."""
    output: Output = ""
    """Folder for figures and tables; results/reproduce if left out."""


def check_number(
    name: str, value: float, *, lowest: float = 0.0, open_end: bool = True, unit: str = ""
) -> None:
    """Refuse an option that is not a finite number above (or at) its lowest value.

    Raises:
        OptionError: with the value and what would be right.
    """
    good = math.isfinite(value) and (value > lowest if open_end else value >= lowest)
    if not good:
        given = f"{value:g} {unit}".strip()
        raise OptionError(f"{name} is {given}, it must be {'>' if open_end else '>='} {lowest:g}")


def _is_file(name: str) -> bool:
    return name.endswith(".toml") or os.sep in name


def _look_up(name: str, changes: Mapping[str, float]) -> tuple[Rig, Move | None]:
    """A rig with its move, from a file or the catalogue; `changes` as for `--set`."""
    of_parts = {key: value for key, value in changes.items() if "." in key}
    of_rig = {key: value for key, value in changes.items() if "." not in key}
    if _is_file(name):
        rig, move = load(name)
        for key in of_rig:
            parts = [part.name for part in _parts(rig)]
            raise OptionError(f"--set {key}: in a file's rig write part.field{_known(parts)}")
    else:
        rig = make(name, **of_rig)
        move = default_move(rig)
    for key, value in of_parts.items():
        rig = _with(rig, key, value)
    return rig, move


def _known(names: list[str]) -> str:
    return f"; parts are {', '.join(names)}"


def _parts(rig: Rig) -> list[Any]:
    return [*rig.frames, *rig.rails, *rig.masses, *rig.ropes, *rig.drives]


def _with(rig: Rig, key: str, value: float) -> Rig:
    """The rig with one number of one part replaced, `key` = part.field."""
    part_name, _, name = key.partition(".")
    holders = [part for part in _parts(rig) if part.name == part_name]
    if not holders:
        known = [part.name for part in _parts(rig)]
        raise OptionError(f"--set {key}: no part {part_name!r}{did_you_mean(part_name, known)}")
    numbers = {
        item.name: part
        for part in holders
        for item in fields(part)
        if isinstance(getattr(part, item.name), float | int)
    }
    if name not in numbers:
        raise OptionError(f"--set {key}: no number {name!r}{did_you_mean(name, numbers)}")
    old, kind = numbers[name], _kind_of(rig, numbers[name])
    changes: dict[str, Any] = {
        kind: tuple(
            replace(part, **{name: value}) if part is old else part for part in getattr(rig, kind)
        )
    }
    return replace(rig, **changes)


def _kind_of(rig: Rig, part: Any) -> str:
    kinds = ("frames", "rails", "masses", "ropes", "drives")
    return next(kind for kind in kinds if any(part is one for one in getattr(rig, kind)))


def _assignments(texts: tuple[str, ...]) -> dict[str, float]:
    """`name=number` texts as a dictionary."""
    values: dict[str, float] = {}
    for text in texts:
        name, equals, number = text.partition("=")
        try:
            values[name] = float(number)
        except ValueError:
            equals = ""
        if not equals or not name:
            raise OptionError(f"--set {text}: write name=number, such as load_mass=80")
    return values
