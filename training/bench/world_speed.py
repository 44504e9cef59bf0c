"""`flatrig bench warp`: how many worlds times steps a second mujoco_warp takes on this machine.

    flatrig bench warp --rig overhead --repetitions 5

Feedforward and PD as torch code, on the device that Warp takes by itself: a GPU where there is one.
Beside it stands the native vector environment, MuJoCo in C on all processors, with the same
controllers.  A step is a control period of four time steps.
"""

import importlib.util
import os
import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from rich.table import Table

from ... import envs, models
from ...models.errors import OptionError
from .. import options
from ..console import console
from ..tables import table

SIZES = (1, 64, 1024, 8192)
"""Numbers of worlds."""
STEPS = 10
"""Control periods of all worlds that are timed at once."""
RIGS = ("overhead", "rotary")
"""Cranes where none is named."""
TIMESTEP = 5e-3
"""Of either simulation [s]."""
NEEDED = ("torch", "warp", "mujoco_warp")
"""Packages of the extra `warp`."""


def main(command: options.Bench) -> int:
    """Print a table for each rig.

    Raises
    ------
    OptionError
        A package is missing.
    """
    for name in NEEDED:
        if importlib.util.find_spec(name) is None:
            raise OptionError(f"worlds need the package {name}: pip install 'flatrig[warp]'")
    out = console()
    for name in command.rig or RIGS:
        out.print(speed_table(models.make(name), command.repetitions))
    return 0


def speed_table(rig: models.Rig, repetitions: int) -> Table:
    """Worlds times steps a second by the number of worlds."""
    from ...envs.warp import Worlds

    lines, device = None, ""
    for size in SIZES:
        worlds = Worlds(rig, size, timestep=TIMESTEP)
        if lines is None:
            device = _name(worlds.device)
            lines = table(
                f"{rig.name}: worlds x control steps a second, medians",
                "worlds", f"mujoco_warp, {device}", f"C, {os.cpu_count()} processors",
            )  # fmt: skip
        fast = _speed(partial(_step, worlds), size, repetitions, worlds)
        vector: Any = envs.make_vec(
            envs.OWN, size, rig=rig, timestep=TIMESTEP, wrappers=(envs.PD, envs.Feedforward)
        )
        vector.reset(seed=0)
        still = np.zeros(vector.action_space.shape)
        slow = _speed(partial(vector.step, still), size, repetitions)
        vector.close()
        lines.add_row(str(size), f"{fast:.0f}", f"{slow:.0f}")
    assert lines is not None
    return lines


def _step(worlds: Any) -> None:
    worlds.step(worlds.base())


def _name(device: Any) -> str:
    """What a device is called."""
    import torch

    return torch.cuda.get_device_name(device) if device.type == "cuda" else "processor"


def _speed(step: Callable[[], object], size: int, repetitions: int, worlds: Any = None) -> float:
    """Steps of single worlds a second, the median of some timings after one to warm up."""
    seconds = []
    for _ in range(repetitions + 1):
        _wait(worlds)
        begin = time.perf_counter()
        for _ in range(STEPS):
            step()
        _wait(worlds)
        seconds.append(time.perf_counter() - begin)
    return STEPS * size / statistics.median(seconds[1:])


def _wait(worlds: Any) -> None:
    """Wait for a GPU to be done."""
    if worlds is not None and worlds.device.type == "cuda":
        import torch

        torch.cuda.synchronize(worlds.device)
