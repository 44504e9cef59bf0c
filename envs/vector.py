"""Many simulations with Gymnasium's `VectorEnv` interface, stepped together in C threads."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray

from .. import models
from ..models.errors import OptionError
from ..models.types import Array, Mask
from .crane.task import CraneTask
from .episodes import Task
from .option_checks import check_options, seed_of
from .rendering import Camera, check_mode
from .spaces import action_space, observation_space

OPTIONS = ("scenarios", "references", "reset_mask")


class TaskVectorEnv(VectorEnv[Array, Any, Any]):
    """All simulations of a task; for cranes see `CraneVectorEnv`."""

    what = "simulations"
    """In messages."""

    metadata = {  # noqa: RUF012 (Gymnasium's)
        "render_modes": ["rgb_array"],
        "render_fps": 50,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(self, task: Task, render_mode: str | None = None) -> None:
        self.task: Any = task
        self._task = task
        self.num_envs = num_envs = self.task.num
        self.render_mode = check_mode(render_mode, ("rgb_array",))
        self.metadata = {**self.metadata, "render_fps": round(1.0 / self.task.period)}
        self.single_observation_space = observation_space(self.task)
        self.single_action_space = action_space(self.task)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._generators = [seeding.np_random()[0] for _ in range(num_envs)]
        self._over: Mask = np.zeros(num_envs, dtype=bool)
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
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Array, dict[str, Any]]:
        """Begin episodes; a number as `seed` means seed, seed + 1, ...

        Raises
        ------
        OptionError
            Seeds, a mask or a list are not one for each crane, or `flatrig.envs.crane.task`
            refuses one.
        """
        options = check_options(options, OPTIONS)
        mask = options.get("reset_mask")
        chosen = np.ones(self.num_envs, dtype=bool) if mask is None else np.asarray(mask)
        if chosen.shape != self._over.shape or chosen.dtype != bool:
            raise OptionError(f"reset_mask is {mask!r}, it must be {self.num_envs} booleans")
        scenarios, references = (self._each(name, options.get(name)) for name in OPTIONS[:2])
        seeds = self._seeds(seed)
        ids = np.flatnonzero(chosen).astype(np.int32)
        for sim in ids.tolist():
            if seeds[sim] is not None:
                self._generators[sim] = seeding.np_random(seeds[sim])[0]
        self._begin(ids, scenarios, references)
        info = self.task.info()
        info["reason"] = np.full(self.num_envs, "", dtype=object)
        info["scenario"] = list(self.task.scenarios)
        return self.task.observation(), info

    def step(self, actions: ArrayLike) -> tuple[Array, Array, Mask, Mask, dict[str, Any]]:
        """Hold inputs, `actions` (n, drives) times their limits, over one control period."""
        task = self.task
        ids = None
        if self._over.any():
            ids = np.flatnonzero(~self._over).astype(np.int32)
        outcome = task.step(actions, ids)
        if ids is not None:
            self._begin(np.flatnonzero(self._over).astype(np.int32))
        self._over = outcome.terminated | outcome.truncated
        info = task.info()
        if ids is not None:
            info["scenario"] = list(task.scenarios)
        info["reason"] = np.array(outcome.reasons, dtype=object)
        return task.observation(), outcome.reward, outcome.terminated, outcome.truncated, info

    def render(self) -> Any:
        """A tuple with a picture (height, width, 3) of bytes for each crane."""
        if self.render_mode is None:
            return None
        if self._camera is None:
            self._camera = self._new_camera(self.render_mode)
        return tuple(self._camera.show(joints) for joints in self.task.plant.qpos)

    def close_extras(self, **options: Any) -> None:
        """Give back the renderer, if there is one."""
        if self._camera is not None:
            self._camera.close()
            self._camera = None

    def _new_camera(self, mode: str) -> Camera:
        raise NotImplementedError

    def _seeds(self, seed: int | Sequence[int | None] | None) -> list[int | None]:
        """One for each crane."""
        if isinstance(seed, int | np.integer):
            first = seed_of(seed)
            assert first is not None
            return [first + sim for sim in range(self.num_envs)]
        return [seed_of(value) for value in self._each("seed", seed)]

    def _each(self, name: str, values: Any) -> list[Any]:
        """What is given for each crane, None if nothing is."""
        try:
            given = [None] * self.num_envs if values is None else list(values)
        except TypeError:
            raise OptionError(f"{name} is {values!r}, it must be one for each crane") from None
        if len(given) != self.num_envs:
            raise OptionError(f"{name} has {len(given)} entries for {self.num_envs} {self.what}")
        return given

    def _begin(self, ids: NDArray[np.int32], scenarios: Any = None, references: Any = None) -> None:
        """Reset some cranes."""
        if ids.size == 0:
            return
        chosen = ids.tolist()
        given = [
            None if values is None else [values[sim] for sim in chosen]
            for values in (scenarios, references)
        ]
        self.task.reset(ids, [self._generators[sim] for sim in chosen], *given)
        self._over[ids] = False


class CraneVectorEnv(TaskVectorEnv):
    """n cranes that are to follow references; see `flatrig.envs.crane.task` for the parameters.

    A crane whose episode is over begins the next one in the following step, which ignores its
    action and rewards it with 0 (autoreset mode NEXT_STEP).  Seeded with `seed`, crane i is the
    single environment seeded with seed + i, to the last bit.

    `reset(options={"scenarios": [...], "references": [...]})` prescribes, crane by crane, what
    would be drawn; "reset_mask", n booleans, resets only some.
    """

    what = "cranes"

    def __init__(
        self, rig: Any = None, *, num_envs: int = 1, render_mode: str | None = None, **options: Any
    ) -> None:
        super().__init__(CraneTask(rig, num=num_envs, **options), render_mode)

    def _new_camera(self, mode: str) -> Camera:
        return Camera(
            models.compile(self.task.rig, visuals=True, massless=self.task.massless), mode
        )
