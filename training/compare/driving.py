"""Driving the scenarios of a comparison: all of them at once, with one contender after another."""

from collections.abc import Callable, Container, Iterator, Sequence
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from rich.progress import track

from ...models.errors import OptionError
from ...models.types import Mask
from ..console import console
from .contenders import Contender, Plant, contenders_for

Driven = TypeVar("Driven")


class AllDriven(NamedTuple, Generic[Driven]):
    """What contenders did, and which of them could do nothing."""

    runs: list[Driven]
    """Of every contender that could run."""
    absent: list[Contender]
    """Learned contenders without the policy that they need."""
    refused: dict[str, str]
    """Names of contenders that do not bear this rig or hand, and why."""


def drive_all(
    plant: Plant,
    drive: Callable[[Contender], Driven],
    policies: Container[str] = (),
    bar: bool = True,
) -> AllDriven[Driven]:
    """Drive with every contender for a plant.

    Learned ones whose sensors are not among those with `policies` are left out.  A terminal shows a
    bar of progress meanwhile, unless there is to be none.

    Raises
    ------
    OptionError
        No contender bears it.
    """
    contenders = contenders_for(plant)
    absent = [entry for entry in contenders if entry.learned and entry.sensors not in policies]
    running = [entry for entry in contenders if entry not in absent]
    out = console(stderr=True)
    hidden = not (bar and out.is_terminal)
    runs: list[Driven] = []
    refused: dict[str, str] = {}
    for entry in track(running, "Driving", transient=True, console=out, disable=hidden):
        try:
            runs.append(drive(entry))
        except OptionError as error:
            refused[entry.name] = str(error)
    if not runs:
        raise OptionError(next(iter(refused.values())))
    return AllDriven(runs, absent, refused)


def periods(
    env: Any, options: dict[str, Sequence[Any]], seed: int | Sequence[int] = 0
) -> Iterator[tuple[Mask, dict[str, Any]]]:
    """Begin N episodes at once; the iterator then steps through their control periods, endlessly.

    Parameters
    ----------
    env
        Vector environment, with the controller around it.
    options, seed
        Of the reset: how each of the N plants differs from the rig or hand, and what it is to do.

    Returns
    -------
    Iterator
        Of each period which runs have not ended early by its end, shape (N,), and the infos.
    """
    env.reset(seed=seed, options=options)
    return _steps(env)


def _steps(env: Any) -> Iterator[tuple[Mask, dict[str, Any]]]:
    action, alive = np.zeros(env.action_space.shape), np.ones(env.num_envs, dtype=bool)
    while True:
        _, _, terminated, _, info = env.step(action)
        alive = alive & ~terminated
        yield alive, info
