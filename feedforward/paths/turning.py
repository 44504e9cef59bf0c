"""A platform's turn about one fixed axis, as a path of its Bryant angles.

    path = three_phase(start=(..., 0, 0, 0), goal=(..., pi/6, pi/4, pi/3), duration=20, blend=5)
    turn = fixed_axis(path, columns=(3, 4, 5))

The two ends keep their orientations; in between the platform turns about the axis that joins
them by the shortest way (Y 6.72, 6.94 to 6.99), as far along as the path's other columns are.
Angles and their derivatives come from the rotation matrix by Taylor arithmetic, which fails only
where the platform's own axis x is vertical, beta = +-90 degrees.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from ...models.errors import PathError
from ...models.types import Array
from ..series.products import factorials
from ..series.rotation import about_axis, bryant
from .profiles import progress
from .reference import ReferencePath
from .straight import StraightPath

SMALLEST_COSINE = 1e-6
"""Of beta, below which a path is refused."""


@dataclass(frozen=True)
class FixedAxis(ReferencePath):
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

    def _rotation(self, end: tuple[float, ...]) -> Rotation:
        return Rotation.from_euler("XYZ", [end[column] for column in self.columns])

    def _derivatives(self, times: Array, order: int) -> Array:
        result = self.path.derivatives(times, order)
        if not self.axis.any():
            return result
        share = progress(self.path.profile, times, self.duration, order)
        rotation = self._rotation(self.path.begin).as_matrix() @ about_axis(self.axis, share)
        flat = np.hypot(rotation[0, ..., 0, 0], rotation[0, ..., 0, 1]) < SMALLEST_COSINE
        if flat.any():
            raise PathError(
                f"at t = {times[flat.argmax()]:.4g} s the platform's x axis is vertical, where its "
                "Bryant angles are singular; choose another orientation"
            )
        angles = bryant(rotation) * factorials(order + 1)[:, None, None]
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
