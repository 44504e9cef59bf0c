"""Multibody mechanisms in redundant coordinates, without rotation parameters (Y 2.3).

    system, start = multibody.assemble(multibody.rotary_crane())
    len(system.names), len(system.constraint_names)     # 42 coordinates, 37 constraints
    accelerations, multipliers = system.accelerations(start.q, start.v)

A body's attitude is its directors, the columns of its rotation matrix; joints are quadratic
constraints; the mass matrix is constant.  An angle or a distance that a drive or a rope needs is
added as a coordinate with a constraint of its own.  `flatrig.feedforward.integrators` integrates
such systems; forces are gravity, springs and constant efforts, all with a potential.
"""

from .bodies import (
    GROUND,
    Angle,
    Body,
    Effort,
    Mechanism,
    Point,
    Prismatic,
    Revolute,
    Rope,
    Slide,
    Spherical,
    Spring,
    euler_of,
    planar,
)
from .building import Start, assemble, track
from .free_crane import rotary_crane
from .nullspace import projected, projected_rate, reduced_accelerations, split, twist_basis
from .squeezer import angles_of_squeezer, hinge_of_squeezer, squeezer
from .system import System, of_equations

__all__ = [
    "GROUND",
    "Angle",
    "Body",
    "Effort",
    "Mechanism",
    "Point",
    "Prismatic",
    "Revolute",
    "Rope",
    "Slide",
    "Spherical",
    "Spring",
    "Start",
    "System",
    "angles_of_squeezer",
    "assemble",
    "euler_of",
    "hinge_of_squeezer",
    "of_equations",
    "planar",
    "projected",
    "projected_rate",
    "reduced_accelerations",
    "rotary_crane",
    "split",
    "squeezer",
    "track",
    "twist_basis",
]
