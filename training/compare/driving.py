"""Driving the scenarios of a comparison: all of them at once, with one contender after another."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from rich.progress import track

from ...models.types import Mask
from ..console import console
from .contenders import Contender, Plant, contenders_for
from .report import Run


def drive_all(
    plant: Plant, drive: Callable[[Contender], Run], learned: bool
) -> tuple[list[Run], list[Contender]]:
    """The run of every contender for a plant, and those left out: the learned if not `learned`."""
    contenders = contenders_for(plant)
    absent = [entry for entry in contenders if entry.learned and not learned]
    running = [entry for entry in contenders if entry not in absent]
    out = console(stderr=True)
    bar = track(running, "Driving", transient=True, console=out, disable=not out.is_terminal)
    return [drive(entry) for entry in bar], absent


def periods(env: Any, scenarios: Sequence[Any]) -> Iterator[tuple[Mask, dict[str, Any]]]:
    """Begin N scenarios at once; the iterator then steps through their control periods, endlessly.

    Parameters
    ----------
    env
        Vector environment, with the controller around it.
    scenarios
        How each of the N plants differs from the rig or hand.

    Returns
    -------
    Iterator
        Of each period which runs have not ended early by its end, shape (N,), and the infos.
    """
    env.reset(seed=0, options={"scenarios": list(scenarios)})
    return _steps(env)


def _steps(env: Any) -> Iterator[tuple[Mask, dict[str, Any]]]:
    action, alive = np.zeros(env.action_space.shape), np.ones(env.num_envs, dtype=bool)
    while True:
        _, _, terminated, _, info = env.step(action)
        alive = alive & ~terminated
        yield alive, info
