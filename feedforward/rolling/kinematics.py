"""Contact geometry, rolling constraints, and the driftless system that they leave.

    rolling = Rolling.of(hand)
    rolling.input_names                      # ("w.x", "w.y", "p.x", ...), generalized velocities
    rolling.velocities(u, normals)           # of object, fingers and tips
    rolling.rates(state, u)                  # of a state, linear in u

With e the unit vector from the object's centre p to a contact, R and r the radii, w and v the
angular velocities of object and tip, and d the position of a finger, rolling without slipping
(K 2.7, 2.8) reads

    p' + R w x e = d'                        on a plate, whose e is constant
    p' + R w x e = d' - r v x e              on a tip, whose d is p + (R + r) e

so that e' = (R w + r v) x e / (R + r) on a tip, and a plate's contact moves over it with -R w x e.
In the coordinates (columns of the rotation, p, contact points, e, turns of the tips) every right
side is linear in the state with constant coefficients: the driftless system is X' = sum u_k A_k X,
its Lie brackets are commutators of the A_k, and no chart is ever singular.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...models.errors import RigError
from ...models.hand.hand import Hand, Plate, Tip
from ...models.types import Array

TOLERANCE = 1e-9
"""Pivots and singular values below this count as zero; constraints have numbers of order one."""


def cross_matrix(vector: Array) -> Array:
    """[a x], shape (..., 3, 3), of vectors (..., 3)."""
    return np.asarray(np.cross(vector[..., None, :], np.eye(3)).swapaxes(-1, -2))


def projector(directions: tuple[tuple[float, float, float], ...]) -> Array:
    """Projector onto the span of directions, shape (3, 3)."""
    if not directions:
        return np.zeros((3, 3))
    columns = np.array(directions).T
    return np.asarray(columns @ np.linalg.pinv(columns))


def constraint_matrix(hand: Hand, normals: Array) -> Array:
    """All velocity constraints A v = 0 with the contacts at `normals` (fingers, 3) (K 2.1, 2.8).

    v holds p' and w, then every finger's d', then every tip's angular velocity.  Rows: rolling at
    each contact, its normal part included, which keeps the contact; slides; axes of the tips; the
    plane of a planar hand; the excluded spin (K 2.14).  Shape (rows, 6 + 6 fingers).
    """
    count, size = len(hand.fingers), 6 + 6 * len(hand.fingers)
    rows = []
    for i, finger in enumerate(hand.fingers):
        turn = cross_matrix(normals[i])
        touch, slide, axis = np.zeros((3, 3, size))
        own, tip = slice(6 + 3 * i, 9 + 3 * i), slice(6 + 3 * (count + i), 9 + 3 * (count + i))
        touch[:, :3], touch[:, own] = np.eye(3), -np.eye(3)
        touch[:, 3:6] = -hand.held.radius * turn
        slide[:, own] = np.eye(3) - projector(finger.slides)
        axis[:, tip] = np.eye(3)
        if isinstance(finger.surface, Tip):
            touch[:, tip] = -finger.surface.radius * turn
            axis[:, tip] -= projector(finger.surface.axes)
        rows += [touch, slide, axis]
    extra = np.zeros((3, size))
    if hand.planar:
        extra[[0, 1, 2], [1, 3, 5]] = 1.0
    if not hand.spin:
        spinning = np.zeros((1, size))
        spinning[0, :6] = spin_direction(hand, normals)
        rows.append(spinning)
    return np.vstack([*rows, extra])


def spin_direction(hand: Hand, normals: Array) -> Array:
    """The motion (p', w) that pivots about all contacts at once, shape (6,) (K 2.13).

    Raises
    ------
    RigError
        There is none (K corollary 1), or more than one.
    """
    turn = cross_matrix(normals)
    identity = np.broadcast_to(np.eye(3), turn.shape)
    eta = np.block([[identity, -hand.held.radius * turn], [np.zeros_like(turn), -turn]])
    _, sizes, right = np.linalg.svd(eta.reshape(-1, 6))
    if (sizes > TOLERANCE).sum() != 5:
        raise RigError(
            f"hand {hand.name} cannot spin about all its {len(normals)} contacts at once, so "
            "there is no spin to exclude; leave spin=True"
        )
    direction = right[-1]
    return np.asarray(direction * np.sign(direction[np.abs(direction).argmax()]))


def free_motions(matrix: Array) -> tuple[Array, list[int]]:
    """A basis of the null space, (columns, m), whose inputs are m of the velocities themselves.

    Columns are eliminated from the first to the last, so the later ones stay free.
    """
    reduced = matrix.copy()
    row, pivots = 0, []
    for column in range(reduced.shape[1]):
        if row == len(reduced):
            break
        best = row + int(np.abs(reduced[row:, column]).argmax())
        if abs(reduced[best, column]) < TOLERANCE:
            continue
        reduced[[row, best]] = reduced[[best, row]]
        reduced[row] /= reduced[row, column]
        others = np.arange(len(reduced)) != row
        reduced[others] -= np.outer(reduced[others, column], reduced[row])
        pivots.append(column)
        row += 1
    free = [column for column in range(matrix.shape[1]) if column not in pivots]
    basis = np.zeros((matrix.shape[1], len(free)))
    basis[free, range(len(free))] = 1.0
    basis[pivots] = -reduced[: len(pivots), free]
    return basis, free


@dataclass(frozen=True, eq=False)
class Rolling:
    """The driftless system of a hand.

    Raises
    ------
    RigError
        Spin is to be excluded where the hand cannot spin.
    """

    hand: Hand
    """The hand."""
    basis: Array
    """Matrix from the inputs to p', w and the tips' angular velocities, (6 + 3 fingers, inputs)."""
    input_names: tuple[str, ...]
    """"p.x" [m/s] of the centre, "w.x" [rad/s] of the object, "NAME.w.x" of a tip, ..."""

    @classmethod
    def of(cls, hand: Hand) -> "Rolling":
        """Derive it from the constraints."""
        normals = np.array([finger.contact for finger in hand.fingers])
        full = constraint_matrix(hand, normals)
        count = len(hand.fingers)
        # Eliminating d' first leaves constraints on the object and the tips alone, in which the
        # moving contacts of round tips no longer occur: their slides go every way.
        order = [*range(6, 6 + 3 * count), *range(6), *range(6 + 3 * count, 6 + 6 * count)]
        basis, free = free_motions(full[:, order])
        keep = 3 * count
        names = [f"{part}.{axis}" for part in ("p", "w") for axis in "xyz"]
        names += [f"{finger}.w.{axis}" for finger in hand.finger_names for axis in "xyz"]
        return cls(hand, basis[keep:], tuple(names[column - keep] for column in free))

    def velocities(self, inputs: Array, normals: Array) -> Array:
        """All velocities of `constraint_matrix`, (6 + 6 fingers,), at contacts (fingers, 3)."""
        short = self.basis @ inputs
        moving, turning, tips = short[:3], short[3:6], short[6:].reshape(-1, 3)
        fingers = moving + self.hand.held.radius * np.cross(turning, normals)
        for i, finger in enumerate(self.hand.fingers):
            if isinstance(finger.surface, Tip):
                fingers[i] += finger.surface.radius * np.cross(tips[i], normals[i])
        return np.concatenate((short[:6], fingers.ravel(), tips.ravel()))

    @cached_property
    def blocks(self) -> dict[str, slice]:
        """Where the state's parts lie in X.

        "r0", "r1", "r2": columns of the rotation; "p"; for a plate "c.NAME", the contact point
        from its home in the plate; for a tip "e.NAME", the direction to the contact, and if it
        turns "q.NAME", its angular velocity integrated over time.  The last number in X is 1.
        """
        names = ["r0", "r1", "r2", "p"]
        for finger in self.hand.fingers:
            if isinstance(finger.surface, Plate):
                names.append(f"c.{finger.name}")
            else:
                names.append(f"e.{finger.name}")
                if finger.surface.axes:
                    names.append(f"q.{finger.name}")
        return {name: slice(3 * k, 3 * k + 3) for k, name in enumerate(names)}

    @cached_property
    def generators(self) -> Array:
        """The A_k, shape (inputs, size, size)."""
        size = 3 * len(self.blocks) + 1
        result = np.zeros((self.basis.shape[1], size, size))
        for matrix, column in zip(result, self.basis.T, strict=True):
            moving, turning, tips = column[:3], column[3:6], column[6:].reshape(-1, 3)
            for name in ("r0", "r1", "r2"):
                matrix[self.blocks[name], self.blocks[name]] = cross_matrix(turning)
            matrix[self.blocks["p"], -1] = moving
            for finger, tip in zip(self.hand.fingers, tips, strict=True):
                if isinstance(finger.surface, Plate):
                    touch = -self.hand.held.radius * np.cross(turning, finger.contact)
                    matrix[self.blocks[f"c.{finger.name}"], -1] = touch
                    continue
                place, radius = self.blocks[f"e.{finger.name}"], finger.surface.radius
                both = self.hand.held.radius * turning + radius * tip
                matrix[place, place] = cross_matrix(both / (self.hand.held.radius + radius))
                if finger.surface.axes:
                    matrix[self.blocks[f"q.{finger.name}"], -1] = tip
        return result

    def rates(self, state: Array, inputs: Array) -> Array:
        """X' at a state X, both (size,)."""
        return np.asarray(np.einsum("kij,k,j->i", self.generators, inputs, state))

    def state(self, rotation: Array, position: Array, **others: Array) -> Array:
        """X of a rotation (3, 3), a position (3,) and named blocks; blocks left out are zero."""
        result = np.zeros(3 * len(self.blocks) + 1)
        parts = {"r0": rotation[:, 0], "r1": rotation[:, 1], "r2": rotation[:, 2], "p": position}
        for name, value in (parts | others).items():
            result[self.blocks[name]] = value
        result[-1] = 1.0
        return result
