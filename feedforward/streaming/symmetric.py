"""Which outputs of a rig with held freedoms an operator can move.

A freedom that symmetry holds at rest (`Rig.held`) would leave it if the others moved out of that
symmetry, as the sideways place of a spreader does that is turned about the vertical on its way.
"""

from functools import lru_cache

import numpy as np

from ..exact.held_freedoms import largest_at_rest, residuals_of_held
from ..exact.home import home_outputs, home_unknowns
from ..exact.problem import Problem
from ..exact.taylor import expand

TRIALS, TRIED = 8, 0.05
"""Random motions with which outputs are tried, and their derivatives over the outputs' size."""


@lru_cache(maxsize=64)
def free_outputs(problem: Problem) -> tuple[bool, ...]:
    """Which outputs can move, in any way, while what is held stays at rest.

    Found by trial, output by output: with those before it, each moves at random about home.
    """
    rig, outputs = problem.rig, home_outputs(problem.equations)
    free = np.ones(len(outputs), dtype=bool)
    if not rig.held:
        return tuple(free.tolist())
    size = max(1.0, float(np.abs(outputs).max()))
    scale = np.array([1.0 if name in rig.angles else size for name in rig.outputs])
    shape = (problem.order + 1, TRIALS, len(outputs))
    moved = TRIED * scale * np.random.default_rng(0).uniform(-1.0, 1.0, shape)
    for column in range(len(outputs)):
        still = free.copy()
        still[column + 1 :] = False
        taylor = np.where(still, moved, 0.0)
        taylor[0] += outputs
        solution = expand(problem, taylor, home_unknowns(problem.equations), follow=False)
        forces = np.abs(residuals_of_held(problem, solution))[:, solution.solved]
        free[column] = bool((forces <= largest_at_rest(rig)).all())
    return tuple(free.tolist())
