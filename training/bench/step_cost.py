"""`flatrig bench steps`: what environments add to their physics, with the goals beside the numbers.

    flatrig bench steps --rig overhead --repetitions 30

With standard disturbances: a step of one environment over as many time steps of plain MuJoCo, one
of a vector over plain `mujoco.batch`, in one thread, and how long it takes to begin an episode in a
vector; then a time step of the exported machine over one of the model that flatrig compiles.  Both
sides of a ratio begin in the same state under the same inputs, are timed in short turns, and the
shortest of each counts, since all that others do on the machine makes them longer.
"""

import time
from collections.abc import Callable
from functools import partial

import mujoco
import numpy as np
from mujoco.batch import Batch
from rich.progress import track
from rich.table import Table
from rich.text import Text

from ... import envs, models
from ...models import Rig
from ...models.mjcf import export
from .. import options
from ..console import console, verdict
from ..tables import table

STATE = int(mujoco.mjtState.mjSTATE_INTEGRATION)
STEPS, VECTOR_STEPS = 20, 2
"""Control periods timed at once, of one environment and of a vector."""
TIME_STEPS = 100
"""Time steps of models that are timed at once."""
ENVIRONMENTS = 256
"""Environments in a vector."""
SHORT = 10
"""So many turns more of what takes milliseconds."""
SEED = 3
"""Of the scenarios."""
STEP_LIMIT, VECTOR_LIMIT, EXPORT_LIMIT = 1.5, 1.05, 1.05
"""Goals for the ratios."""
RESET_LIMIT = 0.3
"""Goal for the time in which an episode of a vector begins [ms]."""

Timer = Callable[[], float]
"""Does something and says how long it took [s]."""


def main(command: options.Bench) -> int:
    """Print the table."""
    out = console()
    names = command.rig or tuple(models.CATALOGUE)
    rows = track(names, "Timing", transient=True, console=out)
    out.print(cost_table([models.make(name) for name in rows], command.repetitions))
    return 0


def cost_table(rigs: list[Rig], repetitions: int) -> Table:
    """A row for each rig."""
    lines = table(
        f"Environments over their physics, {ENVIRONMENTS} in a vector, the shortest of "
        f"{repetitions} turns, of what is short {SHORT * repetitions}",
        "rig", "physics [us]", "one", f"<= {STEP_LIMIT:g}", "vector", f"<= {VECTOR_LIMIT:g}",
        "reset [ms]", f"<= {RESET_LIMIT:g}", "exported", f"<= {EXPORT_LIMIT:g}",
    )  # fmt: skip
    for rig in rigs:
        step, plain = shortest(single(rig), SHORT * repetitions)
        many, batch, reset = shortest(vector(rig), repetitions)
        exported, compiled = shortest(machines(rig), SHORT * repetitions)
        row: list[str | Text] = [rig.name, f"{1e6 * plain:.1f}"]
        for value, limit in (
            (step / plain, STEP_LIMIT), (many / batch, VECTOR_LIMIT),
            (1e3 * reset, RESET_LIMIT), (exported / compiled, EXPORT_LIMIT),
        ):  # fmt: skip
            row += [f"{value:.2f}", verdict(value <= limit)]
        lines.add_row(*row)
    return lines


def shortest(timers: list[Timer], repetitions: int) -> list[float]:
    """The shortest times of some things that are done in turns, after one warm-up each [s]."""
    turns = [[timer() for timer in timers] for _ in range(repetitions + 1)]
    return [min(times) for times in zip(*turns[1:], strict=True)]


def single(rig: Rig) -> list[Timer]:
    """Timers of a step of an environment, and of as many time steps of plain MuJoCo."""
    env = envs.CraneEnv(rig, disturbances="standard")
    env.reset(seed=SEED)
    task, state, model, data = env.task, env.get_state(), env.model, env.data
    start = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, start, STATE)
    inputs = np.array(task.plant.ctrl[0])
    action = task.acting.of_actions(inputs[None] / task.limits)[0]

    def plain() -> None:
        data.ctrl[: len(inputs)] = inputs
        mujoco.mj_step(model, data, task.plant.substeps)

    return [
        _timer(partial(env.set_state, state), partial(env.step, action), STEPS),
        _timer(partial(mujoco.mj_setState, model, data, start, STATE), plain, STEPS),
    ]


def vector(rig: Rig) -> list[Timer]:
    """Timers of a step of a vector, of plain `mujoco.batch`, and of one of its resets."""
    env = envs.CraneVectorEnv(rig, num_envs=ENVIRONMENTS, disturbances="standard", nthread=1)
    env.reset(seed=SEED)
    task, states, batch = env.task, env.get_state(), env.task.plant.batch
    start, inputs = batch.state.copy(), np.array(task.plant.ctrl)
    actions = task.acting.of_actions(inputs / task.limits)

    def plain() -> None:
        task.plant.ctrl[:] = inputs
        batch.step(None, task.plant.substeps)

    def reset() -> float:
        return _timer(lambda: None, partial(env.reset, seed=SEED), 1)() / ENVIRONMENTS

    return [
        _timer(partial(env.set_state, states), partial(env.step, actions), VECTOR_STEPS),
        _timer(partial(_put, batch, start), plain, VECTOR_STEPS),
        reset,
    ]


def machines(rig: Rig) -> list[Timer]:
    """Timers of a time step about home of the exported machine, and of the compiled one."""
    exported = mujoco.MjModel.from_xml_string(export.xml(rig))
    return [_time_step(model) for model in (exported, models.compile(rig, visuals=False))]


def _time_step(model: mujoco.MjModel) -> Timer:
    data = mujoco.MjData(model)
    home = partial(mujoco.mj_resetDataKeyframe, model, data, 0)
    return _timer(home, partial(mujoco.mj_step, model, data), TIME_STEPS)


def _put(batch: Batch, state: np.ndarray) -> None:
    batch.state[:] = state


def _timer(begin: Callable[[], object], step: Callable[[], object], number: int) -> Timer:
    """Timer of one of `number` steps in a row."""

    def timed() -> float:
        begin()
        start = time.perf_counter()
        for _ in range(number):
            step()
        return (time.perf_counter() - start) / number

    return timed
