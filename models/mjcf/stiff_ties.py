"""Links that close a loop of bodies: tendons so heavy and stiff that their lengths hardly change.

Such a link joins bodies that ropes or other links move already, as two slings do that hold one
beam.  Its tendon has an armature of `HEAVY` times the mass that it holds, which keeps its rate, and
a spring and a damper that lead it back where rounding and the integrator have let it drift.  The
spring bears what the link bears: at home exactly, and elsewhere after some 10 time steps, by a
stretch of 1e-10 m.

Limits: bodies accelerate as under a link to the rounding of a mass matrix with that entry, some
1e-10 of gravity, and while the spring gives way to a share 1 / `HEAVY`.
"""

from typing import Any

import mujoco
import numpy as np

from ..rig.chain import apart, stiff_links
from ..rig.rig import Rig
from ..types import Array
from .rigging import lay, tidy
from .spools import hold

HEAVY = 1e7
"""Armature over the mass of all that hangs: with less the link gives way until its spring bears it,
with more the mass matrix loses digits."""
SWIFT = 0.1
"""Natural frequency of the spring with the armature, over one by the time step; RK4 bears 2.8."""
DAMPED = 0.7
"""Damping of that over the critical one."""


def add(scene: mujoco.MjSpec, rig: Rig) -> None:
    """Add the links on which nothing swings."""
    if apart(rig):
        for link in stiff_links(rig):
            hold(scene, lay(scene, link.name, link.ends, 1).name)
        return
    step = scene.option.timestep
    inertia = HEAVY * rig.weight / rig.gravity
    for link in stiff_links(rig):
        tendon = lay(scene, link.name, link.ends, 1, inertia)
        length = rig.link_length(link)
        tendon.springlength = [length, length]
        tendon.stiffness[0] = tidy(inertia * (SWIFT / step) ** 2)
        tendon.damping[0] = tidy(2.0 * DAMPED * inertia * SWIFT / step)


def settle(scene: mujoco.MjSpec, rig: Rig, model: Any, tensions: Array) -> None:
    """Let the springs bear the tensions (links,) [N] of the links on which nothing swings."""
    if apart(rig):
        return
    for link, tension in zip(stiff_links(rig), tensions.tolist(), strict=True):
        tendon = model.tendon(link.name).id
        stiffness = float(np.atleast_1d(model.tendon_stiffness[tendon])[0])
        rest = rig.link_length(link) - tension / stiffness
        scene.tendon(link.name).springlength = model.tendon_lengthspring[tendon] = [rest, rest]
