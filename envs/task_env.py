"""One simulation with Gymnasium's `Env` interface: a batch of one."""

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import replace
from typing import Any, Generic, TypeVar

import gymnasium as gym
import mujoco
from gymnasium.envs.registration import EnvSpec
from numpy.typing import ArrayLike

from ..models.types import Array
from .episodes import AnyTask
from .option_checks import actions_of, check_alone, check_options, seed_of
from .plain_specs import plain_spec
from .rendering import MODES, Camera, View, check_mode
from .spaces import action_space, observation_space
from .states import EpisodeState

TaskT = TypeVar("TaskT", bound=AnyTask)


class TaskFace(Generic[TaskT]):
    """What single and vector environments have in common: a task, its names, and pictures."""

    task: TaskT
    """The simulations."""
    metadata: dict[str, Any]
    _spec: EnvSpec | None = None
    render_mode: str | None

    made_with: Mapping[str, Any]
    """Options that make the same environment again."""

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (type(self), dict(self.made_with)), self._kept()

    def __setstate__(self, kept: dict[str, Any]) -> None:
        states = kept.pop("states")
        vars(self).update(kept)
        for sim, state in states.items():
            self.task.restore(self.task.all[sim : sim + 1], [state])

    def _kept(self) -> dict[str, Any]:
        """What a copy has beside its options: its episodes, and what later ones are drawn by."""
        names = ("_spec", "_np_random", "_np_random_seed", "_generators")
        own = {name: value for name, value in vars(self).items() if name in names}
        return {**own, "states": {sim: self.task.save(sim) for sim in self.task.begun}}

    @property
    def spec(self) -> EnvSpec | None:
        """What makes the same environment again, of plain values, see `flatrig.envs.plain_specs`.

        Its `max_episode_steps` is the length of episodes where all are as long.
        """
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        fixed = self.task.planner.fixed
        self._spec = plain_spec(spec, None if fixed is None else fixed.steps)

    def _show(
        self, task: TaskT, render_mode: str | None, modes: tuple[str, ...], view: View
    ) -> None:
        """Take a task, and check how it is to be drawn."""
        self.task, self._view = task, view
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

    def model_of(self, sim: int) -> mujoco.MjModel:
        """The model of a simulation with its scenario's masses and friction, a copy, to be read."""
        return self.task.plant.batch.get_model(sim)

    def data_of(self, sim: int) -> mujoco.MjData:
        """The data of a simulation after the last step, a copy, to be read."""
        return self.task.plant.batch.get_data(sim)

    def _pictures(self) -> list[Any] | None:
        """A picture (height, width, 3) of bytes of each simulation, None without a mode."""
        if self.render_mode is None:
            return None
        if self._camera is None:
            self._camera = Camera(self.task.looks(), self.render_mode, self._view)
        return [self._camera.show(joints) for joints in self.task.plant.qpos]

    def _close_camera(self) -> None:
        """Close the window or give back the renderer, if there is one."""
        if self._camera is not None:
            self._camera.close()
            self._camera = None


def _again(kind: Callable[..., Any], options: dict[str, Any]) -> Any:
    """An environment made again."""
    return kind(**options)


OPTIONS = ("scenario", "reference")


class TaskEnv(TaskFace[TaskT], gym.Env[Any, Any]):
    """The only simulation of a task.

    `reset(options={"scenario": ..., "reference": ...})` prescribes what would be drawn, and
    `reset(options={"state": ...})` goes on from where a simulation was, see `flatrig.envs.states`.
    """

    metadata = {"render_modes": list(MODES), "render_fps": 50}  # noqa: RUF012 (Gymnasium's)

    def __init__(
        self, task: TaskT, render_mode: str | None = None, view: View | None = None
    ) -> None:
        self._show(task, render_mode, MODES, view or View())
        self.observation_space = observation_space(task.observation_names)
        self.action_space = action_space(task.action_names)
        self._expected = (len(task.action_names),), task.action_names

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begin an episode; see the class for `options`."""
        options = check_options(options, (*OPTIONS, "state"))
        state, prescribed = options.get("state"), [[options.get(name)] for name in OPTIONS]
        task = self.task
        if state is not None:
            check_alone(options, "state")
            task.check_state(state)
        super().reset(seed=seed_of(seed))
        if state is None:
            task.reset(task.all, [self.np_random], *prescribed)
        else:
            self._go_on(state, seed is not None)
        if self.render_mode == "human":
            self.render()
        return task.observation()[0], task.info_of(0)

    def step(self, action: ArrayLike) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Hold inputs, `action` times their limits, over one control period."""
        outcome = self.task.hold(actions_of(action, *self._expected)[None])
        if self.render_mode == "human":
            self.render()
        return (
            self.task.observation()[0],
            float(outcome.reward[0]),
            bool(outcome.terminated[0]),
            bool(outcome.truncated[0]),
            self.task.info_of(0),
        )

    def get_state(self) -> EpisodeState:
        """The episode as it is, to be gone on with, see `flatrig.envs.states`.

        Raises
        ------
        OptionError
            None has begun.
        """
        return replace(self.task.save(0), generator=deepcopy(self.np_random))

    def set_state(self, state: EpisodeState) -> None:
        """Go on with an episode from where it was, here or in an environment that is made alike.

        Raises
        ------
        OptionError
            It is no state, or one of a plant, sensors or rates that are others; then nothing has
            changed.
        """
        self._go_on(state, False)

    @property
    def model(self) -> mujoco.MjModel:
        """The model with the scenario's masses and friction, a copy, to be read."""
        return self.model_of(0)

    @property
    def data(self) -> mujoco.MjData:
        """The simulation's data after the last step, a copy, to be read."""
        return self.data_of(0)

    def _go_on(self, state: EpisodeState, seeded: bool) -> None:
        """Go on from a state; later episodes are drawn as there, unless a seed was given."""
        self.task.restore(self.task.all, [state])
        if not seeded and state.generator is not None:
            self.np_random = deepcopy(state.generator)

    def render(self) -> Any:
        """A picture (height, width, 3) of bytes, or a frame in the viewer's window."""
        pictures = self._pictures()
        return None if pictures is None else pictures[0]

    def close(self) -> None:
        """Close the window, if there is one."""
        self._close_camera()
