"""One simulation with Gymnasium's `Env` interface: a batch of one."""

from typing import Any

import gymnasium as gym
from numpy.typing import ArrayLike

from .. import models
from ..models.types import Array
from .crane.task import CraneTask
from .episodes import Task
from .option_checks import actions_of, check_options, seed_of
from .rendering import MODES, Camera, check_mode
from .spaces import action_space, observation_space

OPTIONS = ("scenario", "reference")


class TaskEnv(gym.Env[Any, Any]):
    """The only simulation of a task.

    `reset(options={"scenario": ..., "reference": ...})` prescribes what would be drawn.
    """

    metadata = {"render_modes": list(MODES), "render_fps": 50}  # noqa: RUF012 (Gymnasium's)

    def __init__(self, task: Task, render_mode: str | None = None) -> None:
        self.task: Any = task
        self._task = task
        self.observation_space = observation_space(self.task)
        self.action_space = action_space(self.task)
        self.render_mode = check_mode(render_mode)
        self.metadata = {**self.metadata, "render_fps": round(1.0 / self.task.period)}
        self._camera: Camera | None = None

    @property
    def observation_names(self) -> tuple[str, ...]:
        """Names of the entries of an observation."""
        return self._task.observation_names

    @property
    def action_names(self) -> tuple[str, ...]:
        """Names of the entries of an action."""
        return self._task.action_names

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begin an episode; see the class for `options`."""
        options = check_options(options, OPTIONS)
        super().reset(seed=seed_of(seed))
        task = self.task
        task.reset(
            task.all, [self.np_random], [options.get("scenario")], [options.get("reference")]
        )
        if self.render_mode == "human":
            self.render()
        info = self._info("")
        info["scenario"] = task.scenarios[0]
        return task.observation()[0], info

    def step(self, action: ArrayLike) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Hold inputs, `action` times their limits, over one control period."""
        outcome = self.task.step(actions_of(action, self.task.limits.shape)[None])
        if self.render_mode == "human":
            self.render()
        return (
            self.task.observation()[0],
            float(outcome.reward[0]),
            bool(outcome.terminated[0]),
            bool(outcome.truncated[0]),
            self._info(outcome.reasons[0]),
        )

    def render(self) -> Any:
        """A picture (height, width, 3) of bytes, or a frame in the viewer's window."""
        if self.render_mode is None:
            return None
        if self._camera is None:
            self._camera = self._new_camera(self.render_mode)
        return self._camera.show(self.task.plant.qpos[0])

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._camera is not None:
            self._camera.close()
            self._camera = None

    def _new_camera(self, mode: str) -> Camera:
        raise NotImplementedError

    def _info(self, reason: str) -> dict[str, Any]:
        """The task's, of its only simulation."""
        info = self._task.info_of(0)
        info["reason"] = reason
        return info


class CraneEnv(TaskEnv):
    """A crane that is to follow a reference; see `flatrig.envs.crane.task` for the parameters.

    `reset(options={"scenario": Scenario(...), "reference": ...})` prescribes what would be drawn.
    `info` tells the truth: "load", "reference", "tension", "input", "reward_terms", and in
    "reason" why the episode is over.
    """

    def __init__(self, rig: Any = None, *, render_mode: str | None = None, **options: Any) -> None:
        super().__init__(CraneTask(rig, num=1, **options), render_mode)

    def _new_camera(self, mode: str) -> Camera:
        return Camera(
            models.compile(self.task.rig, visuals=True, massless=self.task.massless), mode
        )
