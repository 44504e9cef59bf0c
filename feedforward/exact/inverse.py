"""Exact feedforward: the inputs and the motion that a reference path implies.

Nothing is integrated.  `structure` says which derivatives of which equations determine the
unknowns, `taylor` solves for them, `branch` picks the solution that continues the rig's home and
refuses what cannot be followed, and this module names the results.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import PathError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..checks import check_times
from ..holds import check_hold, means_of, within_holds
from ..paths.reference import Reference
from ..series.products import factorials
from ..series.rotation import bryant
from .branch import Branch, branch_of
from .equations import Equations, Orientation
from .motion import Motion, find_slack
from .problem import problem_of
from .refusal import accept_path, stay_on_rails
from .state import State
from .taylor import Solution


def solve(
    rig: Rig,
    reference: Reference,
    times: ArrayLike,
    *,
    hold: float = 0.0,
    begin: State | None = None,
    verify: bool = True,
) -> Motion:
    """Inputs, coordinates and rope tensions along a reference path, to rounding.

    Parameters
    ----------
    rig
        A flat rig.
    reference
        Path of the rig's outputs; at rest before 0 and after its duration.
    times
        Instants [s], shape (N,) or a number.
    hold
        For a controller that holds each input for so long [s], from its instant on: inputs are
        then their means over the holds (see `flatrig.feedforward.holds`), all else is still of the
        instants.
    begin
        State of the motion that this one continues, as `Motion.at` gives it: the reference starts
        as that one moves, on the same branch of the solutions and with the same turns of its
        frames.  Without it the rig comes from its home and the reference starts in rest.
    verify
        Whether the derivatives of a reference that is not the package's own are compared with one
        another, once for each reference.  False takes its word, as for one that knows a single
        instant and answers with its derivatives whatever the time.

    Returns
    -------
    Motion
        The motion at these instants.  Ropes that would have to push are reported in its
        `slack`, not refused.

    Raises
    ------
    RigError
        The rig is not flat, or `begin` is a state of another one.
    OptionError
        The hold is not a finite number >= 0.
    SmoothnessError
        The reference has fewer continuous derivatives than the rig needs.
    PathError
        The path leaves the workspace or passes a singular place, and the message
        says where and when, and which ropes go slack there; or the approach from the rig's home to
        the start of the path is lost; or it has another number of columns than the rig outputs; or
        its derivatives contradict one another; or a time is not a finite number; or the reference
        starts moving without `begin`, or otherwise than that, or a time is before it.

    A pulley without mass hangs where all its ropes pull; where they do at no place, as on the wrong
    side of its winches, it continues the rig's home, with ropes that would have to push.  It
    may hang straight below its winch at the start of a path or at its end (Y 6.1.1), where its
    place is undetermined: it is then the limit of the motion, good to about 1e-7 m within the first
    thousandth of the duration, and its acceleration there to a tenth.

    Source: flatness of the cranes, Y 4.105 to 4.122 and K theorem 3; the method is Taylor
    expansion of the differentiated equations, as in Pryce (BIT 41, 2001).
    """
    instants = check_times(times)
    if not np.isfinite(instants).all():
        i = int(np.flatnonzero(~np.isfinite(instants))[0])
        raise PathError(f"time {i} is {instants[i]}, it must be finite")
    hold, problem = check_hold(hold), problem_of(rig)
    accept_path(reference)
    if begin is not None:
        for i in np.flatnonzero(instants < 0.0)[:1]:
            raise PathError(
                f"time {i} is {instants[i]:g} s, before 0 s, when the reference continues `begin`"
            )
    branch = branch_of(problem, reference, verify, begin)
    taylor, solution = branch.expanded(instants)
    motion = _motion(branch, solution, instants, taylor)
    stay_on_rails(rig, motion.coordinate_names, motion.positions.T, instants)
    if hold:
        within = within_holds(instants, hold)
        exact = solve(rig, reference, within, begin=begin, verify=verify).inputs
        motion = replace(motion, inputs=means_of(exact), hold=hold)
    return motion


def _motion(branch: Branch, solution: Solution, times: Array, taylor: Array) -> Motion:
    """Name the results."""
    rig, equations = branch.problem.rig, branch.problem.equations
    n, m = len(equations.names), len(equations.constraint_names)
    state = np.array([[w[0], w[1], 2.0 * w[2]] for w in solution.series[:n]])
    values = np.array([w[0] for w in solution.series[n:]]).T
    platforms: dict[str, Array] = {}
    for orientation in equations.orientations:
        if orientation.angles[0] in rig.outputs:  # exactly as prescribed
            for name in orientation.angles:
                prescribed = taylor[:3, :, rig.outputs.index(name)]
                platforms[name] = prescribed * factorials(3)[:, None]
        else:
            platforms |= bryant_angles(orientation, state)
    angles = branch.turned(times)
    motion = named_motion(equations, times, state, angles, platforms, values[:, :m], values[:, m:])
    return replace(motion, branch=branch)


def named_motion(
    equations: Equations,
    times: Array,
    state: Array,
    angles: dict[str, Array],
    platforms: dict[str, Array],
    multipliers: Array,
    inputs: Array,
) -> Motion:
    """The motion with the coordinates of the rig's parts in place of cosines and directors.

    Parameters
    ----------
    equations
        Of the rig, with n coordinates.
    times
        Instants [s], shape (N,).
    state
        Their coordinates with two derivatives, shape (n, 3, N).
    angles
        For each turning frame its angle to within half a turn, shape (N,).
    platforms
        For each Bryant angle of a platform its values and two derivatives, shape (3, N).
    multipliers
        Of the constraints, shape (N, m).
    inputs
        Shape (N, inputs).
    """
    columns = dict(zip(equations.names, state, strict=True))
    hidden = {i for orientation in equations.orientations for i in orientation.directors}
    for name, cos, sin in equations.turning:
        columns[name] = _turning_angle(state[cos], state[sin], angles[name])
        hidden |= {cos, sin}
    columns |= platforms
    auxiliary = [name for i, name in enumerate(equations.names) if i not in hidden]
    names = tuple(dict.fromkeys((*equations.rig.coordinate_names, *auxiliary)))
    kinematics = np.array([columns[name] for name in names]).transpose(1, 2, 0)
    tensions = equations.tensions(state[:, 0].T, multipliers)
    return Motion(
        rig=equations.rig,
        times=times,
        coordinate_names=names,
        positions=kinematics[0],
        velocities=kinematics[1],
        accelerations=kinematics[2],
        inputs=inputs,
        tensions=tensions,
        multipliers=multipliers,
        slack=find_slack(equations.rig, times, tensions),
    )


def bryant_angles(orientation: Orientation, state: Array) -> dict[str, Array]:
    """A platform's Bryant angles with two derivatives, (3, N) each, from a state (n, 3, N)."""
    scale = factorials(3)[:, None]
    directors = state[list(orientation.directors)].reshape(3, 3, *state.shape[1:])
    rotation = np.moveaxis(directors, (2, 3), (0, 1)).swapaxes(-1, -2)
    series = bryant(rotation / scale[..., None, None])
    return {name: series[..., i] * scale for i, name in enumerate(orientation.angles)}


def _turning_angle(cos: Array, sin: Array, near: Array) -> Array:
    """An angle and its two derivatives, (3, N), from those of its cosine and sine."""
    principal = np.arctan2(sin[0], cos[0])
    turns = np.round((near - principal) / (2.0 * np.pi))
    rate = cos[0] * sin[1] - sin[0] * cos[1]
    acceleration = cos[0] * sin[2] - sin[0] * cos[2]
    return np.array([principal + 2.0 * np.pi * turns, rate, acceleration])
