"""PPO that is taught first: imitation of the teacher, then reinforcement learning.

While `taught`, the policy acts as it likes, with PPO's exploration, and an update fits its actions
to what the teacher would have done in the same places (DAgger, Ross et al. 2011); the critic
learns from the returns, so that PPO finds it ready.
"""

from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from torch.nn.functional import mse_loss

from .settings import Settings


class Student(PPO):
    """PPO on an `Adapter` that offers lessons."""

    def __init__(self, *args: Any, settings: Settings, taught: Callable[[], bool], **kwargs: Any):
        self.settings, self.taught = settings, taught
        self.lessons: deque[tuple[torch.Tensor, torch.Tensor]] = deque(maxlen=settings.lessons)
        super().__init__(*args, **kwargs)

    def train(self) -> None:
        """Update from the last rollout."""
        adapter: Any = self.env
        advice, adapter.lessons = np.array(adapter.lessons), []
        if self.taught():
            self._imitate(advice)
        else:
            self.lessons.clear()
            super().train()

    def _imitate(self, advice: np.ndarray) -> None:
        """Fit actor and critic; `advice` has the shape (decisions, n, drives)."""
        buffer, network = self.rollout_buffer, self.policy
        seen = torch.as_tensor(buffer.observations.reshape(-1, buffer.observations.shape[-1]))
        returns = torch.as_tensor(buffer.returns.reshape(-1))
        target = torch.as_tensor(advice.reshape(len(seen), -1), dtype=torch.float32)
        self.lessons.append((seen, target))
        self._update_learning_rate(network.optimizer)
        parts: Any = network.mlp_extractor
        head: Any = network.action_net
        network.set_training_mode(True)
        for _ in range(self.settings.gradients):
            places, answers = self.lessons[int(torch.randint(len(self.lessons), ()))]
            pick = torch.randint(len(places), (self.batch_size,))
            error = mse_loss(head(parts.forward_actor(places[pick])), answers[pick])
            pick = torch.randint(len(seen), (self.batch_size,))
            value = network.value_net(parts.forward_critic(seen[pick]))[:, 0]
            loss = error + self.vf_coef * mse_loss(value, returns[pick])
            network.optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            torch.nn.utils.clip_grad_norm_(network.parameters(), self.max_grad_norm)
            network.optimizer.step()
        self.logger.record("train/imitation_loss", float(error.detach()))
        self.logger.record("train/value_loss", float(loss.detach() - error.detach()))
