"""Coordinates of a rig and the map from them to the polynomial coordinates of its equations.

Three sets, as in the source:

- `redundant`: those of the equations themselves; nothing is eliminated (Y 5.103),
- `dependent`: angles instead of cosines, sines and directors, and no coordinate that a constraint
  free of the outputs determines: p = phi(p_bar) of Y 5.111.  Each constraint with an output in it
  is kept,
- `minimal`: positions and angles of frames, trolleys, loads and platforms; all rope lengths
  follow and no constraint is left (Y 4.6, 5.27).

The map q = phi(x) is never written down for a rig.  Part of q is given by x directly; the rest
solves the eliminated constraints Phi_T(q) = 0, and so its derivatives solve linear equations with
the same matrix, G_T dphi = 0 and so on: exact to the third order, which the Jacobian of the
equations of motion needs.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Literal, NamedTuple

import numpy as np

from ...models.errors import RigError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..exact.equations import Equations
from ..exact.problem import Problem

Kind = Literal["redundant", "dependent", "minimal"]


class Place(NamedTuple):
    """A configuration and the derivatives of the coordinate map there."""

    q: Array
    """Polynomial coordinates, shape (n,)."""
    slope: Array
    """First derivatives P = d phi, shape (n, k)."""
    bend: Array | None
    """Second derivatives d2 phi, shape (n, k, k); None if they vanish."""

    def second(self, rate: Array, acceleration: Array) -> Array:
        """Accelerations q'' (n,) at rates x' and accelerations x'', each (k,)."""
        second = self.slope @ acceleration
        return second if self.bend is None else second + self.bend @ rate @ rate


