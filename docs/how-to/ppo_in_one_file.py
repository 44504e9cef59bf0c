"""PPO in one file, in the manner of CleanRL: read it from top to bottom, and change it.

    python docs/how-to/ppo_in_one_file.py --total-timesteps 200000

What is learned stands on top of feedforward and PD.  Needs torch, and no training code of flatrig.
"""

import time
from dataclasses import dataclass
from itertools import pairwise

import gymnasium as gym
import numpy as np
import torch
import tyro
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from torch import nn
from torch.distributions import Normal

import flatrig.envs as envs


@dataclass
class Args:
    """Options."""

    env_id: str = "flatrig/OverheadCrane-v0"
    """Environment."""
    total_timesteps: int = 200_000
    """Steps of all environments together."""
    learning_rate: float = 3e-4
    """Of Adam, falling to 0."""
    num_envs: int = 8
    """Environments side by side."""
    num_steps: int = 256
    """Steps of each between two updates."""
    minibatches: int = 16
    """Parts of what is learned from in an epoch."""
    epochs: int = 6
    """How often the same steps are learned from."""
    gamma: float = 0.99
    """Discount."""
    lam: float = 0.95
    """Of generalised advantage estimation."""
    clip: float = 0.2
    """How far the ratio of probabilities may go from 1."""
    seed: int = 0
    """Of everything."""


def make_env(env_id: str) -> gym.Env:
    """One crane, its controllers, and statistics."""
    env = gym.make(env_id, disturbances="standard")
    env = envs.Residual(envs.Feedforward(envs.PD(env)))
    return gym.wrappers.RecordEpisodeStatistics(env)


class Agent(nn.Module):
    """Actor and critic; the actor begins next to zero, where the controllers below are alone."""

    def __init__(self, entries: int, actions: int) -> None:
        super().__init__()

        def network(outputs: int, gain: float) -> nn.Sequential:
            widths, parts = (entries, 64, 64), []
            for before, after in pairwise(widths):
                parts += [orthogonal(nn.Linear(before, after), 2**0.5), nn.Tanh()]
            return nn.Sequential(*parts, orthogonal(nn.Linear(64, outputs), gain))

        self.critic, self.mean = network(1, 1.0), network(actions, 0.01)
        self.log_std = nn.Parameter(torch.full((actions,), -0.5))

    def value(self, seen: torch.Tensor) -> torch.Tensor:
        """What is still to come."""
        return self.critic(seen)[..., 0]

    def policy(self, seen: torch.Tensor) -> Normal:
        """Distribution of actions."""
        return Normal(self.mean(seen), self.log_std.exp())


def orthogonal(layer: nn.Linear, gain: float) -> nn.Linear:
    """The layer with weights as PPO likes them."""
    nn.init.orthogonal_(layer.weight, gain)
    nn.init.zeros_(layer.bias)
    return layer


args = tyro.cli(Args)
torch.manual_seed(args.seed)

vector = SyncVectorEnv(
    [lambda: make_env(args.env_id)] * args.num_envs, autoreset_mode=AutoresetMode.SAME_STEP
)
entries, actions = (space.shape for space in (vector.observation_space, vector.action_space))
agent = Agent(entries[1], actions[1])
optimizer = torch.optim.Adam(agent.parameters(), lr=args.learning_rate, eps=1e-5)

steps, num = args.num_steps, args.num_envs
seen, taken = torch.zeros(steps, *entries), torch.zeros(steps, *actions)
log_probs, rewards, values, following = (torch.zeros(steps, num) for _ in range(4))
over, failed = torch.zeros(steps, num), torch.zeros(steps, num)

updates, begin = max(1, args.total_timesteps // (steps * num)), time.time()
now = torch.as_tensor(vector.reset(seed=args.seed)[0], dtype=torch.float32)
for update in range(updates):
    optimizer.param_groups[0]["lr"] = args.learning_rate * (1.0 - update / updates)

    returns = []
    for step in range(steps):
        with torch.no_grad():
            choice = agent.policy(now)
            action = choice.sample()
        seen[step], taken[step] = now, action
        log_probs[step] = choice.log_prob(action).sum(-1)
        after, reward, terminated, truncated, info = vector.step(action.clamp(-1, 1).numpy())
        after = torch.as_tensor(after, dtype=torch.float32)
        last = after.clone()
        for sim in np.flatnonzero(terminated | truncated):
            last[sim] = torch.as_tensor(info["final_obs"][sim])  # what an end by time leads to
            returns.append(float(info["final_info"]["episode"]["r"][sim]))
        with torch.no_grad():
            values[step], following[step] = agent.value(now), agent.value(last)
        rewards[step] = torch.as_tensor(reward)
        failed[step] = torch.as_tensor(terminated)
        over[step] = torch.as_tensor(terminated | truncated)
        now = after

    deltas = rewards + args.gamma * following * (1.0 - failed) - values
    advantages, running = torch.zeros(steps, num), torch.zeros(num)
    for step in reversed(range(steps)):
        running = deltas[step] + args.gamma * args.lam * (1.0 - over[step]) * running
        advantages[step] = running
    targets = (advantages + values).flatten()

    flat = seen.flatten(0, 1), taken.flatten(0, 1), log_probs.flatten(), advantages.flatten()
    for _ in range(args.epochs):
        for part in torch.randperm(steps * num).chunk(args.minibatches):
            observed, acted, log_before, advantage = (values_of[part] for values_of in flat)
            advantage = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
            choice = agent.policy(observed)
            ratio = (choice.log_prob(acted).sum(-1) - log_before).exp()
            clipped = ratio.clamp(1.0 - args.clip, 1.0 + args.clip)
            gained = torch.min(advantage * ratio, advantage * clipped).mean()
            missed = 0.5 * (agent.value(observed) - targets[part]).square().mean()
            optimizer.zero_grad()
            (0.5 * missed - gained).backward()
            nn.utils.clip_grad_norm_(agent.parameters(), 0.5)
            optimizer.step()

    done = (update + 1) * steps * num
    mean = f"{np.mean(returns):.1f}" if returns else "-"
    print(f"{done} steps, return {mean}, {done / (time.time() - begin):.0f} steps/s", flush=True)
vector.close()
