"""Driving the scenarios of a comparison: all of them at once, with one contender after another."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from rich.progress import track

from ...models.types import Mask
from ..console import console
from ..policy import Policy
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


def periods(
    env: Any, scenarios: Sequence[Any], policy: Policy | None = None
) -> Iterator[tuple[Mask, dict[str, Any]]]:
    """Begin N scenarios at once; the iterator then steps through their control periods, endlessly.

    Parameters
    ----------
    env
        Vector environment, with the controller around it.
    scenarios
        How each of the N plants differs from the rig or hand.
    policy
        Policy that chooses the action from above; it is zero without one.

    Returns
    -------
    Iterator
        Of each period which runs have not ended early by its end, shape (N,), and the infos.
    """
    observation, _ = env.reset(seed=0, options={"scenarios": list(scenarios)})
    return _steps(env, observation, policy)


def _steps(
    env: Any, observation: Any, policy: Policy | None
) -> Iterator[tuple[Mask, dict[str, Any]]]:
    action, alive = np.zeros(env.action_space.shape), np.ones(env.num_envs, dtype=bool)
    memory = policy.start(env.num_envs) if policy else None
    while True:
        if policy and memory:
            action = policy(observation, memory)
        observation, _, terminated, _, info = env.step(action)
        alive = alive & ~terminated
        yield alive, info
