"""How fast a rig's own program is: in Python, on arrays and in C, beside what it is made from.

All times of a line are of one run and taken in turns, so that other load on the machine hits all
alike; ratios are medians of ratios.  C is timed over thousands of samples in one call, and called
from Python for each; the closed form is written by hand, without a check of anything.
"""

import ctypes
import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from rich.table import Table

from ... import models
from ...feedforward import Motion, Reference, from_move, solve
from ...feedforward.exact.branch import Branch, branch_of
from ...feedforward.exact.naming import motion_of
from ...feedforward.exact.problem import problem_of
from ...feedforward.exact.taylor import expand
from ...feedforward.generated.generator import generate
from ...feedforward.generated.python_source import python_source
from ...feedforward.paths.reference import taylor_of
from ...feedforward.solving.compiling import compiler
from ...feedforward.solving.inverse import interpreted
from ...feedforward.solving.programs import compiled, evaluate, guesses_at, samples_about
from ...models import Rig
from ...models.types import Array
from ..console import verdict
from ..tables import table
from .closed_forms_in_c import FORMS, ClosedForm
from .compiled_steps import CompiledSteps

SAMPLES = 3001
"""Samples of a path."""
IN_A_ROW = 20
"""Single samples timed at once."""
PROGRAM_LIMITS = {
    "overhead_crane": 10.0,
    "rotary_crane": 25.0,
    "navy_crane_3d": 75.0,
    "cable_manipulator": 200.0,
}
"""Goals for one sample by the function in Python [us], of some cranes."""
C_LIMITS = {
    "overhead_crane": 0.1,
    "rotary_crane": 0.3,
    "navy_crane_3d": 1.0,
    "cable_manipulator": 3.0,
}
"""The same in C [us]."""
FASTER = 3.0
"""How often as fast as the expansion arrays are to be."""
GENERATING = 250.0
"""Goal for the time in which a program is made and compiled in Python [ms]."""


class Roads(NamedTuple):
    """What is timed of one rig: calls, with how many samples one call is; none without C."""

    one: dict[str, tuple[Callable[[], object], int]]
    many: dict[str, tuple[Callable[[], object], int]]


def program_tables(repetitions: int) -> tuple[Table, Table]:
    """One sample, and many."""
    single = table(
        "One sample, once the branch is known, medians in one run",
        "rig", "step by step\n[us]", "solve\n[us]", "program in\nPython [us]", "goal\n[us]",
        "C, called from\nPython [us]", "C\n[us]", "goal\n[us]", "closed form\nin C [us]",
        "C is faster than\nstep by step", "",
    )  # fmt: skip
    many = table(
        f"{SAMPLES} samples, medians in one run, and what comes before",
        "rig", "step by step\n[ms]", "program\n[ms]", "ratio", "goal", "solve\n[ms]", "C\n[ms]",
        "ratio", "generating\n[ms]", "goal\n[ms]", "",
    )  # fmt: skip
    for name in models.CATALOGUE:
        rig, reference = models.make(name), from_move(models.default_move(name))
        roads = roads_of(rig, reference)
        one, whole = timed(roads.one, repetitions), timed(roads.many, repetitions)
        making = generating(rig)
        _single_row(single, name, one)
        _many_row(many, name, whole, making)
    return single, many


def roads_of(rig: Rig, reference: Reference) -> Roads:
    """What is timed of a rig along a path."""
    problem = problem_of(rig)
    branch, middle = branch_of(problem, reference), 0.4 * reference.duration
    instant, times = np.array([middle]), np.linspace(0.0, reference.duration, SAMPLES)
    one: dict[str, tuple[Callable[[], object], int]] = {
        "step by step": (partial(interpreted, branch, instant), 1),
        "solve": (partial(solve, rig, reference, middle), 1),
        "program": (_program(branch, middle), 1),
    }
    many: dict[str, tuple[Callable[[], object], int]] = {
        "step by step": (_expansion(branch, times), 1),
        "program": (_program_of_many(branch, times), 1),
        "solve": (partial(solve, rig, reference, times), 1),
    }
    if compiler() is not None:
        steps = CompiledSteps(rig, reference)
        derivatives, gaps = steps.derivatives(times), np.diff(times, prepend=0.0)
        many["C"] = partial(steps.results, derivatives, gaps), 1
        one["C"] = partial(steps.results, derivatives, gaps), SAMPLES
        one["C, called"] = _called(steps, derivatives[0]), 1
        if rig.name in FORMS:
            one["closed form"] = partial(ClosedForm(rig), derivatives), SAMPLES
    return Roads(one, many)


