"""The MuJoCo model of a rig.

    model = models.compile(models.rotary_crane())

A rope with its winch becomes a spatial tendon with `armature` J/r^2 and a motor on the tendon
with gear 1/r: the sources' equations exactly, without a constraint.  A turning frame is a hinge
with the frame's inertia as joint armature, or a rigid body where it has a mass of its own; frames
stand on one another as bodies do.  A sliding frame and a trolley are a mass on a slide, a load is a
point mass on two or three slides, a platform a rigid body on three slides and three hinges
(`flatrig.models.rig.chain` says on which body).  A sheave with inertia adds a second tendon along
the rest of its rope, whose rate is the rope's speed over the sheave.  A rope's last span counts as
often as it has falls.  Inputs are not clipped; rails do not end; ropes never go slack, they push
instead: whoever steps the model looks at `flatrig.models.mjcf.rig_state.tensions`.  Ropes that
stretch, or do go slack, are another choice: `flatrig.models.mjcf.ropes`.

A load without mass, such as the ideal free pulley, cannot be a body of MuJoCo: `massless` is the
mass that stands in for it, without weight.  The model is then a limit: a load's error falls in
proportion to that mass, as long as the time step resolves the pulley's faster motion (1e-4 kg at
1 ms for the Navy cranes; 1e-6 kg diverges).

Names: bodies as the parts, joints as the coordinates ("bridge.angle", "load.x": a load's count
from the body above), sites as the points, tendons as the ropes, actuators as the drives; cameras
"overview" and "side", keyframe "home" with the inputs that hold it.
"""

from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from ..errors import ModelError, did_you_mean
from ..looks.scenery import Scenery
from ..rig.body import Body
from ..rig.chain import chain_of
from ..rig.rig import WORLD, Frame, Platform, Rig, Trolley, Vector
from ..values import as_number, shown
from . import beam_bodies, described_friction, rigging, spools, stiff_ties
from .armature import check
from .at_rest import compile_at_rest
from .frame_body import give_inertia
from .rig_state import State, coordinates, joint_state, paid_out, points, tensions
from .ropes import Ropes, ropes_of

__all__ = [
    "INTEGRATORS",
    "Ropes",
    "State",
    "check",
    "compile",
    "coordinates",
    "joint_state",
    "paid_out",
    "points",
    "spec",
    "tensions",
]

INTEGRATORS = {
    name.removeprefix("mjINT_"): value for name, value in mujoco.mjtIntegrator.__members__.items()
}
"""Integrators by name.  Only RK4 lands a crane's open-loop move (1e-6 m at 1 ms; others 1e-3 m)."""

POINT_INERTIA = 1e-12
"""Principal moments of inertia of a point mass [kg m2].  MuJoCo needs some; those of a ball as
large as it is drawn would carry a load under a turning boom centimetres off its path."""

LARGEST_SHARE = 0.1
"""Largest mass that may stand in for none, over that of all loads: the load's error
grows in proportion to it."""

MEMORY = (65536, 1024)
"""Scratch memory of the bare physics [bytes], and for each square of its degrees of freedom: ten
times what it takes with all constraints on, and a hundredth of what MuJoCo would reserve."""

TIMESTEPS = (1e-12, 1e9)
"""Shortest and longest step [s] whose powers stay far from overflow."""


