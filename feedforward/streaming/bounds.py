"""How far a rig is from the bounds that a governed command has to respect."""

import math

import numpy as np

from ...models.rig.rope_ends import rope_ends
from ...models.types import Array, Mask
from ..exact.drive_limits import uses
from ..exact.home import home_unknowns
from ..exact.problem import Problem
from .evaluation import Evaluated

AWAY = 0.05
"""Of a rail's ends [m], but no more than this share of its length: a trolley has to stay so far."""
SHORTEST = 0.05
"""Of a span's length at home: no rope is wound up further."""
STEEPEST = math.acos(0.2)
"""Of a platform's second Bryant angle [rad]: at a right angle the other two are undetermined."""
TURN = math.pi / 3.0
"""Of a frame from one sample to the next [rad]: a load that passes the tower's axis between two
samples would turn it by half a turn unseen."""


class Bounds:
    """The bounds of one rig.

    Parameters
    ----------
    problem
        Of the rig.
    names
        Of the coordinates, as in `Motion.coordinate_names`.
    share
        Of each drive's limits that may be used.
    margin
        Lowest tension [N].
    """

    def __init__(
        self, problem: Problem, names: tuple[str, ...], share: float, margin: float
    ) -> None:
        rig, equations = problem.rig, problem.equations
        self.share, self.margin, self.weight = share, margin, rig.weight
        self._pulling = list(rig.pulling)
        self._rig, self._driven = rig, [names.index(name) for name in rig.driven_coordinates]
        rows: list[Array] = []

        def bound(terms: dict[str, float], constant: float) -> None:
            row = np.zeros(len(names) + 1)
            for name, factor in terms.items():
                row[names.index(name)] = factor
            row[-1] = constant
            rows.append(row)

        for trolley in rig.trolleys:
            rail = rig.rail(trolley.rail)
            away = AWAY * min(1.0, rail.end - rail.start)
            if math.isfinite(rail.start):
                bound({trolley.coordinate: 1.0}, -rail.start - away)
            if math.isfinite(rail.end):
                bound({trolley.coordinate: -1.0}, rail.end - away)
        for end in rope_ends(rig):
            sums = {name: factor for factor, name in end.terms}
            bound(sums, -end.low)
            if math.isfinite(end.high):
                bound({name: -factor for name, factor in sums.items()}, end.high)
        home = home_unknowns(equations)[: len(equations.names), 0]
        for row in (row for rows in equations.span_lengths for row in rows):
            length = float(row[:-1] @ home + row[-1])
            used = {equations.names[i]: row[i] / length for i in np.flatnonzero(row[:-1])}
            bound(used, row[-1] / length - SHORTEST)
        for platform in rig.platforms if rig.dimensions == 3 else ():
            for sign in (1.0, -1.0):
                bound({platform.angles[1]: sign}, STEEPEST)
        self._rows = np.array(rows).reshape(len(rows), len(names) + 1)
        self._turning = [names.index(name) for name, _, _ in equations.turning]

    def spare(self, rig: Evaluated, times: Array) -> Array:
        """What is left up to each bound at N samples, negative beyond it, shape (bounds, N).

        Of a limit as a share of it, of a tension as a share of the rig's weight, of a rail or a
        rope's end in m, of a span as a share of its length at home, of an angle in rad.  Samples
        are those of courses one after the other, each at the same instants `times` [s].
        """
        return np.vstack(
            (
                *self._of_drives(rig, times),
                (rig.tensions[self._pulling] - self.margin) / self.weight,
                self._rows[:, :-1] @ rig.positions + self._rows[:, -1:],
            )
        )

    def _of_drives(self, rig: Evaluated, times: Array) -> list[Array]:
        """What is left of each limit of a drive, shape (N,) each."""
        shape = len(self._driven), -1, len(times)
        inputs, speeds, accelerations = (
            part.reshape(shape)
            for part in (rig.inputs, rig.rows[1][self._driven], rig.rows[2][self._driven])
        )
        spare = []
        for use in uses(self._rig, times, inputs, speeds, accelerations):
            low, high = use.bounds
            if use.quantity == "input" and low == -high:
                spare.append(self.share - np.abs(use.values) / high)
            else:
                spare.append(use.spare(self.share))
        return [part.reshape(-1) for part in spare]

    def continuous(self, rig: Evaluated, courses: int) -> Mask:
        """Whether no frame turns over between the samples of courses that follow one another."""
        angles = rig.positions[self._turning]
        angles = angles.reshape(len(angles), courses, angles.shape[1] // courses)
        return np.asarray((np.abs(np.diff(angles, axis=2)) < TURN).all(axis=(0, 2)))
