"""`flatrig bench vectors`: how many steps a second vector environments take, as trainers see them.

    flatrig bench vectors --rig overhead --repetitions 5

Feedforward, PD and a residual with random actions, standard disturbances, episodes that begin anew.
Native vectors step all simulations together in C threads; Gymnasium's `SyncVectorEnv` and
stable-baselines3's `DummyVecEnv` step single environments one after the other.
"""

import os
import statistics
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode
from rich.table import Table

from ... import envs, models
from .. import options
from ..console import console
from ..tables import table

SIZES = (1, 8, 64)
"""Numbers of simulations."""
STEPS = 200
"""Steps of all simulations together that are timed at once, at the least."""
RIGS = ("overhead", "rotary")
"""Cranes where none is named."""
FRACTION = 0.02
"""Of the limits, for random actions that leave ropes taut."""


def main(command: options.Bench) -> int:
    """Print a table for each rig."""
    out = console()
    for name in command.rig or RIGS:
        out.print(speed_table(models.make(name), command.repetitions))
    return 0


def speed_table(rig: models.Rig, repetitions: int) -> Table:
    """Steps a second of every kind of vector, by its size."""
    lines = table(
        f"{rig.name}: environment steps a second, medians, {os.cpu_count()} processors",
        "vector", *(f"{size} simulations" for size in SIZES), f"over the next, {SIZES[-1]}",
    )  # fmt: skip
    kinds = list(_kinds(rig))
    speeds = [[_speed(make(size), size, repetitions) for size in SIZES] for _, make in kinds]
    for index, (label, _) in enumerate(kinds):
        beside = "" if index % 2 else f"{speeds[index][-1] / speeds[index + 1][-1]:.1f}"
        lines.add_row(label, *(f"{speed:.0f}" for speed in speeds[index]), beside)
    return lines


def _kinds(rig: models.Rig) -> Iterator[tuple[str, Callable[[int], Any]]]:
    """Labels, and what makes a vector of some size that is ready to be stepped; in pairs."""
    made = partial(envs.make_vec, envs.OWN, rig=rig, disturbances="standard", wrappers=WRAPPERS)
    yield "native, Gymnasium", lambda size: _gymnasium(made(num_envs=size))
    yield (
        "SyncVectorEnv",
        lambda size: _gymnasium(made(num_envs=size, vectorization_mode="sync")),
    )
    try:
        from stable_baselines3.common.vec_env import DummyVecEnv

        from ...envs.sb3 import VecEnv
    except ImportError:  # the table goes without them
        return
    same = {"autoreset_mode": AutoresetMode.SAME_STEP}
    yield (
        "native, envs.sb3.VecEnv",
        lambda size: _stable(VecEnv(made(num_envs=size, vector_kwargs=same))),
    )
    yield "DummyVecEnv", lambda size: _stable(DummyVecEnv([partial(_single, rig)] * size))


WRAPPERS = (envs.PD, envs.Feedforward, partial(envs.Residual, fraction=FRACTION))


def _single(rig: models.Rig) -> Any:
    env: Any = gym.make(envs.OWN, rig=rig, disturbances="standard")
    for wrapper in WRAPPERS:
        env = wrapper(env)
    return env


def _gymnasium(vector: Any) -> Callable[[Any], Any]:
    vector.reset(seed=0)
    return vector.step  # type: ignore[no-any-return]


def _stable(vector: Any) -> Callable[[Any], Any]:
    vector.seed(0)
    vector.reset()
    return vector.step  # type: ignore[no-any-return]


def _speed(step: Callable[[Any], Any], size: int, repetitions: int) -> float:
    """Steps of single simulations a second, the median of some timings after one to warm up."""
    vector = step.__self__  # type: ignore[attr-defined]
    drives = getattr(vector, "single_action_space", vector.action_space).shape[0]
    count = max(1, STEPS // size)
    actions = np.random.default_rng(0).uniform(-1, 1, (count, size, drives)).astype(np.float32)
    seconds = []
    for _ in range(repetitions + 1):
        begin = time.perf_counter()
        for action in actions:
            step(action)
        seconds.append(time.perf_counter() - begin)
    vector.close()
    return count * size / statistics.median(seconds[1:])
