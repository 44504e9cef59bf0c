"""Exact feedforward: from a rig and a reference path to the inputs that follow it.

Example::

    rig = models.overhead_crane()
    path = feedforward.rest_to_rest((0, -4), (5, -1), duration=3.0, order=4)
    motion = feedforward.solve(rig, path, np.linspace(0, 3, 3001))
    motion.inputs, motion.tensions, motion.positions
"""

from .assembly import equations_of
from .equations import Equations, redundant
from .inverse import solve
from .motion import Motion, Slack
from .reference import Reference, from_move, hold, rest_to_rest, three_phase
from .sampled import from_csv, sampled
from .structure import Analysis, analyse
from .verification import residuals

__all__ = [
    "Analysis",
    "Equations",
    "Motion",
    "Reference",
    "Slack",
    "analyse",
    "equations_of",
    "from_csv",
    "from_move",
    "hold",
    "redundant",
    "residuals",
    "rest_to_rest",
    "sampled",
    "solve",
    "three_phase",
]
