"""What a controller is: a law in front of an environment, single or vector.

A controller of one's own is a `Law`, for n simulations at once, and a function that wraps an
environment, single or vector, in it:

    class Damping(envs.Law):
        name = "damped"

        def __init__(self, task, share):
            self.task, self.share = task, share

        def apply(self, actions):
            return actions - self.share * self.task.encoders.rates

    def damped(env, share=0.1):
        return envs.wrap(env, Damping(envs.task_of(env), share), share=share)

It reads what is measured off `task.encoders`, and what is planned off `task.rows`.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper
from numpy.typing import ArrayLike, NDArray

from ..models.errors import OptionError
from ..models.types import Array
from .common import Ids
from .episodes import AnyTask, Task
from .option_checks import actions_of, ids_of, states_of
from .remembering import Remembering
from .states import EpisodeState

AnyEnv = gym.Env[Any, Any] | VectorEnv[Any, Any, Any]


class Law(ABC):
    """What a controller does with the actions for n simulations; see the module for an example."""

    name: str
    """Name of the function, in the same module, that wraps an environment in it."""
    topmost = False
    """Whether it clips and scales what comes from above, so that nothing may stand there."""

    @abstractmethod
    def apply(self, actions: Array) -> Array:
        """Actions to hand down, (n, drives), from those from above."""

    def holding(self) -> Array | None:
        """The part of it that holds the plant at rest, (n, drives) over the limits, if any."""
        return None

    @property
    def memory(self) -> tuple[NDArray[Any], ...]:
        """All that it remembers from step to step: live arrays (n, ...), for saved states."""
        return ()


class Controller(Remembering, gym.Wrapper[Any, Any, Any, Any]):  # type: ignore[override]
    """A law in front of a single environment; `options` make the same controller again."""

    def __init__(
        self, env: gym.Env[Any, Any], law: Law, options: Mapping[str, Any] | None = None
    ) -> None:
        super().__init__(env)
        self.law, self._options = law, dict(options or {})
        self._task = task = task_of(env)
        self._expected = (len(task.action_names),), task.action_names

    def step(self, action: ArrayLike) -> Any:
        """Hand down what the law makes of the action."""
        inputs = self._task.acting.of_drives(actions_of(action, *self._expected)[None])
        return self.env.step(self._task.acting.of_actions(self.law.apply(inputs))[0])

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode, or go on with one."""
        state = options.get("state") if isinstance(options, Mapping) else None
        self._check(state)
        begun = super().reset(seed=seed, options=options)
        if state is not None:
            self._recall(state, 0)
        return begun

    def get_state(self) -> EpisodeState:
        """The episode as it is, with what is remembered here, see `flatrig.envs.states`."""
        return self._adds(self._below.get_state(), 0)

    def set_state(self, state: EpisodeState) -> None:
        """Go on with an episode from where it was.

        Raises
        ------
        OptionError
            It is no state of such an environment with these controllers; then nothing has changed.
        """
        self._check(state)
        self._below.set_state(state)
        self._recall(state, 0)


