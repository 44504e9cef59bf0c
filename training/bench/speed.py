"""`flatrig bench`: how fast and how accurate, with the goals beside the numbers.

`flatrig bench feedforward` is `error_against_time`, `flatrig bench cranebench` is `in_cranebench`,
`flatrig bench stream` is `governed`, `flatrig bench steps` is `step_cost`.
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
from .step_cost import cost_table

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
IN_A_ROW = 20
"""Single samples timed at once."""
ENVIRONMENTS = ("overhead_crane", "rotary_crane")
"""Cranes whose environments are timed; `flatrig bench steps` does it for all."""
TOPICS = {
    **dict.fromkeys(("formulation", "scheme"), ("feedforward",)),
    **dict.fromkeys(("seeds", "seconds"), ("stream",)),
    "rig": ("feedforward", "stream", "steps", "vectors", "warp"),
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
    if command.topic == "steps":
        from . import step_cost

        return step_cost.main(command)
    if command.topic == "warp":
        from . import world_speed

        return world_speed.main(command)
    if command.topic == "vectors":
        from . import vector_speed

        return vector_speed.main(command)
    out = console()
    out.print(feedforward_table(command.repetitions))
    for lines in program_tables(command.repetitions):
        out.print(lines)
    out.print(cost_table([models.make(name) for name in ENVIRONMENTS], command.repetitions))
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
