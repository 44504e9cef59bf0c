"""The equations of motion of a rig, generated from its description.

In redundant coordinates q every term is a polynomial of degree two or less:

    M q'' = f - D q' - sum_k multiplier_k grad(Phi_k) + (B + B'q) u
    0     = Phi_k(q) = 1/2 (q, 1)^T S_k (q, 1)

with a constant mass matrix M, possibly singular (Y 5.102, K 3.39).  To make them so

- a turning frame has the cosine and the sine of its angle as coordinates, and a frame on a turning
  one those components of its directions and origin that something stands on (`frame_rows`),
- a trolley on a turning rail has, besides its position along the rail, those Cartesian
  coordinates that the turning moves,
- a rope's spans but one, mostly the last, have their lengths as coordinates (K 3.41),
- a platform has its three directors, the columns of its rotation matrix, as coordinates; their
  six products are constraints (Y 2.42 to 2.44) and their masses the moments about the planes
  across them, so that its gyroscopic torque needs no term of its own; in a planar rig it has the
  cosine and the sine of its angle,
- a link adds a constraint and no coordinate.

What symmetry holds at home is no coordinate: `Rig.held` leaves it and its equation out.

The multiplier of a span's or a link's constraint, 1/2 (|span|^2 - length^2), times the length is
its tension; of a last span with several falls, of all of them together.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np

from ...models.errors import RigError, did_you_mean
from ...models.rig.rig import Rig
from ...models.types import Array
from ..series.rotation import matrix
from .losses import losses_of


class Constraint(NamedTuple):
    """What one constraint is for."""

    name: str
    owner: str
    """Name of the part that it belongs to."""
    role: Literal["unit", "frame", "rail", "director", "span", "link"]
    """The unit length of the cosine and sine of a frame or a planar platform; a component of the
    direction or origin of a frame on a turning one; a coordinate of a trolley on a turning rail; a
    product of two of a platform's directors; the length of a rope's span; that of a link."""
    coordinate: int | None
    """Index of the coordinate that follows from it: of a frame's, a rail's and a span's."""


class Orientation(NamedTuple):
    """The directors of a platform among the coordinates."""

    angles: tuple[str, str, str]
    """Names of its Bryant angles."""
    directors: tuple[int, ...]
    """Indices of the nine components, director by director."""
    constraints: tuple[int, ...]
    """Indices of the six constraints among them."""


