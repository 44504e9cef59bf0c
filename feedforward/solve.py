"""Exact feedforward: the inputs and the motion that a reference path implies.

Nothing is integrated.  `structure` says which derivatives of which equations determine the
unknowns, `taylor` solves for them, and this module starts on the right branch, refuses what
cannot be followed, and names the results.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..models.errors import PathError, RigError, SmoothnessError
from ..models.rig import Rig
from .assembly import equations_of
from .equations import Equations, redundant
from .motion import Motion, find_slack
from .reference import Reference
from .steps import Step, plan
from .structure import Analysis, analyse
from .taylor import Solution, expand

Array = NDArray[np.float64]

PATH_SAMPLES = 129
"""Samples along the path on which the branch of the solution is followed."""
HOME_SAMPLES = 17
"""Samples of the quasi-static move from the rig's home to the start of the path."""
RAIL_TOLERANCE = 1e-9
"""How far past the end of a rail a trolley may be through rounding [m]."""


def solve(rig: Rig, reference: Reference, times: ArrayLike) -> Motion:
    """Inputs, coordinates and rope tensions along a reference path, to rounding.

    Args:
        rig: a flat rig.
        reference: path of the rig's outputs; at rest before 0 and after its duration.
        times: instants [s], shape (N,) or a number.

    Returns:
        The motion at these instants.  Ropes that would have to push are reported in its
        `slack`, not refused.

    Raises:
        RigError: the rig is not flat.
        SmoothnessError: the reference has fewer continuous derivatives than the rig needs.
        PathError: the path leaves the workspace or passes a singular place; the message says
            where and when.

    Source: flatness of the cranes, Y 4.105 to 4.122 and K theorem 3; the method is Taylor
    expansion of the differentiated equations, as in Pryce (BIT 41, 2001).
    """
    instants = np.atleast_1d(np.asarray(times, dtype=float))
    if instants.ndim != 1 or not np.isfinite(instants).all():
        raise PathError(f"times must be finite numbers of shape (N,), got shape {instants.shape}")
    branch = _branch(rig, reference)
    taylor = _taylor(reference, instants, branch.order)
    guess = branch.near(instants)
    solution = expand(branch.steps, len(guess), taylor, guess, follow=False)
    _refuse(rig, reference, branch.analysis, solution, branch.signs, instants)
    motion = _motion(rig, equations_of(rig), solution, instants, branch)
    _stay_on_rails(rig, motion.coordinate_names, motion.positions.T, instants)
    return motion


@dataclass(frozen=True, eq=False)
class _Branch:
    """The solution on a coarse grid along the whole path."""

    analysis: Analysis
    steps: tuple[Step, ...]
    order: int
    """Derivatives of the reference that are used."""
    times: Array
    values: Array
    """Unknowns, shape (unknowns, samples)."""
    rates: Array
    """Their first derivatives; finite differences where the expansion has none."""
    signs: dict[int, float]
    """Sign of each block's determinant on this branch."""
    angles: dict[str, Array]
    """Continuous angles of the turning frames, shape (samples,)."""

    def near(self, times: Array) -> Array:
        """The unknowns between the grid's samples, shape (unknowns, N)."""
        step = self.times[1]
        place = np.clip(times / step, 0.0, len(self.times) - 1.0)
        below = np.minimum(place.astype(int), len(self.times) - 2)
        share = place - below
        left, right = self.values[:, below], self.values[:, below + 1]
        # Cubic Hermite interpolation, as the chord and what the end slopes add to it.
        drop = left - right
        bend = share * (1.0 - share)
        start = step * self.rates[:, below] + drop
        end = step * self.rates[:, below + 1] + drop
        return np.asarray(left - share * drop + bend * ((1.0 - share) * start - share * end))


