"""On which branch of the solutions a motion lies: followed from the rig's home along the path.

The equations of a rig have several solutions (a trolley on the other half of a turning girder, a
pulley on the other side of its ropes).  The right one continues the rig's home: from there the
outputs are moved to the start of the path in rest, and then along it, on a grid as fine as needed.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...models.errors import PathError, RigError, SmoothnessError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..paths.reference import Reference
from ..paths.turning import FixedAxis
from .assembly import equations_of
from .equations import Equations, redundant
from .refusal import failure, first_wrong, passing, stay_on_rails
from .servo import prescribe
from .steps import Step, plan
from .structure import Analysis, analyse
from .taylor import Solution, expand

GRIDS = (129, 513, 2049)
"""Samples along the path; the next where Newton's method loses its way on one."""
APPROACHES = (17, 65)
"""Samples of the way from home to the start of the path."""
LIMIT_STEPS = 9
"""Steps back to a singular start, each to a quarter of the time before."""
MOSTLY = 0.5
"""Share of a path's samples that may be singular places of a pulley without mass."""


@dataclass(frozen=True, eq=False)
class Branch:
    """The solution on a grid along the whole path."""

    rig: Rig
    analysis: Analysis
    steps: tuple[Step, ...]
    signs: dict[int, float]
    """Sign of each block's determinant on this branch."""
    times: Array
    values: Array
    """Unknowns, shape (unknowns, samples)."""
    rates: Array
    """Their first derivatives; finite differences where the expansion has none."""
    angles: dict[str, Array]
    """Continuous angles of the turning frames, shape (samples,)."""

    @property
    def order(self) -> int:
        """Derivatives of the reference that are used."""
        return _order(self.analysis)

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
def branch_of(rig: Rig, reference: Reference) -> Branch:
    """The branch of a rig along a path; found once for each pair.

    Raises
    ------
    RigError, SmoothnessError, PathError
        As `feedforward.solve`.
    """
    analysis = analyse(rig)
    _accept(rig, reference, analysis)
    equations = equations_of(rig)
    steps = plan(analysis)
    arrived = approach(rig, tuple(np.asarray(reference.start).tolist()))
    signs = {block: float(sign[0]) for block, sign in arrived.signs.items()}
    start = _values(arrived)[:, -1:]
    if any(step.loose for step in steps):
        start = _limit(rig, reference, analysis, steps, start)
    times, solution = _follow(rig, reference, analysis, steps, signs, start)
    path = _values(solution)
    stay_on_rails(rig, equations.names, path, times)
    rates = np.gradient(path, times[1], axis=1)
    for j, coefficients in enumerate(solution.series):
        if len(coefficients) > 1:
            rates[j] = coefficients[1]
    angles = {}
    for name, angle in _angles(equations, path).items():
        turned = _angles(equations, _values(arrived))[name][-1]
        angles[name] = angle + 2.0 * np.pi * np.round((turned - angle[0]) / (2.0 * np.pi))
    return Branch(rig, analysis, steps, signs, times, path, rates, angles)


def _follow(
    rig: Rig,
    reference: Reference,
    analysis: Analysis,
    steps: tuple[Step, ...],
    signs: dict[int, float],
    start: Array,
) -> tuple[Array, Solution]:
    """Instants along the path, as many as are needed, and the solution there.

    Raises
    ------
    PathError
        There is none that continues the start.
    """
    errors = []
    for samples in GRIDS:
        times = np.linspace(0.0, reference.duration, samples)
        taylor = taylor_of(reference, times, _order(analysis))
        solution = expand(steps, len(start), prescribe(rig, taylor), start, follow=True)
        error = failure(rig, analysis, solution, signs, times, taylor[0])
        error = passing(equations_of(rig), _values(solution), times, taylor[0]) or error
        if error is None:
            break
        errors.append(error)
    else:
        # A trolley that has left its rail by then is the plainer reason.
        until = slice(first_wrong(solution, signs, times))
        names, path = equations_of(rig).names, _values(solution)
        stay_on_rails(rig, names, path[:, until], times[until])
        raise errors[-1]
    if np.ptp(taylor[0], axis=0).any() and solution.straight.mean() > MOSTLY:
        raise PathError(
            f"rig {rig.name} cannot follow the path: a pulley without mass hangs straight below "
            "its winch all along and nothing determines its place; move sideways or give it a mass"
        )
    return times, solution


def _angles(equations: Equations, values: Array) -> dict[str, Array]:
    """Continuous angles (N,) of the turning frames from unknowns (unknowns, N)."""
    return {
        name: np.unwrap(np.arctan2(values[sin], values[cos]))
        for name, cos, sin in equations.turning
    }


def _limit(
    rig: Rig,
    reference: Reference,
    analysis: Analysis,
    steps: tuple[Step, ...],
    start: Array,
) -> Array:
    """All unknowns (unknowns, 1) at the start, as the limit of the motion that leaves it.

    A pulley without mass that hangs straight below its winch has no place of its own.
    """
    first = reference.duration / (GRIDS[0] - 1)
    back = first * 4.0 ** -np.arange(LIMIT_STEPS)
    for times in (np.array([0.0, first]), np.array([*back, 0.0])):
        taylor = prescribe(rig, taylor_of(reference, times, _order(analysis)))
        solution = expand(steps, len(start), taylor, start, follow=True)
        if not solution.solved.all():
            return start  # the path itself will tell what is wrong
        start = _values(solution)[:, -1:]
    return start