def _program(branch: Branch, at: float) -> Callable[[], object]:
    """The program's function itself, at one instant."""
    found = compiled(branch.problem)
    assert found is not None
    taylor = taylor_of(branch.reference, np.array([at]), branch.problem.order)[:, 0]
    sides = [branch.signs.get(block, 1.0) for block in found.program.blocks]
    guesses = guesses_at(found.program, branch, at)
    return partial(found.scalar, taylor.ravel().tolist(), guesses, sides)


def _expansion(branch: Branch, times: Array) -> Callable[[], object]:
    """The expansion of many samples, from the reference's coefficients to the motion."""
    problem = branch.problem
    taylor = taylor_of(branch.reference, times, problem.order)

    def expanded() -> Motion:
        near = branch.near(times)
        solution = expand(problem, taylor, near, follow=False, sides=branch.signs)
        return motion_of(problem, solution, times, taylor, branch.turned(times))

    return expanded


def _program_of_many(branch: Branch, times: Array) -> Callable[[], object]:
    """The same by the program, from the reference's derivatives."""
    found = compiled(branch.problem)
    assert found is not None
    derivatives = branch.reference.derivatives(times, branch.problem.order)
    return partial(evaluate, found, branch, times, derivatives)


def _called(steps: CompiledSteps, derivatives: Array) -> Callable[[], object]:
    """One step in C, the first one again and again."""
    library, held = steps.library, derivatives.copy()
    places = ctypes.addressof(library.state), held.ctypes.data, 0.0
    call = partial(steps.step, *places, ctypes.addressof(library.motion))
    call.keywords["_held"] = held  # the memory stays as long as the call
    return lambda: call.func(*call.args)


def generating(rig: Rig) -> float:
    """Time to make a program and compile it for one sample and for many [ms]."""
    begin = time.perf_counter()
    program = generate(problem_of(rig), samples_about(problem_of(rig)))
    for dialect in ("scalar", "numpy"):
        compile(python_source(program, dialect), "program", "exec")
    return 1e3 * (time.perf_counter() - begin)


def timed(
    roads: dict[str, tuple[Callable[[], object], int]], repetitions: int
) -> dict[str, list[float]]:
    """Times for a sample of each road [s], taken in turns."""
    seconds: dict[str, list[float]] = {name: [] for name in roads}
    for turn in range(repetitions + 1):
        for name, (call, samples) in roads.items():
            again = IN_A_ROW if samples == 1 and len(roads) > 3 else 1
            begin = time.perf_counter()
            for _ in range(again):
                call()
            if turn:
                seconds[name].append((time.perf_counter() - begin) / (again * samples))
    return seconds


def _single_row(lines: Table, name: str, seconds: dict[str, list[float]]) -> None:
    median = {road: 1e6 * statistics.median(values) for road, values in seconds.items()}
    goals = PROGRAM_LIMITS.get(name), C_LIMITS.get(name)
    good = all(
        goal is None or road not in median or median[road] <= goal
        for road, goal in zip(("program", "C"), goals, strict=True)
    )
    lines.add_row(
        name, f"{median['step by step']:.0f}", f"{median['solve']:.0f}",
        f"{median['program']:.1f}", "" if goals[0] is None else f"<= {goals[0]:g}",
        _cell(median, "C, called", ".1f"), _cell(median, "C", ".2f"),
        "" if goals[1] is None else f"<= {goals[1]:g}", _cell(median, "closed form", ".3f"),
        f"{_ratio(seconds, 'step by step', 'C'):.0f}" if "C" in median else "", verdict(good),
    )  # fmt: skip


def _many_row(lines: Table, name: str, seconds: dict[str, list[float]], making: float) -> None:
    median = {road: 1e3 * statistics.median(values) for road, values in seconds.items()}
    ratio = _ratio(seconds, "step by step", "program")
    lines.add_row(
        name, f"{median['step by step']:.1f}", f"{median['program']:.1f}", f"{ratio:.1f}",
        f">= {FASTER:g}", f"{median['solve']:.1f}", _cell(median, "C", ".2f"),
        f"{_ratio(seconds, 'step by step', 'C'):.0f}" if "C" in median else "",
        f"{making:.0f}", f"<= {GENERATING:g}", verdict(ratio >= FASTER and making <= GENERATING),
    )  # fmt: skip


def _cell(median: dict[str, float], road: str, form: str) -> str:
    return format(median[road], form) if road in median else ""


def _ratio(seconds: dict[str, list[float]], slow: str, fast: str) -> float:
    return statistics.median(a / b for a, b in zip(seconds[slow], seconds[fast], strict=True))
