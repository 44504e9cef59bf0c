"""`flatrig bench`: how fast and how accurate, with the goals beside the numbers.

`flatrig bench feedforward` is `error_against_time`, `flatrig bench cranebench` is `in_cranebench`,
`flatrig bench stream` is `governed`.

Ratios compare two things in one run on one machine: they are timed in turns, and the median over
the repetitions is taken, so that other load on the machine hits both alike.
"""

import statistics
import time
import tracemalloc
from collections.abc import Callable
from functools import partial

import numpy as np
from rich.table import Table

from ... import models
from ...feedforward import Reference, from_move, solve
from ...feedforward.exact.branch import branch_of
from ...feedforward.exact.home import approach
from ...feedforward.exact.problem import kept_problem
from ...feedforward.solving.programs import compiled
from ...models import Rig, default_move
from ...models.errors import OptionError
from ...models.types import Array
from .. import options
from ..console import console, verdict
from ..tables import table
from .accuracy import accuracy_table, cases, land
from .program_speed import program_tables

SAMPLES = 3001
"""Samples of a path whose solution is timed."""
MEMORY_LIMIT = 200.0
"""Most memory of a solution [MB]."""
SOLVE_LIMITS = {
    "overhead_crane": 10.0,
    "rotary_crane": 40.0,
    "navy_crane_3d": 150.0,
    "cable_manipulator": 150.0,
}
"""Goals for SAMPLES samples [ms], of some cranes."""
ONE_SAMPLE_LIMITS = {"overhead_crane": 0.1, "rotary_crane": 1.0}
"""Goals for one sample [ms], of some cranes."""
STEP_LIMIT = 1.35
"""Time of an environment step over that of the same physics in plain MuJoCo."""
THROUGHPUT_LIMIT = 0.85
"""Throughput of the vector environment over that of plain mujoco.batch."""
IN_A_ROW = 20
"""Single samples timed at once."""
ENVIRONMENTS = 64
"""Environments in a vector."""
STEPS = 100
"""Control periods timed at once."""
TOPICS = {
    **dict.fromkeys(("formulation", "scheme"), ("feedforward",)),
    **dict.fromkeys(("seeds", "seconds"), ("stream",)),
    "rig": ("feedforward", "stream", "vectors"),
    **dict.fromkeys(("output", "resume", "on"), ("feedforward", "cranebench")),
    **dict.fromkeys(("samples", "json"), ("cranebench",)),
}
"""Topics that an option is for, where it is not for all."""


def main(command: options.Bench) -> int:
    """Print all tables; of another topic, those of its module."""
    options.check_number("--repetitions", command.repetitions)
    for name, topics in TOPICS.items():
        if command.topic not in topics and getattr(command, name) != getattr(options.Bench, name):
            known = " or ".join(f"`flatrig bench {topic}`" for topic in topics)
            raise OptionError(f"--{name} is for {known}")
    if command.topic == "feedforward":
        from . import error_against_time

        error_against_time.main(command)
        return 0
    if command.topic == "cranebench":
        from . import in_cranebench

        in_cranebench.main(command)
        return 0
    if command.topic == "stream":
        from . import governed

        return governed.main(command)
    if command.topic == "vectors":
        from . import vector_speed

        return vector_speed.main(command)
    out = console()
    out.print(feedforward_table(command.repetitions))
    for lines in program_tables(command.repetitions):
        out.print(lines)
    out.print(environment_table(command.repetitions))
    out.print(accuracy_table(map(land, cases())))
    return 0


def feedforward_table(repetitions: int) -> Table:
    """Time and memory of the solver."""
    lines = table(
        "Exact feedforward (first: with the analysis and the branch, which are remembered)",
        "rig", "samples", "first [ms]", "best [ms]", "median [ms]", "goal [ms]",
        "peak [MB]", "goal [MB]", "",
    )  # fmt: skip
    for name in models.CATALOGUE:
        rig, reference = models.make(name), from_move(default_move(name))
        times = np.linspace(0.0, reference.duration, SAMPLES)
        first = _first(rig, reference, times)
        path = _Timing.of(partial(solve, rig, reference, times), repetitions)
        sample = _Timing.of(partial(solve, rig, reference, 1.0), repetitions, IN_A_ROW)
        tracemalloc.start()
        solve(rig, reference, times)
        peak = tracemalloc.get_traced_memory()[1] / 1e6
        tracemalloc.stop()
        for count, timing, goal, memory in (
            (SAMPLES, path, SOLVE_LIMITS.get(name), peak),
            (1, sample, ONE_SAMPLE_LIMITS.get(name), None),
        ):
            reached = (goal is None or timing.median <= goal) and (memory or 0.0) <= MEMORY_LIMIT
            lines.add_row(
                name, str(count), f"{first:.0f}" if count > 1 else "",
                f"{timing.best:.2f}", f"{timing.median:.2f}",
                "" if goal is None else f"<= {goal:g}",
                "" if memory is None else f"{memory:.1f}",
                "" if memory is None else f"<= {MEMORY_LIMIT:g}",
                verdict(reached),
            )  # fmt: skip
    return lines


