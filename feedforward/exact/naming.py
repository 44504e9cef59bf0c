"""From the unknowns of the equations to the coordinates of a rig's parts."""

import numpy as np

from ...models.types import Array
from ..series.products import factorials
from ..series.rotation import bryant
from .equations import Equations, Orientation
from .losses import losses_of
from .motion import Motion, find_slack
from .problem import Problem
from .taylor import Solution


def motion_of(
    problem: Problem, solution: Solution, times: Array, taylor: Array, angles: dict[str, Array]
) -> Motion:
    """The motion that a solution at instants (N,) is; parameters as of `named_motion`."""
    equations = problem.equations
    n, m = len(equations.names), len(equations.constraint_names)
    state = np.array([[w[0], w[1], 2.0 * w[2]] for w in solution.series[:n]])
    values = np.array([w[0] for w in solution.series[n:]]).T
    inputs = values[:, m : m + len(problem.rig.drives)]
    platforms = platform_angles(equations, state, taylor)
    return named_motion(equations, times, state, angles, platforms, values[:, :m], inputs)


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
        Of the equations, without friction of what drives act on and losses of gears, which are
        added here, shape (N, inputs).
    """
    columns = dict(zip(equations.names, state, strict=True))
    for name, cos, sin in equations.turning:
        columns[name] = _turning_angle(state[cos], state[sin], angles[name])
    columns |= platforms | _held(equations, state.shape[1:])
    names, losses = coordinate_names(equations), losses_of(equations.rig)
    kinematics = np.array([columns[name] for name in names]).transpose(1, 2, 0)
    if losses is not None:
        driven = [names.index(name) for name in equations.rig.driven_coordinates]
        inputs = losses.asked(inputs, kinematics[1][:, driven])
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


def _held(equations: Equations, shape: tuple[int, ...]) -> dict[str, Array]:
    """What is held, with two derivatives, at home; `shape` is (3, N)."""
    home, held = equations.rig.home_coordinates, {}
    for name in equations.rig.held:
        held[name] = np.zeros(shape)
        held[name][0] = home[name]
    return held


def coordinate_names(equations: Equations) -> tuple[str, ...]:
    """Of a motion's columns: the rig's coordinates, then auxiliary ones of the equations."""
    auxiliary = [name for i, name in enumerate(equations.names) if i not in equations.hidden]
    return tuple(dict.fromkeys((*equations.rig.coordinate_names, *auxiliary)))


def platform_angles(equations: Equations, state: Array, taylor: Array) -> dict[str, Array]:
    """Bryant angles with two derivatives, (3, N) each: as prescribed, or else from the state.

    A state is (n, 3, N), the reference's Taylor coefficients are (orders, N, outputs).
    """
    outputs = equations.rig.outputs
    platforms: dict[str, Array] = {}
    for orientation in equations.orientations:
        if orientation.angles[0] in outputs:
            for name in orientation.angles:
                prescribed = taylor[:3, :, outputs.index(name)]
                platforms[name] = prescribed * factorials(3)[:, None]
        else:
            platforms |= bryant_angles(orientation, state)
    return platforms


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
