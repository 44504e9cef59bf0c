"""The simulations behind the environments: `mujoco.batch` with the rig's own names for things.

Each has its own load mass, friction and wind.  What is read after a control period belongs to the
new state under the inputs still held.
"""

from collections.abc import Sequence

import mujoco
import numpy as np

from ...models.mjcf.rig_state import State, coordinates, points
from ...models.mjcf.ropes import Ropes
from ...models.mjcf.swinging import way
from ...models.rig.chain import joint_names, weighed
from ...models.rig.idealised import with_ideal_gears
from ...models.rig.rig import Rig
from ...models.types import Array
from ..common import NOT_FINITE, NOTHING, Ids
from ..simulations import Simulations
from .disturbances import Scenario
from .friction_forces import DryFriction, ViscousFriction
from .gear_losses import loses
from .geometry import angle_joints, geometry_of, hangers, swing_bodies, turned
from .link_forces import LinkForces
from .moving_base import MovingBase
from .outputs import Outputs
from .payloads import payload_bodies, turns
from .plan import CranePlan
from .plant_model import plant_model
from .stretching import Stretching
from .tensions import RopeForces, sensed
from .wind import Wind, heading

ACCELERATIONS = int(mujoco.mjtStage.mjSTAGE_ACC)
"""What is read after a step: rope tensions follow from accelerations."""

SLACK = "slack"
"""Why an episode ends when a rope would have to push."""


