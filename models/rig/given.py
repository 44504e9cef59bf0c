"""What must hold of frames whose motion is given.

Raises
------
RigError
    What is wrong, in one line.
"""

from collections.abc import Sequence

from ..errors import RigError
from .parts import FRICTIONLESS, WORLD, Drive, Frame


def check_given(frames: Sequence[Frame], drives: Sequence[Drive], outputs: Sequence[str]) -> None:
    """They stand on nothing that can be pushed, and a path says what they do."""
    given = {frame.name for frame in frames if frame.given}
    for frame in frames:
        if not frame.given:
            continue
        label = f"frame {frame.name}, whose motion is given,"
        if frame.parent != WORLD and frame.parent not in given:
            raise RigError(f"{label} stands on {frame.parent}, whose motion is not; give that, too")
        drive = next((drive for drive in drives if drive.on == frame.name), None)
        if drive is None:
            raise RigError(f"{label} has no drive, whose input is its acceleration; add one")
        if drive.gear != 1.0 or drive.efficiency != 1.0:
            raise RigError(f"drive {drive.name}: {frame.name}'s motion is given, it has no gear")
        if frame.friction != FRICTIONLESS:
            raise RigError(f"{label} has friction, which cannot matter; leave it out")
        if frame.coordinate not in outputs:
            raise RigError(f"{label} needs {frame.coordinate} among the outputs")


def refuse_given(rig: str, frames: Sequence[Frame], what: str) -> None:
    """Refuse a moving base where it is not treated yet."""
    name = next((frame.name for frame in frames if frame.given), None)
    if name is not None:
        raise RigError(f"rig {rig} stands on {name}, whose motion is given: {what}")
