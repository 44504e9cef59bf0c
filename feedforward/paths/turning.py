"""A platform's turn about one fixed axis, as a path of its Bryant angles.

    path = three_phase(start=(..., 0, 0, 0), goal=(..., pi/6, pi/4, pi/3), duration=20, blend=5)
    turn = fixed_axis(path, columns=(3, 4, 5))

The two ends keep their orientations; in between the platform turns about the axis that joins
them by the shortest way (Y 6.72, 6.94 to 6.99), as far along as the path's other columns are.
Angles and their derivatives come from the rotation matrix by Taylor arithmetic, which fails only
where beta = +-90 degrees.  They start as they are given and go on without a jump, past half a turn,
too.  Along a turn every entry of the matrix is a constant and a sine of the angle turned by: so it
is told from all of it, not from instants, whether it is singular and where an angle passes half a
turn.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ...models.errors import PathError
from ...models.types import Array
from ..series.products import factorials
from ..series.rotation import about_axis, bryant
from .profiles import progress
from .reference import ReferencePath
from .straight import StraightPath

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

SMALLEST_COSINE = 1e-6
"""Of beta, below which a path is refused."""
OUTER = [0, 2]
"""Places of alpha and gamma, which may pass half a turn."""


@dataclass(frozen=True)
class FixedAxis(ReferencePath):
    """A straight path three of whose columns are the Bryant angles of a turn about one axis.

    Raises
    ------
    PathError
        The columns are not three of the path's, or the turn passes an orientation at which
        Bryant angles are singular.
    """

    path: StraightPath
    columns: tuple[int, int, int]

    def __post_init__(self) -> None:
        known = range(self.path.size)
        if len(set(self.columns)) != 3 or not all(column in known for column in self.columns):
            raise PathError(
                f"columns are {self.columns}, they must be three of 0 to {self.path.size - 1}"
            )
        self._stay_regular()

    @property
    def order(self) -> int:
        """Number of continuous derivatives."""
        return self.path.order

    @property
    def duration(self) -> float:
        """When the goal is reached [s]."""
        return self.path.duration

    @property
    def size(self) -> int:
        """Number of columns."""
        return self.path.size

    @property
    def start(self) -> Array:
        """Where the path rests for t <= 0.  Shape (size,)."""
        return self.path.start

    @property
    def axis(self) -> Array:
        """Axis times angle of the whole turn, in the platform's axes at the start, (3,) [rad]."""
        first, last = (self._rotation(end) for end in (self.path.begin, self.path.end))
        return np.asarray((first.inv() * last).as_rotvec())

    def _rotation(self, end: tuple[float, ...]) -> "Rotation":
        return scipy.spatial.transform.Rotation.from_euler(
            "XYZ", [end[column] for column in self.columns]
        )

    def _derivatives(self, times: Array, order: int) -> Array:
        result = self.path.derivatives(times, order)
        if not self.axis.any():
            return result
        share = self._share(times, order)
        rotation = self._turned(share)
        angles = bryant(rotation) * factorials(order + 1)[:, None, None]
        angles[..., 1] *= self._side
        angles[0, :, 1] += np.pi * np.round(self._begin[1] / np.pi)
        angles[0][:, OUTER] = self._continued(rotation[0], share[0])
        result[..., list(self.columns)] = angles
        return result

    def _share(self, times: Array, order: int) -> Array:
        """How much of the turn is made, as Taylor coefficients, shape (order + 1, N)."""
        return progress(self.path.profile, times, self.duration, order)

    def _turned(self, share: Array) -> Array:
        """Rotation matrices (orders, N, 3, 3) when so much of the turn is made, (orders, N)."""
        return np.asarray(
            self._rotation(self.path.begin).as_matrix() @ about_axis(self.axis, share)
        )

    @property
    def _begin(self) -> Array:
        """Angles at the start, (3,)."""
        return np.array([self.path.begin[column] for column in self.columns])

    @property
    def _side(self) -> float:
        """Sign of cos(beta), which stays."""
        return float(np.sign(np.cos(self._begin[1])))

    def _sides(self, rotation: Array) -> tuple[Array, Array]:
        """Sine and cosine, times |cos(beta)|, of how far alpha and gamma are from their start.

        They are linear in the matrices (N, 3, 3), and (N, 2) each.
        """
        sines = -self._side * rotation[:, [1, 0], [2, 1]]
        cosines = self._side * rotation[:, [2, 0], [2, 0]]
        sin, cos = np.sin(self._begin[OUTER]), np.cos(self._begin[OUTER])
        return sines * cos - cosines * sin, cosines * cos + sines * sin

    def _continued(self, rotation: Array, share: Array) -> Array:
        """Alpha and gamma (N, 2) without jumps, of (N, 3, 3) when so much of the turn is made."""
        sines, cosines = self._sides(rotation)
        half, way = self._half_turns
        passed = (share[:, None] > 0.5 * half) & (way * sines < 0.0)
        turned = np.arctan2(sines, cosines) + 2.0 * np.pi * way * passed
        return np.asarray(self._begin[OUTER] + turned)

    @cached_property
    def _half_turns(self) -> tuple[Array, Array]:
        """Share of the turn at which alpha and gamma pass half a turn, and which way, (2,) each.

        The sine, 0 at the start, is b sin(p) + c (1 - cos(p)) at an angle p of the turn, and 0
        again where tan(p / 2) = -b / c.
        """
        angle = float(np.linalg.norm(self.axis))
        series = self._turned(np.array([[0.0], [1.0 / angle], [0.0]]))[:, 0]
        (_, b, c), _ = self._sides(series)
        half = 2.0 * (np.arctan2(b, -2.0 * c) % np.pi) / angle
        _, cosines = self._sides(self._turned(np.minimum(half, 1.0)[None])[0])
        way = np.where((half < 1.0) & (np.diagonal(cosines) < 0.0), np.sign(b), 0.0)
        return half, way

    def _stay_regular(self) -> None:
        """Refuse a turn that passes beta = +-90 degrees, at whatever instant.

        Raises
        ------
        PathError
            It does.
        """
        angle = float(np.linalg.norm(self.axis))
        if not angle:
            return
        # sin(beta) turns back where its first two derivatives by the angle say so, and at the ends.
        slope, bend = self._turned(np.array([[0.0], [1.0 / angle], [0.0]]))[1:, 0, 0, 2]
        back = np.arctan2(slope, -2.0 * bend) % np.pi
        shares = np.array([0.0, min(back / angle, 1.0), 1.0])
        rotation = self._turned(shares[None])[0]
        flat = np.hypot(rotation[:, 0, 0], rotation[:, 0, 1]) < SMALLEST_COSINE
        if flat.any():
            first = int(flat.argmax())
            beta = float(np.degrees(np.arcsin(np.clip(rotation[first, 0, 2], -1.0, 1.0))))
            raise PathError(
                f"at t = {self._reached(float(shares[first])):.4g} s the platform's beta is "
                f"{beta:.4g} degrees, where its Bryant angles are singular; choose another "
                "orientation, or let each angle go its own way"
            )

    def _reached(self, share: float) -> float:
        """When so much of the turn is made [s]."""
        if share in (0.0, 1.0):
            return share * self.duration

        def left(time: float) -> float:
            return float(self._share(np.array([time]), 0)[0, 0]) - share

        return float(scipy.optimize.brentq(left, 0.0, self.duration))


def fixed_axis(path: StraightPath, columns: Sequence[int]) -> FixedAxis:
    """The path with the Bryant angles in three columns turned about one fixed axis.

    Raises
    ------
    PathError
        See `FixedAxis`.
    """
    return FixedAxis(path, tuple(columns))  # type: ignore[arg-type]
