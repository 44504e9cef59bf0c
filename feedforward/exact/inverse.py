"""Exact feedforward: the inputs and the motion that a reference path implies.

Nothing is integrated.  `structure` says which derivatives of which equations determine the
unknowns, `taylor` solves for them, `branch` picks the solution that continues the rig's home and
refuses what cannot be followed, and this module names the results.
"""

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import PathError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..checks import check_times
from ..paths.reference import Reference, taylor_of
from ..series.rotation import bryant
from .branch import Branch, branch_of
from .equations import Equations
from .motion import Motion, find_slack
from .problem import problem_of
from .refusal import failure, stay_on_rails
from .taylor import Solution, expand


def solve(rig: Rig, reference: Reference, times: ArrayLike) -> Motion:
    """Inputs, coordinates and rope tensions along a reference path, to rounding.

    Parameters
    ----------
    rig
        A flat rig.
    reference
        Path of the rig's outputs; at rest before 0 and after its duration.
    times
        Instants [s], shape (N,) or a number.

    Returns
    -------
    Motion
        The motion at these instants.  Ropes that would have to push are reported in its
        `slack`, not refused.

    Raises
    ------
    RigError
        The rig is not flat.
    SmoothnessError
        The reference has fewer continuous derivatives than the rig needs.
    PathError
        The path leaves the workspace or passes a singular place, and the message
        says where and when; or it has another number of columns than the rig outputs; or
        a time is not a finite number.

    A pulley without mass may hang straight below its winch at the start of a path or at its end
    (Y 6.1.1), where its place is undetermined: it is then the limit of the motion, good to about
    1e-7 m within the first thousandth of the duration, and its acceleration there to a tenth.

    Source: flatness of the cranes, Y 4.105 to 4.122 and K theorem 3; the method is Taylor
    expansion of the differentiated equations, as in Pryce (BIT 41, 2001).
    """
    instants = check_times(times if np.ndim(times) else [times])
    if not np.isfinite(instants).all():
        i = int(np.flatnonzero(~np.isfinite(instants))[0])
        raise PathError(f"time {i} is {instants[i]}, it must be finite")
    problem = problem_of(rig)
    branch = branch_of(problem, reference)
    taylor = taylor_of(reference, instants, problem.order)
    guess = branch.near(instants)
    solution = expand(problem, taylor, guess, follow=False, sides=branch.signs)
    error = failure(problem, solution, branch.signs, instants, taylor[0])
    if error is not None:
        raise error
    motion = _motion(branch, solution, instants, taylor)
    stay_on_rails(rig, motion.coordinate_names, motion.positions.T, instants)
    return motion


def _motion(branch: Branch, solution: Solution, times: Array, taylor: Array) -> Motion:
    """Name the results."""
    rig, equations = branch.problem.rig, branch.problem.equations
    n, m = len(equations.names), len(equations.constraint_names)
    series = solution.series
    state = np.array([[w[0], w[1], 2.0 * w[2]] for w in series[:n]])
    values = np.array([w[0] for w in series[n:]]).T
    columns = {name: state[i] for i, name in enumerate(equations.names)}
    at = np.clip(times, 0.0, branch.times[-1])
    for name, cos, sin in equations.turning:
        near = np.interp(at, branch.times, branch.angles[name])
        columns[name] = turning_angle(state[cos], state[sin], near)
    columns |= _bryant_angles(equations, state, taylor)
    directors = {i for _, *pair in equations.turning for i in pair}
    directors |= {i for orientation in equations.orientations for i in orientation.directors}
    auxiliary = [name for i, name in enumerate(equations.names) if i not in directors]
    names = tuple(dict.fromkeys((*rig.coordinate_names, *auxiliary)))
    positions, velocities, accelerations = np.array([columns[name] for name in names]).transpose(
        1, 2, 0
    )
    tensions = equations.tensions(state[:, 0].T, values[:, :m])
    return Motion(
        rig=rig,
        times=times,
        coordinate_names=names,
        positions=positions,
        velocities=velocities,
        accelerations=accelerations,
        inputs=values[:, m:],
        tensions=tensions,
        multipliers=values[:, :m],
        slack=find_slack(rig, times, tensions),
    )


def _bryant_angles(equations: Equations, state: Array, taylor: Array) -> dict[str, Array]:
    """Bryant angles of the platforms with two derivatives, (3, N) each: as prescribed, or else
    from the directors.
    """
    rig = equations.rig
    factorials = np.array([1.0, 1.0, 2.0])[:, None]
    angles = {}
    for orientation in equations.orientations:
        if orientation.angles[0] in rig.outputs:
            for name in orientation.angles:
                angles[name] = taylor[:3, :, rig.outputs.index(name)] * factorials
            continue
        directors = state[list(orientation.directors)].reshape(3, 3, *state.shape[1:])
        series = bryant(
            np.moveaxis(directors, (2, 3), (0, 1)).swapaxes(-1, -2) / factorials[..., None, None]
        )
        angles |= {name: series[..., i] * factorials for i, name in enumerate(orientation.angles)}
    return angles


def turning_angle(cos: Array, sin: Array, near: Array) -> Array:
    """An angle and its two derivatives, (3, N), from those of its cosine and sine."""
    principal = np.arctan2(sin[0], cos[0])
    turns = np.round((near - principal) / (2.0 * np.pi))
    rate = cos[0] * sin[1] - sin[0] * cos[1]
    acceleration = cos[0] * sin[2] - sin[0] * cos[2]
    return np.array([principal + 2.0 * np.pi * turns, rate, acceleration])
