"""Planned motions of hands in MuJoCo: feedforward forces and a position servo on the fingers.

    track = Track.of(plan, step=1e-3, seconds=10.0)
    result = run_track(compile_hand(hand), track)
    result.log.slip_ratio, result.distance[-1], result.turned[-1], result.lost

Nothing about the object is measured: where it ends shows how well contacts roll.
"""

from dataclasses import dataclass, replace

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from ...feedforward.rolling import HandMotion, HandPlan, in_cones, joint_forces
from ...models.errors import ModelError
from ...models.hand.hand import Hand
from ...models.mjcf import hand_state
from ...models.mjcf.hand_contacts import ContactLog
from ...models.mjcf.hand_state import HandIndex
from ...models.types import Array

SERVO = 100.0
"""Frequency of the critically damped servo of every slide and turn [rad/s]."""
INSTANTS = 401
"""Number of instants at which contact forces are computed."""
MARGIN = 0.2
"""Share of friction that planned forces keep in reserve."""
PRESS = 0.5
"""How hard each of several fingers presses at least, over the object's weight."""
LOST = 0.05
"""Time without contact after which the object counts as lost [s]."""


@dataclass(frozen=True, eq=False)
class Track:
    """What the fingers shall do at each time step, and the object with them."""

    hand: Hand
    motion: HandMotion
    normals: Array
    """Planned normal forces of the contacts [N], shape (N, fingers)."""
    slides: Array
    """Positions of all slides [m], shape (N, slides)."""
    speeds: Array
    """Speeds of all slides [m/s], shape (N, slides)."""
    tips: Array
    """Orientations of all tips, quaternions, shape (N, fingers, 4)."""
    inputs: Array
    """Inputs of the motors without any error [N, N m], as `joint_forces` orders them, shape
    (N, motors)."""

    @classmethod
    def of(cls, plan: HandPlan, step: float, seconds: float) -> "Track":
        """Go a plan's way there and back for some time, sampled every `step` [s].

        Raises
        ------
        PathError
            No contact forces inside the friction cones make the motion.
        """
        times = np.linspace(0.0, seconds, round(seconds / step) + 1)
        few = there_and_back(plan, np.linspace(0.0, seconds, INSTANTS))
        return cls._of(there_and_back(plan, times), few, step)

    @classmethod
    def once(cls, plan: HandPlan, step: float, hold: float) -> "Track":
        """Go a plan's way once and rest there for a time `hold` [s]; otherwise as `of`."""
        seconds = plan.move.duration + hold
        times = np.linspace(0.0, seconds, round(seconds / step) + 1)
        return cls._of(plan(times), plan(np.linspace(0.0, seconds, INSTANTS)), step)

    @classmethod
    def still(cls, plan: HandPlan, step: float, seconds: float) -> "Track":
        """Hold a plan's first pose; otherwise as `of`."""
        rest = plan(np.zeros(round(seconds / step) + 1))
        times = np.asarray(step * np.arange(len(rest.times)))
        return cls._of(replace(rest, times=times), plan([0.0]), step)

    @classmethod
    def _of(cls, motion: HandMotion, few: HandMotion, step: float) -> "Track":
        """From a motion at every step, and at the instants at which to find forces."""
        hand = motion.hand
        forces = in_cones(few, MARGIN, PRESS if len(hand.fingers) > 1 else 0.0)
        motors = joint_forces(few, forces).values
        inputs = _between(few.times, motors, motion.times)
        normals = _between(few.times, forces.normal, motion.times)
        slides = hand_state.slide_positions(hand, motion.finger_positions)
        speeds = hand_state.slide_rates(hand, motion.finger_velocities)
        tips = _turned(motion.tip_velocities, step)
        return cls(hand, motion, normals, slides, speeds, tips, inputs)


def there_and_back(plan: HandPlan, times: Array) -> HandMotion:
    """The motion of a plan that is gone along again and again, every second time backwards."""
    phase = np.mod(times, 2 * plan.move.duration)
    back = phase > plan.move.duration
    motion = plan(np.where(back, 2 * plan.move.duration - phase, phase))
    sign = np.where(back, -1.0, 1.0)[:, None]
    return replace(
        motion,
        times=np.asarray(times, dtype=np.float64),
        velocity=sign * motion.velocity,
        angular_velocity=sign * motion.angular_velocity,
        finger_velocities=sign[..., None] * motion.finger_velocities,
        tip_velocities=sign[..., None] * motion.tip_velocities,
    )