def compile(
    rig: Rig,
    *,
    timestep: float = 1e-3,
    integrator: str = "RK4",
    visuals: bool = True,
    friction: bool = False,
    massless: float | None = None,
    ropes: str | Ropes = "rigid",
    extend: Callable[[mujoco.MjSpec], object] | None = None,
) -> mujoco.MjModel:
    """The rig's MuJoCo model, checked for dropped inertia.

    Parameters
    ----------
    rig
        The description.
    timestep
        Of the simulation [s].
    integrator
        One of `INTEGRATORS`.
    visuals
        The scene for people: looks, cameras, sensors.  False leaves the bare physics, which
        steps 1.2 to 1.5 times as fast.
    friction
        Leave MuJoCo's constraints on, so that `dof_frictionloss` and `tendon_frictionloss` may be
        set at run time; costs time.
    massless
        Stands in for the mass of loads that have none [kg]; None refuses them.
    ropes
        "rigid", "elastic", "slack", or `Ropes` with their numbers.
    extend
        Adds to the scene before it is compiled: sensors, flags.

    Raises
    ------
    ModelError
        MuJoCo cannot hold the rig or would simulate something else, or an option is wrong.
    """
    material = ropes_of(ropes, rig)
    scene = _scene(rig, timestep, integrator, visuals, friction, massless, material)
    if not visuals:
        scene.memory = memory(scene)
    if extend is not None:
        extend(scene)
    model = compile_at_rest(scene, rig, material)
    check(model)
    return model


def spec(
    rig: Rig,
    *,
    timestep: float = 1e-3,
    integrator: str = "RK4",
    visuals: bool = True,
    friction: bool = False,
    massless: float | None = None,
    ropes: str | Ropes = "rigid",
) -> mujoco.MjSpec:
    """The same as an editable `mujoco.MjSpec`; parameters and errors as `compile`."""
    material = ropes_of(ropes, rig)
    scene = _scene(rig, timestep, integrator, visuals, friction, massless, material)
    compile_at_rest(scene, rig, material)
    return scene


def memory(scene: mujoco.MjSpec) -> int:
    """Scratch memory that is ample for the bare physics of a scene [bytes]."""
    size = {mujoco.mjtJoint.mjJNT_FREE: 6, mujoco.mjtJoint.mjJNT_BALL: 3}
    return MEMORY[0] + MEMORY[1] * sum(size.get(joint.type, 1) for joint in scene.joints) ** 2


def _scene(
    rig: Rig,
    timestep: float,
    integrator: str,
    visuals: bool,
    friction: bool,
    massless: float | None,
    ropes: Ropes,
) -> mujoco.MjSpec:
    """The rig's bodies, ropes and drives, without the inputs that hold it at home."""
    friction = friction or described_friction.has_coulomb(rig)
    scene = mujoco.MjSpec()
    scene.modelname = rig.name
    scene.compiler.degree = False
    scene.compiler.autolimits = False
    scene.compiler.savecompiled = False  # XML as written here, every number exact
    scene.compiler.savecanonical = False
    _options(scene, rig, timestep, integrator, friction)
    scenery = Scenery(rig) if visuals else None
    if scenery is not None:
        scenery.prepare(scene)
    _check_masses(rig, massless)
    if ropes.spooled:
        spools.allow(scene, rig, ropes, friction)
    bodies = {WORLD: scene.worldbody}
    for link in chain_of(rig):
        bodies[link.name] = _body(bodies[link.parent.name if link.parent else WORLD], link, rig)
    beam_bodies.add(bodies, rig)
    for load in rig.loads:
        if load.mass == 0:
            bodies[load.name].mass, bodies[load.name].gravcomp = massless, 1.0
    for anchor in rig.anchors:
        bodies[anchor.frame].add_site(name=anchor.name, pos=anchor.position)
    for link in chain_of(rig):
        rigging.add_sum(scene, link)
    paid = spools.add(scene, rig, ropes) if ropes.spooled else []
    for rope in rig.ropes:
        if not ropes.spooled or visuals or ropes.kind == "equality":
            inertia = 0.0 if ropes.spooled else rope.inertia_along
            rigging.lay(scene, rope.name, rope.path, rope.falls, inertia)
        rigging.add_sheaves(scene, rope)
    stiff_ties.add(scene, rig)
    for drive in rig.drives:
        rigging.add_motor(scene, rig, drive)
    described_friction.add(scene, rig)
    if scenery is not None:
        scenery.dress(scene, bodies)
        rigging.add_sensors(scene, rig)
    home = [value for link in chain_of(rig) for value in link.home]
    scene.add_key(name="home", qpos=home + paid, ctrl=np.zeros(len(rig.drives)))
    return scene


