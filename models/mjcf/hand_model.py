"""The MuJoCo model of a hand, with real frictional contacts that roll.

    model = compile_hand(make_hand("ball-in-corner"))
    model = compile_hand(hand, MUJOCO_DEFAULTS)      # for comparison: slips and lets go
    model = compile_hand(hand, servo=300.0)          # position actuators instead of motors

A finger's slides are stacked, the one that moves most outermost, so that the mass matrix holds
what the description says each of them moves.  A turning tip is a ball joint with motors whose
axes stay with the palm, as a trackball's rollers do: nested hinges would turn with each other.
A tip with two motors does not turn about the third axis: a bearing, an
actuator without input, brakes that.

Contacts are points that transmit forces and no moments (`condim` 3).  Torsional friction (4)
would hold back the spin that three contacts need to let the object turn at all (K remark 6): in
the corner and on three fingers it makes contacts slip.  Only a hand whose description excludes
spin gets it.  Rolling friction (6) stops every roll.

Names: body and joint "object" (a disc's joints "object.x", "object.z", "object.angle"); a finger's
body as the finger, its joints and motors "NAME.slide1", ..., its tip's joint "NAME.tip" and motors
"NAME.turn1", ..., the brake "NAME.bearing"; geoms that touch "object" and the fingers' names;
cameras "overview" and "side"; keyframe "home" with inputs that hold the object there.
Slides read 0 at home.
"""

from itertools import groupby
from typing import Any

import mujoco
import numpy as np

from ..errors import ModelError
from ..hand.hand import Finger, Hand, Plate, Tip
from ..hand.holding import holding_forces, motor_forces
from ..looks import hand_looks
from ..types import Array
from ..values import bounded
from .contact_settings import CONES, MUJOCO_DEFAULTS, RECOMMENDED, ContactSettings
from .rig_model import INTEGRATORS, memory

__all__ = [
    "MUJOCO_DEFAULTS",
    "RECOMMENDED",
    "ContactSettings",
    "compile_hand",
    "finger_home",
    "hand_spec",
    "resting_depth",
    "turning_tip",
]

OBJECT = "object"
"""Name of the object's body, joint and geom."""

IDLE = int(
    mujoco.mjtDisableBit.mjDSBL_EQUALITY
    | mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS
    | mujoco.mjtDisableBit.mjDSBL_LIMIT
)
"""Kinds of constraint that no part of a hand calls for: all but contact."""

CARRIAGE_SHARE = 0.5
"""Share of the mass that a turning tip's innermost slide moves which does not turn."""

BRAKE = 1e7
"""Damping of a tip's bearing over the tip's inertia [1/s]: high enough that the tip does not turn
about the bearing's axis; with 1e5 it yields."""

TORSION = 0.1
"""Radius of the spot that resists spin where it is excluded, over the object's radius."""


def compile_hand(
    hand: Hand,
    settings: ContactSettings = RECOMMENDED,
    *,
    servo: float = 0.0,
    squeeze: float | None = None,
    visuals: bool = True,
) -> mujoco.MjModel:
    """The hand's MuJoCo model.

    Parameters
    ----------
    hand
        The description.
    settings
        Of contacts and integration.
    servo
        If not 0, slides have critically damped position actuators of this frequency [rad/s]
        instead of motors; a force F is added by ctrl = position + F / gain.
    squeeze
        Normal force that holds the object at home [N]; see `hand.holding.holding_forces`.
    visuals
        The scene for people: looks and cameras.  False leaves what a simulation needs.

    Raises
    ------
    ModelError
        An option is wrong, the object cannot be held at home, or MuJoCo refuses the model.
    """
    scene = hand_spec(hand, settings, servo=servo, squeeze=squeeze, visuals=visuals)
    if not visuals:
        scene.memory = memory(scene)
    try:
        return scene.compile()
    except (ValueError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split())
        raise ModelError(f"MuJoCo refuses the model of hand {hand.name}: {reason}") from None


