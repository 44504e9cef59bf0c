"""What happens at a hand's contacts in MuJoCo: slip, roll, spin, penetration, use of friction.

    mujoco.mj_step(model, data)
    now = contacts(hand, model, data)        # one row for each finger, at the step's beginning
    now.slip, now.roll, now.touching

    log = ContactLog(hand, model)            # sums them up over a run
    log.add(data)                            # after every step
    log.slip_ratio, log.penetration, log.friction_use

A step leaves contacts, their forces, and the velocities of bodies as they were when it began; so
does `mj_forward` for the present state.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from ..hand.hand import Hand, Tip
from ..types import Array, Mask
from .hand_model import OBJECT
from .hand_state import model_of


@dataclass(frozen=True, eq=False)
class Contacts:
    """Contacts of all fingers with the object at one instant; zero where there is none."""

    touching: Mask
    """Whether each finger touches the object, shape (fingers,)."""
    points: Array
    """Places of the contacts in space [m], shape (fingers, 3)."""
    normals: Array
    """Unit normals of the contacts, from the object outwards, shape (fingers, 3)."""
    forces: Array
    """Forces of the fingers on the object, in space [N], shape (fingers, 3)."""
    penetration: Array
    """How far the surfaces overlap [m], shape (fingers,)."""
    slip: Array
    """Speed of the surfaces along each other [m/s], shape (fingers,)."""
    spin: Array
    """Angular velocity of the object against the finger about the normal [rad/s], (fingers,)."""
    roll: Array
    """Speed at which the contact moves over the object's surface [m/s], shape (fingers,)."""

    @property
    def normal_force(self) -> Array:
        """How hard each finger presses [N], shape (fingers,)."""
        return np.asarray(-(self.forces * self.normals).sum(axis=1))

    @property
    def tangential_force(self) -> Array:
        """Size of each contact's force along the surface [N], shape (fingers,)."""
        rest = self.forces + self.normal_force[:, None] * self.normals
        return np.asarray(np.linalg.norm(rest, axis=1))


def contacts(hand: Hand, model: mujoco.MjModel, data: mujoco.MjData) -> Contacts:
    """The contacts in `data`, after `mj_step` or `mj_forward`.

    Raises
    ------
    ModelError
        The model is not this hand's.
    """
    return ContactLog(hand, model).look(data)


class ContactLog:
    """Sums what happens at the contacts over a run.

    Raises
    ------
    ModelError
        The model is not this hand's.
    """

    def __init__(self, hand: Hand, model: mujoco.MjModel) -> None:
        self.hand, self._model = hand, model
        with model_of(hand):
            self._finger_of = {model.geom(f.name).id: i for i, f in enumerate(hand.fingers)}
            self._object = model.geom(OBJECT)
        count = len(hand.fingers)
        self.steps = 0
        """Number of time steps added."""
        self.seconds = 0.0
        """Time they stand for [s]."""
        self.slipped = np.zeros(count)
        """Way that each finger's contact slipped [m]."""
        self.rolled = np.zeros(count)
        """Way that each contact went over the object [m]."""
        self.spun = np.zeros(count)
        """Angle by which the object spun against each finger, either way counted [rad]."""
        self.apart = np.zeros(count)
        """Time that each finger did not touch [s]."""
        self.penetration = 0.0
        """Largest overlap of surfaces [m]."""
        self.friction_use = 0.0
        """Largest tangential force over what friction allows."""

    @property
    def slip_ratio(self) -> float:
        """Way slipped over way rolled, all contacts together; nan if nothing rolled."""
        rolled = float(self.rolled.sum())
        return float(self.slipped.sum()) / rolled if rolled > 0 else float("nan")

    def add(self, data: mujoco.MjData) -> Contacts:
        """Add one time step; returns its contacts."""
        now, step = self.look(data), self._model.opt.timestep
        self.steps += 1
        self.seconds += step
        self.slipped += step * now.slip
        self.rolled += step * now.roll
        self.spun += step * np.abs(now.spin)
        self.apart += step * ~now.touching
        self.penetration = max(self.penetration, float(now.penetration.max()))
        pressed = now.normal_force > 0
        use = now.tangential_force[pressed] / (self.hand.friction * now.normal_force[pressed])
        self.friction_use = max(self.friction_use, float(use.max(initial=0.0)))
        return now

    def look(self, data: mujoco.MjData) -> Contacts:
        """The contacts of one instant."""
        count, home = len(self.hand.fingers), self._object.id
        touching, values = np.zeros(count, bool), np.zeros((count, 13))
        moving = self._velocity(data, home)
        for k in range(data.ncon):
            pair = data.contact.geom[k]
            other = int(pair[1] if pair[0] == home else pair[0])
            i = self._finger_of.get(other)
            if i is None or home not in pair:
                continue
            touching[i] = True
            away = 1.0 if pair[0] == home else -1.0
            values[i] = self._at(data, k, i, away, moving, self._velocity(data, other))
        points, normals, forces, scalars = np.split(values, (3, 6, 9), axis=1)
        return Contacts(touching, points, normals, forces, *scalars.T.copy())

    def _at(
        self, data: mujoco.MjData, k: int, i: int, away: float, moving: Array, finger: Array
    ) -> Array:
        """A row of `Contacts` from contact k with finger i."""
        frame, point = data.contact.frame[k].reshape(3, 3), data.contact.pos[k]
        normal, force = away * frame[0], np.zeros(6)
        mujoco.mj_contactForce(self._model, data, k, force)
        relative = _velocity_at(moving, point) - _velocity_at(finger, point)
        slip = relative - np.dot(relative, normal) * normal
        turning = moving[3:6] - self._direction_rate(i, normal, moving, finger)
        roll = self.hand.held.radius * np.linalg.norm(np.cross(turning, normal))
        spin = np.dot(moving[3:6] - finger[3:6], normal)
        pressing = -away * (force[:3] @ frame)
        depth = -data.contact.dist[k]
        return np.array([*point, *normal, *pressing, depth, np.linalg.norm(slip), spin, roll])

    def _direction_rate(self, i: int, normal: Array, moving: Array, finger: Array) -> Array:
        """Angular velocity of the line from the object's centre to a contact [rad/s]."""
        surface = self.hand.fingers[i].surface
        if not isinstance(surface, Tip):
            return np.zeros(3)
        length = self.hand.held.radius + surface.radius
        return np.asarray(np.cross(normal, finger[:3] - moving[:3]) / length)

    def _velocity(self, data: mujoco.MjData, geom: int) -> Array:
        """Velocity, angular velocity and place of a body's origin, (9,)."""
        body, velocity = int(self._model.geom_bodyid[geom]), np.zeros(6)
        kind = mujoco.mjtObj.mjOBJ_XBODY
        mujoco.mj_objectVelocity(self._model, data, kind, body, velocity, 0)
        return np.concatenate((velocity[3:], velocity[:3], data.xpos[body]))


def _velocity_at(body: Array, point: Array) -> Array:
    return np.asarray(body[:3] + np.cross(body[3:6], point - body[6:]))
