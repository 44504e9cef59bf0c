"""Winches as bodies of their own, for ropes that stretch or go slack (`flatrig.models.mjcf.ropes`).

A spool slides on a straight line far from the rig, a metre for each metre of rope it pays out; its
joint's armature is the winch's J/r^2, and its motor pulls with u/r.  One tendon runs from a fixed
point to the spool and, in a second branch, along the rope's way: its length is

    (D - w) + L

with the way L, the paid-out length w and a constant D, so that it exceeds D by the stretch L - w.
Its spring or its limit therefore acts on the rope's way and on the spool alike, and the mass matrix
has no entry between them: a spool is a tree of its own.
"""

import mujoco
import numpy as np

from ..errors import ModelError
from ..rig.rig import Rig, Rope
from ..types import Array
from .armature import tendon_jacobian
from .rigging import lay, tidy
from .ropes import Ropes, home_length, reach, spool, stiffness, stretch_of

BODY_MASS = 1e-12
"""Mass of a spool's body besides its armature [kg]; MuJoCo needs some on every body."""

LIMIT_STEPS = 4.0
"""Time constant of a rope's limit in time steps.  With half of it, MuJoCo's least, a load ends
three times nearer (4e-6 m against 1e-5 m at 1 ms), but tensions are three times as noisy."""

PRECISE = 1e-14
"""Tolerance of MuJoCo's solver, whose default of 1e-8 leaves tensions uncertain by 1e-5 where
friction acts beside equalities."""

EQUALITY_STEPS = 2.0
"""The same of an equality, MuJoCo's least."""

IMPEDANCE = 0.9999
"""Share of a violation's acceleration that a rope's limit removes.  With MuJoCo's defaults,
of time constant and share, a crane's rope gives way by 4 mm, with these by 0.1 mm at 1 ms."""


def add(scene: mujoco.MjSpec, rig: Rig, ropes: Ropes) -> list[float]:
    """Add every rope with its spool; returns what each spool has paid out, nothing stretched [m].

    Raises
    ------
    ModelError
        A winch has no inertia.
    """
    return [_add(scene, rig, rope, ropes) for rope in rig.ropes]


def _add(scene: mujoco.MjSpec, rig: Rig, rope: Rope, ropes: Ropes) -> float:
    if rope.inertia_along == 0:
        raise ModelError(
            f"rope {rope.name}: its winch has no inertia, {ropes.kind} ropes need one; "
            "give winch_inertia > 0 or use rigid ropes"
        )
    home, whole = home_length(rig, rope), reach(rig, rope)
    body = scene.worldbody.add_body(name=spool(rope), pos=[whole - home, 0, 0])
    body.mass, body.inertia, body.explicitinertial = BODY_MASS, [BODY_MASS] * 3, True
    body.ipos = [0, 0, 0]
    body.add_site(name=spool(rope))
    joint = body.add_joint(name=spool(rope), type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[-1, 0, 0])
    joint.ref, joint.armature = home, tidy(rope.inertia_along)
    fixed = scene.worldbody.add_site(name=f"{rope.name}.zero", pos=[0, 0, 0])
    tendon = lay(scene, stretch_of(rope), rope.path, rope.falls, before=(fixed.name, spool(rope)))
    spring = ropes.spring(rig, rope)
    if ropes.kind == "equality":
        hold(scene, tendon.name)
        tendon.group = 3  # hidden: it lies on its rope, and leads far away
    elif spring:
        tendon.stiffness[0] = spring
        tendon.springlength = [0 if ropes.kind == "slack" else whole, whole]
    else:
        tendon.limited, tendon.range = mujoco.mjtLimited.mjLIMITED_TRUE, [0, whole]
        tendon.solref_limit = [LIMIT_STEPS * scene.option.timestep, 1]
        tendon.solimp_limit[:2] = IMPEDANCE
    return home


def hold(scene: mujoco.MjSpec, tendon: str) -> None:
    """Keep a tendon at its length at home, and leave that on."""
    off, flags = mujoco.mjtDisableBit, scene.option.disableflags
    if flags & int(off.mjDSBL_CONSTRAINT):
        flags |= int(off.mjDSBL_FRICTIONLOSS) | int(off.mjDSBL_LIMIT)
    scene.option.disableflags = flags & ~int(off.mjDSBL_CONSTRAINT) & ~int(off.mjDSBL_EQUALITY)
    scene.option.tolerance = PRECISE
    equal = scene.add_equality(name=tendon, type=mujoco.mjtEq.mjEQ_TENDON)
    equal.name1, equal.objtype = tendon, mujoco.mjtObj.mjOBJ_TENDON
    equal.data[:5] = [0.0, 1.0, 0.0, 0.0, 0.0]
    equal.solref = [EQUALITY_STEPS * scene.option.timestep, 1]
    equal.solimp[:2] = IMPEDANCE


def allow(scene: mujoco.MjSpec, rig: Rig, ropes: Ropes, friction: bool) -> None:
    """Leave on what of MuJoCo's constraints the ropes' limits need, and nothing else."""
    if all(ropes.spring(rig, rope) for rope in rig.ropes):
        return
    if ropes.kind == "equality":
        scene.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_LIMIT)
    off = mujoco.mjtDisableBit
    scene.option.disableflags &= ~int(off.mjDSBL_CONSTRAINT)
    if not friction:
        scene.option.disableflags |= int(off.mjDSBL_EQUALITY) | int(off.mjDSBL_FRICTIONLOSS)


def settle(scene: mujoco.MjSpec, rig: Rig, ropes: Ropes, model: mujoco.MjModel) -> None:
    """Damp the ropes of scene and model once their critical damping 2 sqrt(k/A) is known."""
    for rope, inverse in zip(rig.ropes, np.diag(_mobility(rig, model)), strict=True):
        critical = 2.0 * float(np.sqrt(ropes.spring(rig, rope) / inverse))
        damping = ropes.damper(rope, critical)
        scene.tendon(stretch_of(rope)).damping[0] = damping
        model.tendon_damping[model.tendon(stretch_of(rope)).id] = damping


def frequencies(rig: Rig, model: mujoco.MjModel) -> Array:
    """Natural frequencies of the ropes' stretch at home without damping, ascending [rad/s].

    Shape (ropes,).  With springs, RK4 needs time steps below 2.8 over the highest (of limits,
    whose stiffness follows the time step, they mean nothing).
    """
    root = np.sqrt([stiffness(model, rope) for rope in rig.ropes])
    squares = np.linalg.eigvalsh(root[:, None] * _mobility(rig, model) * root)
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)))


def stretch_jacobian(rig: Rig, model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    """Of the ropes' stretch by the model's velocities, shape (ropes, nv)."""
    rows = [model.tendon(stretch_of(rope)).id for rope in rig.ropes]
    return tendon_jacobian(model, data)[rows]


def _mobility(rig: Rig, model: mujoco.MjModel) -> Array:
    """Accelerations of the stretches under unit tensions at home, J M^-1 J', (ropes, ropes)."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    jacobian = stretch_jacobian(rig, model, data)
    moved = np.zeros_like(jacobian)
    mujoco.mj_solveM(model, data, moved, jacobian)
    return np.asarray(moved @ jacobian.T)