def hand_spec(
    hand: Hand,
    settings: ContactSettings = RECOMMENDED,
    *,
    servo: float = 0.0,
    squeeze: float | None = None,
    visuals: bool = True,
) -> mujoco.MjSpec:
    """The same as an editable `mujoco.MjSpec`; parameters and errors as `compile_hand`."""
    rule = "a number >= 0"
    servo = bounded("servo", servo, least=0, unit="rad/s", rule=rule, error=ModelError)
    scene = mujoco.MjSpec()
    scene.modelname = hand.name
    scene.compiler.degree = False
    scene.compiler.autolimits = False
    scene.compiler.savecompiled = False
    scene.compiler.savecanonical = False
    _options(scene, hand, settings)
    if visuals:
        hand_looks.prepare(scene, hand)
    bodies = {OBJECT: _object(scene, hand)}
    for finger in hand.fingers:
        bodies[finger.name] = _finger(scene, hand, finger)
        if tip := turning_tip(finger):
            bodies[f"{finger.name}.tip"] = _tip(bodies[finger.name], finger.name, tip)
        _surface(bodies.get(f"{finger.name}.tip", bodies[finger.name]), hand, finger)
    _actuators(scene, hand, servo)
    if visuals:
        hand_looks.dress(scene, hand, bodies)
    _keyframe(scene, hand, servo, squeeze)
    return scene


def _options(scene: mujoco.MjSpec, hand: Hand, settings: ContactSettings) -> None:
    option, geom = scene.option, scene.default.geom
    option.timestep = settings.timestep
    option.integrator = INTEGRATORS[settings.integrator]
    option.cone = CONES[settings.cone]
    option.impratio = settings.impratio
    option.noslip_iterations = settings.noslip
    option.gravity = hand.gravity
    option.disableflags = IDLE
    geom.solref = settings.solref
    geom.solimp[:3] = settings.solimp
    geom.condim = settings.condim or (3 if hand.spin else 4)
    # a disc spins no way but the one it rolls, so a planar hand needs no more than 3 either
    torsion = TORSION * hand.held.radius
    geom.friction = [hand.friction, torsion, 1e-4]


def resting_depth(model: mujoco.MjModel, name: str, force: float) -> float:
    """How deep a contact of geom `name` with the object is at rest under a normal force [m].

    From MuJoCo's constraint model, R f = k d(r) r, with d at the nearer end of its range.
    """
    share, full, width = model.geom(name).solimp[:3]
    bodies = [model.body(model.geom(geom).bodyid[0]).id for geom in (name, OBJECT)]
    give = model.body_invweight0[bodies, 0].sum() * force
    give *= (full * model.geom(name).solref[0] * model.geom(name).solref[1]) ** 2
    depths = [give * (1 - d) / d**2 for d in (share, full)]
    return float(depths[0] if depths[0] < width / 2 else depths[1])


def _object(scene: mujoco.MjSpec, hand: Hand) -> Any:
    """The object; a disc is a sphere that moves in a plane, as no contact leaves that plane."""
    held = hand.held
    body = scene.worldbody.add_body(name=OBJECT, pos=hand.position)
    body.explicitinertial, body.ipos = True, [0, 0, 0]
    body.mass, body.inertia = held.mass, [held.inertia] * 3
    if hand.planar:
        slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
        body.add_joint(name="object.x", type=slide, axis=[1, 0, 0], ref=hand.position[0])
        body.add_joint(name="object.z", type=slide, axis=[0, 0, 1], ref=hand.position[2])
        body.add_joint(name="object.angle", type=hinge, axis=[0, -1, 0])
    else:
        body.add_freejoint(name=OBJECT)
    sphere, size = mujoco.mjtGeom.mjGEOM_SPHERE, [held.radius, 0, 0]
    body.add_geom(name=OBJECT, type=sphere, size=size, contype=1, conaffinity=2, group=3)
    return body


def finger_home(hand: Hand, finger: Finger) -> Array:
    """A finger's position at home [m]: the contact of a plate, the centre of a tip."""
    radius = finger.surface.radius if isinstance(finger.surface, Tip) else 0.0
    return np.asarray(hand.position) + (hand.held.radius + radius) * np.asarray(finger.contact)


def _finger(scene: mujoco.MjSpec, hand: Hand, finger: Finger) -> Any:
    """The innermost body of a finger's stack of slides."""
    order = sorted(range(len(finger.slides)), key=lambda k: -finger.masses[k])
    groups = [(m, list(g)) for m, g in groupby(order, key=lambda k: finger.masses[k])]
    inner = [mass for mass, _ in groups[1:]] + [0.0]
    turning = turning_tip(finger) is not None
    body, position = scene.worldbody, finger_home(hand, finger)
    for level, ((mass, slides), further) in enumerate(zip(groups, inner, strict=True)):
        last = level == len(groups) - 1
        name = finger.name if last else f"{finger.name}.stage{level + 1}"
        body = body.add_body(name=name, pos=position)
        body.explicitinertial, body.ipos = True, [0, 0, 0]
        body.mass = (mass - further) * (CARRIAGE_SHARE if last and turning else 1.0)
        body.inertia = [1e-6] * 3
        for k in slides:
            body.add_joint(
                name=f"{finger.name}.slide{k + 1}",
                type=mujoco.mjtJoint.mjJNT_SLIDE,
                axis=finger.slides[k],
            )
        position = np.zeros(3)
    return body


