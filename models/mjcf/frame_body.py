"""Mass and inertia of a frame's body in a rig's MuJoCo model."""

from typing import Any

import numpy as np

from ..rig.frames import tensor
from ..rig.rig import WORLD, Frame

FRAME_MASS = 1e-9
"""Mass of a turning frame's body [kg].  MuJoCo needs some; the frame's inertia is its joint's
armature, to which this adds nothing that counts."""

CARRIED_MASS = 1e-14
"""The same of one on another frame, which has to move it [kg], and of its moments [kg m2]."""

FLAT = 1e-12
"""Share of a frame's moments of inertia by which each is made larger: MuJoCo refuses a flat or thin
body, whose moments only just exist."""


def give_inertia(body: Any, frame: Frame) -> None:
    """A frame's body; what a turning frame's single number says is its joint's armature."""
    nested = frame.parent != WORLD or frame.given
    least = CARRIED_MASS if nested else FRAME_MASS
    body.mass = frame.mass or (least if frame.kind == "turning" or frame.given else frame.along)
    body.ipos = frame.centre
    if nested or frame.mass:
        body.inertia = [CARRIED_MASS] * 3
    if isinstance(frame.inertia, tuple):
        moments = tensor(frame.inertia)
        moments += (CARRIED_MASS + FLAT * np.trace(moments)) * np.eye(3)
        if np.any(moments - np.diag(np.diag(moments))):
            body.inertia = np.zeros(3)
            body.fullinertia = moments[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        else:
            body.inertia = np.diag(moments)
