"""Ropes, motors and encoders of a rig's MuJoCo model: its tendons, actuators and sensors."""

from typing import Any

import mujoco

from ..rig.body import Body
from ..rig.rig import Drive, Frame, Rig, Rope, Trolley
from .ropes import spool

GIVEN = 1e18
"""Armature [kg], [kg m2] of a frame whose motion is given, and gear of its motor, whose input is
then an acceleration: so large that nothing which the frame carries moves it."""


def add_sum(scene: mujoco.MjSpec, link: Body) -> None:
    """A trolley that rides on another one has a position of its own: a sum of slides."""
    if link.sums:
        tendon = scene.add_tendon(name=link.joints[0])
        for name, factor in link.sums:
            tendon.wrap_joint(name, factor)


def add_sheaves(scene: mujoco.MjSpec, rope: Rope) -> None:
    """A tendon for each sheave with inertia: the path from there to the rope's end."""
    for sheave in rope.sheaves:
        rest = rope.path[rope.after(sheave) :]
        inertia = sheave.inertia / sheave.radius**2
        lay(scene, f"{rope.name}.{sheave.at}", rest, rope.falls, inertia)


def lay(
    scene: mujoco.MjSpec,
    name: str,
    path: tuple[str, ...],
    falls: int,
    inertia: float = 0.0,
    before: tuple[str, ...] = (),
) -> Any:
    """A tendon along a path whose last span counts `falls` times; `before` is another branch."""
    tendon = scene.add_tendon(name=name, armature=tidy(inertia))
    for point in before:
        tendon.wrap_site(point)
    if before and (falls == 1 or len(path) > 2):
        tendon.wrap_pulley(1.0)  # what comes after it starts anew
    single, repeated = (path, ()) if falls == 1 else (path[:-1], path[-2:])
    if len(single) == 1:
        single = ()
    for point in single:
        tendon.wrap_site(point)
    if repeated:
        tendon.wrap_pulley(1 / falls)  # divides what comes after it
    for point in repeated:
        tendon.wrap_site(point)
    return tendon


def add_motor(scene: mujoco.MjSpec, rig: Rig, drive: Drive) -> None:
    """A force or torque; its range is for sliders and scaling and clips nothing."""
    part = rig.driven(drive)
    motor = scene.add_actuator(name=drive.name)
    motor.type = mujoco.mjtActuator.mjACTUATOR_MOTOR
    motor.ctrlrange = [tidy(drive.lowest), tidy(drive.limit)]
    motor.ctrllimited = mujoco.mjtLimited.mjLIMITED_FALSE
    motor.target = part.name if isinstance(part, Rope) else part.coordinate
    motor.gear = [tidy(1 / rig.arm(drive)), 0, 0, 0, 0, 0]
    if isinstance(part, Frame) and part.given:
        motor.gear = [GIVEN, 0, 0, 0, 0, 0]
    if isinstance(part, Rope) and scene.joint(spool(part)) is not None:
        motor.target = spool(part)
    motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
    if scene.tendon(motor.target) is not None:
        motor.trntype = mujoco.mjtTrn.mjTRN_TENDON


def add_sensors(scene: mujoco.MjSpec, rig: Rig) -> None:
    """Encoders of frames, trolleys and winches, and where loads and platforms are."""
    parts: tuple[Frame | Trolley | Rope, ...] = (*rig.frames, *rig.trolleys, *rig.ropes)
    for part in parts:
        target = part.name if isinstance(part, Rope) else part.coordinate
        if isinstance(part, Rope) and scene.joint(spool(part)) is not None:
            target = spool(part)  # what an encoder sees
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
    for body in rig.hanging:
        scene.add_sensor(
            name=f"{body.name}.position",
            type=mujoco.mjtSensor.mjSENS_FRAMEPOS,
            objtype=mujoco.mjtObj.mjOBJ_SITE,
            objname=body.name,
        )
    for name in rig.platform_angles:
        kind = mujoco.mjtSensor.mjSENS_JOINTPOS
        scene.add_sensor(name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=name)


def tidy(value: float) -> float:
    """Without the last digit's noise, so that XML shows 10 where J/r^2 is 9.999999999999998."""
    return float(f"{value:.15g}")