class Plant(Simulations[CranePlan, Scenario]):
    """n simulations of a rig.

    Attributes
    ----------
    outputs, output_rates
        The rig's outputs as they really are, (n, outputs), and if made with `rates` theirs.
    margins
        Tensions of what cannot push, then clearances; an episode ends when one is not > 0.
    tensions
        Of the ropes, then of the links, (n, ropes + links) [N]; links by the description's masses
        where ropes are constraints or hold beams.
    reasons
        For each column of `margins`, why.
    """

    stage = ACCELERATIONS

    def __init__(
        self,
        rig: Rig,
        num: int,
        *,
        timestep: float,
        substeps: int,
        friction: bool = False,
        frame_friction: bool = False,
        rates: bool = False,
        massless: float | None = None,
        ropes: str | Ropes = "rigid",
        nthread: int | None = None,
    ) -> None:
        self.rig, self.simulated = rig, with_ideal_gears(rig)  # in MuJoCo gears lose nothing
        self.stretching = Stretching(rig, ropes)
        model = plant_model(rig, timestep, friction, rates, massless, ropes)
        self.geometry = geometry_of(rig, model, np.array(model.key_qpos[0]))
        if sensed(rig, model, self.geometry):
            model = plant_model(rig, timestep, friction, rates, massless, ropes, ends=True)
        self.stretching.check(model)
        super().__init__(model, num, len(rig.drives), substeps, nthread)
        self.home = np.array(self.model.key_qpos[0])
        self._bind()
        self._allocate()
        self._outputs = Outputs(rig, self.model, self.batch, rates, self.tensions)
        self.outputs, self.output_rates = self._outputs.values, self._outputs.rates
        pulls, self._links = self.tensions, None
        if rig.links and not weighed(rig):  # or what tells of ropes tells of links
            pulls, held = np.split(self.tensions, [len(rig.ropes)], axis=1)
            self._links = LinkForces(rig, self.model, self.batch, held)
        self._forces = RopeForces(rig, self.model, self.batch, self.geometry, self._spans, pulls)
        self._friction = None
        described = self.model.tendon_frictionloss.any(), self.model.dof_frictionloss.any()
        if friction or any(described) or loses(rig):
            frames = frame_friction or any(frame.friction.coulomb for frame in rig.frames)
            frames = frames or loses(rig)
            self._friction = DryFriction(rig, self.model, self.batch, frames)
        self._viscous: ViscousFriction | None = None
        if self.model.tendon_damping.any() or self.model.dof_damping.any():
            self._viscous = ViscousFriction(rig, self.model, self.batch)
        self._wind = Wind(rig, self.model, self.batch)
        self.base: MovingBase | None = None
        self.qpos[...] = self.home  # a first reset may be of some simulations only
        self.batch.forward()

    def step(self, ids: Ids | None = None) -> None:
        """Hold `ctrl` over one control period, in all simulations or some."""
        if self.base is not None:
            self.base.lead(ids)
        if self._wind.blowing:
            self._wind.blow()
        if self._friction is None or not self._friction.falling:
            self.batch.step(ids, self.substeps, ACCELERATIONS)
        else:
            for left in range(self.substeps, 0, -1):
                self._friction.follow()
                self.batch.step(ids, 1, NOTHING if left > 1 else ACCELERATIONS)
        self._read()

    @property
    def sound(self) -> bool:
        """Whether every simulation can go on."""
        worst = self.margins.argmin()  # the first that is not a number, if there is one
        return bool(self.margins.item(worst) > 0)

    @property
    def memory(self) -> tuple[Array, ...]:
        """What was read, and bounds of friction."""
        read = (self.encoders, self._mapped, self.margins, self.outputs, self.output_rates)
        return read if self._friction is None else (*read, *self._friction.memory)

    @property
    def ends(self) -> tuple[str, ...]:
        """Reasons that `why` can give, beside that something is not finite."""
        return tuple(dict.fromkeys(self.reasons))

    def change(self, ids: Ids, scenarios: Sequence[Scenario]) -> None:
        """Go on with other masses, friction and wind, from where simulations are."""
        for sim, scenario in zip(ids.tolist(), scenarios, strict=True):
            self._disturb(sim, scenario)
            scenario.disturb(self, sim)
        if self._masses is not None:
            self.batch.set_const(ids)
        self._forget(ids)
        self.batch.forward(ids, self.stage)
        self._read()

    def set_off(self, ids: Ids, plans: Sequence[CranePlan]) -> None:
        """Let simulations that stand where their plans begin move as these do."""
        if self.base is not None:
            self.base.start(ids, plans)
            self.batch.forward(ids, self.stage)
            self._read()

    def at_rest(self, plan: CranePlan) -> Array:
        """Joints (nq,) where a plan begins."""
        return self.stretching.at_rest(self.model, plan.start, plan.inputs)

    def drives_at(self, joints: Array) -> Array:
        """Drive positions (drives,) at joints (nq,)."""
        state = State(joints[None], np.zeros_like(joints[None]))
        values, _ = coordinates(self.rig, self.model, state)
        parts = map(self.rig.driven, self.rig.drives)
        return np.array([values[part.coordinate][0] for part in parts])

    def why(self, sim: int) -> str:
        """Reason for which a simulation cannot go on, "" if it can."""
        if not np.isfinite(self.margins[sim]).all():
            return NOT_FINITE
        beyond = np.flatnonzero(self.margins[sim] <= 0)
        return self.reasons[beyond[0]] if beyond.size else ""

    def _bind(self) -> None:
        """Live views of what is read and written at every step."""
        batch, model, num = self.batch, self.model, self.num
        start = (self.qpos.ctypes.data - batch.state.ctypes.data) // batch.state.itemsize
        both = batch.state[:, start : start + 2 * model.nq]  # qvel follows qpos
        self._joint_state = both.reshape(num, 2, model.nq)
        self._joint_accelerations = batch.bind("qacc")
        self._lengths = batch.bind("actuator_length")
        self._length_rates = batch.bind("actuator_velocity")
        self._per_gear = np.tile(1.0 / model.actuator_gear[:, 0], (num, 1))
        self._heights = batch.bind("site_xpos")[..., 2]
        sites = [[model.site(name).id for name in pair] for pair in self.geometry.hung]
        self._above, self._below = np.array(sites, dtype=int).reshape(-1, 2).T

    def _allocate(self) -> None:
        """Work arrays of the affine map, one small product of matrices for each simulation."""
        num, geometry = self.num, self.geometry
        ropes, clearances = len(self.rig.tension_names), len(geometry.reasons)
        joints, size = geometry.spans.shape[-1], self.model.nq
        pulling = [] if self.stretching.slackens else list(self.rig.pulling)
        self._pulling = pulling if len(pulling) < ropes else None
        self.reasons = (SLACK,) * len(pulling) + geometry.reasons
        rows = (np.zeros((ropes, joints)), geometry.clearances, geometry.spans.reshape(-1, joints))
        self._weights = np.ascontiguousarray(np.vstack(rows).T)
        self._joints = np.zeros((num, 3, joints))
        self._joints[:, 0, -1] = 1.0
        self._state, self._accelerations = self._joints[:, :2, :size], self._joints[:, 2, :size]
        self._turning = [
            (self._joints[:, :, own], self._joints[:, :, size + 9 * index : size + 9 * index + 9])
            for index, own in enumerate(angle_joints(self.rig))
        ]
        self._swinging = swing_bodies(self.rig)
        first = size + 9 * len(self._turning)
        self._ways = [
            self._joints[:, :, first + 3 * index : first + 3 * index + 3].swapaxes(0, 1)
            for index in range(len(self._swinging))
        ]
        self._named = {
            name: self._joints[..., column].T for column, name in enumerate(joint_names(self.rig))
        }
        self._mapped = np.zeros((num, 3, self._weights.shape[1]))
        self.margins = self._mapped[:, 0, : ropes + clearances]
        self.tensions = self.margins[:, :ropes]
        if self._pulling is not None:  # what pushes is no reason
            self._clearances = self.margins[:, ropes:]
            self.margins = np.ones((num, len(self.reasons)))
        self._spans = self._mapped[:, :, ropes + clearances :]

    def _read(self) -> None:
        """Bring every attribute up to date."""
        np.multiply(self._lengths, self._per_gear, self.drive_positions)
        np.multiply(self._length_rates, self._per_gear, self.drive_rates)
        self._state[...] = self._joint_state
        self._accelerations[...] = self._joint_accelerations
        for angles, rotation in self._turning:
            rotation[...] = turned(angles)
        if self._swinging:
            self._swing()
        np.matmul(self._joints, self._weights, self._mapped)
        if self._above.size:
            ropes = len(self.rig.ropes)
            heights = self._heights[:, self._above] - self._heights[:, self._below]
            self.margins[:, ropes : ropes + self._above.size] = heights
        self._forces.read(self._rubbing())
        if self._links is not None:
            self._links.read()
        if self._pulling is not None:
            self.margins[:, : len(self._pulling)] = self.tensions[:, self._pulling]
            self.margins[:, len(self._pulling) :] = self._clearances
        self._outputs.read()

    def _swing(self) -> None:
        """Where the loads on links are, from the points that they swing about."""
        for body, place in zip(self._swinging, self._ways, strict=True):
            place[...] = way(self.rig, body, self._named, place)

    def _rubbing(self) -> Array | None:
        """Force of friction along each rope, (n, ropes), None where nothing can rub."""
        dry = None if self._friction is None else self._friction.read()
        if self._viscous is None:
            return dry
        return self._viscous.read() if dry is None else dry + self._viscous.read()

    def _disturb(self, sim: int, scenario: Scenario) -> None:
        """Give a simulation its masses, friction and wind."""
        self._wind.set(sim, scenario)
        loads = [self.model.body(name).id for name in payload_bodies(self.rig)]
        self._scale_masses(sim, loads, scenario.load_mass, turns(self.rig))
        if self._friction is not None:
            self._friction.set(sim, scenario)
        if self._viscous is None and scenario.viscous:
            self._viscous = ViscousFriction(self.rig, self.model, self.batch)
        if self._viscous is not None:
            self._viscous.set(sim, scenario)

    def _forget(self, ids: Ids) -> None:
        self._wind.blow()

    def _placed(self, joints: Array, scenario: Scenario) -> Array:
        """Joints with each hanging load swung about what it hangs from, its rope or link as long.

        A platform stays upright: it moves as its first corner would, or what its links hang from.
        """
        if not scenario.swing:
            return joints
        state = State(joints[None], np.zeros_like(joints[None]))
        values, _ = coordinates(self.rig, self.model, state)
        place = {name: motion[0, 0] for name, motion in points(self.rig, *state).items()}
        corners = {anchor.name: anchor.frame for anchor in self.rig.anchors}
        moved, shifts = set[str](), dict[str, Array]()
        for end, above in hangers(self.rig).items():
            length = float(np.linalg.norm(place[end] - place[above]))
            aside = np.sin(scenario.swing) * heading(self.rig, scenario.swing_direction)
            down = np.array([0.0, 0.0, -np.cos(scenario.swing)])
            swung = place[above] + length * (aside + down)
            name = corners.get(end, end)
            if name in moved:
                continue
            moved.add(name)
            if name != end:
                swung = place[name] + (shifts[above] if above in shifts else swung - place[end])
            shifts[name] = swung - place[name]
            place[name] = swung
            for axis in self.rig.axes:
                values[f"{name}.{axis}"] = swung["xyz".index(axis), None]
        return self.stretching.moved(self.model, joints, values)
