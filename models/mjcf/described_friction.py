"""Described friction in a rig's MuJoCo model.

Viscous friction is damping of a joint or tendon, exact with RK4.  Coulomb friction is MuJoCo's
`frictionloss`, a constraint, made hard: with MuJoCo's own softness a crane that is driven past it
open loop ends 10 mm from its goal, with these numbers 1 mm at 1 ms.

Drag of a load acts on its velocity in the world.  Where nothing turns above it, that is a constant
sum of joints.  Elsewhere two tendons for each axis damp it, from the load to points `FAR` away on
either side: what the one pulls aside the other takes back, up to the square of the load's way over
that distance.

What a gear loses depends on the input, and a motor of MuJoCo loses nothing: such a rig is refused.
Environments take it off (`flatrig.envs.crane.gear_losses`), with the model of
`flatrig.models.rig.idealised.with_ideal_gears`.
"""

from typing import Any

import mujoco

from ..errors import ModelError
from ..friction import Friction
from ..rig.body import Body
from ..rig.chain import chain_of
from ..rig.rig import Load, Rig, Rope
from .ropes import spool

STEPS = 2.0
"""Time constant of Coulomb friction in time steps, MuJoCo's least."""
IMPEDANCE = 0.9999
"""Share of the slip's acceleration that it removes."""
FAR = 1e7
"""Distance of the points from which drag is damped [m]."""


def has_coulomb(rig: Rig) -> bool:
    """Whether a rig is described with dry friction."""
    return any(part.friction.coulomb for part in rig.drivable)


def add(scene: mujoco.MjSpec, rig: Rig) -> None:
    """Put a rig's friction and drag on its joints and tendons.

    Raises
    ------
    ModelError
        A drive's gear loses power.
    """
    for drive in rig.drives:
        if drive.efficiency != 1.0:
            raise ModelError(
                f"drive {drive.name}: efficiency is {drive.efficiency:g}, a motor of MuJoCo loses "
                "nothing; environments take it off (flatrig/Rig-v0), for MuJoCo alone say 1"
            )
    for part in rig.drivable:
        if part.friction != Friction():
            name = part.name if isinstance(part, Rope) else part.coordinate
            if isinstance(part, Rope) and scene.joint(spool(part)) is not None:
                name = spool(part)
            _rub(scene.tendon(name) or scene.joint(name), part.friction, scene.option.timestep)
    for link in chain_of(rig):
        if isinstance(link.part, Load) and link.part.drag:
            _drag(scene, rig, link, link.part)


def _rub(item: Any, friction: Friction, timestep: float) -> None:
    """Friction of a joint or a tendon."""
    item.damping[0] = friction.viscous
    item.frictionloss = friction.coulomb
    if friction.coulomb:
        harden(item, timestep)


def harden(item: Any, timestep: float) -> None:
    """Let dry friction of a joint or tendon hold as hard as MuJoCo can."""
    item.solref_friction[0] = STEPS * timestep
    item.solimp_friction[:2] = IMPEDANCE


def _drag(scene: mujoco.MjSpec, rig: Rig, link: Body, load: Load) -> None:
    """Dampers for each axis along which a load moves in the world."""
    joints = []
    above: Body | None = link
    while above is not None:
        joints += [scene.joint(name) for name in above.joints]
        above = above.parent
    if any(joint.type != mujoco.mjtJoint.mjJNT_SLIDE for joint in joints):
        _drag_from_afar(scene, rig, load)
        return
    for axis in rig.axes:
        tendon = scene.add_tendon(name=f"{load.name}.drag.{axis}")
        tendon.damping[0] = load.drag
        for joint in joints:
            share = float(joint.axis["xyz".index(axis)])
            if share:
                tendon.wrap_joint(joint.name, share)


def _drag_from_afar(scene: mujoco.MjSpec, rig: Rig, load: Load) -> None:
    for axis in rig.axes:
        for side, way in (("ahead", FAR), ("behind", -FAR)):
            name = f"far.{axis}.{side}"
            if scene.site(name) is None:
                place = [way * (letter == axis) for letter in "xyz"]
                scene.worldbody.add_site(name=name, pos=place, group=3)
            tendon = scene.add_tendon(name=f"{load.name}.drag.{axis}.{side}")
            tendon.damping[0], tendon.group = 0.5 * load.drag, 3  # hidden: it leads far away
            tendon.wrap_site(load.name)
            tendon.wrap_site(name)
