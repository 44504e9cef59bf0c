"""Forces that a motion's places and accelerations ask for: judges of its inputs and tensions.

    seen = Seen(motion)
    seen.inputs()          # what MuJoCo says that the accelerations take
    seen.winches()         # tensions, from each winch's equation
    seen.bodies()          # tensions and drives, from the balance of every load, trolley and frame
    seen.slack()           # intervals in which a rope would have to push

Each is a relative error, and multipliers, with which the solver works, are used in none of them.
"""

from functools import cached_property, lru_cache

import mujoco
import numpy as np

from ...feedforward import Motion
from ...models.mjcf import rig_model as mjcf
from ...models.mjcf.joint_motion import joint_motion
from ...models.mjcf.rig_state import points
from ...models.mjcf.rigging import GIVEN
from ...models.rig.chain import chain_of
from ...models.rig.lengths import rope_lengths, spans
from ...models.rig.rig import Frame, Load, Platform, Rig, Trolley
from ...models.types import Array
from .beam_forces import of_beams
from .frame_motion import Moving, carried, moving_frames, taken, turning
from .given_forces import added_by_sheave, given, rubbed, smooth_twin

UNLOADED = 1e-6
"""Share of the largest tension below which a rope that pushes counts as unloaded."""
THROUGH = 1e-6
"""Lever about an axis, over its length, below which a force counts as through the axis."""
INSTANTS = 12
"""Instants at which MuJoCo is asked."""


def few_of(motion: Motion) -> Array:
    """Numbers of some samples, the first and the last among them."""
    return np.unique(np.linspace(0, len(motion.times) - 1, INSTANTS).astype(int))


@lru_cache(maxsize=2)
def model_of(rig: Rig) -> mujoco.MjModel:
    """The bare model of a rig, made once for all that judges a motion.

    Raises
    ------
    ModelError
        MuJoCo cannot hold the rig.
    """
    return mjcf.compile(rig, visuals=False)


