"""Consistent starting values: the equations at rest, solved by Newton's method, or a moving base.

A path starts from rest, so before its start everything rests too: z solves F(z, 0, 0) = 0 with all
dummies zero, and every past state that a multistep formula asks for is this one, exactly.  Which of
the solutions it is (the load below the trolley, not above) the rig's home says; the exact solver's
rest there is the first guess and nothing more.

Where a base moves as given nothing rests: it moved before the start, too, and the start and the
past that a multistep formula asks for are those of the exact motion.
"""

import numpy as np

from ...models.errors import PathError
from ...models.types import Array
from ..exact.branch import branch_of
from ..exact.naming import motion_of
from ..exact.problem import Problem
from ..paths.reference import Reference
from ..paths.straight import hold
from ..paths.waves import base_at
from ..series.products import factorials
from ..series.rotation import bryant
from .direct import Direct
from .formulation import Formulation, Instant, prescribed
from .schemes import State

ITERATIONS = 20
"""Newton steps allowed; the guess is exact but for a pulley that chooses its own place."""
BALANCED = 1e-11
"""Largest residual of a start, over the size of the terms in its equation, or over a thousandth of
the largest equation's where an equation has hardly any."""


def at_rest(equations: Formulation, reference: Reference) -> Array:
    """The unknowns of a formulation at the start of a path, shape (N,).

    Raises
    ------
    RigError, PathError
        As `feedforward.solve` for the rig at rest at the start.
    """
    direct = Direct(equations.mechanics)
    z = _guess(direct, reference)
    still = np.zeros(len(z))
    target = prescribed(direct.mechanics.coordinates, reference, [0.0], 0)[:, 0]
    for _ in range(ITERATIONS):
        residual, jacobian = direct.evaluate(target, z, still, still, True)
        assert jacobian is not None
        size = np.abs(jacobian[0]) @ np.abs(z)
        if (np.abs(residual) <= BALANCED * np.maximum(size, size.max() * 1e-3)).all():
            break
        # Least squares: a pulley without mass may start at a place of its own choice.
        z = z - np.linalg.lstsq(jacobian[0], residual, rcond=None)[0]
    else:
        rig = direct.mechanics.coordinates.problem.rig
        raise PathError(f"rig {rig.name} has no equilibrium at the start of the path")
    return np.concatenate((z, np.zeros(len(equations.names) - len(z))))


def states_before(
    equations: Formulation, reference: Reference, h: float, count: int
) -> list[State]:
    """The last states up to the start of a path on a moving base, at steps of h [s].

    Raises
    ------
    RigError, PathError
        As `feedforward.solve` there, or a recording has no such past.
    """
    back, base = (count - 1) * h, base_at(reference, 0.0)
    if base is not None and any(record.start + base.since < back for record in base.records):
        raise PathError(
            f"a record must start {back:g} s or later after its first sample: the scheme looks back"
        )
    coordinates = equations.mechanics.coordinates
    problem, e = coordinates.problem, coordinates.equations
    branch = branch_of(problem, reference)
    times = h * np.arange(1.0 - count, 1.0)
    taylor, solution = branch.expanded(times)
    motion = motion_of(problem, solution, times, taylor, branch.turned(times))
    series = [
        np.asarray(factorials(len(parts))[:, None] * np.array(parts, float))
        for parts in solution.series
    ]
    n, m = len(e.names), len(e.constraint_names)

    def known(name: str) -> Array:
        if name in e.names:
            return np.array(series[e.names.index(name)][:3])
        column = motion.column(name)
        parts = motion.positions, motion.velocities, motion.accelerations
        return np.array([part[:, column] for part in parts])

    paths = np.array([known(name) for name in coordinates.names])
    values = np.array([parts[0] for parts in series[n:]])
    last = m + len(problem.rig.drives)
    states = []
    for i in range(count):
        place, rate, acceleration = paths[:, :, i].T
        derivatives = tuple(parts[:, i] for parts in series)
        multipliers, inputs = values[:m, i], values[m:last, i]
        instant = Instant(place, rate, acceleration, multipliers, inputs, derivatives)
        states.append(State(*equations.moving(instant)))
    return states


def start_angles(problem: Problem, reference: Reference) -> dict[str, float]:
    """Angles of the turning frames at the start of a path [rad], full turns counted."""
    branch = branch_of(problem, hold(reference.start))
    return {name: float(angles[0]) for name, angles in branch.angles.items()}


def _guess(direct: Direct, reference: Reference) -> Array:
    """Coordinates, multipliers and inputs of the exact rest."""
    coordinates = direct.mechanics.coordinates
    e = coordinates.equations
    branch = branch_of(coordinates.problem, hold(reference.start))
    n, m = len(e.names), len(e.constraint_names)
    q, multipliers, inputs = np.split(branch.values[:, 0], [n, n + m])
    values = dict(zip(e.names, q, strict=True))
    values |= start_angles(coordinates.problem, reference)
    for orientation in e.orientations:
        rotation = q[list(orientation.directors)].reshape(3, 3).T
        values |= dict(zip(orientation.angles, bryant(rotation[None])[0], strict=True))
    x = [values[name] for name in coordinates.names]
    return np.concatenate((x, multipliers[list(coordinates.multipliers)], inputs))
