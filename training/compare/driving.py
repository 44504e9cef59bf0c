"""Driving the episodes of a comparison: all of them at once, with one contender after another.

Or with several side by side: each contender is an item of `Jobs`.
"""

from collections.abc import Callable, Container, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...models.errors import OptionError
from ...models.types import Mask
from ..jobs import Backend, Jobs, Processes
from .contenders import Contender, Plant, contenders_for
from .kept_runs import Driven, kept, restored


@dataclass(frozen=True)
class How:
    """Where contenders are driven, and whether that is kept and shown."""

    backend: Backend = field(default_factory=Processes)
    file: Path | None = None
    """File that keeps what contenders did; None keeps nothing."""
    resume: bool = False
    """Whether to go on with that file."""
    bar: bool = True
    """Whether a terminal shows a bar of progress."""


ONE_BY_ONE = How()
"""In this process, and nothing is kept."""


class AllDriven(NamedTuple):
    """What contenders did, and which of them could do nothing."""

    found: list[Driven]
    """Of every contender that could run."""
    absent: list[Contender]
    """Learned contenders without the policy that they need."""
    refused: dict[str, str]
    """Names of contenders that do not bear this rig or hand, and why."""


def drive_all(
    plant: Plant,
    entry_of: Callable[[Contender], Any],
    metrics: type,
    how: How,
    policies: Container[str] = (),
) -> AllDriven:
    """Drive with every contender for a plant.

    Parameters
    ----------
    plant
        Whose contenders.
    entry_of
        Makes what a process works on: its methods are `drive` and `identity`.
    metrics
        Dataclass of the metrics.
    how
        Where, and whether that is kept.
    policies
        Sensors of learned contenders with a policy; the others are left out.

    Raises
    ------
    OptionError
        No contender bears it.
    """
    contenders = contenders_for(plant)
    absent = [entry for entry in contenders if entry.learned and entry.sensors not in policies]
    entries = [entry_of(entry) for entry in contenders if entry not in absent]
    jobs: Jobs[Any, Driven] = Jobs(
        type(entries[0]).drive,
        how.backend,
        file=how.file,
        resume=how.resume,
        bar=how.bar,
        encode=kept,
        decode=partial(restored, metrics),
        identity=lambda entry: entry.identity(),
    )
    found: list[Driven] = []
    refused: dict[str, str] = {}
    for result in sorted(jobs.results(entries), key=lambda result: result.number):
        if isinstance(result.failure, OptionError):
            refused[result.item.contender.name] = str(result.failure)
        else:
            found.append(result.value)
    if not found:
        raise OptionError(next(iter(refused.values())))
    return AllDriven(found, absent, refused)


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
