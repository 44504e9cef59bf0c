"""The crane environments as stable-baselines3 wants them.

`Adapter` turns a gymnasium vector environment into an SB3 VecEnv: episodes are restarted in the
step in which they end, and the policy's memory stands between the network and the environment.
`Network` is SB3's actor-critic with a critic that may look at what the actor must not: the state
of the load and the scenario are known in simulation, and a critic that knows them learns faster.
"""

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.vec_env import VecEnv
from torch import nn

from ...models.types import Array, Mask
from ..policy import CLIP, Card, Policy
from ..recall import Memory, Recall

Single = NDArray[np.float32]


class Adapter(VecEnv):
    """SB3's view of a vector environment whose observations split into public and private.

    The first entries of an observation, `recall.observations` of them, are what the policy is
    given when it is used; the rest only the critic sees.  Observations here are the memory's
    features followed by the private entries, normalised by their running mean and deviation.

    The first episodes are cut short, each after another share of the `episode` periods that one
    lasts: an update then sees all phases of the move, and not the same one in all simulations.
    """

    def __init__(self, env: Any, recall: Recall, episode: int) -> None:
        (total,) = env.single_observation_space.shape or (0,)
        self.env = env
        self.recall = recall
        self.private = total - recall.observations
        self.memory: Memory = recall.start(env.num_envs)
        self.normaliser = RunningMeanStd(shape=(recall.features + self.private,))
        self.lessons: list[Array] = []
        self._returns = np.zeros(env.num_envs)
        self._lengths = np.zeros(env.num_envs, dtype=np.int64)
        self._longest = self._lengths.copy()
        self._episode = episode
        bound = np.full(recall.features + self.private, CLIP, dtype=np.float32)
        super().__init__(
            env.num_envs,
            gym.spaces.Box(-bound, bound),
            gym.spaces.Box(-1.0, 1.0, (recall.actions,), np.float32),
        )

    def reset(self) -> Single:
        """Start all episodes anew."""
        observation, _ = self.env.reset(seed=self._seeds[0])
        self._reset_seeds()
        self.memory.reset()
        self._returns[:] = 0.0
        self._lengths[:] = 0
        ends = np.linspace(0, self._episode, self.num_envs + 1)[1:]
        every = self.recall.every
        self._longest = np.maximum(np.ceil(ends / every).astype(np.int64), 1) * every
        return self._look(observation)

    def step_async(self, actions: NDArray[Any]) -> None:
        """Take the network's outputs."""
        self.memory.aim[...] = self.recall.aim(actions)
        self.lessons.append(self.env.advice())

    def step_wait(self) -> tuple[Single, Single, Mask, list[dict[str, Any]]]:
        """Go on to the next decision; after an episode's end the inputs are the next one's."""
        total = np.zeros(self.num_envs)
        finished = np.zeros(self.num_envs, dtype=bool)
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for _ in range(self.recall.every):
            action = self.recall.act(self.memory)
            observation, reward, terminated, truncated, _ = self.env.step(action)
            reward = np.where(finished, 0.0, reward)
            total += reward
            self._returns += reward
            self._lengths += 1
            done = (terminated | truncated | (self._lengths >= self._longest)) & ~finished
            inputs = self._look(observation)
            if done.any():
                for i in np.flatnonzero(done):
                    infos[i] = {
                        "terminal_observation": inputs[i],
                        "TimeLimit.truncated": not terminated[i],
                        "episode": {"r": self._returns[i], "l": int(self._lengths[i]), "t": 0.0},
                    }
                inputs = np.where(done[:, None], self._restart(done), inputs)
                finished |= done
        return inputs, total.astype(np.float32), finished, infos

    def _restart(self, ids: Mask) -> Single:
        """Begin new episodes; what the networks see of them."""
        observation, _ = self.env.reset(options={"reset_mask": ids})
        self.memory.reset(ids)
        self._returns[ids], self._lengths[ids] = 0.0, 0
        self._longest[ids] = np.iinfo(np.int64).max
        return self._look(observation, ids)

    def _look(self, observation: Array, ids: Mask | slice = slice(None)) -> Single:
        """What the networks see, (num, ...); only the memory of `ids` takes it in."""
        public, private = np.split(observation, [self.recall.observations], axis=1)
        memory = self.memory
        part = Memory(memory.action[ids], memory.aim[ids], memory.slow[ids], memory.age[ids])
        features = np.zeros((self.num_envs, self.recall.features))
        features[ids] = self.recall.look(public[ids], part)
        memory.slow[ids] = part.slow
        whole = np.concatenate((features, private), axis=1)
        self.normaliser.update(whole[ids])
        normal = (whole - self.normaliser.mean) / self.scale
        return np.clip(normal, -CLIP, CLIP).astype(np.float32)

    @property
    def scale(self) -> Array:
        """Standard deviations of features and private entries."""
        # 1e-8 keeps entries that have never varied from being divided by zero; SB3's own value.
        return np.asarray(np.sqrt(self.normaliser.var + 1e-8))

    def close(self) -> None:
        """Close the environment."""
        self.env.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """The attribute, once for each simulation asked for."""
        return [getattr(self.env, attr_name)] * len(self._get_indices(indices))  # type: ignore[arg-type]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute of the one environment behind all simulations."""
        setattr(self.env, attr_name, value)

    def env_method(
        self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any
    ) -> list[Any]:
        """Call a method of the one environment behind all simulations."""
        return [getattr(self.env, method_name)(*args, **kwargs)]

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """SB3's wrappers do not apply; episodes are recorded here."""
        return [True] * len(self._get_indices(indices))  # type: ignore[arg-type]