def _options(
    scene: mujoco.MjSpec, rig: Rig, timestep: float, integrator: str, friction: bool
) -> None:
    if not isinstance(integrator, str) or integrator not in INTEGRATORS:
        known = did_you_mean(str(integrator), INTEGRATORS)
        raise ModelError(f"there is no integrator {shown(integrator)}{known}")
    if not TIMESTEPS[0] <= as_number(timestep) <= TIMESTEPS[1]:
        limits = "{:g} s to {:g} s".format(*TIMESTEPS)
        raise ModelError(f"timestep is {shown(timestep)} s, it must be a number > 0 ({limits})")
    scene.option.timestep = float(timestep)
    scene.option.integrator = INTEGRATORS[integrator]
    scene.option.gravity = [0, 0, -rig.gravity]
    scene.option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    if not friction:
        scene.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)


def _check_masses(rig: Rig, massless: float | None) -> None:
    """Every body needs a mass, and one that stands in for none must be small."""
    without = [load.name for load in rig.loads if load.mass == 0]
    if without and massless is None:
        raise ModelError(
            f"load {without[0]}: mass is 0 kg, MuJoCo needs a positive mass on every body; give "
            "one that stands in for it [kg], as in compile(rig, massless=1e-3)"
        )
    largest = LARGEST_SHARE * rig.weight / rig.gravity
    if massless is not None and not 0 < as_number(massless) <= largest:
        raise ModelError(
            f"massless is {shown(massless)} kg, it must be a number > 0 and at most {largest:g}, "
            f"{LARGEST_SHARE:g} of the loads' mass"
        )


def _body(parent: Any, link: Body, rig: Rig) -> Any:
    """A body at its home pose, its joints reading the home values there."""
    part = link.part
    body = parent.add_body(name=link.name, pos=link.position)
    turning = part if isinstance(part, Frame) and part.kind == "turning" else None
    body.explicitinertial = True
    body.ipos = [0, 0, 0]
    body.inertia = [POINT_INERTIA] * 3
    if isinstance(part, Frame):
        give_inertia(body, part)
    else:
        body.mass = part.mass
        body.ipos = (0.0, 0.0, 0.0) if link.swing is None else link.swing.reach
        body.add_site(name=part.name, pos=body.ipos)
    if isinstance(part, Platform):
        body.inertia = part.inertia[:3]
        if any(part.inertia[3:]):
            body.inertia, body.fullinertia = np.zeros(3), part.inertia
    if turning is not None and link.home[0] != 0:
        body.alt.type = mujoco.mjtOrientation.mjORIENTATION_AXISANGLE
        body.alt.axisangle = [*turning.axis, link.home[0]]
    hinges = rig.angles_of(part) if isinstance(part, Platform) else ()
    if turning or link.swing is not None:
        hinges = link.joints
    for name, value, axis in zip(link.joints, link.home, _axes(rig, link), strict=True):
        kind = mujoco.mjtJoint.mjJNT_HINGE if name in hinges else mujoco.mjtJoint.mjJNT_SLIDE
        joint = body.add_joint(name=name, type=kind, axis=axis, ref=value)
        if isinstance(part, Frame) and part.given:
            joint.armature = rigging.GIVEN
        elif turning is not None:
            joint.armature = turning.along
    return body


def _axes(rig: Rig, link: Body) -> list[Vector]:
    """Axes of a body's joints, in their order; a platform turns about x, y, z after it slides."""
    if isinstance(link.part, Frame):
        return [link.part.axis]
    if link.swing is not None:
        return list(link.swing.axes)
    if isinstance(link.part, Trolley):
        return [rig.rail(link.part.rail).direction]
    units = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    turns = ("xyz" if rig.dimensions == 3 else "y") if isinstance(link.part, Platform) else ""
    return [units[letter] for letter in (*rig.axes, *turns)]