@lru_cache(maxsize=512)
def _branch(rig: Rig, reference: Reference) -> _Branch:
    """Follow the solution from the rig's home to the start of the path and along it."""
    analysis = analyse(rig)
    _accept(rig, reference, analysis)
    equations = equations_of(rig)
    steps = _plan(analysis)
    order = max(analysis.reference_order, 2)
    grid = np.linspace(0.0, reference.duration, PATH_SAMPLES)
    home = _home(rig, equations)
    outputs = list(equations.outputs)
    approach = np.linspace(home[outputs], reference.start, HOME_SAMPLES)
    along = _taylor(reference, grid, order)
    taylor = np.zeros((order + 1, HOME_SAMPLES + len(grid), reference.size))
    taylor[0, :HOME_SAMPLES] = approach
    taylor[:, HOME_SAMPLES:] = along
    solution = expand(steps, len(home), taylor, home[:, None], follow=True)
    signs = {block: float(sign[0]) for block, sign in solution.signs.items()}
    times = np.concatenate((np.zeros(HOME_SAMPLES), grid))
    _refuse(rig, reference, analysis, solution, signs, times, HOME_SAMPLES)
    values = np.array([coefficients[0] for coefficients in solution.series])
    path = values[:, HOME_SAMPLES:]
    _stay_on_rails(rig, equations.names, path, grid)
    rates = np.gradient(path, grid[1], axis=1)
    for j, coefficients in enumerate(solution.series):
        if len(coefficients) > 1:
            rates[j] = coefficients[1][HOME_SAMPLES:]
    angles = {
        name: np.unwrap(np.arctan2(values[sin], values[cos]))[HOME_SAMPLES:]
        for name, cos, sin in equations.turning
    }
    return _Branch(analysis, steps, order, grid, path, rates, signs, angles)


@lru_cache(maxsize=256)
def _plan(analysis: Analysis) -> tuple[Step, ...]:
    return plan(analysis)


def _accept(rig: Rig, reference: Reference, analysis: Analysis) -> None:
    """Refuse a rig that is not flat and a reference of the wrong kind."""
    if not analysis.flat:
        raise RigError(
            f"rig {rig.name} is not flat: its outputs leave {analysis.degrees_of_freedom} "
            "degrees of freedom undetermined"
        )
    if reference.size != len(rig.outputs):
        raise PathError(
            f"the reference has {reference.size} columns, rig {rig.name} needs "
            f"{len(rig.outputs)}: {', '.join(rig.outputs)}"
        )
    if reference.order < analysis.reference_order:
        raise SmoothnessError(
            f"the reference has {reference.order} continuous derivatives, rig {rig.name} "
            f"needs {analysis.reference_order}"
        )


def _taylor(reference: Reference, times: Array, order: int) -> Array:
    """Taylor coefficients of a reference, shape (order + 1, N, outputs)."""
    factorials = [math.factorial(k) for k in range(order + 1)]
    derivatives = reference.derivatives(times, order)
    return np.asarray(derivatives / np.array(factorials, dtype=float)[:, None, None])


def _home(rig: Rig, equations: Equations) -> Array:
    """All unknowns at rest at the rig's home, those of statics in the sense of least squares."""
    values = {}
    for frame in rig.frames:
        values[frame.coordinate] = np.array(rig.home_of(frame))
    for mass in rig.masses:
        place = np.array(rig.home_of(mass), dtype=float)
        if place.ndim == 0:
            values[f"{mass.name}.position"] = place
        else:
            values |= {f"{mass.name}.{axis}": place["xyz".index(axis)] for axis in rig.axes}
    state, _ = redundant(equations, values, dict.fromkeys(values, np.zeros(())))
    pull = np.hstack((equations.constraint_jacobian(state).T, -equations.input_matrix(state)))
    statics = np.linalg.lstsq(pull, equations.force, rcond=None)[0]
    return np.concatenate((state, statics))


