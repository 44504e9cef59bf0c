"""The simulations behind the environments of hands: `mujoco.batch` with a hand's names for things.

Inputs are held over a control period of several substeps; what is read afterwards belongs to the
new state.  Slides have encoders; a turning tip has a roller for each motor, which counts the angle
that the tip turns about that motor's axis.  A finger touches the object while their surfaces
overlap.
"""

from dataclasses import replace

import mujoco
import numpy as np

from ...models.hand.hand import Hand, Plate, Tip
from ...models.hand.holding import holding_forces
from ...models.mjcf.hand_model import OBJECT, RECOMMENDED, finger_home, hand_spec
from ...models.mjcf.hand_state import HandIndex, joint_positions
from ...models.types import Array
from ..common import NOT_FINITE, Ids
from ..simulations import Simulations, let_errors_show
from .disturbances import HandScenario
from .plan import HandPlan, Start, hand_layout

VELOCITIES = int(mujoco.mjtStage.mjSTAGE_VEL)

LOST = 0.05
"""Time without contact after which an episode ends [s]."""
DROPPED = "dropped"
"""Why it ends when no finger touches the object."""
CONTACT_LOST = "contact lost"
"""Why it ends when one finger does not, and others do."""


class HandPlant(Simulations[HandPlan, HandScenario]):
    """n simulations of a hand.

    Attributes
    ----------
    outputs
        The object's position and rotation, row by row, (n, 12).
    twist
        Its velocity and angular velocity in space, (n, 6) [m/s, rad/s].
    normals
        From the object's centre to each finger's contact, unit vectors, (n, fingers, 3).
    gaps
        Between the object and each finger, (n, fingers) [m].
    apart
        For how long each finger has not touched, (n, fingers) [s].
    offsets
        By how much encoders read too much, (n, drives) [m, rad].
    """

    stage = VELOCITIES
    ends = (DROPPED, CONTACT_LOST)

    def __init__(
        self, hand: Hand, num: int, *, timestep: float, substeps: int, nthread: int | None = None
    ) -> None:
        self.hand, self.drives = hand, hand_layout(hand).drives
        super().__init__(_model(hand, timestep), num, self.drives, substeps, nthread)
        self._period = timestep * substeps
        self._index = HandIndex.of(hand, self.model)
        batch, drives = self.batch, self.drives
        self._lengths = batch.bind("actuator_length")
        self._speeds = batch.bind("actuator_velocity")
        self._places, self._frames = batch.bind("xpos"), batch.bind("xmat")
        self._object = self.model.body(OBJECT).id
        self._fingers = [self.model.geom_bodyid[self.model.geom(f.name).id] for f in hand.fingers]
        self._slides = self._index.motors
        self._turns = np.setdiff1d(np.arange(drives), self._slides)
        self._friction: Array | None = None
        self.offsets = np.zeros((num, drives))
        self._true = np.zeros((num, 2 * drives))
        self.outputs, self.twist = np.zeros((num, 12)), np.zeros((num, 6))
        self.normals = np.zeros((num, len(hand.fingers), 3))
        self.gaps, self.apart = np.zeros((2, num, len(hand.fingers)))
        self.home = self._at_home()
        self.qpos[...] = self.home  # a first reset may be of some simulations only
        self.batch.forward(stage=VELOCITIES)
        self._read()

    def step(self, ids: Ids | None = None) -> None:
        """Hold `ctrl` over one control period, in all simulations or some."""
        which = slice(None) if ids is None else ids
        before = self._speeds[which][:, self._turns].copy()
        self.batch.step(ids, self.substeps, VELOCITIES)
        turned = 0.5 * self._period * (before + self._speeds[which][:, self._turns])
        rolled = self._true[which]
        rolled[:, self._turns] += turned
        self._true[which] = rolled
        self._read()
        with np.errstate(invalid="ignore"):
            longer = np.where(self.gaps[which] < 0.0, 0.0, self.apart[which] + self._period)
        self.apart[which] = longer

    @property
    def sound(self) -> bool:
        """Whether every simulation can go on."""
        finite = np.isfinite(self.encoders).all() and np.isfinite(self.outputs).all()
        return bool(finite and self.apart.max() <= LOST)

    def why(self, sim: int) -> str:
        """Reason for which a simulation cannot go on, "" if it can."""
        if not (np.isfinite(self.encoders[sim]).all() and np.isfinite(self.outputs[sim]).all()):
            return NOT_FINITE
        if self.apart[sim].max() <= LOST:
            return ""
        return DROPPED if self.gaps[sim].min() >= 0.0 else CONTACT_LOST

    @property
    def memory(self) -> tuple[Array, ...]:
        """What was read, how far tips have turned, and how long fingers have not touched."""
        read = (self.encoders, self.outputs, self.twist, self.normals, self.gaps)
        return *read, self._true, self.apart

    def at_rest(self, plan: HandPlan) -> Array:
        """Joints (nq,) of the pose in which a plan begins."""
        return self._joints(plan.start)

    def _joints(self, start: Start) -> Array:
        """Joints (nq,) of a pose at rest."""
        return joint_positions(
            self.hand, self.model, start.position, start.rotation, start.fingers,
            start.normal_forces,
        )  # fmt: skip

    def _at_home(self) -> Array:
        """Joints (nq,) at home, contacts as deep as they are at rest there."""
        hand = self.hand
        places = np.array([finger_home(hand, finger) for finger in hand.fingers])
        contacts = np.array([finger.contact for finger in hand.fingers])
        normal = -np.einsum("ij,ij->i", holding_forces(hand), contacts)
        return self._joints(Start(np.array(hand.position), np.eye(3), places, normal))

    def _placed(self, joints: Array, scenario: HandScenario) -> Array:
        """Joints with the object misplaced, and fingers closed on it there."""
        result, shift, turn = joints.copy(), np.array(scenario.shift), np.array(scenario.turn)
        if self.hand.planar:
            result[:3] += (shift[0], shift[2], -turn[1])
            shift[1] = 0.0
        else:
            result[:3] += shift
            angle, by = float(np.linalg.norm(turn)), np.zeros(4)
            axis = turn / angle if angle > 0 else np.array([1.0, 0.0, 0.0])
            mujoco.mju_axisAngle2Quat(by, axis, angle)
            mujoco.mju_mulQuat(result[3:7], by, joints[3:7])
        follow = []
        for finger in self.hand.fingers:
            along = np.array(finger.contact)
            way = along * (along @ shift) if isinstance(finger.surface, Plate) else shift
            follow.append(np.array(finger.slides) @ way)
        result[self._index.slides] += np.concatenate(follow)
        return result

    def _disturb(self, sim: int, scenario: HandScenario) -> None:
        """Give a simulation its mass, friction and encoders' errors."""
        signs = 1.0 - 2.0 * (np.arange(len(self._slides)) % 2)
        self.offsets[sim, self._slides] = scenario.offset * signs
        if self._friction is None and scenario.friction != 1.0:
            self._friction = self.batch.expand("geom_friction")
        if self._friction is not None:
            self._friction[sim] = self.model.geom_friction
            self._friction[sim, :, 0] *= scenario.friction
        self._scale_masses(sim, self._object, scenario.mass, True)

    def _forget(self, ids: Ids) -> None:
        self._true[ids] = self.apart[ids] = 0.0

    def _read(self) -> None:
        """Bring every attribute but `apart` up to date."""
        drives, hand = self.drives, self.hand
        self._true[:, self._slides] = self._lengths[:, self._slides]
        self._true[:, drives:] = self._speeds[:, :drives]
        self.encoders[...] = self._true
        self.drive_positions += self.offsets
        centre, frame = self._places[:, self._object], self._frames[:, self._object]
        self.outputs[:, :3], self.outputs[:, 3:] = centre, frame.reshape(self.num, 9)
        if hand.planar:
            self.twist[:, [0, 2]] = self.qvel[:, :2]
            self.twist[:, 4] = -self.qvel[:, 2]
        else:
            self.twist[:, :3] = self.qvel[:, :3]
            rotation = frame.reshape(self.num, 3, 3)
            self.twist[:, 3:] = (rotation @ self.qvel[:, 3:6, None])[..., 0]
        for i, (finger, body) in enumerate(zip(hand.fingers, self._fingers, strict=True)):
            away = self._places[:, body] - centre
            if isinstance(finger.surface, Tip):
                # Centres that coincide have left the model; the division must not warn.
                distance = np.maximum(np.linalg.norm(away, axis=1), 1e-12)
                self.normals[:, i] = away / distance[:, None]
                self.gaps[:, i] = distance - hand.held.radius - finger.surface.radius
                continue
            normal = np.array(finger.contact)
            self.normals[:, i] = normal
            height = away @ normal
            aside = np.linalg.norm(away - height[:, None] * normal, axis=1)
            inside = aside <= finger.surface.radius
            self.gaps[:, i] = np.where(inside, height, aside) - hand.held.radius


def _model(hand: Hand, timestep: float) -> mujoco.MjModel:
    """The hand's bare physics."""
    scene = hand_spec(hand, replace(RECOMMENDED, timestep=timestep), visuals=False)
    let_errors_show(scene)
    return scene.compile()
