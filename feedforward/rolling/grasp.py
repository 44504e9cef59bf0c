"""Contact forces that make a planned motion, and whether they stay in the friction cones.

    forces = least_norm(motion)              # as K in examples 7 and 8
    forces.friction_use, forces.outside      # they may pull or slip
    forces = in_cones(motion)                # `cones`: forces that do not

The object's motion fixes the forces up to internal ones, which cancel: B f = w (K 2.48, 2.49), with
f = f0 + Z z, f0 of least norm and the columns of Z a basis of the null space of B.  Arms are those
in space; K prints B with contact points in the object's axes, which is B only while it is upright.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ...models.errors import PathError
from ...models.types import Array
from .hand_motion import HandMotion
from .kinematics import cross_matrix

RANK_TOLERANCE = 1e-9
"""Singular values of B below this count as zero, moments divided by the object's radius."""
UNBALANCED = 1e-8
"""Share of the weight that may be left over through rounding."""
OUTSIDE = 1e-6
"""Share of the weight by which forces may leave the cones through the solver's tolerance."""


class Outside(NamedTuple):
    """How a finger's force leaves its friction cone, of all fingers the first to do so."""

    finger: str
    """Name of the finger."""
    time: float
    """Time of the first instant outside [s]."""
    excess: float
    """Largest tangential force beyond what friction allows [N]."""
    normal: float
    """Least normal force, pulling if < 0 [N]."""

    def __str__(self) -> str:
        pulls = f", which pulls with up to {-self.normal:.3g} N" if self.normal < 0 else ""
        return (
            f"from t = {self.time:.4g} s on the force of finger {self.finger}{pulls} leaves its "
            f"friction cone by up to {self.excess:.3g} N"
        )


@dataclass(frozen=True, eq=False)
class ContactForces:
    """Forces of the fingers on the object along a motion."""

    motion: HandMotion
    """The motion that the forces make."""
    values: Array
    """Forces in axes fixed in space [N], shape (N, fingers, 3)."""

    @property
    def normal(self) -> Array:
        """How hard each finger presses [N], shape (N, fingers)."""
        return np.asarray(-(self.values * self.motion.normals).sum(axis=-1))

    @property
    def tangential(self) -> Array:
        """Size of the tangential force of each finger [N], shape (N, fingers)."""
        rest = self.values + self.normal[..., None] * self.motion.normals
        return np.asarray(np.linalg.norm(rest, axis=-1))

    @property
    def friction_use(self) -> Array:
        """Tangential over normal force, infinite where a finger does not press; (N, fingers)."""
        normal = self.normal
        return np.where(normal > 0, self.tangential / np.where(normal > 0, normal, 1.0), np.inf)

    @property
    def cosines(self) -> Array:
        """Cosines of the angles between forces and outward normals (K 2.19); below 0 it presses.

        Shape (N, fingers).
        """
        sizes = np.linalg.norm(self.values, axis=-1)
        return np.asarray(-self.normal / np.where(sizes > 0, sizes, 1.0))

    @property
    def outside(self) -> Outside | None:
        """Where the forces first leave the friction cones, as far as the samples show it."""
        excess = self.tangential - self.motion.hand.friction * self.normal
        least = OUTSIDE * weight_of(self.motion)
        i = self.motion.earliest((excess > least).any(axis=1))
        if i is None:
            return None
        k = int(excess[i].argmax())
        name = self.motion.hand.finger_names[k]
        time, normal = float(self.motion.times[i]), float(self.normal[:, k].min())
        return Outside(name, time, float(excess[:, k].max()), normal)


def weight_of(motion: HandMotion) -> float:
    """The unit of forces [N]: the weight, or what the motion needs if that is more."""
    body = motion.hand.held
    needed = wrench(motion)
    sizes = [np.linalg.norm(needed[:, :3], axis=1), np.linalg.norm(needed[:, 3:], axis=1)]
    most = [float(size.max(initial=0.0)) for size in sizes]
    weight = body.mass * float(np.linalg.norm(motion.hand.gravity))
    return max(weight, most[0], most[1] / body.radius) or body.mass


def wrench(motion: HandMotion) -> Array:
    """Force [N] and moment about the centre [N m] that the motion needs, (N, 6) (K 2.48, 2.49)."""
    body = motion.hand.held
    force = body.mass * (motion.acceleration - np.array(motion.hand.gravity))
    return np.concatenate((force, body.inertia * motion.angular_acceleration), axis=1)


