"""An environment driven by one controller through one episode, for figures, tables and films."""

from typing import Any, NamedTuple

import numpy as np

from ...envs import CraneEnv, HandEnv
from ...models.types import Array
from ..compare.chosen import Choice


class Driven(NamedTuple):
    """What happened at T instants, a control period apart."""

    times: Array
    """[s], shape (T,)."""
    joints: Array
    """Joints of the model, shape (T, nq)."""
    rates: Array
    """Their rates, shape (T, nv)."""
    seen: dict[str, Array]
    """Entries of `info` that were asked for, shape (T, ...)."""
    ended: str
    """Why the episode ended early; "" if it did not."""


def driven(
    env: CraneEnv | HandEnv, choice: Choice, scenario: Any, *names: str, seed: int = 0
) -> Driven:
    """One episode with a controller around an environment; without a scenario the seed draws one.

    Parameters
    ----------
    env
        Plain, with the sensors that the controller needs.
    choice
        The controller.
    scenario
        Of the plant, or None.
    names
        Entries of `info` to keep.
    seed
        Of the reset.
    """
    above = choice.wrap(env)
    _, info = above.reset(seed=seed, options={} if scenario is None else {"scenario": scenario})
    still, terminated, truncated = np.zeros(above.action_space.shape), False, False
    plant, rows = env.task.plant, []
    while True:
        rows.append(
            (plant.qpos[0].copy(), plant.qvel[0].copy(), *(np.array(info[n]) for n in names))
        )
        if terminated or truncated:
            break
        _, _, terminated, truncated, info = above.step(still)
    joints, rates, *kept = (np.array(column) for column in zip(*rows, strict=True))
    return Driven(
        times=np.asarray(env.task.period * np.arange(len(rows)), dtype=np.float64),
        joints=joints,
        rates=rates,
        seen=dict(zip(names, kept, strict=True)),
        ended=env.reasons[int(info["reason"])] if terminated else "",
    )
