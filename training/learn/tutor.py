"""What training adds to the environment: a reward for tracking, hints for the critic, a teacher."""

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np

from ...envs.crane.disturbances import Scenario
from ...models.types import Array, Mask
from .teacher import Teacher

REWARD = 0.1
"""Largest reward of one control period."""
FAILURE = 2.0
"""Penalty when an episode ends early; about what is lost by standing still for a second."""
EFFORT = 0.02
"""Share of the reward that a full residual costs."""


class Tutor(gym.vector.VectorWrapper[Any, Any, Any, Any, Any]):
    """A vector environment with `sensors="full"` whose observations begin with public entries.

    Observations are the entries named in `public`, in that order, then all others, then the
    scenario.  The reward falls linearly with the distance, from REWARD to 0 at `scale`, and a
    little with the action.
    """

    def __init__(self, env: Any, public: Sequence[str], scale: float, teacher: Teacher) -> None:
        super().__init__(env)
        task = env.unwrapped.task
        names = list(task.observation_names)
        first = [names.index(name) for name in public]
        self._order = np.array(first + sorted(set(range(len(names))) - set(first)))
        self._task, self._scale, self._teacher = task, scale, teacher
        self._weight = task.rig.weight
        self._hints = np.zeros((self.num_envs, len(_hints(Scenario(), 1.0))))
        width = len(self._order) + self._hints.shape[1]
        self.single_observation_space = gym.spaces.Box(-np.inf, np.inf, (width,), np.float64)

    def reset(self, **keywords: Any) -> tuple[Array, dict[str, Any]]:
        """As the environment's."""
        observation, info = self.env.reset(**keywords)
        mask = (keywords.get("options") or {}).get("reset_mask", np.ones(self.num_envs, bool))
        for sim in np.flatnonzero(mask):
            self._hints[sim] = _hints(self._task.scenarios[sim], self._weight)
        self._teacher.reset(mask)
        self._teacher.watch(mask)
        return self._ordered(observation), info

    def step(self, actions: Array) -> tuple[Array, Array, Mask, Mask, dict[str, Any]]:
        """As the environment's, with the tutor's reward."""
        observation, _, terminated, truncated, info = self.env.step(actions)
        self._teacher.watch()
        distance = np.linalg.norm(info["load"] - info["reference"], axis=1)
        effort = np.square(actions).mean(axis=1)
        reward = REWARD * (1.0 - distance / self._scale - EFFORT * effort)
        reward = np.where(terminated, -FAILURE, reward)
        return self._ordered(observation), reward, terminated, truncated, info

    def advice(self) -> Array:
        """What the teacher would do now, (n, drives) in [-1, 1]."""
        return self._teacher.advice()

    def _ordered(self, observation: Array) -> Array:
        """The observation with its public entries first, and the hints at its end."""
        return np.concatenate((observation[:, self._order], self._hints), axis=1)


def _hints(scenario: Scenario, weight: float) -> Array:
    """What a scenario is, in numbers of order one."""
    force = 50.0 / weight
    heading = np.array([np.cos(scenario.wind_direction), np.sin(scenario.wind_direction)])
    return np.concatenate(
        (
            3.0 * np.array([scenario.load_mass - 1.0]),
            force * np.array([scenario.winch_friction, scenario.trolley_friction]),
            force * scenario.wind * heading,
            force * scenario.gust * heading,
            [np.sin(scenario.gust_phase), np.cos(scenario.gust_phase)],
            [4.0 * scenario.gust_frequency, float(scenario.delay)],
        )
    )