def grasp_matrix(motion: HandMotion) -> Array:
    """B, from all fingers' forces to force and moment on the object, (N, 6, 3 fingers)."""
    count, fingers = motion.normals.shape[:2]
    arms = motion.hand.held.radius * cross_matrix(motion.normals)
    identity = np.broadcast_to(np.eye(3), arms.shape)
    both = np.concatenate((identity, arms), axis=2)
    return both.transpose(0, 2, 1, 3).reshape(count, 6, 3 * fingers)


class Factors(NamedTuple):
    """B with moments over the object's radius, and its singular value decomposition."""

    matrix: Array
    """B, (N, 6, 3 fingers)."""
    u: Array
    sizes: Array
    vt: Array

    def at(self, which: Any) -> "Factors":
        """Those of some instants."""
        return Factors(*(part[which] for part in self))


def factors(motion: HandMotion) -> Factors:
    """Factors of all instants; B is decomposed once where contacts stay where they are."""
    moved = (motion.normals[1:] != motion.normals[:-1]).any(axis=(1, 2))
    places = np.flatnonzero(np.concatenate(([True], moved))[: len(motion.normals)])
    matrix = grasp_matrix(motion)
    matrix[:, 3:] /= motion.hand.held.radius
    if motion.hand.planar:
        matrix[:, [1, 3, 5]] = 0.0
        matrix[:, :, 1::3] = 0.0
    kept = Factors(matrix[places], *np.linalg.svd(matrix[places]))
    return kept.at(np.searchsorted(places, np.arange(len(matrix)), side="right") - 1)


def split(motion: HandMotion, known: Factors | None = None) -> tuple[Array, Array]:
    """Forces of least norm (N, 3 fingers), and bases Z of the internal ones, (N, 3 fingers, k).

    `known` are the factors of the motion's contacts, found anew if left out.

    Raises
    ------
    PathError
        No forces at the contacts give the wrench that the motion needs.
    """
    matrix, u, sizes, vt = factors(motion) if known is None else known
    right = wrench(motion)
    right[:, 3:] /= motion.hand.held.radius
    weak = sizes < RANK_TOLERANCE
    gain = np.where(weak, 0.0, 1.0 / np.where(weak, 1.0, sizes))
    count = sizes.shape[1]
    along = np.einsum("nij,ni->nj", u, right)[:, :count]
    forces = np.einsum("nkj,nk->nj", vt[:, :count], gain * along)
    error = right - np.einsum("nij,nj->ni", matrix, forces)
    worst = np.abs(error).max(axis=1)
    if worst.max(initial=0.0) > UNBALANCED * weight_of(motion):
        raise _unbalanced(motion, error, worst)
    null = vt.copy()
    null[:, :count][~weak] = 0.0
    if motion.hand.planar:
        null[:, :, 1::3] = 0.0
    columns = np.abs(null).max(axis=(0, 2)) > 0
    return forces, null[:, columns].swapaxes(1, 2)


def _unbalanced(motion: HandMotion, error: Array, worst: Array) -> PathError:
    """The refusal of a wrench that the contacts cannot give, with the largest part of it."""
    start = motion.times[(worst > UNBALANCED * weight_of(motion)).argmax()]
    i = int(worst.argmax())
    force, moment = error[i, :3], error[i, 3:] * motion.hand.held.radius
    what = f"a moment of {np.linalg.norm(moment):.3g} N m"
    axis = moment / max(float(np.linalg.norm(moment)), 1e-300)
    if np.linalg.norm(force) > np.linalg.norm(error[i, 3:]):
        what, axis = f"a force of {np.linalg.norm(force):.3g} N", force / np.linalg.norm(force)
    words = ", ".join(f"{value:.2g}" for value in axis + 0.0)
    fingers = " and ".join(motion.hand.finger_names)
    return PathError(
        f"hand {motion.hand.name} cannot make the motion from t = {start:.4g} s on: the contacts "
        f"of {fingers} cannot give {what} along ({words}), needed at t = {motion.times[i]:.4g} s, "
        "whatever the friction"
    )


def least_norm(motion: HandMotion) -> ContactForces:
    """Contact forces of the smallest sum of squares, wherever they point (K example 7, 8).

    Raises
    ------
    PathError
        No forces at the contacts give what the motion needs.
    """
    forces, _ = split(motion)
    return ContactForces(motion, forces.reshape(motion.normals.shape))
