"""What the rigs of the catalogue are asked to do: moves that they can make, and printed ones.

Sources: Y = Yang 2016, K = Kiss 2001.
"""

import math

from .move import Move

_ROOT3 = math.sqrt(3.0)
_PLATFORM, _SPREAD = (1.0 + 0.2 * _ROOT3, 1.2, -3.0), 0.6 * _ROOT3
_OVERHEAD_MOVE = Move(start=(0.0, -4.0), goal=(5.0, -1.0), duration=3.0)
_ROTARY_MOVE = Move(
    start=(5.0, 0.0, -5.0), goal=(-2.0, 2.0, -2.0), duration=20.0, profile="three_phase"
)

MOVES: dict[str, Move] = {
    "overhead_crane": _OVERHEAD_MOVE,
    "roped_overhead_crane": _OVERHEAD_MOVE,
    "rotary_crane": _ROTARY_MOVE,
    "extended_rotary_crane": _ROTARY_MOVE,
    "cantilever_crane": Move(
        start=(5.0, 0.0, -5.0), goal=(2.0, 4.0, -2.0), duration=20.0, profile="three_phase"
    ),
    "gantry_crane": Move(
        start=(5.0, 0.0, -5.0), goal=(1.0, 2.0, -2.0), duration=20.0, profile="three_phase"
    ),
    "navy_crane_2d": Move(
        start=(-2.5 * _ROOT3, -22.5, -12.5), goal=(-7.0, -17.5, -10.5), duration=5.0
    ),
    "navy_crane_3d": Move(
        start=(5.0 * _ROOT3, 0.0, -15.0, 2.5),
        goal=(-2.0, 4.0 * _ROOT3, -13.0, 2.5),
        duration=20.0,
        order=6,
    ),
    "cable_manipulator": Move(
        start=(*_PLATFORM, 0.0, 0.0, 0.0, _SPREAD),
        goal=(3.0 + 0.2 * _ROOT3, 5.0, -1.0, 0.0, 0.0, 0.0, _SPREAD),
        duration=20.0,
        profile="three_phase",
    ),
}
"""A move for each rig of the catalogue that its ropes and drives can make.

Those of the overhead and rotary cranes are the sources' (Y 4.107, 4.123 to 4.128, 5.142); the Navy
cranes' printed moves (`PRINTED_MOVES`) need ropes that push, and a rougher path than the crane in
space can follow.  CABLEV's is the sources' move (b) (Y 6.3.7).
"""

PRINTED_MOVES: dict[str, Move] = {
    "navy_crane_2d": Move(
        start=(-2.5 * _ROOT3, -22.5, -12.5), goal=(-1.0, -17.5, -10.5), duration=3.0
    ),
    "navy_crane_3d": Move(
        start=(5.0 * _ROOT3, 0.0, -15.0, 2.5),
        goal=(-2.0, 4.0 * _ROOT3, -13.0, 1.5),
        duration=20.0,
        profile="three_phase",
    ),
}
"""The sources' moves that cannot be made (Y 6.22, 6.23; 6.34 to 6.39 with z0 of 6.2.2)."""

PRINTED_MASSLESS_MOVES: dict[str, Move] = {
    "navy_crane_2d": Move(start=(0.0, -15.0), goal=(-5.0, -12.0), duration=3.0),
}
"""The same of a Navy crane whose pulley has no mass (Y 6.9, 6.10)."""

MASSLESS_MOVES: dict[str, Move] = {
    "navy_crane_2d": Move(start=(0.0, -15.0), goal=(-5.0, -12.0), duration=5.0),
    "navy_crane_3d": Move(
        start=(5.0 * _ROOT3, 0.0, -15.0),
        goal=(-2.0, 4.0 * _ROOT3, -13.0),
        duration=20.0,
        profile="three_phase",
    ),
}
"""Moves of the Navy cranes whose pulley has no mass (Y 6.9, 6.10, 6.34, 6.35), the planar one in
5 s instead of the printed 3, in which the tagline would have to push."""

MANIPULATOR_MOVES: dict[str, Move] = {
    "turn": Move(
        start=(*_PLATFORM, 0.0, 0.0, 0.0, _SPREAD),
        goal=(*_PLATFORM, 0.0, 0.0, math.pi / 3, _SPREAD),
        duration=20.0,
        profile="three_phase",
    ),
    "line": MOVES["cable_manipulator"],
    "line and turn": Move(
        start=(*_PLATFORM, 0.0, 0.0, 0.0, _SPREAD),
        goal=(
            *MOVES["cable_manipulator"].goal[:3],
            -math.pi / 6,
            -math.pi / 4,
            math.pi / 3,
            _SPREAD,
        ),
        duration=20.0,
        profile="three_phase",
        turning=(3, 4, 5),
    ),
}
"""CABLEV's moves (a), (b), (c) of Y 6.3.7, seen with z up: alpha and beta change their signs."""
