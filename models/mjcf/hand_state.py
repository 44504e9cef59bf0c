"""Between a hand's own terms (poses, positions of fingers) and MuJoCo's joint positions.

    index = HandIndex.of(hand, model)
    slides = slide_positions(hand, motion.finger_positions)        # (N, slides) [m]
    data.qpos[index.slides] = slides[0]
    place, rotation = object_poses(hand, data.qpos[None])

In space, a finger's position is its body's `xpos`: the middle of a plate, the centre of a tip.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ModelError
from ..hand.hand import Hand, Tip
from ..types import Array
from .hand_model import finger_home, resting_depth, turning_tip

Indices = NDArray[np.int64]


@contextmanager
def model_of(hand: Hand) -> Iterator[None]:
    """Look names up that a hand's model has.

    Raises
    ------
    ModelError
        One is missing, so the model is not this hand's.
    """
    try:
        yield
    except KeyError as error:
        reason = str(error).split(". Valid names")[0].strip('"')
        raise ModelError(f"the model is not one of hand {hand.name}: {reason}") from None


@dataclass(frozen=True, eq=False)
class TurningTip:
    """Where a model keeps a tip that turns."""

    finger: int
    """Index of the finger in the hand."""
    qpos: slice
    """Where qpos holds its orientation, a quaternion."""
    qvel: slice
    """Where qvel holds its angular velocity, in its own axes [rad/s]."""
    motors: Indices
    """Where ctrl holds the torques of its motors [N m], shape (motors,)."""
    axes: Array
    """Unit axes of the motors, in the palm, shape (motors, 3)."""
    inertia: float
    """Moment of inertia about any axis through its centre [kg m2]."""


@dataclass(frozen=True, eq=False)
class HandIndex:
    """Where a model keeps a hand's slides and tips; slides finger by finger."""

    slides: Indices
    """Where qpos holds the positions of the slides, shape (slides,)."""
    rates: Indices
    """Where qvel holds the rates of the slides, shape (slides,)."""
    motors: Indices
    """Where ctrl holds the inputs of the slides, shape (slides,)."""
    masses: Array
    """Masses that the slides move [kg], shape (slides,)."""
    tips: tuple[TurningTip, ...]
    """The tips that motors turn, in the order of the fingers."""

    @classmethod
    def of(cls, hand: Hand, model: mujoco.MjModel) -> "HandIndex":
        """Find them by their names.

        Raises
        ------
        ModelError
            The model is not this hand's.
        """
        with model_of(hand):
            return cls._by_name(hand, model)

    @classmethod
    def _by_name(cls, hand: Hand, model: mujoco.MjModel) -> "HandIndex":
        joints, tips = [], []
        for i, finger in enumerate(hand.fingers):
            joints += [
                model.joint(f"{finger.name}.slide{k + 1}") for k in range(len(finger.slides))
            ]
            if surface := turning_tip(finger):
                ball, axes = model.joint(f"{finger.name}.tip"), np.array(surface.axes)
                names = [f"{finger.name}.turn{k + 1}" for k in range(len(axes))]
                motors = np.array([model.actuator(name).id for name in names])
                at, rate = int(ball.qposadr[0]), int(ball.dofadr[0])
                place = slice(at, at + 4), slice(rate, rate + 3)
                tips.append(TurningTip(i, *place, motors, axes, surface.inertia))
        return cls(
            np.array([joint.qposadr[0] for joint in joints]),
            np.array([joint.dofadr[0] for joint in joints]),
            np.array([model.actuator(joint.name).id for joint in joints]),
            np.array([mass for finger in hand.fingers for mass in finger.masses]),
            tuple(tips),
        )


def slide_positions(hand: Hand, places: ArrayLike) -> Array:
    """Positions of all slides (N, slides) of fingers at places in space (N, fingers, 3) [m]."""
    home = np.array([finger_home(hand, finger) for finger in hand.fingers])
    return slide_rates(hand, np.asarray(places) - home)


def slide_rates(hand: Hand, velocities: ArrayLike) -> Array:
    """Rates of all slides (N, slides) of fingers with velocities in space (N, fingers, 3)."""
    rates = np.asarray(velocities)
    by_finger = [
        rates[:, i] @ np.linalg.pinv(np.array(finger.slides))
        for i, finger in enumerate(hand.fingers)
    ]
    return np.concatenate(by_finger, axis=1)


def joint_positions(
    hand: Hand,
    model: mujoco.MjModel,
    position: ArrayLike,
    rotation: ArrayLike,
    fingers: ArrayLike,
    normal_forces: ArrayLike | None = None,
) -> Array:
    """Joint positions (nq,) of one state, tips upright.

    Parameters
    ----------
    hand, model
        A hand and its model.
    position, rotation
        Of the object, shapes (3,) [m] and (3, 3).
    fingers
        Their positions in space, shape (fingers, 3) [m].
    normal_forces
        If given, fingers go into the object as deep as contacts with these forces (fingers,) are
        at rest [N], so that the object does not drop until they carry it.
    """
    place, turn, spots = np.asarray(position), np.asarray(rotation), np.array(fingers, dtype=float)
    for i, force in enumerate([] if normal_forces is None else np.asarray(normal_forces)):
        tip = isinstance(hand.fingers[i].surface, Tip)
        away = spots[i] - place if tip else np.array(hand.fingers[i].contact)
        name = hand.finger_names[i]
        spots[i] -= resting_depth(model, name, float(force)) * away / np.linalg.norm(away)
    qpos = np.array(model.key("home").qpos)
    if hand.planar:
        qpos[:3] = [place[0], place[2], np.arctan2(turn[2, 0], turn[0, 0])]
    else:
        qpos[:3] = place
        mujoco.mju_mat2Quat(qpos[3:7], turn.ravel())
    qpos[HandIndex.of(hand, model).slides] = slide_positions(hand, spots[None])[0]
    return qpos


def object_poses(hand: Hand, qpos: ArrayLike) -> tuple[Array, Array]:
    """Positions (N, 3) [m] and rotations (N, 3, 3) of the object from joint positions (N, nq)."""
    path = np.asarray(qpos, dtype=np.float64)
    rotations = np.zeros((len(path), 3, 3))
    if hand.planar:
        depth = np.full(len(path), hand.position[1])
        cos, sin = np.cos(path[:, 2]), np.sin(path[:, 2])
        rotations[:, 0, 0] = rotations[:, 2, 2] = cos
        rotations[:, 2, 0], rotations[:, 0, 2], rotations[:, 1, 1] = sin, -sin, 1.0
        return np.stack((path[:, 0], depth, path[:, 1]), axis=1), rotations
    for quaternion, rotation in zip(path[:, 3:7], rotations, strict=True):
        flat = np.zeros(9)
        mujoco.mju_quat2Mat(flat, quaternion)
        rotation[:] = flat.reshape(3, 3)
    return path[:, :3], rotations