@dataclass(frozen=True, eq=False)
class Equations:
    """Equations of motion with n coordinates, m constraints and a inputs.

    All arrays are read-only; `states` below are arrays whose last axis is the coordinate.
    """

    rig: Rig
    names: tuple[str, ...]
    """Names of the n coordinates."""
    roles: tuple[Constraint, ...]
    """What each of the m constraints is for."""
    mass: Array
    """Mass matrix, shape (n, n)."""
    force: Array
    """Gravity, shape (n,)."""
    damping: Array | None
    """D, shape (n, n), if anything rubs or drags that no drive acts on: then -D q' is a force."""
    constraints: Array
    """Matrices S_k, symmetric, shape (m, n + 1, n + 1)."""
    input_constant: Array
    """B, shape (n, a)."""
    input_linear: Array
    """B', shape (n, a, n): the force on coordinate i of input j is B'[i, j] @ q times u_j."""
    turning: tuple[tuple[str, int, int], ...]
    """For each turning frame, and each platform of a planar rig, its angle's name and the indices
    of cosine and sine."""
    orientations: tuple[Orientation, ...]
    """Directors of each platform in space."""
    spans: tuple[tuple[int, ...], ...]
    """For each rope the indices of the constraints of its spans."""
    span_lengths: tuple[Array, ...]
    """For each rope the rows giving its spans' lengths from (q, 1), shape (spans, n + 1)."""
    links: tuple[int, ...]
    """For each link the index of its constraint."""
    points: Mapping[str, Array]
    """For each anchor and mass the rows giving its world position from (q, 1), (3, n + 1)."""
    pushed: Array | None = None
    """1 where a constraint's force moves a coordinate, 0 where that is given, shape (m, n)."""

    @cached_property
    def constraint_names(self) -> tuple[str, ...]:
        """Names of the m constraints."""
        return tuple(constraint.name for constraint in self.roles)

    @cached_property
    def hidden(self) -> frozenset[int]:
        """Coordinates that stand for a part's angle, or follow from angles."""
        pairs = {i for _, cos, sin in self.turning for i in (cos, sin)}
        directors = {i for orientation in self.orientations for i in orientation.directors}
        frames = {self.roles[k].coordinate for k in self.with_role("frame")}
        return frozenset(i for i in pairs | directors | frames if i is not None)

    def with_role(self, *roles: str, owner: str | None = None) -> tuple[int, ...]:
        """Indices of the constraints of some role, of one part if an owner is named."""
        return tuple(
            k
            for k, constraint in enumerate(self.roles)
            if constraint.role in roles and owner in (None, constraint.owner)
        )

    def constraint_values(self, state: Array) -> Array:
        """Phi at states (..., n): shape (..., m)."""
        ones = _with_one(state)
        return np.asarray(0.5 * np.einsum("...i,kij,...j->...k", ones, self.constraints, ones))

    def constraint_jacobian(self, state: Array) -> Array:
        """Gradients of Phi at states (..., n): shape (..., m, n)."""
        gradients = np.einsum("kij,...j->...ki", self.constraints, _with_one(state))
        return np.asarray(gradients)[..., :-1]

    def constraint_forces(self, state: Array) -> Array:
        """Forces of unit multipliers at states (..., n): shape (..., m, n)."""
        gradients = self.constraint_jacobian(state)
        return gradients if self.pushed is None else gradients * self.pushed

    def constraint_curvature(self, rate: Array) -> Array:
        """q'^T (d2 Phi / dq2) q' at rates (..., n): shape (..., m)."""
        hessian = self.constraints[:, :-1, :-1]
        return np.asarray(np.einsum("...i,kij,...j->...k", rate, hessian, rate))

    def input_matrix(self, state: Array) -> Array:
        """B + B'q at states (..., n): shape (..., n, a)."""
        linear = np.einsum("iaj,...j->...ia", self.input_linear, state)
        return np.asarray(self.input_constant + linear)

    def tensions(self, state: Array, multipliers: Array) -> Array:
        """Of the ropes where they leave their winches, then of the links [N], (N, ropes + links).

        States (N, n) and multipliers (N, m).
        """
        ones = _with_one(state)
        tensions = np.zeros((len(state), len(self.rig.tension_names)))
        ropes = list(zip(self.rig.ropes, self.spans, self.span_lengths, strict=True))
        for i, (rope, spans, rows) in enumerate(ropes):
            falls = rope.falls if len(spans) == 1 else 1
            tensions[:, i] = multipliers[:, spans[0]] * (ones @ rows[0]) / falls
        for i, (link, k) in enumerate(zip(self.rig.links, self.links, strict=True), len(ropes)):
            tensions[:, i] = multipliers[:, k] * self.rig.link_length(link)
        return tensions

    def accelerations(self, state: Array, rate: Array, inputs: Array) -> tuple[Array, Array]:
        """Accelerations (N, n) and multipliers (N, m) under given inputs (N, a).

        Solves the index-1 form of the equations (Y 4.10) at consistent states and rates (N, n).
        """
        n, m = len(self.names), len(self.constraint_names)
        jacobian = self.constraint_jacobian(state)
        matrix = np.zeros((len(state), n + m, n + m))
        matrix[:, :n, :n] = self.mass
        matrix[:, :n, n:] = np.swapaxes(self.constraint_forces(state), 1, 2)
        matrix[:, n:, :n] = jacobian
        arms, losses = self.input_matrix(state), losses_of(self.rig)
        if losses is not None:
            # Power is input times speed of the motor, whatever its coordinate.
            speeds = losses.arms * np.einsum("nia,ni->na", arms, rate)
            inputs = losses.delivered(inputs, speeds)
        applied = self.force + np.einsum("nia,na->ni", arms, inputs)
        if self.damping is not None:
            applied -= rate @ self.damping
        right = np.concatenate((applied, -self.constraint_curvature(rate)), axis=1)
        solution = np.linalg.solve(matrix, right[..., None])[..., 0]
        return solution[:, :n], solution[:, n:]


