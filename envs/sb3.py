"""A vector environment as stable-baselines3 has them; needs that package, and nothing else does.

    from flatrig.envs.sb3 import VecEnv

    vector = gym.make_vec("flatrig/OverheadCrane-v0", num_envs=32, autoreset_mode="SameStep")
    vector = envs.Residual(envs.Feedforward(envs.PD(vector)))
    SAC("MlpPolicy", VecEnv(vector)).learn(100_000)

All simulations are stepped together in C threads, which stable-baselines3's own ``DummyVecEnv`` and
``SubprocVecEnv`` do not; `flatrig bench vectors` compares them.  Seeded alike, the episodes are the
same.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from stable_baselines3.common.vec_env import VecEnv as AnyVecEnv

from ..models.errors import OptionError

Indices = int | Iterable[int] | None


class VecEnv(AnyVecEnv):
    """A Gymnasium vector environment, wrapped or not, for stable-baselines3.

    Parameters
    ----------
    env
        Whose `autoreset_mode` is SAME_STEP: that is what stable-baselines3 counts on.

    Raises
    ------
    OptionError
        It is no vector environment, or another mode's.
    """

    def __init__(self, env: VectorEnv[Any, Any, Any]) -> None:
        mode = env.metadata.get("autoreset_mode") if isinstance(env, VectorEnv) else None
        if mode is not AutoresetMode.SAME_STEP:
            raise OptionError(
                f"VecEnv takes a vector whose autoreset_mode is SameStep, not {env}; "
                'make it by gymnasium.make_vec(..., autoreset_mode="SameStep")'
            )
        self.env = env
        self._actions: Any = None
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)

    def reset(self) -> Any:
        """First observations; seeds and options are those of `seed` and ``set_options``."""
        options: dict[str, Any] = {}
        names = {name for own in self._options for name in own}
        for name in names:  # one for each simulation, as the vector has them
            options[f"{name}s"] = [own.get(name) for own in self._options]
        seeds = None if all(seed is None for seed in self._seeds) else list(self._seeds)
        observations, info = self.env.reset(seed=seeds, options=options or None)  # type: ignore[arg-type]
        self.reset_infos = self._each(info)
        self._reset_seeds()
        self._reset_options()
        return observations

    def step_async(self, actions: Any) -> None:
        """Take note of actions; `step_wait` hands them down."""
        self._actions = actions

    def step_wait(self) -> Any:
        """Observations, rewards, which episodes are over, and an info for each simulation.

        Where an episode is over the observation is the next one's first, and the info the last of
        the old one, with "terminal_observation" and "TimeLimit.truncated".
        """
        seen, rewards, terminated, truncated, info = self.env.step(self._actions)
        over = terminated | truncated
        infos = self._each(info)
        for sim in np.flatnonzero(over).tolist():
            last, final = infos[sim].pop("final_info"), infos[sim].pop("final_obs")
            self.reset_infos[sim] = infos[sim]
            infos[sim] = {
                **last,
                "terminal_observation": final,
                "TimeLimit.truncated": bool(truncated[sim] and not terminated[sim]),
            }
        return seen, rewards.astype(np.float32), over, infos

    def close(self) -> None:
        """Close the vector."""
        self.env.close()

    def get_images(self) -> Sequence[Any]:
        """A picture of each simulation."""
        return self.env.render() or [None] * self.num_envs

    def get_attr(self, attr_name: str, indices: Indices = None) -> list[Any]:
        """An attribute of the vector, once for each of the simulations asked for."""
        return [getattr(self._holder(attr_name), attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Indices = None) -> None:
        """Set an attribute of the vector, which all simulations share."""
        setattr(self._holder(attr_name), attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: Indices = None, **method_kwargs: Any
    ) -> list[Any]:
        """What a method of the vector says, called once for all, for each simulation asked for."""
        said = getattr(self._holder(method_name), method_name)(*method_args, **method_kwargs)
        return [said for _ in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Indices = None) -> list[bool]:
        """Whether a wrapper of a class is around the vector, for each simulation asked for."""
        wrapped = any(isinstance(layer, wrapper_class) for layer in self._layers())
        return [wrapped for _ in self._get_indices(indices)]

    def _layers(self) -> list[Any]:
        """The vector and what is below its wrappers."""
        layers: list[Any] = [self.env]
        while layers[-1] is not layers[-1].unwrapped:
            layers.append(layers[-1].env)
        return layers

    def _holder(self, name: str) -> Any:
        """The outermost layer that has an attribute."""
        layers = self._layers()
        return next((layer for layer in layers if hasattr(layer, name)), layers[-1])

    def _each(self, info: Any) -> list[dict[str, Any]]:
        """An info for each simulation, of those entries that are about it."""
        if isinstance(info, list):  # from `DictInfoToList`
            return info
        return each_info(info, self.num_envs)


def each_info(info: dict[str, Any], num: int) -> list[dict[str, Any]]:
    """The info of a vector of n simulations, taken apart."""
    infos: list[dict[str, Any]] = [{} for _ in range(num)]
    for name, values in info.items():
        if name.startswith("_") and name[1:] in info:
            continue
        which = info.get(f"_{name}")
        parts = each_info(values, num) if isinstance(values, dict) else values
        if which is None or which.all():
            for own, part in zip(infos, parts, strict=True):
                own[name] = part
        else:
            for sim in np.flatnonzero(which).tolist():
                infos[sim][name] = parts[sim]
    return infos
