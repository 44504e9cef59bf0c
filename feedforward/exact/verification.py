"""How well a motion satisfies a rig's equations, computed from its named results alone."""

from collections.abc import Sequence

import numpy as np

from ...models.errors import OptionError
from ...models.types import Array
from ..paths.reference import Reference
from ..series.rotation import matrix
from .equations import Equations
from .losses import losses_of
from .motion import Motion
from .problem import Problem, problem_of
from .refusal import accept_columns
from .structure import Row


def residuals(motion: Motion, reference: Reference) -> Array:
    """Residual of every equation at every sample, relative to the size of its terms.

    That size is the largest sum of the terms' magnitudes along the motion; an equation all of
    whose terms vanish is measured by a millionth of the largest size among its kind.
    Equations of motion, constraints and servo constraints stand in the order of
    `analyse(rig).rows`.  Shape (N, equations).

    Raises
    ------
    OptionError
        The motion's inputs are for a controller that holds them, not of its instants.
    PathError
        The reference is no path of the rig's outputs.
    """
    accept_columns(motion.rig, reference)
    if motion.hold:
        raise OptionError(
            f"the inputs are means over holds of {motion.hold:g} s, which satisfy no equation of "
            "an instant; solve without hold"
        )
    problem = problem_of(motion.rig)
    rows = problem.analysis.rows
    if not len(motion.times):
        return np.zeros((0, len(rows)))
    values, rates, seconds = _unknowns(problem, motion)
    values += _closest(rows, values, len(problem.analysis.unknowns) - len(values))
    path = problem.servo.prescribe(reference(motion.times)[None])[0]
    wrong, sizes = [], []
    for row in rows:
        terms = [np.full(len(path), row.constant)]
        terms += [a * values[j] for a, j in row.linear]
        terms += [a * rates[j] for a, j in row.first]
        terms += [a * seconds[j] for a, j in row.second]
        terms += [a * values[j] * values[k] for a, j, k in row.quadratic]
        if row.output is not None:
            terms.append(-path[:, row.output])
        wrong.append(np.abs(np.sum(terms, axis=0)))
        sizes.append(np.sum(np.abs(terms), axis=0).max())
    kinds = np.array([row.kind for row in rows])
    floors = {kind: 1e-6 * np.max(sizes, where=kinds == kind, initial=0.0) for kind in kinds}
    scales = [max(size, floors[kind]) for size, kind in zip(sizes, kinds, strict=True)]
    return np.asarray(np.array(wrong).T / scales)


def _closest(rows: Sequence[Row], values: Sequence[Array], count: int) -> list[Array]:
    """The unknowns y that satisfy the rules best in the sense of least squares, (N,) each.

    Parameters
    ----------
    rows
        All equations, as `structure` has them.
    values
        The unknowns before y, (N,) each.
    count
        How many y there are.
    """
    own = [row for row in rows if row.kind == "distribution"]
    if not own:
        return []
    first, samples = len(values), len(values[0])
    matrix, right = np.zeros((samples, len(own), count)), np.zeros((samples, len(own)))
    for i, row in enumerate(own):
        right[:, i] -= row.constant
        for a, j in row.linear:
            if j < first:
                right[:, i] -= a * values[j]
            else:
                matrix[:, i, j - first] += a
        for a, y, j in row.quadratic:
            matrix[:, i, y - first] += a * values[j]
    found = np.linalg.pinv(matrix) @ right[..., None]
    return [*found[..., 0].T]


def _unknowns(problem: Problem, motion: Motion) -> tuple[list[Array], list[Array], list[Array]]:
    """Coordinates, multipliers and inputs, and the coordinates' first two derivatives."""
    equations = problem.equations
    table: dict[str, tuple[Array, Array, Array]] = {}
    for i, name in enumerate(motion.coordinate_names):
        kinematics = motion.positions, motion.velocities, motion.accelerations
        table[name] = kinematics[0][:, i], kinematics[1][:, i], kinematics[2][:, i]
    for name, cos, sin in equations.turning:
        angle, rate, turn = table[name]
        c, s = np.cos(angle), np.sin(angle)
        table[equations.names[cos]] = c, -s * rate, -s * turn - c * rate**2
        table[equations.names[sin]] = s, c * rate, c * turn - s * rate**2
    for orientation in equations.orientations:
        columns = [motion.column(name) for name in orientation.angles]
        angles = np.array([motion.positions, motion.velocities, 0.5 * motion.accelerations])
        rotation = matrix(angles[..., columns]).swapaxes(-1, -2).reshape(3, -1, 9)
        for i, index in enumerate(orientation.directors):
            name = equations.names[index]
            table[name] = rotation[0, :, i], rotation[1, :, i], 2.0 * rotation[2, :, i]
    for k in equations.with_role("frame"):
        _follow(equations, table, k)
    names = problem.analysis.unknowns
    inputs, losses = motion.inputs, losses_of(motion.rig)
    if losses is not None:
        inputs = losses.delivered(inputs, motion.drive_velocities)
    forces = np.hstack((motion.multipliers, inputs)).T
    values, rates, seconds = zip(
        *(table[name] for name in names[: len(equations.names)]), strict=True
    )
    return [*values, *forces], [*rates], [*seconds]


def _follow(equations: Equations, table: dict[str, tuple[Array, Array, Array]], k: int) -> None:
    """Add the coordinate that follows from a constraint in which it stands alone, with slope 1."""
    own = equations.roles[k].coordinate
    assert own is not None
    none = 0.0 * next(iter(table.values()))[0]
    still = (none, none, none)
    q, v, a = np.array([table.get(name, still) for name in equations.names]).transpose(1, 2, 0)
    slope = equations.constraint_jacobian(q)[:, k]
    value = -equations.constraint_values(q)[:, k]
    rate = -np.einsum("ni,ni->n", slope, v)
    curved = equations.constraint_curvature(v)[:, k]
    second = -np.einsum("ni,ni->n", slope, a) - curved
    table[equations.names[own]] = value, rate, second
