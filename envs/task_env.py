"""One simulation with Gymnasium's `Env` interface: a batch of one."""

from typing import Any, Generic, TypeVar

import gymnasium as gym
from numpy.typing import ArrayLike

from ..models.types import Array
from .episodes import AnyTask
from .option_checks import actions_of, check_options, seed_of
from .rendering import MODES, Camera, check_mode
from .spaces import action_space, observation_space

TaskT = TypeVar("TaskT", bound=AnyTask)


class TaskFace(Generic[TaskT]):
    """What single and vector environments have in common: a task, its names, and pictures."""

    task: TaskT
    """The simulations."""
    metadata: dict[str, Any]
    render_mode: str | None

    def _show(self, task: TaskT, render_mode: str | None, modes: tuple[str, ...]) -> None:
        """Take a task, and check how it is to be drawn."""
        self.task = task
        self.render_mode = check_mode(render_mode, modes)
        self.metadata = {**self.metadata, "render_fps": round(1.0 / task.period)}
        self._camera: Camera | None = None

    @property
    def observation_names(self) -> tuple[str, ...]:
        """Names of the entries of an observation."""
        return self.task.observation_names

    @property
    def action_names(self) -> tuple[str, ...]:
        """Names of the entries of an action."""
        return self.task.action_names

    @property
    def scenario_names(self) -> tuple[str, ...]:
        """Names of the numbers in `info["scenario"]`."""
        return self.task.scenario_names

    @property
    def reasons(self) -> tuple[str, ...]:
        """What the number `info["reason"]` stands for: why an episode is over, "" if it goes on."""
        return self.task.reasons

    def _pictures(self) -> list[Any] | None:
        """A picture (height, width, 3) of bytes of each simulation, None without a mode."""
        if self.render_mode is None:
            return None
        if self._camera is None:
            self._camera = Camera(self.task.looks(), self.render_mode)
        return [self._camera.show(joints) for joints in self.task.plant.qpos]

    def _close_camera(self) -> None:
        """Close the window or give back the renderer, if there is one."""
        if self._camera is not None:
            self._camera.close()
            self._camera = None


OPTIONS = ("scenario", "reference")


class TaskEnv(TaskFace[TaskT], gym.Env[Any, Any]):
    """The only simulation of a task.

    `reset(options={"scenario": ..., "reference": ...})` prescribes what would be drawn.
    """

    metadata = {"render_modes": list(MODES), "render_fps": 50}  # noqa: RUF012 (Gymnasium's)

    def __init__(self, task: TaskT, render_mode: str | None = None) -> None:
        self._show(task, render_mode, MODES)
        self.observation_space = observation_space(task.observation_names)
        self.action_space = action_space(task.action_names)
        self._expected = (len(task.action_names),), task.action_names

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begin an episode; see the class for `options`."""
        options = check_options(options, OPTIONS)
        super().reset(seed=seed_of(seed))
        task = self.task
        prescribed = ([options.get(name)] for name in OPTIONS)
        task.reset(task.all, [self.np_random], *prescribed)
        if self.render_mode == "human":
            self.render()
        return task.observation()[0], task.info_of(0)

    def step(self, action: ArrayLike) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Hold inputs, `action` times their limits, over one control period."""
        outcome = self.task.step(actions_of(action, *self._expected)[None])
        if self.render_mode == "human":
            self.render()
        return (
            self.task.observation()[0],
            float(outcome.reward[0]),
            bool(outcome.terminated[0]),
            bool(outcome.truncated[0]),
            self.task.info_of(0),
        )

    def render(self) -> Any:
        """A picture (height, width, 3) of bytes, or a frame in the viewer's window."""
        pictures = self._pictures()
        return None if pictures is None else pictures[0]

    def close(self) -> None:
        """Close the window, if there is one."""
        self._close_camera()
