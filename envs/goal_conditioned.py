"""Goal-conditioned cranes, for hindsight experience replay.

    env = envs.GoalConditioned(envs.PD(gym.make("flatrig/OverheadCrane-v0", reference="random")))
    observation, info = env.reset()         # "observation", "achieved_goal", "desired_goal"
    env.unwrapped                           # is still the crane

The goal is where the reference ends, and achieved is where the load is: the rig's outputs.  What an
observation says of the way there is left out, since it would tell of another goal than the one that
is put in its place in hindsight.  The reward is of the distance alone:

    1 / (1 + (distance / near)^2),          or, where `within` is given, 0 within it and -1 beyond

so that `compute_reward` knows it for any goal.  `info` has "is_success".
"""

from fnmatch import fnmatchcase
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.spaces import Box, Dict
from gymnasium.vector import VectorEnv, VectorWrapper
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike

from ..models.errors import OptionError
from ..models.types import Array, Mask
from ..models.values import bounded
from .episodes import AnyTask
from .laws import AnyEnv, task_of
from .remembering import Above

OF_THE_WAY = ("*.error", "*.rate_error", "*.mean_error", "*.ahead_*", "left")
"""Entries of observations that tell of the reference."""


class Goals:
    """What is achieved and desired in n simulations, and what that is worth."""

    def __init__(self, task: AnyTask, within: float | None) -> None:
        self._task, self._within = task, within
        levers = task.goal_levers()
        if levers is None:
            raise OptionError("GoalConditioned is for outputs of cranes, this is no crane")
        self._levers, self._near = levers
        shown = task.observation_names
        kept = [not any(fnmatchcase(name, way) for way in OF_THE_WAY) for name in shown]
        self._columns = np.flatnonzero(kept)
        self.names = tuple(shown[column] for column in self._columns)
        """Names of the entries that are shown."""

    def space(self, observed: Box) -> Dict:
        """Of a single simulation, whose observations are in another space."""
        columns, size = self._columns, len(self._levers)
        low, high = observed.low[columns], observed.high[columns]
        goal = Box(-np.inf, np.inf, (size,), np.float64)
        return Dict(
            observation=Box(low, high, dtype=np.float64), achieved_goal=goal, desired_goal=goal
        )

    def observed(self, seen: Array, achieved: Array, desired: Array) -> dict[str, Array]:
        """An observation with goals; arrays (..., entries) and (..., outputs)."""
        return {
            "observation": seen[..., self._columns],
            "achieved_goal": achieved.copy(),
            "desired_goal": desired.copy(),
        }

    @property
    def achieved(self) -> Array:
        """Where outputs are, (n, outputs)."""
        return self._task.plant.outputs

    @property
    def desired(self) -> Array:
        """Where they are to be in the end, (n, outputs)."""
        part = self._task.rows.columns["outputs"]
        return np.array([plan.rows[-1, part] for plan in self._task.plans])

    def distance(self, achieved: ArrayLike, desired: ArrayLike) -> Array:
        """How far outputs are from goals [m], (...)."""
        missing = (np.asarray(achieved) - np.asarray(desired)) * self._levers
        return np.asarray(np.linalg.norm(missing, axis=-1))

    def reward(self, achieved: ArrayLike, desired: ArrayLike) -> Array:
        """What outputs are worth for goals, (...)."""
        distance = self.distance(achieved, desired)
        if self._within is None:
            return np.asarray(1.0 / (1.0 + np.square(distance / self._near)))
        return np.where(distance <= self._within, 0.0, -1.0)

    def reached(self, achieved: Array, desired: Array) -> Mask:
        """Whether outputs are as near to goals as counts, (...)."""
        reach = self._near if self._within is None else self._within
        return np.asarray(self.distance(achieved, desired) <= reach)


class _Conditioned(Above):
    """What single and vector environments with goals have in common."""

    goals: Goals

    _function = __name__, "GoalConditioned"

    @property
    def observation_names(self) -> tuple[str, ...]:
        """Names of the entries of "observation"."""
        return self.goals.names

    def compute_reward(self, achieved_goal: ArrayLike, desired_goal: ArrayLike, info: Any) -> Any:
        """Rewards (...) for outputs and goals (..., outputs); what `info` says does not matter."""
        reward = self.goals.reward(achieved_goal, desired_goal)
        return reward if reward.ndim else float(reward)