def _first(rig: Rig, reference: Reference, times: Array) -> float:
    """Time of a solution with nothing remembered from an earlier one [ms]."""
    for remembered in (kept_problem, branch_of, approach, compiled):
        remembered.cache_clear()
    begin = time.perf_counter()
    solve(rig, reference, times)
    return 1e3 * (time.perf_counter() - begin)


def environment_table(repetitions: int) -> Table:
    """Environments against plain MuJoCo with the same model and the same held inputs."""
    lines = table(
        f"Environments against plain MuJoCo, {STEPS} control periods, medians",
        "", "environment", "plain", "ratio", "goal", "",
    )  # fmt: skip
    for name in ("overhead_crane", "rotary_crane"):
        timings = _alternate(*_single(models.make(name)), repetitions)
        ratio = statistics.median(env / plain for env, plain in zip(*timings, strict=True))
        times = (1e6 / STEPS * statistics.median(seconds) for seconds in timings)
        lines.add_row(
            f"{name}: step against mj_step", *(f"{value:.1f} us" for value in times),
            f"{ratio:.2f}", f"<= {STEP_LIMIT:g}", verdict(ratio <= STEP_LIMIT),
        )  # fmt: skip
    for name in ("overhead_crane", "rotary_crane"):
        timings = _alternate(*_vector(models.make(name)), repetitions)
        ratio = statistics.median(plain / env for env, plain in zip(*timings, strict=True))
        speeds = (ENVIRONMENTS * STEPS / statistics.median(seconds) for seconds in timings)
        lines.add_row(
            f"{name}: {ENVIRONMENTS} in a vector against mujoco.batch",
            *(f"{1e-3 * value:.1f} k/s" for value in speeds),
            f"{ratio:.2f}", f">= {THROUGHPUT_LIMIT:g}", verdict(ratio >= THROUGHPUT_LIMIT),
        )  # fmt: skip
    return lines


def _single(rig: Rig) -> tuple[Callable[[], float], Callable[[], float]]:
    """Timers of one environment's steps and of bare `mj_step` with as many substeps."""
    import mujoco

    from ...envs import CraneEnv

    env = CraneEnv(rig)
    env.reset(seed=0)
    task = env.task
    plant = task.plant
    inputs = np.array(plant.ctrl[0])
    action = inputs / task.limits
    data = mujoco.MjData(plant.model)

    def plain() -> None:
        data.ctrl[:] = inputs
        mujoco.mj_step(plant.model, data, plant.substeps)

    return (
        _timer(partial(env.reset, seed=0), partial(env.step, action)),
        _timer(partial(mujoco.mj_resetDataKeyframe, plant.model, data, 0), plain),
    )


def _vector(rig: Rig) -> tuple[Callable[[], float], Callable[[], float]]:
    """Timers of a vector environment's steps and of bare `mujoco.batch` with as many threads."""
    from mujoco.batch import Batch

    from ...envs import CraneVectorEnv

    env = CraneVectorEnv(rig, num_envs=ENVIRONMENTS)
    env.reset(seed=0)
    task = env.task
    plant = task.plant
    inputs = np.array(plant.ctrl)
    actions = inputs / task.limits
    batch = Batch(plant.model, ENVIRONMENTS, plant.batch.nthread)
    ctrl, qpos, home = batch.bind("ctrl"), batch.bind("qpos"), np.array(plant.model.key_qpos[0])

    def go_home() -> None:
        batch.reset()
        qpos[:] = home

    def plain() -> None:
        ctrl[:] = inputs
        batch.step(None, plant.substeps)

    return (
        _timer(partial(env.reset, seed=0), partial(env.step, actions)),
        _timer(go_home, plain),
    )


def _timer(reset: Callable[[], object], step: Callable[[], object]) -> Callable[[], float]:
    """Timer of `STEPS` control periods from the start [s]."""

    def timed() -> float:
        reset()
        begin = time.perf_counter()
        for _ in range(STEPS):
            step()
        return time.perf_counter() - begin

    return timed


def _alternate(
    first: Callable[[], float], second: Callable[[], float], repetitions: int
) -> tuple[list[float], list[float]]:
    """Timings of two things in turns, after one warm-up each."""
    first(), second()
    pairs = [(first(), second()) for _ in range(repetitions)]
    return [pair[0] for pair in pairs], [pair[1] for pair in pairs]


class _Timing:
    """Best and median time of a call [ms]."""

    def __init__(self, seconds: list[float]) -> None:
        self.best = 1e3 * min(seconds)
        self.median = 1e3 * statistics.median(seconds)

    @classmethod
    def of(cls, call: Callable[[], object], repetitions: int, times: int = 1) -> "_Timing":
        """Time `times` calls in a row, `repetitions` times; values are for one call."""
        call()
        seconds = []
        for _ in range(repetitions):
            begin = time.perf_counter()
            for _ in range(times):
                call()
            seconds.append((time.perf_counter() - begin) / times)
        return cls(seconds)
