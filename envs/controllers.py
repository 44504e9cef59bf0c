"""Controllers as wrappers: feedback, feedforward, and what is learned on top.

    env = Feedforward(PD(gym.make("flatrig/OverheadCrane-v0")))
    env = Residual(env, fraction=0.2)       # a policy's action, a fifth of the limits

Each adds its share of the drives' limits to the action that comes from above and hands the sum
down; only the environment clips.  All work on single and vector environments through the same
code: `PD(env)` returns a `gym.Wrapper` or a `gym.vector.VectorWrapper` as `env` needs.

`PD` and `Feedforward` stand in any order, each once; `Residual` stands on top of them, because it
clips and scales whatever comes from above.  `flatrig.envs.crane.friction_compensation` and
`flatrig.envs.hand.pose_controller` have one more each.

The inputs that hold the rig at rest (a winch carries its load) are needed once.  `PD` adds them
unless a controller below does; `Feedforward`, which contains them, leaves out what is added below.

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
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec, WrapperSpec
from gymnasium.vector import VectorEnv, VectorWrapper
from numpy.typing import ArrayLike

from ..models.errors import OptionError
from ..models.types import Array
from .episodes import AnyTask, Task
from .gains import Gains, Track
from .option_checks import actions_of, number

AnyEnv = gym.Env[Any, Any] | VectorEnv[Any, Any, Any]


class Law(ABC):
    """What a controller does with the actions for n simulations; see the module for an example."""

    name: str
    """Name of the function, in the same module, that wraps an environment in it."""

    @abstractmethod
    def apply(self, actions: Array) -> Array:
        """Actions to hand down, (n, drives), from those from above."""

    def holding(self) -> Array | None:
        """The part of it that holds the plant at rest, (n, drives) over the limits, if any."""
        return None


class PDLaw(Law):
    """u = holding + k (reference - measured) + d (reference rate - measured rate)."""

    name = "PD"

    def __init__(self, task: AnyTask, gains: Gains, moving: bool, hold: bool) -> None:
        self._task, self.moving, self._hold = task, moving, hold
        self.gains = np.concatenate((gains.stiffness / task.limits, gains.damping / task.limits))

    def apply(self, actions: Array) -> Array:
        """Add the feedback."""
        encoders, drives = self._task.encoders, len(self._task.limits)
        if self.moving:
            feedback = encoders.errors * self.gains
        else:
            feedback = encoders.measured * -self.gains
            feedback[:, :drives] += self._task.rows.goal * self.gains[:drives]
        inputs = feedback[:, :drives] + feedback[:, drives:]
        inputs += actions
        if self._hold:
            inputs += self._equilibrium()
        return np.asarray(inputs)

    def holding(self) -> Array | None:
        """Inputs of the equilibrium, along the reference or at its goal (K 3.62)."""
        return self._equilibrium() if self._hold else None

    def _equilibrium(self) -> Array:
        return self._task.rows.parts["holding"] if self.moving else self._task.rows.goal_inputs


class FeedforwardLaw(Law):
    """The exact inputs of the reference, for the middle of the hold that begins."""

    name = "Feedforward"

    def __init__(self, task: AnyTask, below: Law | None) -> None:
        self._task, self._below = task, below

    def apply(self, actions: Array) -> Array:
        """Add the feedforward."""
        inputs = self._task.rows.parts["feedforward"]
        added = None if self._below is None else self._below.holding()
        return np.asarray(actions + (inputs if added is None else inputs - added))

    def holding(self) -> Array | None:
        """The equilibrium is part of the feedforward."""
        return self._task.rows.parts["holding"] if self._below is None else None


class ResidualLaw(Law):
    """A fraction of the limits for what is learned."""

    name = "Residual"

    def __init__(self, fraction: float) -> None:
        self._fraction = fraction

    def apply(self, actions: Array) -> Array:
        """Scale the action."""
        return np.asarray(np.minimum(np.maximum(actions, -1.0), 1.0) * self._fraction)


class Controller(gym.Wrapper[Any, Any, Any, Any]):
    """A law in front of a single environment; `options` make the same controller again."""

    def __init__(
        self, env: gym.Env[Any, Any], law: Law, options: Mapping[str, Any] | None = None
    ) -> None:
        super().__init__(env)
        self.law, self._options = law, dict(options or {})
        self._shape = task_of(env).limits.shape

    @property
    def spec(self) -> EnvSpec | None:  # type: ignore[override]
        """What `gym.make` makes an environment with the same controllers of."""
        return _spec_with(self.env.spec, self.law, self._options)

    def step(self, action: ArrayLike) -> Any:
        """Hand down what the law makes of the action."""
        return self.env.step(self.law.apply(actions_of(action, self._shape)[None])[0])


class VectorController(VectorWrapper[Any, Any, Any, Any, Any]):
    """A law in front of a vector environment; `options` make the same controller again."""

    def __init__(
        self, env: VectorEnv[Any, Any, Any], law: Law, options: Mapping[str, Any] | None = None
    ) -> None:
        super().__init__(env)
        self.law, self._options = law, dict(options or {})
        task = task_of(env)
        self._shape = (task.num, *task.limits.shape)

    @property
    def spec(self) -> EnvSpec | None:  # type: ignore[override]
        """The environment's, with the controllers, which `gym.make_vec` leaves to its caller."""
        return _spec_with(self.env.spec, self.law, self._options)

    def step(self, actions: ArrayLike) -> Any:
        """Hand down what the law makes of the actions."""
        return self.env.step(self.law.apply(actions_of(actions, self._shape)))