@dataclass(frozen=True, eq=False)
class Coordinates:
    """k coordinates of a rig, with b inputs and the constraints that they leave."""

    problem: Problem
    """Inverse dynamics of the rig."""
    kind: Kind
    """Which of the three sets."""
    names: tuple[str, ...]
    """Names of the k coordinates."""
    eliminated: tuple[int, ...]
    """Constraints that determine the `implicit` coordinates."""
    implicit: tuple[int, ...]
    """Coordinates of the equations that are functions of the k, one for each of `eliminated`."""
    multipliers: tuple[int, ...]
    """Constraints whose multipliers are unknowns."""
    constraints: tuple[int, ...]
    """Constraints that are equations: the same, unless prescribed angles imply some."""
    servo: Array
    """C of the servo constraints C x = prescribed, shape (a, k)."""

    @property
    def equations(self) -> Equations:
        """Equations of motion in the polynomial coordinates q, n of them."""
        return self.problem.equations

    def place(self, x: Array) -> Place:
        """The configuration at coordinates x (k,)."""
        if self.kind == "redundant":
            return Place(x, np.eye(len(x)), None)
        e = self.equations
        q = np.zeros(len(e.names))
        slope, bend = np.zeros((len(q), len(x))), np.zeros((len(q), len(x), len(x)))
        rows, columns = self._plain
        q[rows], slope[rows, columns] = x[columns], 1.0
        for j, cos, sin in self._turning:
            q[cos], q[sin] = np.cos(x[j]), np.sin(x[j])
            slope[cos, j], slope[sin, j] = -q[sin], q[cos]
            bend[cos, j, j], bend[sin, j, j] = -q[cos], -q[sin]
        for directors, columns, angles in self._platforms(x):
            q[directors] = _rotation(angles, 0)
            slope[np.ix_(directors, columns)] = _rotation(angles, 1)
            bend[np.ix_(directors, columns, columns)] = _rotation(angles, 2)
        self._complete(q)
        if self.eliminated:
            hessian, gradient, pivot = self._eliminating(q)
            slope[list(self.implicit)] = pivot @ (gradient @ slope)
            curved = slope.T @ hessian @ slope + _apply(gradient, bend)
            bend[list(self.implicit)] = _apply(pivot, curved)
        return Place(q, slope, bend)

    def third(self, place: Place, x: Array, rate: Array) -> Array:
        """d3 phi applied twice to a rate (k,), shape (n, k)."""
        result = np.zeros_like(place.slope)
        if place.bend is None:
            return result
        for j, cos, sin in self._turning:
            result[cos, j] = place.q[sin] * rate[j] ** 2
            result[sin, j] = -place.q[cos] * rate[j] ** 2
        for directors, columns, angles in self._platforms(x):
            turned = np.einsum("nijk,i,j->nk", _rotation(angles, 3), rate[columns], rate[columns])
            result[np.ix_(directors, columns)] = turned
        if self.eliminated:
            hessian, gradient, pivot = self._eliminating(place.q)
            turned = place.bend @ rate
            curved = hessian @ (turned @ rate) @ place.slope
            curved += 2.0 * (hessian @ (place.slope @ rate)) @ turned
            result[list(self.implicit)] = pivot @ (curved + gradient @ result)
        return result

    def _complete(self, q: Array) -> None:
        """Set the implicit coordinates: each constraint is linear or quadratic in its own."""
        for k, i in zip(self.eliminated, self.implicit, strict=True):
            state = np.append(q, 1.0)
            row = self.equations.constraints[k] @ state
            b, c, a = row[i], 0.5 * (state @ row), self.equations.constraints[k, i, i]
            # A length is the larger root; a is negative there.
            q[i] = -c / b if a == 0.0 else -(b + np.sqrt(b * b - 2.0 * a * c)) / a

    def _eliminating(self, q: Array) -> tuple[Array, Array, Array]:
        """Second and first derivatives of the eliminated constraints, and minus the inverse of
        the latter by the implicit coordinates.
        """
        matrices = self._matrices
        gradient = matrices[:, :-1, :-1] @ q + matrices[:, :-1, -1]
        pivot = np.asarray(-np.linalg.inv(gradient[:, self.implicit]), dtype=float)
        return matrices[:, :-1, :-1], gradient, pivot

    @cached_property
    def own(self) -> Array | None:
        """Rows of q that the coordinates of a base that moves as given have for themselves, 1 or 0.

        Shape (n, k); all rows for other coordinates, None where nothing moves as given.
        """
        e = self.equations
        given = [frame for frame in e.rig.frames if frame.given]
        if not given or self.kind == "redundant":
            return None
        rows = np.ones((len(e.names), len(self.names)))
        turning = {name: (cos, sin) for name, cos, sin in e.turning}
        for frame in given:
            mine = turning.get(frame.coordinate) or (e.names.index(frame.coordinate),)
            column = self.names.index(frame.coordinate)
            rows[:, column] = 0.0
            rows[list(mine), column] = 1.0
        return rows

    @cached_property
    def _matrices(self) -> Array:
        """Matrices S of the eliminated constraints."""
        return self.equations.constraints[list(self.eliminated)]

    @cached_property
    def _plain(self) -> tuple[list[int], list[int]]:
        """Indices in q and in x of the polynomial coordinates that are coordinates themselves."""
        shared = [name for name in self.names if name in self.equations.names]
        rows = [self.equations.names.index(name) for name in shared]
        return rows, [self.names.index(name) for name in shared]

    @cached_property
    def _turning(self) -> list[tuple[int, int, int]]:
        """For each turning frame its angle and the indices of cosine and sine."""
        return [(self.names.index(name), cos, sin) for name, cos, sin in self.equations.turning]

    def _platforms(self, x: Array) -> list[tuple[list[int], list[int], Array]]:
        """For each platform its directors, the columns of its angles, and these."""
        platforms = []
        for orientation in self.equations.orientations:
            columns = [self.names.index(name) for name in orientation.angles]
            platforms.append((list(orientation.directors), columns, x[columns]))
        return platforms


def _apply(matrix: Array, tensor: Array) -> Array:
    """A matrix times the first axis of a tensor of three."""
    return (matrix @ tensor.reshape(len(tensor), -1)).reshape(len(matrix), *tensor.shape[1:])