def _tip(carriage: Any, name: str, tip: Tip) -> Any:
    body = carriage.add_body(name=f"{name}.tip")
    body.explicitinertial, body.ipos = True, [0, 0, 0]
    body.mass = carriage.mass / CARRIAGE_SHARE * (1 - CARRIAGE_SHARE)
    body.inertia = [tip.inertia] * 3
    body.add_joint(name=f"{name}.tip", type=mujoco.mjtJoint.mjJNT_BALL)
    return body


def _surface(body: Any, hand: Hand, finger: Finger) -> None:
    """What touches the object; it touches nothing else."""
    geom = body.add_geom(name=finger.name, contype=2, conaffinity=1, group=3)
    if isinstance(finger.surface, Plate):
        half = 0.5 * hand_looks.thickness(hand)
        geom.type = mujoco.mjtGeom.mjGEOM_CYLINDER
        geom.size = [hand_looks.plate_radius(hand, finger.surface), half, 0]
        geom.pos = -half * np.asarray(finger.surface.normal)
        geom.alt.type = mujoco.mjtOrientation.mjORIENTATION_ZAXIS
        geom.alt.zaxis = finger.surface.normal
    else:
        geom.type = mujoco.mjtGeom.mjGEOM_SPHERE
        geom.size = [finger.surface.radius, 0, 0]


def _actuators(scene: mujoco.MjSpec, hand: Hand, servo: float) -> None:
    """Every finger's slides and turns, then all bearings, which have no input."""
    for finger in hand.fingers:
        for k, mass in enumerate(finger.masses, start=1):
            name, limit = f"{finger.name}.slide{k}", finger.force_limit
            motor = scene.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            if servo:
                motor.set_to_position(mass * servo**2, kv=2 * mass * servo)
            motor.forcerange, motor.forcelimited = [-limit, limit], True
        if tip := turning_tip(finger):
            for k, axis in enumerate(tip.axes, start=1):
                motor = _turn(scene, finger, f"turn{k}", axis)
                motor.forcerange, motor.forcelimited = [-tip.torque_limit, tip.torque_limit], True
    for finger in hand.fingers:
        tip = turning_tip(finger)
        if tip and len(tip.axes) == 2:
            brake = _turn(scene, finger, "bearing", np.cross(tip.axes[0], tip.axes[1]))
            brake.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            brake.gainprm[0] = 0.0
            brake.biasprm[2] = -BRAKE * tip.inertia


def _turn(scene: mujoco.MjSpec, finger: Finger, name: str, axis: Any) -> Any:
    """An actuator that turns a tip about an axis of the palm."""
    axis = np.asarray(axis) / np.linalg.norm(axis)
    return scene.add_actuator(
        name=f"{finger.name}.{name}",
        target=f"{finger.name}.tip",
        trntype=mujoco.mjtTrn.mjTRN_JOINTINPARENT,
        gear=[*axis, 0, 0, 0],
    )


def turning_tip(finger: Finger) -> Tip | None:
    """A finger's tip, if motors turn it."""
    tip = finger.surface
    return tip if isinstance(tip, Tip) and tip.axes else None


def _keyframe(scene: mujoco.MjSpec, hand: Hand, servo: float, squeeze: float | None) -> None:
    inputs = motor_forces(hand, holding_forces(hand, squeeze))
    home = [hand.position[0], hand.position[2], 0] if hand.planar else [*hand.position, 1, 0, 0, 0]
    gains = []
    for finger in hand.fingers:
        tip = turning_tip(finger)
        home += [0.0] * len(finger.slides) + ([1, 0, 0, 0] if tip else [])
        gains += [mass * servo**2 if servo else 1.0 for mass in finger.masses]
        gains += [1.0] * len(tip.axes if tip else ())
    bearings = [0.0] * (len(scene.actuators) - len(inputs))
    scene.add_key(name="home", qpos=home, ctrl=[*(inputs / gains), *bearings])
