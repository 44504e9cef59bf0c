"""From a rig's home to the start of a path, in rest: which of its equations' solutions is meant."""

import math
from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from ...models.errors import PathError
from ...models.rig.open_tensions import TENSION
from ...models.rig.rig import Rig
from ...models.types import Array
from .distribution import open_unknowns
from .equations import Equations, redundant
from .problem import Problem
from .refusal import first_wrong, lost, place
from .taylor import Solution, expand

UNBALANCED = 1e-3
"""Force over the rig's weight that shows that a home is not at rest."""
APPROACHES = (17, 65)
"""Samples of the way from home to the start of the path; the finer one where Newton's method loses
its way between two of the coarser."""


@lru_cache(maxsize=512)
def approach(problem: Problem, start: tuple[float, ...]) -> Solution:
    """The solution in rest from home to the start of a path, by the first way that has one.

    Raises
    ------
    PathError
        None has.
    """
    rig = problem.rig
    home = _home(problem.equations)[1]
    outputs = home_outputs(problem.equations)
    reasons = []
    for way in _ways(outputs, _unwound(rig, start)):
        taylor = np.zeros((problem.order + 1, *way.shape))
        taylor[0] = way
        solution = expand(problem, taylor, home[:, None], follow=True)
        signs = {block: float(sign[0]) for block, sign in solution.signs.items()}
        wrong = first_wrong(solution, signs, np.arange(float(len(way))))
        if wrong is None:
            return solution
        reasons.append(f"{place(rig, way[wrong])}: {lost(problem, solution, signs, wrong)}")
    raise PathError(
        f"rig {rig.name}: the approach from its home to the start of the path, in rest, is lost at "
        f"{reasons[0]}{_unrest(problem.equations)}"
    )


def _unrest(equations: Equations) -> str:
    """What at home is not at rest, as the end of a message; nothing if all is."""
    unknowns, loads = _home(equations)[1], {load.name for load in equations.rig.loads}
    n, m, drives = len(equations.names), len(equations.roles), len(equations.rig.drives)
    pull = _pull(equations, unknowns[:n])
    forces = np.abs(equations.force - pull @ unknowns[n : n + m + drives]).tolist()
    pairs = zip(equations.names, forces, strict=True)
    missing = {name: force for name, force in pairs if name.rsplit(".", 1)[0] in loads}
    worst = max(missing, key=lambda name: missing[name], default="")
    if not worst or missing[worst] < UNBALANCED * equations.rig.weight:
        return ""
    return (
        f"; its home is not at rest, where nothing balances {missing[worst]:.4g} N along {worst}: "
        "what hangs on one rope is straight below where that comes from"
    )


def _unwound(rig: Rig, outputs: tuple[float, ...]) -> Array:
    """The same outputs with a platform's angles within half a turn of upright."""
    angles = set(rig.platform_angles)
    pairs = zip(rig.outputs, outputs, strict=True)
    return np.array([math.remainder(x, math.tau) if name in angles else x for name, x in pairs])


def _ways(home: Array, start: Array) -> Iterator[Array]:
    """Ways of the outputs (N, outputs) from home to the start: straight, then around what is not.

    A load behind a tower is reached around it: by a parabola to one side or the other.
    """
    for samples in APPROACHES:
        yield np.linspace(home, start, samples)
    share = np.linspace(0.0, 1.0, APPROACHES[-1])[:, None]
    reach = float(np.linalg.norm(start - home))
    for side in (*np.eye(len(home)), *-np.eye(len(home))):
        yield home + share * (start - home) + 2.0 * reach * share * (1.0 - share) * side


def home_outputs(equations: Equations) -> Array:
    """The outputs of a rig at home, shape (outputs,)."""
    values = _home(equations)[0]
    return np.array([_output(equations.rig, values, name) for name in equations.rig.outputs])


def home_unknowns(equations: Equations) -> Array:
    """All unknowns of a rig at home and at rest, shape (unknowns, 1)."""
    return _home(equations)[1][:, None]


def _home(equations: Equations) -> tuple[dict[str, Array], Array]:
    """The rig's coordinates and tensions at home, and all unknowns there at rest.

    Those of statics are meant in the sense of least squares.
    """
    rig = equations.rig
    values = {name: np.array(value) for name, value in rig.home_coordinates.items()}
    state, _ = redundant(equations, values, dict.fromkeys(values, np.zeros(())))
    values |= {rope.coordinate: state[equations.names.index(rope.coordinate)] for rope in rig.ropes}
    pull = _pull(equations, state)
    statics = np.asarray(np.linalg.lstsq(pull, equations.force, rcond=None)[0])
    tensions = equations.tensions(state[None], statics[None, : len(equations.roles)])[0]
    pairs = zip(rig.tension_names, tensions, strict=True)
    values |= {name + TENSION: np.array(tension) for name, tension in pairs}
    return values, np.concatenate((state, statics, np.zeros(len(open_unknowns(equations)))))


def _pull(equations: Equations, state: Array) -> Array:
    """What unit multipliers and inputs pull at coordinates in a state (n,), (n, m + drives)."""
    forces = equations.constraint_forces(state).T
    return np.hstack((forces, -equations.input_matrix(state)))


def _output(rig: Rig, values: dict[str, Array], name: str) -> float:
    """One of the rig's outputs, a coordinate or a combination of them."""
    return sum(factor * float(values[coordinate]) for factor, coordinate in rig.terms(name))
