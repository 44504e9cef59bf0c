"""Frames whose motion is given, as a ship's or a lorry's is: nothing that they carry moves them.

The equation of motion of such a frame is that its input is its acceleration: of a position x'' = u,
of a cosine and a sine, with the multiplier m of their unit length, c'' = -m c - s u and
s'' = -m s + c u.  What ropes and masses do to it is left out; what it does to them is not.
"""

from dataclasses import replace

import numpy as np

from .equations import Equations


def give(equations: Equations) -> Equations:
    """Equations in which nothing moves the frames whose motion is given."""
    rig, names = equations.rig, equations.names
    given = [frame for frame in rig.frames if frame.given]
    if not given:
        return equations
    mass, force = equations.mass.copy(), equations.force.copy()
    pushed = np.ones((len(equations.roles), len(names)))
    damping = None if equations.damping is None else equations.damping.copy()
    for frame in given:
        own = [frame.coordinate]
        if frame.kind == "turning":
            own = [f"{frame.name}.cos", f"{frame.name}.sin"]
        places = [names.index(name) for name in own]
        mass[places], force[places] = np.eye(len(names))[places], 0.0
        pushed[:, places] = 0.0
        pushed[np.ix_(equations.with_role("unit", owner=frame.name), places)] = 1.0
        if damping is not None:
            damping[places] = 0.0
    for array in (mass, force, pushed):
        array.flags.writeable = False
    return replace(equations, mass=mass, force=force, damping=damping, pushed=pushed)
