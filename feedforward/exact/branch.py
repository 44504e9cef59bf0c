"""On which branch of the solutions a motion lies: followed from the rig's home along the path.

The equations of a rig have several solutions (a trolley on the other half of a turning girder, a
pulley on the other side of its ropes).  The right one continues the rig's home: from there the
outputs are moved to the start of the path in rest, and then along it, on a grid as fine as needed.
A path that continues another motion starts from that one's state instead, see `state`.  A pulley
without mass is taken to hang where all its ropes pull, if the way from home leads there or not.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...models.errors import PathError
from ...models.types import Array
from ..paths.consistency import accept_rest, verify_reference
from ..paths.reference import Reference, taylor_of
from ..paths.waves import base_at, still
from ..series.products import factorials
from .at_sea import accept_waves, given_columns, set_moving
from .between import look_between
from .equations import Equations
from .held_freedoms import stay_held
from .home import approach, home_unknowns
from .problem import Problem
from .pulleys import LOOKS, has_light_pulley, settle
from .refusal import accept, failure, first_wrong, passing, stay_on_rails
from .state import State, accept_join
from .taylor import Solution, expand

GRIDS = (129, 513, 2049)
"""Samples along the path; the next where Newton's method loses its way on one."""
MOSTLY = 0.5
"""Share of a path's samples that may be singular places of a pulley without mass."""


@dataclass(frozen=True, eq=False)
class Branch:
    """The solution on a grid along the whole path."""

    problem: Problem
    reference: Reference
    signs: dict[int, float]
    """Sign of each block's determinant on this branch."""
    times: Array
    values: Array
    """Unknowns, shape (unknowns, samples)."""
    rates: Array
    """Their first derivatives; finite differences where the expansion has none."""
    angles: dict[str, Array]
    """Continuous angles of the turning frames, shape (samples,)."""

    def near(self, times: Array, unknowns: Sequence[int] | slice = slice(None)) -> Array:
        """All unknowns or some between the grid's samples, shape (unknowns, N)."""
        step = self.times[1]
        place = np.clip(times / step, 0.0, len(self.times) - 1.0)
        below = np.minimum(place.astype(int), len(self.times) - 2)
        share = place - below
        values, rates = self.values[unknowns, :], self.rates[unknowns, :]
        left, right = values[:, below], values[:, below + 1]
        # Cubic Hermite interpolation, as the chord and what the end slopes add to it.
        drop = left - right
        bend = share * (1.0 - share)
        start = step * rates[:, below] + drop
        end = step * rates[:, below + 1] + drop
        return np.asarray(left - share * drop + bend * ((1.0 - share) * start - share * end))

    def ends(self, below: int, unknowns: Sequence[int]) -> list[list[float]]:
        """Values and rates of some unknowns at a sample of the grid and at the next one.

        A list (left, right, rate at the left, rate at the right) for each.
        """
        columns = (self.values, below), (self.values, below + 1), (self.rates, below)
        both = [a[unknowns, i] for a, i in (*columns, (self.rates, below + 1))]
        return [list(map(float, row)) for row in np.array(both).T.tolist()]

    def turned(self, times: Array) -> dict[str, Array]:
        """Continuous angles of the turning frames to within half a turn, shape (N,)."""
        at = np.clip(times, 0.0, self.times[-1])
        return {name: np.interp(at, self.times, near) for name, near in self.angles.items()}

    def expanded(self, times: Array) -> tuple[Array, Solution]:
        """Taylor coefficients of the reference (orders, N, outputs) and the solution.

        Raises
        ------
        PathError
            There is none at one of the times (N,).
        """
        taylor = taylor_of(self.reference, times, self.problem.order)
        guess = self.near(times)
        solution = expand(self.problem, taylor, guess, follow=False, sides=self.signs)
        error = failure(self.problem, solution, self.signs, times, taylor[0])
        if error is not None:
            raise error
        return taylor, solution

    def at(self, time: float) -> State:
        """The state at one time [s].

        Raises
        ------
        PathError
            The branch has no solution there.
        """
        instant = np.array([time])
        taylor, solution = self.expanded(instant)
        values = solution.values
        near = {name: float(angle[0]) for name, angle in self.turned(instant).items()}
        angles = turning_angles(self.problem.equations, values, near)
        return State(
            problem=self.problem,
            time=time,
            derivatives=taylor[:, 0] * factorials(len(taylor))[:, None],
            unknowns=values[:, 0],
            signs=self.signs,
            angles={name: float(angle[0]) for name, angle in angles.items()},
            base=base_at(self.reference, time),
        )