def _refuse(
    rig: Rig,
    reference: Reference,
    analysis: Analysis,
    solution: Solution,
    signs: dict[int, float],
    times: Array,
    approach: int = 0,
) -> None:
    """Raise at the first sample that has no solution or lies beyond a singular place."""
    wrong = ~solution.solved
    for block, sign in solution.signs.items():
        wrong |= (sign != signs[block]) | (signs[block] == 0)
    if not wrong.any():
        return
    order = np.argsort(times, kind="stable")
    first = int(order[wrong[order].argmax()])
    guilty = [
        block
        for block, (_, unknowns) in enumerate(analysis.blocks)
        if solution.signs[block][first] != signs[block]
        or signs[block] == 0
        or not all(np.isfinite(solution.series[j][0][first]) for j in unknowns)
    ]
    lost = " and ".join(analysis.unknowns[j] for j in analysis.blocks[guilty[0]][1])
    place = ", ".join(
        f"{name} = {value:.4g}"
        for name, value in zip(rig.outputs, reference(times[first : first + 1])[0], strict=True)
    )
    when = "on the way from its home to the start" if first < approach else ""
    raise PathError(
        f"rig {rig.name} cannot follow the path {when or f'at t = {times[first]:.4g} s'} "
        f"({place}): {lost} has no value there that continues the motion"
    )


def _motion(
    rig: Rig, equations: Equations, solution: Solution, times: Array, branch: _Branch
) -> Motion:
    """Name the results."""
    n, m = len(equations.names), len(equations.constraint_names)
    series = solution.series
    state = np.array([[w[0], w[1], 2.0 * w[2]] for w in series[:n]])
    values = np.array([w[0] for w in series[n:]]).T
    columns = {name: state[i] for i, name in enumerate(equations.names)}
    at = np.clip(times, 0.0, branch.times[-1])
    for name, cos, sin in equations.turning:
        near = np.interp(at, branch.times, branch.angles[name])
        columns[name] = _angle(state[cos], state[sin], near)
    directors = {i for _, *pair in equations.turning for i in pair}
    auxiliary = [name for i, name in enumerate(equations.names) if i not in directors]
    names = tuple(dict.fromkeys((*rig.coordinate_names, *auxiliary)))
    positions, velocities, accelerations = np.array([columns[name] for name in names]).transpose(
        1, 2, 0
    )
    ones = np.ones(len(times))
    tensions = np.array(
        [
            values[:, spans[-1]] * (lengths[-1] @ np.vstack((state[:, 0], ones)))
            for spans, lengths in zip(equations.spans, equations.span_lengths, strict=True)
        ]
    ).reshape(len(rig.ropes), len(times))
    return Motion(
        rig=rig,
        times=times,
        coordinate_names=names,
        positions=positions,
        velocities=velocities,
        accelerations=accelerations,
        inputs=values[:, m:],
        tensions=tensions.T,
        multipliers=values[:, :m],
        slack=find_slack(rig, times, tensions.T),
    )


def _angle(cos: Array, sin: Array, near: Array) -> Array:
    """An angle and its two derivatives, (3, N), from those of its cosine and sine."""
    principal = np.arctan2(sin[0], cos[0])
    turns = np.round((near - principal) / (2.0 * np.pi))
    rate = cos[0] * sin[1] - sin[0] * cos[1]
    acceleration = cos[0] * sin[2] - sin[0] * cos[2]
    return np.array([principal + 2.0 * np.pi * turns, rate, acceleration])


def _stay_on_rails(rig: Rig, names: tuple[str, ...], positions: Array, times: Array) -> None:
    """Refuse a motion (coordinates, N) in which a trolley leaves its rail."""
    for trolley in rig.trolleys:
        rail = rig.rail(trolley.rail)
        place = positions[names.index(trolley.coordinate)]
        beyond = np.maximum(rail.start - place, place - rail.end) > RAIL_TOLERANCE
        if beyond.any():
            i = int(beyond.argmax())
            raise PathError(
                f"rig {rig.name} cannot follow the path at t = {times[i]:.4g} s: "
                f"{trolley.name} is at {place[i]:.4g} m, rail {rail.name} goes from "
                f"{rail.start:g} m to {rail.end:g} m"
            )