class Seen:
    """A motion at all its instants, by the names of its coordinates, inputs and ropes."""

    def __init__(self, motion: Motion) -> None:
        self.motion, self.rig = motion, motion.rig
        self.coordinates = {
            name: np.stack([table[:, motion.column(name)] for table in _orders(motion)])
            for name in self.rig.coordinate_names
        }
        """Of the rig's coordinates, (3, N) each."""
        self.joints = joint_motion(self.rig, self.coordinates)
        """Of the model's joints, (3, N, nv)."""

    @cached_property
    def world(self) -> dict[str, Array]:
        """Motion of every point, (3, N, 3).

        Those that the joints add up to lose digits where a trolley above is much faster.
        """
        found = points(self.rig, *self.joints)
        for part in self.rig.hanging:
            for axis in self.rig.axes:
                found[part.name][..., "xyz".index(axis)] = self.coordinates[f"{part.name}.{axis}"]
        return found

    @property
    def rounding(self) -> float:
        """What the direction of the shortest span is known to [rad]."""
        shortest = min(float(length[0].min()) for length in spans(self.rig, self.world).values())
        return float(np.finfo(float).eps * np.abs(self.motion.positions).max() / shortest)

    def inputs(self) -> float:
        """By how much the inputs miss what MuJoCo needs at some instants, over the forces' size.

        Inputs from 1e10 on MuJoCo takes for a mistake: such a motion is not compared.

        Raises
        ------
        ModelError
            MuJoCo cannot hold the rig.
        """
        few, twin = few_of(self.motion), smooth_twin(self.motion)
        if np.abs(twin.inputs[few]).max() >= mujoco.mjMAXVAL:
            return 0.0
        model = model_of(twin.rig)
        data = mujoco.MjData(model)
        mass = np.zeros((model.nv, model.nv))
        missing, sizes = [], []
        for i in few:
            data.qpos[:], data.qvel[:] = self.joints[0, i], self.joints[1, i]
            data.ctrl[:] = twin.inputs[i]
            mujoco.mj_forward(model, data)
            mujoco.mj_fullM(model, data, mass)
            missing.append(mass @ (data.qacc - self.joints[2, i]))
            sizes.append(np.abs(mass) @ np.abs(self.joints[2, i]) + np.abs(data.qfrc_bias))
        gears = np.abs(model.actuator_gear[:, 0])
        gears[gears == GIVEN] = 0.0  # of accelerations, not of forces
        pull = np.abs(twin.inputs[few]) @ gears
        size = np.array(sizes) + np.multiply.outer(pull, self._levers())
        free = model.dof_armature < GIVEN  # what pushes a base does not move it
        return _largest(np.array(missing)[:, free], size[:, free])

    def _levers(self) -> Array:
        """How long a lever forces have on each joint, 1 if it slides, (nv,)."""
        levers = []
        for link in chain_of(self.rig):
            for name in link.joints:
                lever = 1.0
                if isinstance(link.part, Platform) and name in self.rig.angles_of(link.part):
                    corners = [a.position for a in self.rig.anchors if a.frame == link.name]
                    lever = float(np.linalg.norm(corners, axis=1).max())
                elif isinstance(link.part, Frame) and link.part.kind == "turning":
                    lever = max(float(np.abs(place[0]).max()) for place in self.world.values())
                levers.append(lever)
        return np.array(levers)

    @cached_property
    def tensions(self) -> Array:
        """Of the ropes at their winches from their own equations, T = (J/r^2) w'' - u/r + F."""
        return np.stack([a + b for a, b, _ in self._pulls], axis=1)

    @property
    def _pulls(self) -> list[tuple[Array, Array, Array]]:
        """What turns a winch faster, what its torque takes, and the size of both."""
        lengths, rig = rope_lengths(self.rig, self.world), self.rig
        torques = {drive.on: column for column, drive in enumerate(rig.drives)}
        pulls = []
        for rope in rig.ropes:
            turn = rope.winch_inertia / rope.drum_radius**2 * lengths[rope.name][2]
            if rope.name in torques:
                pull, size = (part[:, torques[rope.name]] for part in self._given)
            else:
                pull = -rubbed(rope.friction, lengths[rope.name][1])
                size = np.abs(pull)
            pulls.append((turn, -pull, np.abs(turn) + size))
        return pulls

    @cached_property
    def _given(self) -> tuple[Array, Array]:
        """What drives give along their coordinates, and the size of its parts, (N, drives)."""
        return given(self.motion)

    def winches(self) -> float:
        """By how much tensions miss their winches' equations, over the forces in these."""
        size = np.stack([size for *_, size in self._pulls], axis=1)
        if self.rig.pushing:  # it may be unloaded, up to rounding
            size = np.maximum(size, UNLOADED * size.max())
        return _largest(self.motion.tensions[:, : len(self.rig.ropes)] - self.tensions, size)

    def bodies(self) -> float:
        """By how much tensions and drives miss what moves each part, over the forces' size."""
        pulls, sizes = self._on_points()
        count, worst, pushed = len(self.motion.times), 0.0, {}
        still = np.zeros((count, 3)), np.zeros(count)
        for part in self.rig.masses:
            second = self.world[part.name][2]
            own = [part.name, *(a.name for a in self.rig.anchors if a.frame == part.name)]
            missing = sum((pulls.get(name, still[0]) for name in own), still[0])
            missing = missing - part.mass * (second + np.array((0.0, 0.0, self.rig.gravity)))
            size = sum((sizes.get(name, still[1]) for name in own), still[1])
            size = size + part.mass * (np.linalg.norm(second, axis=1) + self.rig.gravity)
            if isinstance(part, Load) and part.drag:
                missing = missing - part.drag * self.world[part.name][1]
            if isinstance(part, Trolley):
                pushed[part.name] = missing, size
                missing, size = self._along(part, missing, size)
            worst = max(worst, _largest(missing, size[:, None]))
        for anchor in self.rig.anchors:
            if anchor.name in pulls:
                pushed[anchor.name] = pulls[anchor.name], sizes[anchor.name]
        frames = [frame for frame in self.rig.frames if not frame.given]
        return max(worst, *(self._frame(frame, pushed) for frame in frames), 0.0)

    @cached_property
    def _moving(self) -> dict[str, Moving]:
        """All frames in the world."""
        return moving_frames(self.motion)

    def _frame(self, frame: Frame, pushed: dict[str, tuple[Array, Array]]) -> float:
        """The same of a frame, from the forces on all that it carries, trolleys and anchors."""
        on = {other.name for other in carried(self.rig, frame)}
        rails = {rail.name for rail in self.rig.rails if rail.frame in on}
        own = [trolley.name for trolley in self.rig.trolleys if trolley.rail in rails]
        own += [a.name for a in self.rig.anchors if a.frame in on and a.name in pushed]
        axis = self._moving[frame.parent].turned @ np.array(frame.axis)
        second = self.motion.accelerations[:, self.motion.column(frame.coordinate)]
        missing, size = np.zeros_like(second), np.zeros_like(second)
        forces: list[tuple[Array, Array, Array, Array, Array]] = []
        for name in own:
            force, pull = pushed[name]
            forces.append((force, self.world[name][0], np.zeros_like(force), pull, size))
        for other in carried(self.rig, frame):
            force, place, moment, turned = taken(self.rig, other, self._moving[other.name])
            forces.append((-force, place, -moment, np.linalg.norm(force, axis=1), turned))
        if frame.kind == "turning":
            missing, size = -frame.along * second, frame.along * turning(self._moving[frame.name])
        for force, place, moment, pull, turned in forces:
            if frame.kind == "sliding":
                missing, size = missing + (force * axis).sum(axis=1), size + pull
                continue
            arm = place - self._moving[frame.name].origin
            turn = np.cross(arm, force) + moment
            missing = missing + (turn * axis).sum(axis=1)
            reach = np.linalg.norm(np.cross(arm, axis), axis=1)
            reach = np.maximum(reach, THROUGH * np.linalg.norm(arm, axis=1))
            size = size + reach * pull + turned
        return _largest(*self._driven(frame.name, missing, size))

    def _driven(self, part: str, missing: Array, size: Array) -> tuple[Array, Array]:
        """A force that a part misses, and the forces' size, with what its drive gives."""
        for column, drive in enumerate(self.rig.drives):
            if drive.on == part:
                force, strength = (part[:, column] for part in self._given)
                return missing + force, size + strength
        (own,) = (other for other in self.rig.drivable if other.name == part)
        return missing - rubbed(own.friction, self.coordinates[own.coordinate][1]), size

    def _along(self, trolley: Trolley, missing: Array, size: Array) -> tuple[Array, Array]:
        """The part of a force that the rail does not carry, and the drive."""
        rail = self.rig.rail(trolley.rail)
        along = self._moving[rail.frame].turned @ np.array(rail.direction)
        force, size = self._driven(trolley.name, (missing * along).sum(axis=1), size)
        return force[:, None], size

    def _on_points(self) -> tuple[dict[str, Array], dict[str, Array]]:
        """Pull of all ropes and links on each point (N, 3), and the sum of its magnitudes (N,)."""
        pulls: dict[str, Array] = {}
        sizes: dict[str, Array] = {}
        lengths = spans(self.rig, self.world)
        for column, rope in enumerate(self.rig.ropes):
            tension = self.motion.tensions[:, column]
            for k in range(len(rope.path) - 1):
                tension = tension + added_by_sheave(rope, k, lengths[rope.name][2])
                before, after = rope.path[k], rope.path[k + 1]
                pull = tension * (rope.falls if k == len(rope.path) - 2 else 1)
                step = self.world[after][0] - self.world[before][0]
                force = (pull / lengths[rope.name][0, :, k])[:, None] * step
                for name, sign in ((before, 1.0), (after, -1.0)):
                    pulls[name] = pulls.get(name, 0.0) + sign * force
                    sizes[name] = sizes.get(name, 0.0) + np.abs(pull)
        for column, link in enumerate(self.rig.links, start=len(self.rig.ropes)):
            pull, (first, second) = self.motion.tensions[:, column], link.ends
            step = self.world[second][0] - self.world[first][0]
            force = (pull / self.rig.link_length(link))[:, None] * step
            for name, sign in ((first, 1.0), (second, -1.0)):
                pulls[name] = pulls.get(name, 0.0) + sign * force
                sizes[name] = sizes.get(name, 0.0) + np.abs(pull)
        for name, force, size in of_beams(self.rig, self.world):
            pulls[name], sizes[name] = pulls[name] + force, sizes[name] + size
        return pulls, sizes

    def off_rails(self) -> float:
        """How far trolleys are past the ends of their rails [m]."""
        beyond = 0.0
        for trolley in self.rig.trolleys:
            rail = self.rig.rail(trolley.rail)
            place = self.motion.positions[:, self.motion.column(trolley.coordinate)]
            beyond = max(beyond, rail.start - place.min(), place.max() - rail.end)
        return float(beyond)

    def slack(self) -> float:
        """The largest tension whose sign the motion's intervals of slack tell wrongly, relative."""
        times = self.motion.times
        size = np.stack([size for *_, size in self._pulls], axis=1)
        wrong = 0.0
        for column, rope in enumerate(self.rig.ropes):
            if rope.pushes:
                continue
            told = np.zeros(len(times), dtype=bool)
            for part in self.motion.slack:
                if part.rope == rope.name:
                    told |= (part.start <= times) & (times <= part.end)
            tension = self.tensions[:, column]
            lie = told != (tension < 0)
            wrong = max(wrong, _largest(tension[lie], size[lie, column]))
        return wrong


def _orders(motion: Motion) -> tuple[Array, Array, Array]:
    return motion.positions, motion.velocities, motion.accelerations


def _largest(error: Array, size: Array) -> float:
    """The largest error over its size, where either is not zero."""
    share = np.divide(np.abs(error), size, out=np.zeros_like(error), where=size > 0)
    return float(share.max(initial=0.0))