@lru_cache(maxsize=512)
def branch_of(
    problem: Problem, reference: Reference, verify: bool = True, begin: State | None = None
) -> Branch:
    """The branch of a rig along a path; found once for each pair.

    It starts from a state if there is one, otherwise in rest.  The derivatives of a path that is
    not the package's own are compared with one another, unless `verify` says not to.

    Raises
    ------
    RigError, SmoothnessError, PathError
        As `feedforward.solve`.
    """
    accept(problem, reference)
    accept_waves(problem.rig, reference)
    if verify:
        free = given_columns(problem.rig)
        verify_reference(
            still(reference), problem.rig.outputs, problem.order,
            moving=begin is not None, free=free,
        )  # fmt: skip
    if begin is not None:
        accept_join(problem, begin, reference)
        outset = Outset(begin.unknowns[:, None], begin.signs, begin.angles, False)
    else:
        if verify:
            accept_rest(still(reference), problem.rig.outputs, problem.order, free)
        outset = _outset(problem, reference)
        moving = set_moving(problem, reference, outset.start, outset.signs)
        outset = outset._replace(start=moving)
    equations = problem.equations
    times, solution = _follow(problem, reference, outset)
    path = solution.values
    stay_on_rails(problem.rig, equations.names, path, times)
    stay_held(problem, solution, times)
    look_between(problem, reference, outset.signs, times, solution)
    rates = np.gradient(path, times[1], axis=1)
    for j, coefficients in enumerate(solution.series):
        if len(coefficients) > 1:
            rates[j] = coefficients[1]
    angles = turning_angles(equations, path, outset.angles)
    return Branch(problem, reference, outset.signs, times, path, rates, angles)


class Outset(NamedTuple):
    """Where a branch starts, with the path."""

    start: Array
    """All unknowns, shape (unknowns, 1)."""
    signs: dict[int, float]
    """Sign of each block's determinant."""
    angles: dict[str, float]
    """Continuous angles of the turning frames."""
    slack: bool
    """Whether there is a pulley without mass, and no place along the path was found at which all
    its ropes pull."""


def _outset(problem: Problem, reference: Reference) -> Outset:
    """The start of a path, on the branch that continues the rig's home.

    Raises
    ------
    PathError
        No way from home leads there, nor a search for the pulleys without mass.
    """
    home = home_unknowns(problem.equations)
    light = has_light_pulley(problem)
    lost = None
    way, signs = home, {}
    try:
        arrived = approach(problem, tuple(np.asarray(reference.start).tolist()))
        way = arrived.values
        signs = {block: float(sign[0]) for block, sign in arrived.signs.items()}
    except PathError as error:
        if not light:
            raise
        lost = error
    start, slack = way[:, -1:], False
    if light:
        start, pulling, sought = settle(problem, reference, home, start)
        if lost is not None and not pulling:
            raise lost
        slack = not pulling
        signs = pulling or signs
        if sought:
            way = np.hstack((home, start))
    angles = turning_angles(problem.equations, way)
    return Outset(start, signs, {name: float(angle[-1]) for name, angle in angles.items()}, slack)


def _follow(problem: Problem, reference: Reference, outset: Outset) -> tuple[Array, Solution]:
    """Instants along the path, as many as are needed, and the solution there.

    Raises
    ------
    PathError
        There is none that continues the start.
    """
    start, signs, errors = outset.start, outset.signs, []
    for samples in GRIDS:
        times = np.linspace(0.0, reference.duration, samples)
        taylor = taylor_of(reference, times, problem.order)
        solution = expand(problem, taylor, start, follow=True)
        error = failure(problem, solution, signs, times, taylor[0])
        # Of a rope that reverses there that is the plainer reason; what lies beyond does not count.
        first = first_wrong(solution, signs, times)
        until = slice(None if first is None else first + 1)
        error = passing(problem.equations, solution.values[:, until], times, taylor[0]) or error
        if error is None:
            break
        errors.append(error)
    else:
        # A trolley that has left its rail by then is the plainer reason.
        until = slice(first_wrong(solution, signs, times))
        names = problem.equations.names
        stay_on_rails(problem.rig, names, solution.values[:, until], times[until])
        if outset.slack:
            raise PathError(
                f"{errors[-1]}; nor was a place found, at {LOOKS} instants of the path, where all "
                "ropes at its pulley without mass pull"
            )
        raise errors[-1]
    if np.ptp(taylor[0], axis=0).any() and solution.straight.mean() > MOSTLY:
        raise PathError(
            f"rig {problem.rig.name} cannot follow the path: a pulley without mass hangs straight "
            "below its winch all along and nothing determines its place; move sideways or give it "
            "a mass"
        )
    return times, solution


def turning_angles(
    equations: Equations, values: Array, start: Mapping[str, float] | None = None
) -> dict[str, Array]:
    """Continuous angles (N,) of the turning frames from unknowns (unknowns, N).

    The first of each is the one nearest to its `start`, or lies within half a turn of zero.
    """
    angles = {}
    for name, cos, sin in equations.turning:
        angle = np.unwrap(np.arctan2(values[sin], values[cos]))
        turns = np.round((start[name] - angle[0]) / (2.0 * np.pi)) if start else 0.0
        angles[name] = angle + 2.0 * np.pi * turns
    return angles
