"""The motion of a hand and its object: poses, contacts and fingers at N instants."""

from collections.abc import Iterator, Sequence
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
        return tuple(name for name, _ in self._columns())

    @property
    def table(self) -> Array:
        """All of it, one row an instant, columns `column_names`."""
        return np.stack([values for _, values in self._columns()], axis=1)

    def _columns(self) -> Iterator[tuple[str, Array]]:
        """Name and values (N,) of every column."""
        yield "time", self.times
        yield from _named("object", AXES, self.position)
        yield from _named("object.v", AXES, self.velocity)
        yield from _named("object.a", AXES, self.acceleration)
        entries = [f"R{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)]
        yield from _named("object", entries, self.rotation.reshape(-1, 9))
        yield from _named("object", ("phi", "theta", "psi"), self.rpy)
        yield from _named("object.w", AXES, self.angular_velocity)
        yield from _named("object.w_dot", AXES, self.angular_acceleration)
        for kind, values in (
            ("position", self.finger_positions),
            ("velocity", self.finger_velocities),
            ("acceleration", self.finger_accelerations),
            ("tip_velocity", self.tip_velocities),
            ("tip_turn", self.tip_turns),
            ("contact_on_object", self.contacts_on_object),
            ("contact_on_finger", self.contacts_on_fingers),
        ):
            for i, finger in enumerate(self.hand.finger_names):
                yield from _named(f"{finger}.{kind}", AXES, values[:, i])

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


def _named(owner: str, entries: Sequence[str], values: Array) -> Iterator[tuple[str, Array]]:
    """Columns OWNER.ENTRY of values (N, entries)."""
    return ((f"{owner}.{entry}", column) for entry, column in zip(entries, values.T, strict=True))
