"""Actions that last: a policy that acts less often than the controllers below it.

    env = envs.Residual(envs.Feedforward(envs.PD(gym.make("flatrig/OverheadCrane-v0"))))
    env = envs.ActionRate(env, 10.0)        # controllers at 50 Hz, actions at 10 Hz

An action is handed down in every control period until the next one.  The reward is the mean of
those of the periods, of which none follow where an episode is over; what is observed and told is
the last.
"""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper

from ..models.errors import OptionError
from ..models.values import bounded
from .laws import AnyEnv, task_of
from .remembering import Above


class _Lasting(Above):
    """What single and vector environments with lasting actions have in common."""

    lasts = True
    """Marks what controllers must not stand on."""
    _function = __name__, "ActionRate"
    _every: int

    def _prepare(self, rate: float, every: int) -> None:
        self._options, self._every = {"rate": rate}, every
        self.metadata = {**self.env.metadata, "render_fps": round(rate)}


class LastingEnv(_Lasting, gym.Wrapper[Any, Any, Any, Any]):  # type: ignore[override]
    """A single environment whose actions last."""

    def __init__(self, env: gym.Env[Any, Any], rate: float, every: int) -> None:
        super().__init__(env)
        self._prepare(rate, every)

    def step(self, action: Any) -> Any:
        """Hand the action down until the next one, or the end of the episode."""
        total = 0.0
        for _ in range(self._every):
            seen, reward, terminated, truncated, info = self.env.step(action)
            total += float(reward)
            if terminated or truncated:
                break
        return seen, total / self._every, terminated, truncated, info


class LastingVectorEnv(  # type: ignore[override]
    _Lasting, VectorWrapper[Any, Any, Any, Any, Any]
):
    """A native vector whose actions last: whose episodes are over stand still until the next."""

    def __init__(self, env: VectorEnv[Any, Any, Any], rate: float, every: int) -> None:
        super().__init__(env)
        self._prepare(rate, every)

    @property
    def autoreset_mode(self) -> AutoresetMode:
        """When the next episode begins."""
        return self.env.metadata["autoreset_mode"]  # type: ignore[no-any-return]

    def step(self, actions: Any) -> Any:
        """Hand the actions down until the next ones."""
        base: Any = self.unwrapped
        begun, total = base.over.copy(), np.zeros(self.num_envs)
        terminated, truncated = np.zeros((2, self.num_envs), dtype=bool)
        try:
            base.still = np.zeros(self.num_envs, dtype=bool)
            for _ in range(self._every):
                _, rewards, ended, late, _ = self.env.step(actions)
                total += rewards
                terminated |= ended
                truncated |= late
                base.still = begun | terminated | truncated
                if base.still.all():
                    break
        finally:
            base.still = None
        return base.told(total / self._every, terminated, truncated)


def ActionRate(env: AnyEnv, rate: float) -> Any:
    """Let actions last for several control periods.

    Parameters
    ----------
    env
        A crane or hand, single or vector, with its controllers.
    rate
        Actions in a second [Hz]; a whole number of control periods must fit between two.

    Raises
    ------
    OptionError
        None does, or `env` is neither a crane nor a hand.
    """
    period = task_of(env).period
    rate = bounded("rate", rate, above=0, unit="Hz")
    every = round(1.0 / (rate * period))
    if every < 1 or abs(every * rate * period - 1.0) > 1e-6:
        raise OptionError(
            f"rate is {rate:g} Hz, it must be {1.0 / period:g} Hz, that of control, over a whole "
            "number"
        )
    if isinstance(env, VectorEnv):
        return LastingVectorEnv(env, rate, every)
    return LastingEnv(env, rate, every)