def _with_one(state: Array) -> Array:
    return np.concatenate((state, np.ones((*state.shape[:-1], 1))), axis=-1)


def redundant(
    equations: Equations, values: Mapping[str, Array], rates: Mapping[str, Array]
) -> tuple[Array, Array]:
    """Coordinates and their rates, each (..., n), from those of the rig's parts.

    Parameters
    ----------
    equations
        Of the rig.
    values
        Arrays (...) for the names of `Rig.coordinate_names`; rope lengths may be left
        out, they follow.
    rates
        Their rates, for the same names.

    Raises
    ------
    RigError
        A coordinate or its rate is missing, or a name is unknown.
    """
    _check_names(equations.rig, values, rates)
    samples = np.broadcast_shapes(*(np.shape(value) for value in values.values()))
    q, v = (np.zeros((*samples, len(equations.names))) for _ in range(2))
    for angle, cos, sin in equations.turning:
        q[..., cos], q[..., sin] = np.cos(values[angle]), np.sin(values[angle])
        v[..., cos], v[..., sin] = -q[..., sin] * rates[angle], q[..., cos] * rates[angle]
    for orientation in equations.orientations:
        angles = [
            [np.broadcast_to(table[name], samples) for name in orientation.angles]
            for table in (values, rates)
        ]
        directors = np.swapaxes(matrix(np.moveaxis(np.array(angles), 1, -1)), -1, -2)
        columns = list(orientation.directors)
        q[..., columns], v[..., columns] = directors.reshape(2, *samples, 9)
    lengths = {rope.coordinate for rope in equations.rig.ropes}
    for name in values:
        if name in equations.names and name not in lengths:
            q[..., equations.names.index(name)] = values[name]
            v[..., equations.names.index(name)] = rates[name]
    _complete(equations, q, v)
    return q, v


def completed(equations: Equations, q: Array) -> Array:
    """Coordinates (..., n) with those that follow from others, on rails and of ropes, renewed."""
    q, v = q.copy(), np.zeros_like(q)
    _complete(equations, q, v)
    return q


def _complete(equations: Equations, q: Array, v: Array) -> None:
    """Set the coordinates that follow from others, and their rates: on rails and of ropes."""
    _put_on_rails(equations, q, v)
    for rope, constraints in zip(equations.rig.ropes, equations.spans, strict=True):
        chords = [equations.points[b] - equations.points[a] for a, b in pairwise(rope.path)]
        spans = [_distance(chord, q, v) for chord in chords]
        last = rope.falls * spans[-1][0], rope.falls * spans[-1][1]
        whole, length = np.sum([*spans[:-1], last], axis=0), equations.names.index(rope.coordinate)
        for k, span in zip(constraints, spans, strict=True):
            i = equations.roles[k].coordinate
            q[..., i], v[..., i] = whole if i == length else span


def _check_names(rig: Rig, *tables: Mapping[str, Array]) -> None:
    lengths = {rope.coordinate for rope in rig.ropes}
    for names in tables:
        for name in rig.coordinate_names:
            if name not in lengths and name not in names:
                raise RigError(f"rig {rig.name}: coordinate {name} is missing")
        for name in names:
            if name not in rig.coordinate_names:
                known = did_you_mean(name, rig.coordinate_names)
                raise RigError(f"rig {rig.name} has no coordinate {name!r}{known}")


def _put_on_rails(equations: Equations, q: Array, v: Array) -> None:
    """Set the coordinates of frames on frames and trolleys on rails, whatever they were."""
    # Phi is the coordinate less what it follows from: an earlier one's, or a given one.
    for k in equations.with_role("frame", "rail"):
        i = equations.roles[k].coordinate
        slope = equations.constraint_jacobian(q)[..., k, :]
        q[..., i] -= equations.constraint_values(q)[..., k]
        v[..., i] -= np.einsum("...i,...i->...", slope, v)


def _distance(chord: Array, q: Array, v: Array) -> tuple[Array, Array]:
    """Length of an affine chord (3, n + 1) and its rate."""
    vector, speed = _with_one(q) @ chord.T, v @ chord[:, :-1].T
    length = np.asarray(np.linalg.norm(vector, axis=-1))
    return length, np.einsum("...i,...i->...", vector, speed) / length