def _rotation(angles: Array, order: int) -> Array:
    """All derivatives of an order of the nine directors by three Bryant angles, (9, 3, ..., 3)."""
    factors = [
        [_turn(axis, angle, times) for times in range(order + 1)]
        for axis, angle in enumerate(angles)
    ]
    result = np.empty((9, *(3,) * order))
    for index in np.ndindex(*(3,) * order):
        alpha, beta, gamma = (factors[axis][index.count(axis)] for axis in range(3))
        result[:, *index] = (alpha @ beta @ gamma).T.ravel()
    return result


def _turn(axis: int, angle: float, times: int) -> Array:
    """A derivative of the rotation matrix about a coordinate axis."""
    cos, sin = np.cos(angle + times * np.pi / 2), np.sin(angle + times * np.pi / 2)
    i, k = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.zeros((3, 3))
    matrix[axis, axis] = times == 0
    matrix[i, i] = matrix[k, k] = cos
    matrix[i, k], matrix[k, i] = -sin, sin
    return matrix


@lru_cache(maxsize=256)
def coordinates_of(problem: Problem, kind: Kind) -> Coordinates:
    """One of the three sets of coordinates of a rig.

    Raises
    ------
    RigError
        The rig has no such coordinates, and why.
    """
    e, rig = problem.equations, problem.rig
    constraints = tuple(range(len(e.constraint_names)))
    if kind == "redundant":
        servo = problem.servo
        equations = tuple(k for k in constraints if k not in servo.implied)
        matrix = np.zeros((len(servo.rows), len(e.names)))
        for i, terms in enumerate(servo.rows):
            for factor, j in terms:
                matrix[i, j] = factor
        return Coordinates(problem, kind, e.names, (), (), constraints, equations, matrix)
    by_angles = set(e.with_role("unit", "director"))
    remaining = () if kind == "minimal" else _with_outputs(problem, by_angles)
    eliminated = tuple(k for k in constraints if k not in by_angles and k not in remaining)
    follows = {k: c.coordinate for k, c in enumerate(e.roles) if c.coordinate is not None}
    for k in eliminated:
        if k not in follows:
            raise RigError(
                f"rig {rig.name} has no {kind} coordinates: of no coordinate constraint "
                f"{e.constraint_names[k]} says that it follows from the others"
            )
    implicit = tuple(follows[k] for k in eliminated)
    hidden = {e.names[i] for i in implicit}
    spans = (e.names[follows[k]] for k in e.with_role("span"))
    candidates = dict.fromkeys((*rig.coordinate_names, *spans))
    names = tuple(name for name in candidates if name not in hidden and name not in rig.held)
    matrix = _outputs(rig, names, kind)
    if len(remaining) > len(matrix):
        raise RigError(
            f"rig {rig.name} has no dependent coordinates: {len(remaining)} constraints contain "
            f"its {len(matrix)} outputs, there may be no more than outputs (Y assumption 1)"
        )
    return Coordinates(problem, kind, names, eliminated, implicit, remaining, remaining, matrix)


def _with_outputs(problem: Problem, implied: set[int]) -> tuple[int, ...]:
    """Constraints that contain an output."""
    prescribed = sorted({j for terms in problem.servo.rows for _, j in terms})
    return tuple(
        k
        for k, matrix in enumerate(problem.equations.constraints)
        if k not in implied and matrix[prescribed].any()
    )


def _outputs(rig: Rig, names: tuple[str, ...], kind: Kind) -> Array:
    """The outputs as sums of coordinates, shape (outputs, coordinates)."""
    matrix = np.zeros((len(rig.outputs), len(names)))
    for i, output in enumerate(rig.outputs):
        for factor, name in rig.terms(output):
            if name not in names:
                raise RigError(f"rig {rig.name}: output {name!r} is none of its {kind} coordinates")
            matrix[i, names.index(name)] = factor
    return matrix
