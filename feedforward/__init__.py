"""Exact feedforward: from a rig and a reference path to the inputs that follow it.

Example::

    rig = models.overhead_crane()
    path = feedforward.rest_to_rest((0, -4), (5, -1), duration=3.0, order=4)
    motion = feedforward.solve(rig, path, np.linspace(0, 3, 3001))
    motion.inputs, motion.tensions, motion.positions
"""

from ..models.rig.obstacles import Box, Sphere
from .dae import Integration, integrate
from .exact.drive_limits import driven_unit
from .exact.equations import Equations, redundant
from .exact.motion import Motion, Slack
from .exact.problem import analyse, equations_of
from .exact.state import State
from .exact.structure import Analysis
from .exact.verification import residuals
from .paths.base_motion import BaseMotion
from .paths.continuing import Connected, Stopped, connected, stopped
from .paths.curves import Curve, CurvedPath, Polynomial, Waypoints, along, over
from .paths.moves import from_move
from .paths.profiles import Profile, RestToRest, ThreePhase
from .paths.recordings import from_csv, sampled
from .paths.reference import Reference
from .paths.straight import hold, rest_to_rest, three_phase
from .paths.waves import at_sea, base_at
from .planning.bisector import Beside, Bisected, beside, bisected, massless
from .planning.clearance import Clearance, clearance
from .planning.feasibility import Feasibility, check
from .planning.sizing import Sizing
from .planning.timing import Scaled, Shortest, scaled, shortest_duration
from .planning.uncertainty import input_uncertainty
from .solving.inverse import solve
from .solving.places import places_of
from .solving.source import source
from .solving.stepper import Step, Stepper
from .stability.energy import Regulator
from .streaming.record import Commanded
from .streaming.sample import Sample
from .streaming.stream import Stream

__all__ = [
    "Analysis",
    "BaseMotion",
    "Beside",
    "Bisected",
    "Box",
    "Clearance",
    "Commanded",
    "Connected",
    "Curve",
    "CurvedPath",
    "Equations",
    "Feasibility",
    "Integration",
    "Motion",
    "Polynomial",
    "Profile",
    "Reference",
    "Regulator",
    "RestToRest",
    "Sample",
    "Scaled",
    "Shortest",
    "Sizing",
    "Slack",
    "Sphere",
    "State",
    "Step",
    "Stepper",
    "Stopped",
    "Stream",
    "ThreePhase",
    "Waypoints",
    "along",
    "analyse",
    "at_sea",
    "base_at",
    "beside",
    "bisected",
    "check",
    "clearance",
    "connected",
    "driven_unit",
    "equations_of",
    "from_csv",
    "from_move",
    "hold",
    "input_uncertainty",
    "integrate",
    "massless",
    "over",
    "places_of",
    "redundant",
    "residuals",
    "rest_to_rest",
    "sampled",
    "scaled",
    "shortest_duration",
    "solve",
    "source",
    "stopped",
    "three_phase",
]
