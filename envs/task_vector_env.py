"""Many simulations with Gymnasium's `VectorEnv` interface, stepped together in C threads."""

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import replace
from typing import Any

import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike

from ..models.errors import OptionError
from ..models.types import Array, Mask
from ..models.values import shown
from .common import Ids, Outcome
from .infos import with_masks
from .option_checks import check_alone, check_options, ids_of, mode_of, seed_of, states_of
from .rendering import View
from .spaces import action_space, observation_space
from .states import EpisodeState
from .task_env import TaskFace, TaskT

OPTIONS = ("scenarios", "references", "reset_mask", "states")


class TaskVectorEnv(TaskFace[TaskT], VectorEnv[Array, Any, Any]):
    """All simulations of a task; seeded with `seed`, simulation i is the single environment seeded
    with seed + i, to the last bit.

    What becomes of a simulation whose episode is over, `autoreset_mode` says:

        NEXT_STEP     the following step begins the next episode, ignores the action and gives 0
        SAME_STEP     the same step does; the info has "final_obs" and "final_info" of the old one
        DISABLED      nothing; it is to be reset before the next step, by "reset_mask"

    `reset(options={"scenarios": [...], "references": [...]})` prescribes, one by one, what would
    be drawn, and "states" goes on from where simulations were, see `flatrig.envs.states`; None
    leaves one out.  "reset_mask", n booleans, resets only some.
    """

    what = "simulations"
    """What they are of, in messages."""

    metadata = {  # noqa: RUF012 (Gymnasium's)
        "render_modes": ["rgb_array"],
        "render_fps": 50,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        task: TaskT,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        view: View | None = None,
    ) -> None:
        self.autoreset_mode = mode_of(autoreset_mode)
        """When the next episode begins."""
        self.still: Mask | None = None
        """Who stands still in a period that is a part of a longer step, see `ActionRate`."""
        self._show(task, render_mode, ("rgb_array",), view or View())
        self.metadata["autoreset_mode"] = self.autoreset_mode
        self.num_envs = num_envs = task.num
        self.single_observation_space = observation_space(task.observation_names)
        self.single_action_space = action_space(task.action_names)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._generators = [seeding.np_random()[0] for _ in range(num_envs)]

    @property
    def over(self) -> Mask:
        """Whose episodes are over and have not begun anew, shape (n,), live."""
        return self.task.over

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
            Seeds, a mask or a list are not one for each simulation, or the task refuses one.
        """
        options = check_options(options, OPTIONS)
        mask = options.get("reset_mask")
        chosen = np.ones(self.num_envs, dtype=bool) if mask is None else np.asarray(mask)
        if chosen.shape != (self.num_envs,) or chosen.dtype != bool:
            raise OptionError(f"reset_mask is {shown(mask)}, it must be {self.num_envs} booleans")
        prescribed = [self._each(name, options.get(name)) for name in OPTIONS[:2]]
        states, seeds = self._states(options.get("states"), chosen, prescribed), self._seeds(seed)
        ids = np.flatnonzero(chosen).astype(np.int32)
        for sim in ids.tolist():
            if seeds[sim] is not None:
                self._generators[sim] = seeding.np_random(seeds[sim])[0]
        self._begin(np.array([sim for sim in ids if states[sim] is None], np.int32), *prescribed)
        for sim in ids.tolist():
            if (state := states[sim]) is not None:
                self.task.restore(self.task.all[sim : sim + 1], [state])
                if seeds[sim] is None and state.generator is not None:
                    self._generators[sim] = deepcopy(state.generator)
        return self.task.observation(), with_masks(self.task.info(), chosen)

    def step(self, actions: ArrayLike) -> tuple[Array, Array, Mask, Mask, dict[str, Any]]:
        """Hold inputs, `actions` (n, drives) times their limits, over one control period.

        Raises
        ------
        OptionError
            As `Task.step`, or an episode is over and nothing resets it.
        """
        outcome = self._go(actions)
        told = outcome.reward, outcome.terminated, outcome.truncated
        return self.told(*told) if self.still is None else (self.task.observation(), *told, {})

    def _go(self, actions: ArrayLike) -> Outcome:
        """Go on by a control period, and begin what waits for it."""
        still = np.zeros(self.num_envs, bool) if self.still is None else self.still
        waiting, going = np.flatnonzero(self.over & ~still).astype(np.int32), None
        if waiting.size:
            self._must_reset(waiting)
        if waiting.size or still.any():
            going = np.flatnonzero(~(self.over | still)).astype(np.int32)
        outcome = self.task.step(actions, going)
        self._begin(waiting)
        return outcome

    def told(
        self, reward: Array, terminated: Mask, truncated: Mask
    ) -> tuple[Array, Array, Mask, Mask, dict[str, Any]]:
        """What a step says that has given such rewards and ends, (n,) each."""
        task, last = self.task, {}
        if self.autoreset_mode is AutoresetMode.SAME_STEP and self.over.any():
            last = self._last()
            self._begin(np.flatnonzero(self.over).astype(np.int32))
        info = with_masks(task.info(), np.ones(self.num_envs, bool)) | last
        return task.observation(), reward, terminated, truncated, info

    def _must_reset(self, waiting: Ids) -> None:
        """Refuse to go on where nobody begins new episodes."""
        if self.autoreset_mode is AutoresetMode.DISABLED:
            raise OptionError(
                f"episodes of {self.what} {shown(waiting.tolist())} are over; without autoreset "
                'call reset(options={"reset_mask": terminated | truncated}) before step'
            )

    def _last(self) -> dict[str, Any]:
        """What is seen and told at the ends of episodes that make place for others now."""
        over, seen = self.over.copy(), self.task.observation()
        final = np.full(self.num_envs, None, dtype=object)
        for sim in np.flatnonzero(over).tolist():
            final[sim] = seen[sim]
        last = {"final_obs": final, "final_info": with_masks(self.task.info(), over)}
        return last | {f"_{name}": over.copy() for name in last}

    def get_state(self, ids: Sequence[int] | Ids | None = None) -> list[EpisodeState]:
        """Episodes as they are, of some simulations or all, see `flatrig.envs.states`.

        Raises
        ------
        OptionError
            One has not begun, or `ids` are none.
        """
        sims = ids_of(ids, self.num_envs, self.what).tolist()
        return [
            replace(self.task.save(sim), generator=deepcopy(self._generators[sim])) for sim in sims
        ]

    def set_state(
        self, states: Sequence[EpisodeState], ids: Sequence[int] | Ids | None = None
    ) -> None:
        """Go on with episodes from where they were, in some simulations or all.

        Raises
        ------
        OptionError
            There is not one for each, one is no state, or of a plant, sensors or rates that are
            others; then nothing has changed.
        """
        ids = ids_of(ids, self.num_envs, self.what)
        states = states_of(states, len(ids), self.what)
        self.task.restore(ids, states)
        for sim, state in zip(ids.tolist(), states, strict=True):
            if state.generator is not None:
                self._generators[sim] = deepcopy(state.generator)

    def _states(
        self, given: Any, chosen: Mask, prescribed: list[list[Any]]
    ) -> list[EpisodeState | None]:
        """The option "states": one for each simulation, or None."""
        states: list[EpisodeState | None] = self._each("states", given)
        for sim, state in enumerate(states):
            if state is not None and chosen[sim]:
                scenario, reference = (values[sim] for values in prescribed)
                check_alone({"state": 1, "scenario": scenario, "reference": reference}, "state")
                self.task.check_state(state)
        return states

    def render(self) -> Any:
        """A tuple with a picture (height, width, 3) of bytes for each simulation."""
        pictures = self._pictures()
        return None if pictures is None else tuple(pictures)

    def close_extras(self, **options: Any) -> None:
        """Give back the renderer, if there is one."""
        self._close_camera()

    def _seeds(self, seed: int | Sequence[int | None] | None) -> list[int | None]:
        """A seed or None for each simulation."""
        if isinstance(seed, int | np.integer):
            first = seed_of(seed)
            assert first is not None
            return [first + sim for sim in range(self.num_envs)]
        return [seed_of(value) for value in self._each("seed", seed)]

    def _each(self, name: str, values: Any) -> list[Any]:
        """A value for each simulation; None where there is none."""
        try:
            entries = [None] * self.num_envs if values is None else list(values)
        except TypeError:
            raise OptionError(
                f"{name} is {shown(values)}, it must be one for each of the {self.what}"
            ) from None
        if len(entries) != self.num_envs:
            raise OptionError(f"{name} has {len(entries)} entries for {self.num_envs} {self.what}")
        return entries

    def _begin(self, ids: Ids, *prescribed: list[Any]) -> None:
        """Reset some simulations, with scenarios and references of all, if any."""
        if ids.size == 0:
            return
        chosen = ids.tolist()
        values = [[entries[sim] for sim in chosen] for entries in prescribed]
        self.task.reset(ids, [self._generators[sim] for sim in chosen], *values)
