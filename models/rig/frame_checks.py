"""What must hold of frames, and of the inertia tensor of any body.

Raises
------
RigError
    From every check: what is wrong, in one line.
"""

import math
from collections.abc import Sequence

import numpy as np

from ..errors import RigError, did_you_mean
from ..values import Vector
from .frames import about_axis, second_moments, tensor
from .parts import Frame

TOLERANCE = 1e-9
"""Share of a tensor by which rounding may make a flat body's moments impossible."""


def check_frame(label: str, frame: Frame, frames: Sequence[str], *, planar: bool) -> None:
    """A frame stands on one that exists, named among `frames`, and moves along or about an axis."""
    if frame.kind not in ("turning", "sliding"):
        raise RigError(f"{label}: kind is {frame.kind!r}, it must be turning or sliding")
    if frame.parent not in frames:
        known = [name for name in frames if name != frame.name]
        raise RigError(
            f"{label}: parent is {frame.parent!r}, which does not exist"
            f"{did_you_mean(frame.parent, known)}"
        )
    _check_axis(label, frame.axis)
    if planar:
        _check_plane(label, frame)
    _check_inertia(label, frame)


def _check_axis(label: str, axis: Vector) -> None:
    size = math.hypot(*axis)
    if size == 0:
        raise RigError(f"{label}: axis is {tuple(axis)}, it has no length and no direction")
    # Looser than rounding, so that directions written with ten digits pass.
    if abs(size - 1) > 1e-9:
        unit = ", ".join(f"{part / size:.12g}" for part in axis)
        raise RigError(f"{label}: axis is {tuple(axis)}, it must be a unit vector: ({unit})")


def _check_plane(label: str, frame: Frame) -> None:
    """In the plane y = 0 frames slide, or turn about y."""
    for vector in (frame.origin, frame.centre, *([frame.axis] * (frame.kind == "sliding"))):
        if vector[1] != 0:
            raise RigError(f"{label}: y is {vector[1]:g}, a planar rig lies in the plane y = 0")
    if frame.kind == "turning" and (frame.axis[0] != 0 or frame.axis[2] != 0):
        raise RigError(
            f"{label}: axis is {tuple(frame.axis)}, a planar rig has no turning frame but about "
            "(0, 1, 0) or (0, -1, 0)"
        )


def _check_inertia(label: str, frame: Frame) -> None:
    """It has a mass, or a moment of inertia about its axis, and only one of each."""
    unit = "kg m2" if frame.kind == "turning" else "kg"
    if frame.mass < 0:
        raise RigError(f"{label}: mass is {frame.mass:g} kg, it must be >= 0")
    if not frame.mass and frame.centre != (0.0, 0.0, 0.0):
        raise RigError(f"{label}: centre is {frame.centre} m of a mass of 0 kg; give its mass, too")
    if isinstance(frame.inertia, tuple):
        check_tensor(label, frame.inertia)
        if not frame.mass:
            raise RigError(f"{label}: mass is 0 kg, a body with an inertia tensor needs one > 0")
    elif frame.kind == "sliding" and frame.mass and frame.inertia:
        raise RigError(
            f"{label}: its mass is given twice, as mass {frame.mass:g} kg and as inertia "
            f"{frame.inertia:g} kg; leave one out"
        )
    elif frame.along < 0 or not (frame.along or frame.mass or frame.given):
        raise RigError(f"{label}: inertia is {frame.along:g} {unit}, it must be > 0")
    if frame.kind == "turning" and not (frame.given or about_axis(frame) > 0):
        raise RigError(
            f"{label}: it has no inertia about its axis, on which all of its mass lies; give it an "
            "inertia > 0 kg m2"
        )


def check_tensor(label: str, inertia: tuple[float, ...]) -> None:
    """Three or six numbers are the inertia of a body: no mass of it is negative."""
    if len(inertia) not in (3, 6):
        raise RigError(
            f"{label}: inertia has {len(inertia)} numbers, it needs 1 about the axis, 3 (xx, yy, "
            "zz) or 6 (xx, yy, zz, xy, xz, yz)"
        )
    matrix = tensor(inertia)
    size = float(np.abs(matrix).max())
    if np.linalg.eigvalsh(second_moments(matrix))[0] < -TOLERANCE * size:
        raise RigError(
            f"{label}: inertia is {inertia}, which no body has: no principal moment can exceed "
            "the sum of the others"
        )
