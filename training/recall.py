"""A policy's memory: features that know the recent past, and actions without jumps."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..models.types import Array, Mask


@dataclass(frozen=True, eq=False)
class Memory:
    """Filters and last actions of a number of simulations; changed in place."""

    action: Array
    """Last action, shape (num, actions)."""
    aim: Array
    """What the action is drawn to, shape (num, actions)."""
    slow: Array
    """Filtered observations and actions, shape (num, filters, observations + actions)."""
    age: NDArray[np.int64]
    """Control periods since the episode began, shape (num,)."""

    def reset(self, ids: Mask | slice = slice(None)) -> None:
        """Forget the past of some simulations."""
        self.action[ids] = 0.0
        self.aim[ids] = 0.0
        self.age[ids] = 0


@dataclass(frozen=True, eq=False)
class Recall:
    """The memory's law: features from observations, smooth actions from outputs."""

    observations: int
    """Number of the observation's entries."""
    actions: int
    """Number of the action's entries."""
    period: float
    """Control period [s]."""
    time_constants: tuple[float, ...]
    """Time constants of the low-pass filters [s]."""
    smoothing: float
    """Share of the way that the action goes to its aim in one period."""
    every: int
    """Control periods from one decision of the network to the next."""
    shares: tuple[float, ...]
    """Largest action of each drive."""

    @property
    def features(self) -> int:
        """Number of the network's inputs."""
        return (self.observations + self.actions) * (1 + len(self.time_constants))

    def start(self, num: int) -> Memory:
        """A memory without a past, for `num` simulations."""
        width = self.observations + self.actions
        return Memory(
            action=np.zeros((num, self.actions)),
            aim=np.zeros((num, self.actions)),
            slow=np.zeros((num, len(self.time_constants), width)),
            age=np.zeros(num, dtype=np.int64),
        )

    def look(self, observation: Array, memory: Memory) -> Array:
        """Take in an observation (num, observations); returns features (num, features)."""
        now = np.concatenate((observation, memory.action), axis=1)
        shares = np.array([-np.expm1(-self.period / tau) for tau in self.time_constants])
        first = memory.age == 0
        memory.slow[first] = now[first, None, :]
        memory.slow[...] += shares[:, None] * (now[:, None, :] - memory.slow)
        return np.concatenate((now, memory.slow.reshape(len(now), -1)), axis=1)

    def aim(self, output: Array) -> Array:
        """Where outputs of the network (num, actions) draw the action to."""
        return np.asarray(np.clip(output, -1.0, 1.0) * np.array(self.shares))

    def act(self, memory: Memory) -> Array:
        """The action (num, actions) of this period; a copy."""
        memory.action[...] += self.smoothing * (memory.aim - memory.action)
        memory.age[...] += 1
        return memory.action.copy()
