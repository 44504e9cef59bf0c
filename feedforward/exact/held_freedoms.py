"""Freedoms that symmetry holds at rest: whether it does, and which might be meant.

`Rig.held` leaves a coordinate and its equation of motion out.  The equation still has to hold: its
residual is the force that would be needed to keep the freedom where it is.
"""

from dataclasses import replace

import numpy as np

from ...models.errors import PathError, RigError
from ...models.types import Array
from .equations import Equations
from .problem import Problem, kept_problem
from .taylor import Solution

AT_REST = 1e-8
"""Largest residual of a held equation over the rig's weight, far above rounding (1e-14)."""


def residuals_of_held(problem: Problem, solution: Solution) -> Array:
    """Forces [N] that would have to keep held freedoms at rest, shape (held, N)."""
    own, rig = problem.equations, problem.rig
    free = _let_go(own)
    n, m = len(own.names), len(own.constraint_names)
    values = solution.values
    samples = values.shape[1]
    home = rig.home_coordinates
    state, second = np.zeros((2, len(free.names), samples))
    for i, name in enumerate(free.names):
        if name in rig.held:
            state[i] = home[name]
            continue
        j = own.names.index(name)
        state[i] = values[j]
        series = solution.series[j]
        second[i] = 2.0 * series[2] if len(series) > 2 else 0.0
    rows = [free.names.index(name) for name in rig.held]
    pulls = free.constraint_jacobian(state.T)[:, :, rows]
    drives = free.input_matrix(state.T)[:, rows]
    forces = free.mass[rows] @ second - free.force[rows][:, None]
    forces += np.einsum("tkr,kt->rt", pulls, values[n : n + m])
    forces -= np.einsum("tra,at->rt", drives, values[n + m : n + m + len(rig.drives)])
    return np.asarray(forces)


def _let_go(equations: Equations) -> Equations:
    return kept_problem(replace(equations.rig, held=())).equations


def stay_held(problem: Problem, solution: Solution, times: Array) -> None:
    """Refuse a motion at times (N,) in which something held would not stay at rest.

    Raises
    ------
    PathError
        It would not.
    """
    rig = problem.rig
    if not rig.held:
        return
    forces = np.abs(residuals_of_held(problem, solution))
    row, sample = np.unravel_index(int(forces.argmax()), forces.shape)
    if not forces[row, sample] <= AT_REST * rig.weight:
        raise PathError(
            f"rig {rig.name}: {rig.held[row]} is held, but at t = {times[sample]:.4g} s it would "
            f"take {forces[row, sample]:.4g} N to keep it at rest; rig and path have to be "
            "symmetric about it"
        )


def what_is_missing(problem: Problem) -> str:
    """What might make a rig flat that is not: a link, or a freedom that is held."""
    rig = problem.rig
    driven = [drive.on for drive in rig.drives]
    loose = [rope.name for rope in rig.ropes if rope.name not in driven]
    if loose:
        return (
            f"; rope {loose[0]} has no drive, so that its winch turns freely: if its length is to "
            "stay, it is a link"
        )
    prescribed = {name for output in rig.outputs for _, name in rig.terms(output)}
    for part in rig.hanging:
        for name in (f"{part.name}.{axis}" for axis in rig.axes):
            if name not in prescribed and name not in rig.held:
                try:
                    flat = kept_problem(replace(rig, held=(*rig.held, name))).analysis.flat
                except RigError:
                    continue
                if flat:
                    return f"; if symmetry keeps {name} at rest, say so: held = [{name!r}]"
    return ""