class VectorController(  # type: ignore[override]
    Remembering, VectorWrapper[Any, Any, Any, Any, Any]
):
    """A law in front of a vector environment; `options` make the same controller again."""

    def __init__(
        self, env: VectorEnv[Any, Any, Any], law: Law, options: Mapping[str, Any] | None = None
    ) -> None:
        super().__init__(env)
        self.law, self._options = law, dict(options or {})
        self._task = task = task_of(env)
        base: Any = env.unwrapped
        names = task.action_names
        self._expected = (task.num, len(names)), names, lambda: base.over

    @property
    def autoreset_mode(self) -> AutoresetMode:
        """When the next episode begins."""
        return self.env.metadata["autoreset_mode"]  # type: ignore[no-any-return]

    def step(self, actions: ArrayLike) -> Any:
        """Hand down what the law makes of the actions."""
        inputs = self._task.acting.of_drives(actions_of(actions, *self._expected))
        return self.env.step(self._task.acting.of_actions(self.law.apply(inputs)))

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> Any:
        """Begin episodes, or go on with some."""
        states = options.get("states") if isinstance(options, Mapping) else None
        states = list(states) if isinstance(states, Iterable) else []
        mask = np.ones(len(states), bool) if states else None
        if states and options is not None and options.get("reset_mask") is not None:
            mask = options["reset_mask"]
        for state in states:
            self._check(state)
        begun = super().reset(seed=seed, options=options)
        for sim, state in enumerate(states):
            if state is not None and mask is not None and mask[sim]:
                self._recall(state, sim)
        return begun

    def get_state(self, ids: Sequence[int] | Ids | None = None) -> list[EpisodeState]:
        """Episodes as they are, with what is remembered here, see `flatrig.envs.states`."""
        sims = ids_of(ids, self.num_envs, "simulations").tolist()
        below = self._below.get_state(ids)
        return [self._adds(state, sim) for sim, state in zip(sims, below, strict=True)]

    def set_state(
        self, states: Sequence[EpisodeState], ids: Sequence[int] | Ids | None = None
    ) -> None:
        """Go on with episodes from where they were, in some simulations or all.

        Raises
        ------
        OptionError
            One is no state of such an environment with these controllers; then nothing has changed.
        """
        ids = ids_of(ids, self.num_envs, "simulations")
        states = states_of(states, len(ids), "simulations")
        for state in states:
            self._check(state)
        self._below.set_state(states, ids)
        for sim, state in zip(ids.tolist(), states, strict=True):
            self._recall(state, sim)


def task_of(env: AnyEnv) -> AnyTask:
    """The task below all wrappers.

    Raises
    ------
    OptionError
        There is none: `env` is neither a crane nor a hand.
    """
    task = getattr(getattr(env, "unwrapped", None), "task", None)
    if not isinstance(task, Task):
        several = hasattr(getattr(env, "unwrapped", None), "env_fns")  # a sync or async vector
        hint = "; wrap what it is made of, as by make_vec(..., wrappers=[PD])" if several else ""
        raise OptionError(f"{env} is not an environment of flatrig{hint}")
    return task


def wrap(env: AnyEnv, law: Law, **options: Any) -> Controller | VectorController:
    """Put a law in front of an environment.

    Parameters
    ----------
    env
        A crane or hand, single or vector, wrapped or not.
    law
        What the controller does.
    **options
        With which the function of the law's name makes the same controller again; they go into
        the `spec`, and are plain values where that is to be saved.

    Raises
    ------
    OptionError
        `env` is neither a crane nor a hand, or its actions are no inputs.
    """
    layer: Any = env
    while layer is not layer.unwrapped:
        if getattr(layer, "lasts", False):
            raise OptionError(f"{law.name} would act at the rate of ActionRate; put that on top")
        layer = layer.env
    if not task_of(env).takes_inputs:
        raise OptionError(
            f'{law.name} adds inputs, and the actions with reference="operator" are velocities; '
            "take reference=feedforward.hold(start, duration) and `lead` in each step"
        )
    if isinstance(env, VectorEnv):
        return VectorController(env, law, options)
    return Controller(env, law, options)


def laws_of(env: AnyEnv) -> Iterator[Law]:
    """Those of the controllers in an environment, from the top."""
    layer: Any = env
    while layer is not layer.unwrapped:
        if isinstance(layer, Controller | VectorController):
            yield layer.law
        layer = layer.env


def refuse_below(env: AnyEnv, name: str, *alike: str) -> None:
    """Nothing is added twice, and nothing above a residual, which would clip and scale it."""
    for law in laws_of(env):
        if law.name in (name, *alike):
            once = "it must be there once" if law.name == name else f"{name} does the same"
            raise OptionError(f"{law.name} stands below already, {once}; take one of them")
        if law.topmost:
            raise OptionError(
                f"{name} above {law.name} would be clipped and scaled; put {law.name} on top"
            )