def _order(analysis: Analysis) -> int:
    """Derivatives of the reference to use: those that are needed, and the outputs' own two."""
    return max(analysis.reference_order, 2)


def taylor_of(reference: Reference, times: Array, order: int) -> Array:
    """Taylor coefficients of a reference, shape (order + 1, N, outputs)."""
    factorials = [math.factorial(k) for k in range(order + 1)]
    derivatives = reference.derivatives(times, order)
    return np.asarray(derivatives / np.array(factorials, dtype=float)[:, None, None])


def _accept(rig: Rig, reference: Reference, analysis: Analysis) -> None:
    """Refuse a rig that is not flat and a reference of the wrong kind."""
    if not analysis.flat:
        raise RigError(
            f"rig {rig.name} is not flat: its outputs leave {analysis.degrees_of_freedom} "
            "degrees of freedom undetermined"
        )
    accept_columns(rig, reference)
    if reference.order < analysis.reference_order:
        raise SmoothnessError(
            f"the reference has {reference.order} continuous derivatives, rig {rig.name} "
            f"needs {analysis.reference_order}"
        )


def accept_columns(rig: Rig, reference: Reference) -> None:
    """Refuse a reference whose columns are not the rig's outputs.

    Raises
    ------
    PathError
        It has more or fewer, or turns something that is no platform, or is no path.
    """
    if not hasattr(reference, "derivatives"):
        raise PathError(
            f"the reference is a {type(reference).__name__}, it must be a path; from_move makes one"
        )
    if reference.size != len(rig.outputs):
        raise PathError(
            f"the reference has {reference.size} columns, rig {rig.name} needs "
            f"{len(rig.outputs)}: {', '.join(rig.outputs)}"
        )
    if isinstance(reference, FixedAxis):
        turned = tuple(rig.outputs[column] for column in reference.columns)
        if turned not in [platform.angles for platform in rig.platforms]:
            raise PathError(
                f"the path turns {', '.join(turned)} of rig {rig.name} about one axis, these must "
                "be the angles alpha, beta and gamma of a platform"
            )


@lru_cache(maxsize=512)
def approach(rig: Rig, start: tuple[float, ...]) -> Solution:
    """The solution in rest from home to the start of a path, by the first way that has one."""
    analysis, equations = analyse(rig), equations_of(rig)
    steps = plan(analysis)
    values, home = _home(rig, equations)
    outputs = np.array([_output(rig, values, name) for name in rig.outputs])
    when = "on the way from the rig's home to the start"
    errors = []
    for way in _ways(outputs, _unwound(rig, start)):
        taylor = np.zeros((_order(analysis) + 1, *way.shape))
        taylor[0] = way
        solution = expand(steps, len(home), prescribe(rig, taylor), home[:, None], follow=True)
        signs = {block: float(sign[0]) for block, sign in solution.signs.items()}
        error = failure(rig, analysis, solution, signs, np.arange(float(len(way))), way, when)
        if error is None:
            return solution
        errors.append(error)
    raise errors[0]


def _unwound(rig: Rig, outputs: tuple[float, ...]) -> Array:
    """The same outputs with a platform's angles within half a turn of upright."""
    angles = {angle for platform in rig.platforms for angle in platform.angles}
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


def _home(rig: Rig, equations: Equations) -> tuple[dict[str, Array], Array]:
    """The rig's coordinates at home, and all unknowns there at rest.

    Those of statics are meant in the sense of least squares.
    """
    values = {}
    for frame in rig.frames:
        values[frame.coordinate] = np.array(rig.home_of(frame))
    for mass in rig.masses:
        place = np.array(rig.home_of(mass), dtype=float)
        if place.ndim == 0:
            values[f"{mass.name}.position"] = place
        else:
            values |= {f"{mass.name}.{axis}": place["xyz".index(axis)] for axis in rig.axes}
    values |= {angle: np.zeros(()) for part in rig.platforms for angle in part.angles}
    state, _ = redundant(equations, values, dict.fromkeys(values, np.zeros(())))
    values |= {rope.coordinate: state[equations.names.index(rope.coordinate)] for rope in rig.ropes}
    pull = np.hstack((equations.constraint_jacobian(state).T, -equations.input_matrix(state)))
    statics = np.linalg.lstsq(pull, equations.force, rcond=None)[0]
    return values, np.concatenate((state, statics))


def _output(rig: Rig, values: dict[str, Array], name: str) -> float:
    """One of the rig's outputs, a coordinate or a combination of them."""
    for part in rig.combinations:
        if part.name == name:
            pairs = zip(part.factors, part.of, strict=True)
            return sum(factor * float(values[one]) for factor, one in pairs)
    return float(values[name])


def _values(solution: Solution) -> Array:
    """The unknowns themselves, shape (unknowns, N)."""
    return np.array([coefficients[0] for coefficients in solution.series])