def _spec_with(below: EnvSpec | None, law: Law, options: dict[str, Any]) -> EnvSpec | None:
    """The spec of what is below a controller, with the controller."""
    if below is None:
        return None
    wrapper = WrapperSpec(law.name, f"{type(law).__module__}:{law.name}", options)
    return replace(below, additional_wrappers=(*below.additional_wrappers, wrapper))


def PD(
    env: AnyEnv,
    *,
    track: Track = "moving",
    stiffness: ArrayLike | None = None,
    damping: ArrayLike | None = None,
) -> Any:
    """Proportional-derivative feedback of every drive, from encoders only.

    Parameters
    ----------
    env
        A crane or hand, single or vector, wrapped or not.
    track
        "moving": towards the reference; "set point": towards its goal from the start (K 3.62).
    stiffness, damping
        For each drive, per metre, or radian of a turning frame: [N/m, N s/m] for a trolley,
        [N m/m, N m s/m], torque per metre of rope, for a winch, [N m/rad, N m s/rad] for a
        turning frame.  By default they follow from the rig, see `flatrig.envs.crane.tuning`.

    Raises
    ------
    OptionError
        `track` is unknown, gains are negative or not one for each drive, `env` is neither a
        crane nor a hand, or a `PD` or a `Residual` stands below.
    """
    task = task_of(env)
    refuse_below(env, "PD")
    if track not in ("moving", "set point"):
        raise OptionError(f'track is {track!r}, it must be "moving" or "set point"')
    own = {
        name: _gain(task, name, value)
        for name, value in (("stiffness", stiffness), ("damping", damping))
        if value is not None
    }
    holds_below = any(law.holding() is not None for law in laws_of(env))
    law = PDLaw(task, task.gains(track)._replace(**own), track == "moving", not holds_below)
    return wrap(env, law, track=track, **{name: value.tolist() for name, value in own.items()})


def Feedforward(env: AnyEnv) -> Any:
    """The exact inputs of the reference; alone, or with `PD` below or above.

    Raises
    ------
    OptionError
        `env` is neither a crane nor a hand, or a `Feedforward` or a `Residual` stands below.
    """
    task = task_of(env)
    refuse_below(env, "Feedforward")
    holding = (law for law in laws_of(env) if law.holding() is not None)
    return wrap(env, FeedforwardLaw(task, next(holding, None)))


def Residual(env: AnyEnv, fraction: float = 0.2) -> Any:
    """What is learned: the action, clipped to [-1, 1], times a fraction of the drives' limits.

    An action of zero leaves the controller below as it is, to the last bit.

    Raises
    ------
    OptionError
        The fraction is not in (0, 1], `env` is neither a crane nor a hand, or a `Residual` stands
        below.
    """
    task_of(env)
    refuse_below(env, "Residual")
    return wrap(env, ResidualLaw(number("fraction", fraction, above=0, most=1)), fraction=fraction)


def task_of(env: AnyEnv) -> AnyTask:
    """The task below all wrappers.

    Raises
    ------
    OptionError
        There is none: `env` is neither a crane nor a hand.
    """
    task = getattr(getattr(env, "unwrapped", None), "task", None)
    if not isinstance(task, Task):
        raise OptionError(f"{env} is not an environment of flatrig")
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
        `env` is neither a crane nor a hand.
    """
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


def refuse_below(env: AnyEnv, name: str) -> None:
    """Nothing is added twice, and nothing above a residual, which would clip and scale it."""
    for law in laws_of(env):
        if law.name == name:
            raise OptionError(f"{name} stands below already, it must be there once")
        if isinstance(law, ResidualLaw):
            raise OptionError(
                f"{name} above Residual would be clipped and scaled; put Residual on top"
            )


def _gain(task: AnyTask, name: str, value: ArrayLike) -> Array:
    count = len(task.limits)
    try:
        gains = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        gains = np.array(np.nan)
    if gains.shape not in ((), (count,)) or not (np.isfinite(gains) & (gains >= 0)).all():
        raise OptionError(
            f"{name} is {value!r}, it must be {count} numbers >= 0, one for each of "
            f"{', '.join(task.action_names)}"
        )
    return np.broadcast_to(gains, (count,)).copy()
