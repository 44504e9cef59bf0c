"""What simulations of cranes and of hands have in common: names, limits, and how they are made."""

import os
from typing import Protocol

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from ..models.mjcf.simulate import leave_no_log
from ..models.types import Array

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

NOT_FINITE = "not finite"
"""Why an episode ends when the simulation has left the numbers."""

NOTHING = int(mujoco.mjtStage.mjSTAGE_NONE)
"""What MuJoCo computes after a step or reset whose results nobody reads."""


class Encoded(Protocol):
    """n simulations whose drives have encoders; arrays are live."""

    num: int
    """Number of simulations n."""
    encoders: Array
    """What ideal encoders read: positions, then rates, shape (n, 2 drives)."""
    drive_positions: Array
    """The first half of `encoders`, shape (n, drives) [m, rad]."""
    drive_rates: Array
    """The second half of `encoders`, shape (n, drives) [m/s, rad/s]."""


class Measured(Protocol):
    """What a scenario says about encoders and inputs."""

    @property
    def encoder_resolution(self) -> float:
        """Step of what encoders read [m, rad], 0 for none."""

    @property
    def delay(self) -> int:
        """Whole control periods between command and input."""


def bare_model(scene: mujoco.MjSpec) -> mujoco.MjModel:
    """Compile the physics of an environment, whose warnings go to the console only."""
    leave_no_log()
    # A state that is not finite must show, not be replaced by the initial one without a word.
    scene.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    return scene.compile()


def batch_of(model: mujoco.MjModel, num: int, nthread: int | None) -> Batch:
    """Make `num` simulations, by default with as many threads as there are processors for them."""
    threads = min(num, os.cpu_count() or 1) if nthread is None else int(nthread)
    return Batch(model, num, threads, persistent=True)
