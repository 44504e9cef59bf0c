"""Driving the scenarios of a comparison: all of them at once, with one contender after another."""

from collections.abc import Callable, Container, Iterator, Sequence
from typing import Any, TypeVar

import numpy as np
from rich.progress import track

from ...models.types import Mask
from ..console import console
from .contenders import Contender, Plant, contenders_for

Driven = TypeVar("Driven")


def drive_all(
    plant: Plant,
    drive: Callable[[Contender], Driven],
    policies: Container[str] = (),
    bar: bool = True,
    suits: Callable[[Contender], bool] = lambda entry: True,
) -> tuple[list[Driven], list[Contender]]:
    """What every contender for a plant did, and those left out.

    Contenders that do not suit are not told of.  Those left out are the learned ones whose sensors
    are not among those with `policies`.  A terminal shows a bar of progress meanwhile, unless there
    is to be none.
    """
    contenders = [entry for entry in contenders_for(plant) if suits(entry)]
    absent = [entry for entry in contenders if entry.learned and entry.sensors not in policies]
    running = [entry for entry in contenders if entry not in absent]
    out = console(stderr=True)
    hidden = not (bar and out.is_terminal)
    entries = track(running, "Driving", transient=True, console=out, disable=hidden)
    return [drive(entry) for entry in entries], absent


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
