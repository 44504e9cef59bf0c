"""How an object turns from one orientation to another: by RPY angles, or about one axis.

A path gives its rotation as a Taylor series in time; that is regular everywhere, also where the
RPY angles are not.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy.spatial.transform import Rotation

from ...models.hand.move import HandMove
from ...models.types import Array
from ..series.products import between, matmul
from ..series.rotation import about_axis, rotation_of, rpy_matrix
from .progress import ORDERS, share

Axes = tuple[tuple[float, ...], ...]
"""Rows of a rotation, hashable."""


class Turning(Protocol):
    """A path of orientations from rest to rest."""

    @property
    def note(self) -> str:
        """How the path departs from its recipe; empty if it does not."""

    def rotation(self, times: Array, orders: int = ORDERS) -> Array:
        """Taylor series of the rotation, shape (orders, N, 3, 3)."""


@dataclass(frozen=True)
class ByAngles:
    """RPY angles from rest to rest on one polynomial (K 2.102)."""

    move: HandMove
    note: str = ""

    def rotation(self, times: Array, orders: int = ORDERS) -> Array:
        """See `Turning`."""
        part = share(self.move, times, orders)
        return rpy_matrix(between(np.array(self.move.start), np.array(self.move.goal), part))


@dataclass(frozen=True)
class AboutAxis:
    """A turn about one axis fixed in space, the shortest way in space, as given in the plane."""

    move: HandMove
    note: str = ""

    @cached_property
    def vector(self) -> Array:
        """Axis times angle, (3,)."""
        if len(self.move.goal) == 1:
            return np.array([0.0, self.move.start[0] - self.move.goal[0], 0.0])
        turn = rotation_of(self.move.goal) @ rotation_of(self.move.start).T
        return np.asarray(Rotation.from_matrix(turn).as_rotvec())

    def turned(self, part: Array, factor: float) -> Array:
        """Rotation about the same axis by `factor` times the angle, (orders, N, 3, 3).

        Takes the series of the share of the move that is done, (orders, N).
        """
        return about_axis(factor * self.vector, part)

    def rotation(self, times: Array, orders: int = ORDERS) -> Array:
        """See `Turning`."""
        return self.turned(share(self.move, times, orders), 1.0) @ rotation_of(self.move.start)


def in_axes(rotation: Array, axes: Axes | None) -> Array:
    """Series of a rotation times the constant one of other axes of the object, if any."""
    if axes is None:
        return rotation
    series = np.zeros((len(rotation), 1, 3, 3))
    series[0] = axes
    return matmul(rotation, series)
