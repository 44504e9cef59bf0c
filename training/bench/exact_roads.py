"""Roads to the exact solution: by the rig's program, step by step of the expansion, and in C."""

from collections.abc import Callable
from functools import partial

from ...feedforward import Motion, solve
from ...feedforward.exact.branch import branch_of
from ...feedforward.exact.problem import problem_of
from ...feedforward.solving.compiling import compiler
from ...feedforward.solving.inverse import interpreted
from ...models.types import Array
from .compiled_steps import CompiledSteps
from .smooth_moves import Case

EXACT = "exact solution"
"""What `solve` does, by a program in Python."""
STEP_BY_STEP = "exact, step by step"
"""The expansion, from which the program is made."""
COMPILED = "exact, compiled C"
"""The program in C, and the reference's derivatives in Python."""


def roads() -> tuple[str, ...]:
    """Names of those that this machine has."""
    return EXACT, STEP_BY_STEP, *((COMPILED,) if compiler() else ())


def road(name: str, case: Case, times: Array) -> Callable[[], Motion]:
    """What makes the motion of a case at times (N,), prepared.

    Raises
    ------
    PathError
        There is no program where the path starts; the call, that it is refused on the way.
    """
    if name == COMPILED:
        return partial(CompiledSteps(case.rig, case.reference).motion, times)
    if name == STEP_BY_STEP:
        return partial(interpreted, branch_of(problem_of(case.rig), case.reference), times)
    return partial(solve, case.rig, case.reference, times)
