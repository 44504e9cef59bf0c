"""A platform's turn about one fixed axis, as a path of its Bryant angles.

    path = three_phase(start=(..., 0, 0, 0), goal=(..., pi/6, pi/4, pi/3), duration=20, blend=5)
    turn = fixed_axis(path, columns=(3, 4, 5))

The two ends keep their orientations; in between the platform turns about the axis that joins
them by the shortest way (Y 6.72, 6.94 to 6.99), as far along as the path's other columns are.
Angles and their derivatives come from the rotation matrix by Taylor arithmetic, which fails only
where the platform's own axis x is vertical, beta = +-90 degrees.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from ...models.errors import PathError
from ...models.types import Array
from ..checks import check_times
from ..series.rotation import bryant, sine_cosine
from .reference import OfPath, StraightPath

SMALLEST_COSINE = 1e-6
"""Of beta, below which a path is refused."""


@dataclass(frozen=True)
class FixedAxis(OfPath):
    """A straight path three of whose columns are the Bryant angles of a turn about one axis.

    Raises
    ------
    PathError
        The columns are not three of the path's, or an orientation is one at which
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
        self.derivatives(np.linspace(0.0, self.duration, 65), 0)

    @property
    def order(self) -> int:
        """Number of continuous derivatives."""
        return self.path.order

    @property
    def duration(self) -> float:
        """When the goal is reached [s]."""
        return self.path.duration

    @property
    def goal(self) -> Array:
        """Shape (size,); alpha and gamma within half a turn of zero."""
        return np.asarray(self(np.array([self.duration]))[0])

    @property
    def axis(self) -> Array:
        """Axis times angle of the whole turn, in the platform's axes at the start, (3,) [rad]."""
        first, last = (self._rotation(end) for end in (self.path.begin, self.path.end))
        return np.asarray((first.inv() * last).as_rotvec())

    def _rotation(self, end: tuple[float, ...]) -> Rotation:
        return Rotation.from_euler("XYZ", [end[column] for column in self.columns])

    def derivatives(self, times: ArrayLike, order: int) -> Array:
        """Values and derivatives up to `order`, see `Reference`.  Shape (order+1, N, size).

        Raises
        ------
        PathError
            Also where beta comes to +-90 degrees.
        """
        times = check_times(times)
        result = self.path.derivatives(times, order)
        shares = self.path.profile.derivatives(times / self.duration, order)[..., None, None]
        factorials = np.array([math.factorial(k) for k in range(order + 1)], dtype=float)
        spans = self.duration ** np.arange(order + 1)
        share = shares / (factorials * spans)[:, None, None, None]
        angle = float(np.linalg.norm(self.axis))
        if angle == 0.0:
            return result
        # Rodrigues: R = R0 (1 + sin(s) K + (1 - cos(s)) K K) with the axis' cross product K.
        cross = np.cross(np.eye(3), self.axis / angle)
        sin, cos = sine_cosine(angle * share)
        turn = sin * cross - cos * (cross @ cross)
        turn[0] += np.eye(3) + cross @ cross
        rotation = self._rotation(self.path.begin).as_matrix() @ turn
        flat = np.hypot(rotation[0, ..., 0, 0], rotation[0, ..., 0, 1]) < SMALLEST_COSINE
        if flat.any():
            raise PathError(
                f"at t = {times[flat.argmax()]:.4g} s the platform's x axis is vertical, where its "
                "Bryant angles are singular; choose another orientation"
            )
        angles = bryant(rotation) * factorials[:, None, None]
        result[..., list(self.columns)] = angles
        return result


def fixed_axis(path: StraightPath, columns: Sequence[int]) -> FixedAxis:
    """The path with the Bryant angles in three columns turned about one fixed axis.

    Raises
    ------
    PathError
        See `FixedAxis`.
    """
    return FixedAxis(path, tuple(columns))  # type: ignore[arg-type]
