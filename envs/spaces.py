"""Observation and action spaces of one simulation of a task."""

import numpy as np
from gymnasium.spaces import Box

from .common import LIMIT


def observation_space(names: tuple[str, ...]) -> Box:
    """Scaled entries, cut off at `LIMIT`."""
    return Box(-LIMIT, LIMIT, (len(names),), np.float64)


def action_space(names: tuple[str, ...]) -> Box:
    """Inputs over their limits."""
    return Box(-1.0, 1.0, (len(names),), np.float32)
