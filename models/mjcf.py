"""The MuJoCo model of a rig.

    model = mjcf.compile(models.rotary_crane())

A rope with its winch becomes a spatial tendon with `armature` J/r^2 and a motor on the tendon
with gear 1/r: the sources' equations exactly, without a constraint.  A turning frame is a hinge
with the frame's inertia as joint armature, a sliding frame and a trolley are a mass on a slide, a
load is a point mass on two or three slides (`flatrig.models.chain` says on which body).  A sheave
with inertia adds a second tendon along the rest of its rope, whose rate is the rope's speed over
the sheave.  Inputs are not clipped; rails do not end; ropes never go slack, they push instead:
whoever steps the model looks at `flatrig.models.state.tensions`.

Names: bodies as the parts, joints as the coordinates ("bridge.angle", "load.x": a load's count
from the body above), sites as the points, tendons as the ropes, actuators as the drives; cameras
"overview" and "side", keyframe "home" with the inputs that hold it.
"""

from typing import Any

import mujoco
import numpy as np

from . import looks
from .armature import check, tendon_jacobian
from .chain import Link, links
from .errors import ModelError, did_you_mean
from .rig import Frame, Load, Rig, Rope, Trolley
from .state import State, coordinates, joint_state, points, tensions

__all__ = [
    "INTEGRATORS",
    "State",
    "check",
    "compile",
    "coordinates",
    "joint_state",
    "points",
    "spec",
    "tensions",
]

INTEGRATORS = {
    name.removeprefix("mjINT_"): value for name, value in mujoco.mjtIntegrator.__members__.items()
}
"""Integrators by name.  Only RK4 lands a crane's open-loop move (1e-6 m at 1 ms; others 1e-3 m)."""

POINT_INERTIA = 1e-12
"""Principal moments of inertia of a point mass [kg m2]; MuJoCo needs some."""

FRAME_MASS = 1e-9
"""Mass of a turning frame's body [kg], whose inertia is its joint's armature."""