class _Split(nn.Module):
    """Two tanh networks; the actor's sees the first `public` features only."""

    def __init__(self, features: int, public: int, hidden: Sequence[int]) -> None:
        super().__init__()
        self.public = public
        self.latent_dim_pi = self.latent_dim_vf = hidden[-1]
        self.actor = _tanh_layers(public, hidden)
        self.critic = _tanh_layers(features, hidden)

    def forward(self, features: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        return self.forward_actor(features), self.forward_critic(features)

    def forward_actor(self, features: torch.Tensor) -> torch.Tensor:
        return self.actor(features[:, : self.public])  # type: ignore[no-any-return]

    def forward_critic(self, features: torch.Tensor) -> torch.Tensor:
        return self.critic(features)  # type: ignore[no-any-return]


def _tanh_layers(inputs: int, hidden: Sequence[int]) -> nn.Sequential:
    layers: list[nn.Module] = []
    for outputs in hidden:
        layers += [nn.Linear(inputs, outputs), nn.Tanh()]
        inputs = outputs
    return nn.Sequential(*layers)


class Network(ActorCriticPolicy):
    """SB3's policy with an actor that starts at zero and a critic that sees more."""

    def __init__(self, *args: Any, public: int, hidden: Sequence[int], **kwargs: Any) -> None:
        self.public, self.hidden = public, tuple(hidden)
        super().__init__(*args, **kwargs)

    def _build_mlp_extractor(self) -> None:
        self.mlp_extractor = _Split(self.features_dim, self.public, self.hidden)  # type: ignore[assignment]

    def _build(self, lr_schedule: Any) -> None:
        super()._build(lr_schedule)
        head: Any = self.action_net
        nn.init.zeros_(head.weight)
        nn.init.zeros_(head.bias)


def export(network: Network, adapter: Adapter, card: Card) -> Policy:
    """The trained actor as a NumPy policy, normalisation included."""
    split: Any = network.mlp_extractor
    head: Any = network.action_net
    layers = [*(layer for layer in split.actor if isinstance(layer, nn.Linear)), head]
    numbers = [
        [p.detach().cpu().numpy().astype(np.float64) for p in (layer.weight, layer.bias)]
        for layer in layers
    ]
    public = adapter.recall.features  # the private entries follow
    return Policy(
        card=card,
        weights=tuple(weight for weight, _ in numbers),
        biases=tuple(bias for _, bias in numbers),
        mean=np.array(adapter.normaliser.mean[:public]),
        scale=adapter.scale[:public].copy(),
    )
