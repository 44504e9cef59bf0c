"""Observation and action spaces of a task."""

import numpy as np
from gymnasium.spaces import Box

from .crane.observation import LIMIT
from .episodes import Task


def observation_space(task: Task) -> Box:
    """Of one simulation."""
    return Box(-LIMIT, LIMIT, (len(task.observation_names),), np.float64)


def action_space(task: Task) -> Box:
    """Of one simulation: inputs over their limits."""
    return Box(-1.0, 1.0, (len(task.action_names),), np.float32)