def compile(
    rig: Rig,
    *,
    timestep: float = 1e-3,
    integrator: str = "RK4",
    visuals: bool = True,
    friction: bool = False,
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
        The scene for people: looks, cameras, sensors.  False leaves the bare physics.
    friction
        Leave MuJoCo's constraints on, so that `dof_frictionloss` and `tendon_frictionloss` may be
        set at run time; costs time.

    Raises
    ------
    ModelError
        MuJoCo cannot hold the rig or would simulate something else, or an option is wrong.
    """
    scene = spec(rig, timestep=timestep, integrator=integrator, visuals=visuals, friction=friction)
    model = scene.compile()
    check(model)
    return model


def spec(
    rig: Rig,
    *,
    timestep: float = 1e-3,
    integrator: str = "RK4",
    visuals: bool = True,
    friction: bool = False,
) -> mujoco.MjSpec:
    """The same as an editable `mujoco.MjSpec`; parameters and errors as `compile`."""
    scene = mujoco.MjSpec()
    scene.modelname = rig.name
    scene.compiler.degree = False
    scene.compiler.autolimits = False
    scene.compiler.savecompiled = False  # XML as written here, every number exact
    scene.compiler.savecanonical = False
    _options(scene, rig, timestep, integrator, friction)
    if visuals:
        looks.prepare(scene, rig)
    bodies = {"": scene.worldbody}
    for link in links(rig):
        bodies[link.name] = _body(bodies[link.parent.name if link.parent else ""], link, rig)
    for anchor in rig.anchors:
        body = bodies[anchor.frame] if rig.frame(anchor.frame) else scene.worldbody
        body.add_site(name=anchor.name, pos=anchor.position)
    for link in links(rig):
        _sum_of_slides(scene, link)
    for rope in rig.ropes:
        _rope(scene, rope)
    for drive in rig.drives:
        _motor(scene, rig, drive.name, drive.limit, rig.driven(drive))
    if visuals:
        looks.dress(scene, rig, bodies)
        _sensors(scene, rig)
    home = [value for link in links(rig) for value in link.home]
    scene.add_key(name="home", qpos=home, ctrl=np.zeros(len(rig.drives)))
    try:
        scene.key("home").ctrl = _holding_inputs(scene.compile())
    except (ValueError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split())
        raise ModelError(f"MuJoCo refuses the model of rig {rig.name}: {reason}") from None
    return scene


def _options(
    scene: mujoco.MjSpec, rig: Rig, timestep: float, integrator: str, friction: bool
) -> None:
    if not isinstance(integrator, str) or integrator not in INTEGRATORS:
        known = did_you_mean(str(integrator), INTEGRATORS)
        raise ModelError(f"there is no integrator {integrator!r}{known}")
    number = isinstance(timestep, int | float | np.number) and not isinstance(timestep, bool)
    if not number or not 0 < timestep < np.inf:
        raise ModelError(f"timestep is {timestep!r} s, it must be a number > 0")
    scene.option.timestep = timestep
    scene.option.integrator = INTEGRATORS[integrator]
    scene.option.gravity = [0, 0, -rig.gravity]
    scene.option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    if not friction:
        scene.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)


def _body(parent: Any, link: Link, rig: Rig) -> Any:
    """A body at its home pose, its joints reading the home values there."""
    part = link.part
    body = parent.add_body(name=link.name, pos=link.position)
    turning = part if isinstance(part, Frame) and part.kind == "turning" else None
    body.explicitinertial = True
    body.ipos = [0, 0, 0]
    body.inertia = [POINT_INERTIA] * 3
    if isinstance(part, Frame):
        body.mass = FRAME_MASS if turning else part.inertia
    else:
        body.mass = part.mass
        body.add_site(name=part.name)
    if turning is not None and link.home[0] != 0:
        body.alt.type = mujoco.mjtOrientation.mjORIENTATION_AXISANGLE
        body.alt.axisangle = [0, 0, 1, link.home[0]]
    kind = mujoco.mjtJoint.mjJNT_HINGE if turning else mujoco.mjtJoint.mjJNT_SLIDE
    for name, value in zip(link.joints, link.home, strict=True):
        joint = body.add_joint(name=name, type=kind, axis=_axis(rig, part, name), ref=value)
        if turning is not None:
            joint.armature = turning.inertia
    return body


def _axis(rig: Rig, part: Frame | Trolley | Load, joint: str) -> list[float]:
    if isinstance(part, Frame):
        return list(part.axis)
    if isinstance(part, Trolley):
        return list(rig.rail(part.rail).direction)
    return [float(joint.endswith(f".{axis}")) for axis in "xyz"]


def _sum_of_slides(scene: mujoco.MjSpec, link: Link) -> None:
    """A trolley that rides on another one has a position of its own: a sum of slides."""
    if link.sums:
        tendon = scene.add_tendon(name=link.joints[0])
        for name, factor in link.sums:
            tendon.wrap_joint(name, factor)


def _rope(scene: mujoco.MjSpec, rope: Rope) -> None:
    """Its tendon, then one for each sheave with inertia: the path from there to the rope's end."""
    _path(scene, rope.name, rope.path, rope.inertia_along)
    for sheave in rope.sheaves:
        rest = rope.path[rope.after(sheave) :]
        _path(scene, f"{rope.name}.{sheave.at}", rest, sheave.inertia / sheave.radius**2)


def _path(scene: mujoco.MjSpec, name: str, path: tuple[str, ...], inertia: float) -> None:
    tendon = scene.add_tendon(name=name, armature=_tidy(inertia))
    for point in path:
        tendon.wrap_site(point)


def _motor(
    scene: mujoco.MjSpec, rig: Rig, name: str, limit: float, part: Frame | Trolley | Rope
) -> None:
    """A force or torque; its range is for sliders and scaling and clips nothing."""
    motor = scene.add_actuator(name=name)
    motor.type = mujoco.mjtActuator.mjACTUATOR_MOTOR
    motor.ctrlrange = [-_tidy(limit), _tidy(limit)]
    motor.ctrllimited = mujoco.mjtLimited.mjLIMITED_FALSE
    motor.target = part.name if isinstance(part, Rope) else part.coordinate
    if isinstance(part, Rope):
        motor.gear = [_tidy(1 / part.drum_radius), 0, 0, 0, 0, 0]
    motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
    if scene.tendon(motor.target) is not None:
        motor.trntype = mujoco.mjtTrn.mjTRN_TENDON


def _sensors(scene: mujoco.MjSpec, rig: Rig) -> None:
    """Encoders of frames, trolleys and winches, and the loads' positions, for plain MuJoCo."""
    parts: tuple[Frame | Trolley | Rope, ...] = (*rig.frames, *rig.trolleys, *rig.ropes)
    for part in parts:
        target = part.name if isinstance(part, Rope) else part.coordinate
        tendon = scene.tendon(target) is not None
        for suffix, on_tendon, on_joint in (
            ("", mujoco.mjtSensor.mjSENS_TENDONPOS, mujoco.mjtSensor.mjSENS_JOINTPOS),
            (".rate", mujoco.mjtSensor.mjSENS_TENDONVEL, mujoco.mjtSensor.mjSENS_JOINTVEL),
        ):
            scene.add_sensor(
                name=part.coordinate + suffix,
                type=on_tendon if tendon else on_joint,
                objtype=mujoco.mjtObj.mjOBJ_TENDON if tendon else mujoco.mjtObj.mjOBJ_JOINT,
                objname=target,
            )
    for load in rig.loads:
        scene.add_sensor(
            name=f"{load.name}.position",
            type=mujoco.mjtSensor.mjSENS_FRAMEPOS,
            objtype=mujoco.mjtObj.mjOBJ_SITE,
            objname=load.name,
        )


def _holding_inputs(model: mujoco.MjModel) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Inputs that hold the first keyframe at rest, or the nearest to it (least squares)."""
    data = mujoco.MjData(model)
    data.qpos[:] = model.key_qpos[0]
    mujoco.mj_forward(model, data)
    effect = np.zeros((model.nv, model.nu))
    jacobian = tendon_jacobian(model, data)
    for index in range(model.nu):
        target = model.actuator_trnid[index, 0]
        column = np.eye(model.nv)[model.jnt_dofadr[target]]
        if model.actuator_trntype[index] == mujoco.mjtTrn.mjTRN_TENDON:
            column = jacobian[target]
        effect[:, index] = model.actuator_gear[index, 0] * column
    inputs = np.linalg.lstsq(effect, data.qfrc_bias, rcond=None)[0]
    return np.array([round(float(value), 9) + 0.0 for value in inputs])


def _tidy(value: float) -> float:
    """Without the last digit's noise, so that XML shows 10 where J/r^2 is 9.999999999999998."""
    return float(f"{value:.15g}")
