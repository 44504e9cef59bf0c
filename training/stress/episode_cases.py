"""Stressed episodes of the environments: they end with a reason, and say nothing but numbers.

On the plant that it knows exact feedforward follows the path, alone and with feedback, and a load
in a steady wind hangs where the wind and its weight hold the balance.

Swings over 90 degrees, drives with a hundred times their limits, plants nothing like the model,
time steps beyond the stability limit, and actions that are not numbers.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ... import models
from ...envs import PD, CraneEnv, Feedforward, Scenario
from ...feedforward import rest_to_rest
from ...models.rig.frames import rises
from ...models.types import Array
from .case import CORRECT, REFUSED, STOPPED, Case, Finding, Stopped, case

Policy = Callable[[np.random.Generator, int], Array]

SPIKE = 100.0
"""Times its limit that a drive can give."""
STEPS = 5
"""Control periods that a spike lasts."""

NEAR = 5e-3
"""How near its path exact inputs, held for 0.02 s each, keep a load [m]: 3 mm on the worst crane,
and 49 mm where they come half a period late."""
WIND = 20.0
"""Steady force on the overhead crane's load [N]."""
MINUTE = 60.0
"""How long it blows [s]; the swing's mean is then the equilibrium."""

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
        falls = any(map(rises, models.make(name).frames))  # as a boom does under given inputs
        for feedback in (True,) if falls else (False, True):
            row, label = "environments, exact feedforward", f"{name}, feedback {feedback}"
            yield case(row, label, exact, name, feedback, must=(CORRECT,))
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
    yield case("environments, steady wind", "overhead_crane", windy, must=(CORRECT,))


def exact(name: str, feedback: bool) -> Finding:
    """Exact feedforward on the plant that it knows, from start to a second's rest."""
    env = CraneEnv(models.make(name), hold=1.0)
    driven = Feedforward(PD(env)) if feedback else Feedforward(env)
    return Finding(float(np.max(_distances(driven))), NEAR)


def windy() -> Finding:
    """The overhead crane's load in a steady wind, its drives held by feedback."""
    rig = models.overhead_crane()
    load = rig.home["load"]
    assert isinstance(load, tuple)
    path = rest_to_rest((load[0], load[2]), (load[0], load[2]), 1.0)
    env = PD(CraneEnv(rig, reference=path, hold=MINUTE, disturbances={"wind": (0.0, WIND)}))
    stiffness = env.env.unwrapped.task.gains("moving").stiffness[0]
    places = [info["load"][0] for info in _driven(env, scenario=Scenario(wind=WIND))]
    aside = WIND / stiffness - load[2] * WIND / rig.weight
    return Finding(abs(float(np.mean(places)) - load[0] - aside), 0.01 * aside)


def _distances(env: Any) -> list[float]:
    return [float(np.linalg.norm(info["load"] - info["reference"])) for info in _driven(env)]


def _driven(env: Any, **options: Any) -> Iterator[dict[str, Any]]:
    """What each step of an episode says, whose actions are left to the controllers."""
    env.reset(seed=0, options=options)
    over = False
    while not over:
        _, _, terminated, truncated, info = env.step(np.zeros(env.action_space.shape))
        over = terminated or truncated
        yield info


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
            reason = env.reasons[info["reason"]]
            if not reason:
                return Finding(math.inf, 1.0, "an end without a reason")
            raise Stopped(reason)
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
