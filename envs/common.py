"""What environments of cranes and of hands have in common: names and limits."""

from typing import Any, NamedTuple, Protocol

import mujoco
import numpy as np
from numpy.typing import NDArray

from ..models.types import Array, Mask

Ids = NDArray[np.int32]
"""Indices of some simulations, sorted."""

Steps = NDArray[np.int64]
"""A number of control periods for each simulation, shape (n,)."""

Range = tuple[float, float]
"""The lowest and the highest value that is drawn."""

LONGEST_DELAY = 31
"""Longest delay of an input in control periods: the length of the memory of commands."""

LIMIT = 100.0
"""Largest magnitude of an entry of an observation; what is beyond is cut off."""

TIME = "time"
"""Why an episode is truncated."""

NOT_FINITE = "not finite"
"""Why an episode ends when the simulation has left the numbers."""

NOTHING = int(mujoco.mjtStage.mjSTAGE_NONE)
"""What MuJoCo computes after a step or reset whose results nobody reads."""


def none_of(ids: Ids | None, num: int) -> Mask:
    """Which of `num` simulations are none of these, shape (num,); None stands for all."""
    others = np.full(num, ids is not None)
    if ids is not None:
        others[ids] = False
    return others


class Outcome(NamedTuple):
    """What a step did to each of n simulations; arrays are the caller's own."""

    reward: Array
    """Rewards in [0, 1], shape (n,)."""
    terminated: Mask
    """Whether the physics left the range in which the model is valid, shape (n,)."""
    truncated: Mask
    """Whether the time is over, shape (n,)."""
    reasons: list[str]
    """Why each simulation's episode is over; "" while it goes on."""


class AnyScenario(Protocol):
    """How one plant differs from its model."""

    @property
    def encoder_resolution(self) -> float:
        """Step of what encoders read [m, rad], 0 for none."""

    @property
    def delay(self) -> int:
        """Whole control periods between command and input."""

    def disturb(self, plant: Any, sim: int) -> None:
        """Change simulation `sim` of a plant at the start of an episode."""
