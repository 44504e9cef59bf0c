"""Stressed episodes of the environments: they end with a reason, and say nothing but numbers.

Swings over 90 degrees, drives with a hundred times their limits, plants nothing like the model,
time steps beyond the stability limit, and actions that are not numbers.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ... import models
from ...envs import CraneEnv, Scenario
from ...models.types import Array
from .case import REFUSED, STOPPED, Case, Finding, Stopped, case

Policy = Callable[[np.random.Generator, int], Array]

SPIKE = 100.0
"""Times its limit that a drive can give."""
STEPS = 5
"""Control periods that a spike lasts."""

PLANTS = {
    "swing of 100 degrees": Scenario(swing=math.radians(100.0)),
    "swing of 179 degrees": Scenario(swing=math.radians(179.0)),
    "load of 1e-3": Scenario(load_mass=1e-3),
    "load of 1e3": Scenario(load_mass=1e3),
    "wind of 1e6 N": Scenario(wind=1e6),
    "winches stuck": Scenario(winch_friction=1e6),
    "viscous winches": Scenario(winch_viscous=1e9),
}
"""Plants by what is absurd about them."""


def cases() -> Iterator[Case]:
    """Cases of episodes."""
    either = (REFUSED, STOPPED)
    for name in models.CATALOGUE:
        for plant in PLANTS:
            row = "swings over 90 degrees in environments"
            row = row if "swing" in plant else "environments, absurd plants"
            yield case(row, f"{name}, {plant}", in_plant, name, plant, must=either)
        yield case("environments, drives of 100 limits", name, spiked, name, must=either)
        for rate, step in ((50.0, 0.02), (2.0, 0.5), (0.1, 10.0)):
            row, label = "environments, steps of 0.02 to 10 s", f"{name}, {step:g} s"
            yield case(row, label, coarse, name, rate, step, must=either)
        for value in (math.nan, math.inf, 1e300):
            row, label = "environments, absurd actions", f"{name}, {value:g}"
            yield case(row, label, absurd, name, value, must=either)


def episode(env: CraneEnv, policy: Policy, **options: Any) -> Finding:
    """Run one to its end.

    Raises
    ------
    Stopped
        With the reason that the environment names; that is how an episode must end.
    """
    draw = np.random.default_rng(0)
    observation, _ = env.reset(seed=0, options=options)
    limits = env.task.limits * (1.0 + 1e-12)
    for step in range(100_000):
        numbers: list[Any] = [observation]
        observation, reward, terminated, truncated, info = env.step(policy(draw, step))
        numbers += [observation, reward, info["load"], info["tension"], info["input"]]
        if not all(np.isfinite(number).all() for number in numbers):
            return Finding(math.nan, 0.0, "a number that is none")
        if not 0.0 <= reward <= 1.0 or (np.abs(info["input"]) > limits).any():
            return Finding(math.inf, 1.0, f"reward {reward}, input {info['input']}")
        if terminated or truncated:
            if not info["reason"]:
                return Finding(math.inf, 1.0, "an end without a reason")
            raise Stopped(info["reason"])
    return Finding(math.inf, 1.0, "an episode without an end")


def _random(size: int) -> Policy:
    return lambda draw, _: draw.uniform(-1.0, 1.0, size)


def in_plant(name: str, plant: str) -> Finding:
    """Random inputs in a plant nothing like the rig."""
    friction = {"winch_friction": (0.0, 1.0)}
    env = CraneEnv(models.make(name), disturbances=friction if "stuck" in plant else None)
    return episode(env, _random(len(env.task.limits)), scenario=PLANTS[plant])


def spiked(name: str) -> Finding:
    """Drives that can give a hundred times as much, and do for a while."""
    rig = models.make(name)
    drives = tuple(replace(drive, limit=SPIKE * drive.limit) for drive in rig.drives)
    env = CraneEnv(replace(rig, drives=drives))

    def policy(draw: np.random.Generator, step: int) -> Array:
        return draw.choice((-1.0, 1.0), len(drives)) * (step < STEPS)

    return episode(env, policy)


def coarse(name: str, rate: float, step: float) -> Finding:
    """Large time steps."""
    env = CraneEnv(models.make(name), rate=rate, timestep=step)
    return episode(env, _random(len(env.task.limits)))


def absurd(name: str, value: float) -> Finding:
    """Actions that are no numbers, or huge: refused or clipped."""
    env = CraneEnv(models.make(name))
    return episode(env, lambda _, step: np.full(len(env.task.limits), value if step > 2 else 0.0))
