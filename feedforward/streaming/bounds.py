"""How far a rig is from the bounds that a governed command has to respect."""

from itertools import pairwise

import numpy as np

from ...models.types import Array, Mask
from ..exact.home import home_unknowns
from ..exact.problem import Problem

AWAY = 0.05
"""Of a rail's ends [m], but no more than this share of its length: a trolley has to stay so far."""
SHORTEST = 0.05
"""Of a span's length at home: no rope is wound up further."""
STEEPEST = 0.2
"""Least cosine of a platform's second Bryant angle: at zero the other two are undetermined."""
TURN = 0.5
"""Least cosine of a frame's turn from one sample to the next: a load that passes the tower's axis
between two samples would turn it by half a turn unseen."""


class Bounds:
    """The bounds of one rig.

    Parameters
    ----------
    problem
        Of the rig.
    share
        Of each drive's limit that may be used.
    margin
        Lowest tension [N].
    """

    def __init__(self, problem: Problem, share: float, margin: float) -> None:
        self.problem, self.share, self.margin = problem, share, margin
        rig, equations = problem.rig, problem.equations
        self._counts = len(equations.names), len(equations.constraint_names)
        self._limits = np.array([drive.limit for drive in rig.drives])[:, None]
        home = np.append(home_unknowns(equations)[: self._counts[0], 0], 1.0)
        rows = []
        for trolley in rig.trolleys:
            rail = rig.rail(trolley.rail)
            place = equations.names.index(trolley.coordinate)
            away = AWAY * min(1.0, rail.end - rail.start)
            for sign, end in ((1.0, rail.start), (-1.0, rail.end)):
                if np.isfinite(end):
                    row = np.zeros(self._counts[0] + 1)
                    row[place], row[-1] = sign, -sign * end - away
                    rows.append(row)
        for lengths in equations.span_lengths:
            for row in lengths:
                shortest = row / (row @ home)
                shortest[-1] -= SHORTEST
                rows.append(shortest)
        for orientation in equations.orientations:
            # The first component of the third director is the sine of beta.
            row = np.zeros(self._counts[0] + 1)
            row[orientation.directors[6]] = 1.0
            for sign in (1.0, -1.0):
                tilted = sign * row
                tilted[-1] = np.sqrt(1.0 - STEEPEST**2)
                rows.append(tilted)
        self._rows = np.array(rows).reshape(len(rows), self._counts[0] + 1)
        self._chords = np.array(
            [
                equations.points[after] - equations.points[before]
                for rope in rig.ropes
                for before, after in pairwise(rope.path)
            ]
        )

    def spare(self, values: Array) -> Array:
        """What is left up to each bound, negative beyond it; unknowns (unknowns, N): (bounds, N).

        Of a limit as a share of it, of a tension as a share of the rig's weight, of a rail in m, of
        a span as a share of its length at home.
        """
        n, m = self._counts
        equations = self.problem.equations
        tensions = equations.tensions(values[:n].T, values[n : n + m].T).T
        state = np.vstack((values[:n], np.ones(values.shape[1])))
        return np.vstack(
            (
                self.share - np.abs(values[n + m :]) / self._limits,
                (tensions - self.margin) / self.problem.rig.weight,
                self._rows @ state,
            )
        )

    def continuous(self, values: Array) -> Mask:
        """Whether nothing turns over between the samples of courses (unknowns, courses, N)."""
        n = self._counts[0]
        good = np.ones(values.shape[1], dtype=bool)
        for _, cos, sin in self.problem.equations.turning:
            pair = values[[cos, sin]]
            good &= ((pair[:, :, 1:] * pair[:, :, :-1]).sum(axis=0) > TURN).all(axis=-1)
        spans = np.tensordot(self._chords[..., :n], values[:n], axes=1)
        spans += self._chords[..., n, None, None]
        return np.asarray(good & ((spans[..., 1:] * spans[..., :-1]).sum(axis=1) > 0).all((0, -1)))
