"""The motion of a hand and its object: poses, contacts and fingers at N instants."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ...models.files import replacing
from ...models.hand.hand import Hand
from ...models.hand.move import HandMove
from ...models.types import Array
from ..series.rotation import rpy_angles

AXES = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class HandMotion:
    """Everything about a hand at N instants, in SI units and axes fixed in space unless said.

    Arrays of fingers have shape (N, fingers, 3), fingers in the order of `Hand.finger_names`.
    """

    hand: Hand
    """The hand that moves."""
    move: HandMove
    """The move that was planned."""
    times: Array
    """Instants [s], shape (N,)."""
    position: Array
    """Position of the object's centre [m], shape (N, 3)."""
    velocity: Array
    """Velocity of the object's centre [m/s], shape (N, 3)."""
    acceleration: Array
    """Acceleration of the object's centre [m/s^2], shape (N, 3)."""
    rotation: Array
    """Rotation matrix of the object, whose columns are its axes, shape (N, 3, 3)."""
    angular_velocity: Array
    """Angular velocity of the object [rad/s], shape (N, 3)."""
    angular_acceleration: Array
    """Angular acceleration of the object [rad/s^2], shape (N, 3)."""
    normals: Array
    """Unit vectors from the object's centre to each contact."""
    finger_positions: Array
    """Positions of the plates' middles and the tips' centres [m]."""
    finger_velocities: Array
    """Their velocities [m/s]."""
    finger_accelerations: Array
    """Their accelerations [m/s^2]."""
    tip_velocities: Array
    """Angular velocities of tips [rad/s]; zero for plates and fixed tips."""
    tip_accelerations: Array
    """Angular accelerations of tips [rad/s^2]."""
    tip_turns: Array
    """Angular velocities of tips integrated over time, axis by axis [rad] (K's q4, q5)."""
    quadrature_error: float
    """Bound of the error of all integrals of angular velocities [rad]."""
    notes: tuple[str, ...]
    """Where the plan did something beyond its recipe."""

    @property
    def rpy(self) -> Array:
        """(phi, theta, psi) of the object [rad], phi and psi continuous in time, shape (N, 3)."""
        return self._continuous(rpy_angles(self.rotation))

    @property
    def angle(self) -> Array:
        """Angle of a planar hand's object, positive from x to z [rad], shape (N,)."""
        return self._continuous(np.arctan2(self.rotation[:, 2, 0], self.rotation[:, 0, 0]))

    def _continuous(self, angles: Array) -> Array:
        """Angles (N, ...) without jumps of a whole turn from each instant to the next."""
        order = np.argsort(self.times, kind="stable")
        result = np.empty_like(angles)
        result[order] = np.unwrap(angles[order], axis=0)
        return result

    def earliest(self, wrong: ArrayLike) -> int | None:
        """Index of the earliest instant at which something is wrong (N,), None if nowhere."""
        indices = np.flatnonzero(wrong)
        return int(indices[np.argmin(self.times[indices])]) if len(indices) else None

    @property
    def contacts(self) -> Array:
        """Contact points in space [m]."""
        return self.position[:, None] + self.hand.held.radius * self.normals

    @property
    def contacts_on_object(self) -> Array:
        """Contact points from the object's centre, in its axes [m]."""
        turned = np.einsum("nji,nfj->nfi", self.rotation, self.normals)
        return np.asarray(self.hand.held.radius * turned)

    @property
    def contacts_on_fingers(self) -> Array:
        """Contact points from each finger's position, in axes that do not turn with a tip [m]."""
        return self.contacts - self.finger_positions

    @property
    def column_names(self) -> tuple[str, ...]:
        """Names of the columns of `table`."""
        names = ["time"]
        for part in ("object", "object.v", "object.a"):
            names += [f"{part}.{axis}" for axis in AXES]
        names += [f"object.R{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)]
        names += [f"object.{angle}" for angle in ("phi", "theta", "psi")]
        for part in ("object.w", "object.w_dot"):
            names += [f"{part}.{axis}" for axis in AXES]
        for kind in self._of_fingers():
            for finger in self.hand.finger_names:
                names += [f"{finger}.{kind}.{axis}" for axis in AXES]
        return tuple(names)

    def _of_fingers(self) -> dict[str, Array]:
        return {
            "position": self.finger_positions,
            "velocity": self.finger_velocities,
            "acceleration": self.finger_accelerations,
            "tip_velocity": self.tip_velocities,
            "tip_turn": self.tip_turns,
            "contact_on_object": self.contacts_on_object,
            "contact_on_finger": self.contacts_on_fingers,
        }

    @property
    def table(self) -> Array:
        """All of it, one row an instant, columns `column_names`."""
        count, fingers = len(self.times), len(self.hand.fingers)
        parts = [
            self.times[:, None],
            self.position,
            self.velocity,
            self.acceleration,
            self.rotation.reshape(count, 9),
            self.rpy,
            self.angular_velocity,
            self.angular_acceleration,
            *(array.reshape(count, 3 * fingers) for array in self._of_fingers().values()),
        ]
        return np.concatenate(parts, axis=1)

    def to_csv(self, path: str | Path) -> None:
        """Write `table`.

        Raises
        ------
        OutputError
            The file cannot be written.
        """
        with replacing(path) as beside:
            header = ",".join(self.column_names)
            np.savetxt(beside, self.table, "%.17g", ",", header=header, comments="")