class GoalEnv(_Conditioned, gym.Wrapper[Any, Any, Any, Any]):  # type: ignore[override]
    """A single crane with goals."""

    def __init__(self, env: gym.Env[Any, Any], within: float | None) -> None:
        super().__init__(env)
        self.goals, self._options = Goals(task_of(env), within), {"within": within}
        self.observation_space = self.goals.space(env.observation_space)  # type: ignore[arg-type]

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Array], dict[str, Any]]:
        """Begin an episode."""
        seen, info = self.env.reset(seed=seed, options=options)
        return self._observed(seen), info | self._success()

    def step(self, action: Any) -> tuple[dict[str, Array], float, bool, bool, dict[str, Any]]:
        """Go on; the reward is that of the goal."""
        seen, _, terminated, truncated, info = self.env.step(action)
        goals = self.goals
        reward = float(goals.reward(goals.achieved[0], goals.desired[0]))
        return self._observed(seen), reward, terminated, truncated, info | self._success()

    def _observed(self, seen: Array) -> dict[str, Array]:
        goals = self.goals
        return goals.observed(seen, goals.achieved[0], goals.desired[0])

    def _success(self) -> dict[str, Any]:
        goals = self.goals
        return {"is_success": goals.reached(goals.achieved[0], goals.desired[0])[()]}


class GoalVectorEnv(_Conditioned, VectorWrapper[Any, Any, Any, Any, Any]):  # type: ignore[override]
    """Cranes with goals, side by side."""

    def __init__(self, env: VectorEnv[Any, Any, Any], within: float | None) -> None:
        super().__init__(env)
        self.goals, self._options = Goals(task_of(env), within), {"within": within}
        self.single_observation_space = self.goals.space(env.single_observation_space)  # type: ignore[arg-type]
        self.observation_space = batch_space(self.single_observation_space, env.num_envs)

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> Any:
        """Begin episodes."""
        seen, info = self.env.reset(seed=seed, options=options)
        return self._observed(seen), self._told(info, self.goals.achieved, self.goals.desired)

    def step(self, actions: Any) -> Any:
        """Go on; rewards are those of the goals that were there."""
        goals, desired = self.goals, self.goals.desired
        waiting = task_of(self).over.copy()
        seen, _, terminated, truncated, info = self.env.step(actions)
        achieved = goals.achieved.copy()
        if "final_info" in info:
            ended = info["_final_info"]
            achieved[ended] = info["final_info"]["load"][ended]
            for sim in np.flatnonzero(ended).tolist():
                final = info["final_obs"][sim]
                info["final_obs"][sim] = goals.observed(final, achieved[sim], desired[sim])
            self._told(info["final_info"], achieved, desired)
        rewards = np.where(waiting, 0.0, goals.reward(achieved, desired))
        told = self._told(info, goals.achieved, goals.desired)
        return self._observed(seen), rewards, terminated, truncated, told

    def _observed(self, seen: Array) -> dict[str, Array]:
        return self.goals.observed(seen, self.goals.achieved, self.goals.desired)

    def _told(self, info: dict[str, Any], achieved: Array, desired: Array) -> dict[str, Any]:
        info["is_success"] = self.goals.reached(achieved, desired)
        info["_is_success"] = info["_load"].copy()
        return info


def GoalConditioned(env: AnyEnv, within: float | None = None) -> Any:
    """Observations with goals, rewards of the distance to them; above controllers.

    Parameters
    ----------
    env
        A crane, single or vector, wrapped or not.
    within
        Distance at which a goal counts as reached [m], for rewards of 0 and -1; by default rewards
        are smooth, and a goal counts as reached where they are 1/2 or more: within 1/80 of the
        rig's typical length.

    Raises
    ------
    OptionError
        `env` is no crane, or the distance is not a finite number > 0.
    """
    if within is not None:
        within = bounded("within", within, above=0, unit="m")
    return GoalVectorEnv(env, within) if isinstance(env, VectorEnv) else GoalEnv(env, within)