def _between(times: Array, values: Array, instants: Array) -> Array:
    """Values (N, columns) at the instants, linear between those (M, columns) at times (M,)."""
    return np.stack([np.interp(instants, times, column) for column in values.T], axis=1)


def _turned(velocities: Array, step: float) -> Array:
    """Quaternions (N, fingers, 4) from angular velocities (N, fingers, 3), upright at first."""
    turns = 0.5 * step * (velocities[1:] + velocities[:-1])
    result = np.zeros((*velocities.shape[:2], 4))
    for i in range(velocities.shape[1]):
        rotation = Rotation.identity()
        result[0, i, 0] = 1.0
        for k, turn in enumerate(Rotation.from_rotvec(turns[:, i]), start=1):
            rotation = turn * rotation
            result[k, i] = rotation.as_quat(scalar_first=True)
    return result


@dataclass(frozen=True, eq=False)
class HandRun:
    """What became of a track in MuJoCo."""

    log: ContactLog
    qpos: Array
    """Joint positions at each step, shape (N, nq); it ends where a finger lost the object."""
    distance: Array
    """Distance of the object's centre from its path [m], shape (N,)."""
    turned: Array
    """Angle between its orientation and the planned one [rad], shape (N,)."""
    normals: Array
    """How hard each finger presses at the beginning of each step [N], shape (N - 1, fingers)."""
    lost: str
    """The finger that lost the object, or ""."""


def run_track(model: mujoco.MjModel, track: Track, servo: float = SERVO) -> HandRun:
    """Follow a track from its start, at rest, until a finger loses the object.

    Raises
    ------
    ModelError
        The model's time step is not the track's, or the simulation breaks down.
    """
    step = float(np.diff(track.motion.times[:2]).sum())
    if abs(step - model.opt.timestep) > 1e-9:
        raise ModelError(f"the track has steps of {step:g} s, the model of {model.opt.timestep:g}")
    hand, motion, data = track.hand, track.motion, mujoco.MjData(model)
    index, log, lost = HandIndex.of(hand, model), ContactLog(hand, model), ""
    pose = motion.position[0], motion.rotation[0], motion.finger_positions[0]
    qpos, normals = [hand_state.joint_positions(hand, model, *pose, track.normals[0])], []
    data.qpos[:] = qpos[0]
    apart = np.zeros(len(hand.fingers))
    for k, inputs in enumerate(track.inputs[:-1]):
        data.ctrl[: len(inputs)] = inputs
        _correct(data, track, index, k, servo)
        mujoco.mj_step(model, data)
        if data.warning.number.any():
            raise ModelError(f"the simulation of {hand.name} breaks down at {data.time:.3g} s")
        qpos.append(data.qpos.copy())
        now = log.add(data)
        normals.append(now.normal_force)
        apart = np.where(now.touching, 0.0, apart + model.opt.timestep)
        if apart.max() > LOST:
            lost = hand.finger_names[int(apart.argmax())]
            break
    path, rotation = hand_state.object_poses(hand, np.array(qpos))
    count = len(qpos)
    away = np.linalg.norm(path - motion.position[:count], axis=1)
    planned = Rotation.from_matrix(motion.rotation[:count])
    turned = (Rotation.from_matrix(rotation) * planned.inv()).magnitude()
    return HandRun(log, np.array(qpos), away, np.asarray(turned), np.array(normals), lost)


def _correct(data: mujoco.MjData, track: Track, index: HandIndex, k: int, servo: float) -> None:
    """Add the servo's part to the inputs."""
    error = servo**2 * (track.slides[k] - data.qpos[index.slides])
    error += 2 * servo * (track.speeds[k] - data.qvel[index.rates])
    data.ctrl[index.motors] += index.masses * error
    for tip in index.tips:
        pose, error, angle, rate = data.qpos[tip.qpos], np.zeros(4), np.zeros(3), np.zeros(3)
        mujoco.mju_mulQuat(error, track.tips[k, tip.finger], pose * (1, -1, -1, -1))
        mujoco.mju_quat2Vel(angle, error, 1.0)
        mujoco.mju_rotVecQuat(rate, data.qvel[tip.qvel], pose)
        missing = track.motion.tip_velocities[k, tip.finger] - rate
        data.ctrl[tip.motors] += tip.inertia * tip.axes @ (servo**2 * angle + 2 * servo * missing)
