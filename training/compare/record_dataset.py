"""`flatrig dataset`: what a controller does, as a dataset of Minari; needs the extra `minari`.

    flatrig dataset overhead --controller ff+pd --episodes 100 -o datasets

Controllers are those of `flatrig compare`, by their names without spaces.  Actions are what reaches
the bare environment, inputs over their limits, in the precision in which they are stored: from an
episode's seed they repeat it to the last bit.
"""

import importlib.util
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
from rich.progress import track

from ... import envs
from ...models import CATALOGUE, HAND_CATALOGUE, Hand, HandMove, Move, Rig
from ...models.errors import OptionError
from ...models.files import make_folder, unwinding
from .. import options
from ..console import console
from ..describe.feasible import INFEASIBLE, problems_of
from ..exits import DONE, refuse
from ..option_values import check_number, output_folder
from ..policy import Policy
from .chosen import named, policy_for
from .contenders import Contender, Plant

ROOT = "MINARI_DATASETS_PATH"
"""Environment variable in which Minari has the folder of its datasets."""
NEEDED = ("minari", "h5py", "jax")
"""Packages with which Minari records."""


class Stored(gym.ActionWrapper[Any, Any, Any]):
    """Hands down actions as they are stored: within the action space, and in its precision."""

    def action(self, action: Any) -> Any:
        """The action, clipped and rounded."""
        space: Any = self.action_space
        return np.clip(action, space.low, space.high).astype(space.dtype)


def of_a_crane(command: options.Dataset) -> int:
    """Record a crane."""
    check(command)
    rig, move = command.target()
    if status := refuse(INFEASIBLE, problems_of(rig, move)):
        return status
    return _main(command, "crane", rig, move)


def of_a_hand(command: options.Dataset) -> int:
    """Record a hand."""
    check(command)
    return _main(command, "hand", *command.hand_target())


def check(command: options.Dataset) -> None:
    """Refuse what cannot be, before anything is made.

    Raises
    ------
    OptionError
        A number is wrong, or a package is missing.
    """
    check_number("--episodes", command.episodes, lowest=1, open_end=False)
    check_number("--seed", command.seed, open_end=False)
    for name in NEEDED:
        if importlib.util.find_spec(name) is None:
            raise OptionError(f"datasets need the package {name}: pip install 'flatrig[minari]'")


def _main(command: options.Dataset, kind: Plant, plant: Rig | Hand, move: Move | HandMove) -> int:
    entry = named(command.controller, kind)
    slug = re.sub(r"[^a-z0-9]+", "-", entry.name.lower())
    name = command.name or f"{plant.name}/{slug}-v0"
    output_folder(command.output, "")  # datasets are folders
    with datasets_in(command.output), unwinding():
        place = _place(name, command.replace)
        policy = _policy(command, entry, plant)
        env = _environment(command, entry, plant, move)
        told = _record(command, entry, env, policy, name, place)
    console().print(told, soft_wrap=True)
    return DONE


@contextmanager
def datasets_in(folder: str) -> Iterator[None]:
    """Let Minari have its datasets in a folder; its own if that is ""."""
    before = os.environ.get(ROOT)
    if folder:
        make_folder(Path(folder))
        os.environ[ROOT] = os.path.abspath(folder)
    try:
        yield
    finally:
        if folder and before is None:
            del os.environ[ROOT]
        elif folder:
            os.environ[ROOT] = before or ""


def _place(name: str, replace: bool) -> Path:
    """Where a dataset will be.

    Raises
    ------
    OptionError
        The name is none of Minari, or there is one already, which is not to be replaced.
    """
    from minari.dataset.minari_dataset import parse_dataset_id
    from minari.storage import get_dataset_path

    try:
        parse_dataset_id(name)
    except (ValueError, TypeError):
        raise OptionError(
            f"--name is {name}, it must be like overhead_crane/ff-pd-v0: letters, digits, - and _, "
            "and a version"
        ) from None
    place = Path(get_dataset_path(name))
    if place.exists() and not replace:
        raise OptionError(
            f"there is a dataset {name} in {place} already; say --replace, or take another --name"
        )
    return place


def _policy(command: options.Dataset, entry: Contender, plant: Rig | Hand) -> Policy | None:
    if command.policy and not entry.learned:
        raise OptionError(f"--policy is for controllers that are learned, not {entry.name}")
    return policy_for(entry, plant, Policy.load(command.policy) if command.policy else None)


def _environment(
    command: options.Dataset, entry: Contender, plant: Rig | Hand, move: Move | HandMove
) -> Any:
    """The bare environment, by its registered name and with no more options than it needs."""
    given: dict[str, Any] = {"sensors": command.sensors or entry.sensors}
    if not command.nominal:
        given["disturbances"] = "standard"
    hand = isinstance(plant, Hand)
    catalogue: Any = HAND_CATALOGUE if hand else CATALOGUE
    known = plant.name in catalogue and catalogue.make(plant.name) == plant
    if command.moves == "random":
        given["reference"] = "random"
    elif not known or move != catalogue.entry(plant.name).move:
        given["reference"] = move
    names = [name for name, own in catalogue.environments.items() if own == plant.name]
    if not (known and names):
        given["hand" if hand else "rig"] = plant
    return gym.make(names[0] if names else envs.OWN, **given)


def _record(
    command: options.Dataset, entry: Contender, env: Any, policy: Policy | None, name: str,
    place: Path,
) -> str:  # fmt: skip
    """Drive the episodes and store them; says what was stored."""
    import minari

    collector = minari.DataCollector(env, record_infos=True)
    try:
        stored = Stored(collector)
        above = entry.wrap(stored) if policy is None else entry.wrap(stored, policy=policy)
        out = console(stderr=True)
        seeds = range(command.seed, command.seed + command.episodes)
        bar = track(seeds, "Recording", transient=True, console=out, disable=not out.is_terminal)
        steps, ended, rewards = 0, 0, []
        for seed in bar:
            length, total, early = _episode(above, seed)
            steps, ended = steps + length, ended + early
            rewards.append(total)
        if place.exists():
            minari.delete_dataset(name)
        collector.create_dataset(
            name,
            eval_env=env.spec,
            algorithm_name=entry.name,
            author="flatrig",
            author_email="none",
            code_permalink="none",
            description=f"{entry.name} from seed {command.seed} on, recorded by flatrig dataset",
            requirements=[],
        )
    finally:
        collector.close()
    return (
        f"wrote {place}: {command.episodes} episodes, {steps} steps, mean return "
        f"{np.mean(rewards):.4g}, {ended} ended early; minari.load_dataset({name!r})"
    )


def _episode(env: Any, seed: int) -> tuple[int, float, bool]:
    """Steps, return, and whether it ended early."""
    env.reset(seed=seed)
    still = np.zeros(env.action_space.shape)
    steps, total = 0, 0.0
    while True:
        _, reward, terminated, truncated, _ = env.step(still)
        steps, total = steps + 1, total + float(reward)
        if terminated or truncated:
            return steps, total, bool(terminated)
