"""The simulations behind the environments: `mujoco.batch` with the rig's own names for things.

Each has its own load mass, friction and wind.  What is read after a control period belongs to the
new state under the inputs still held.
"""

from collections.abc import Callable, Sequence
from weakref import WeakKeyDictionary

import mujoco
import numpy as np

from ...models.mjcf.rig_state import State, coordinates, joint_state, points
from ...models.mjcf.ropes import Ropes
from ...models.rig.chain import joint_names, weighed
from ...models.rig.idealised import with_ideal_gears
from ...models.rig.rig import Rig
from ...models.types import Array
from ..common import NOT_FINITE, NOTHING, Ids
from ..formulas import Formulas, Value, in_order
from ..simulations import Simulations
from .disturbances import Scenario
from .friction_forces import DryFriction, ViscousFriction
from .gear_losses import loses
from .geometry import angle_joints, geometry_of, hangers, swing_bodies
from .link_forces import LinkForces
from .moving_base import MovingBase
from .outputs import Outputs
from .payloads import payload_bodies, turns
from .plan import CranePlan
from .plant_model import plant_model
from .stretching import Stretching
from .tensions import RopeForces, sensed
from .turning_parts import rotation, way
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
        # How BLAS rounds depends on the place of a column: the first ones are left empty.
        empty = np.zeros((len(rig.tension_names), self.geometry.clearances.shape[1]))
        rows = (empty, self.geometry.clearances, *self.geometry.spans)
        self._weights = np.ascontiguousarray(np.vstack(rows).T)
        self._pulling = [] if self.stretching.slackens else list(rig.pulling)
        self.reasons = (SLACK,) * len(self._pulling) + self.geometry.reasons
        self.tensions = np.zeros((num, len(rig.tension_names)))
        self.margins = np.ones((num, len(self.reasons)))
        self._outputs = Outputs(rig, self.model, self.batch)
        self.outputs = np.zeros((num, len(rig.outputs)))
        self.output_rates = np.zeros((num, len(rig.outputs) if rates else 0))
        self._links: LinkForces | None = None
        if rig.links and not weighed(rig):  # or what tells of ropes tells of links
            self._links = LinkForces(rig, self.model, self.batch)
        self._forces = RopeForces(rig, self.model, self.batch, self.geometry)
        self._friction = None
        described = self.model.tendon_frictionloss.any(), self.model.dof_frictionloss.any()
        if friction or any(described) or loses(rig):
            frames = frame_friction or any(frame.friction.coulomb for frame in rig.frames)
            frames = frames or loses(rig)
            self._friction = DryFriction(rig, self.model, self.batch, frames)
        self._viscous: ViscousFriction | None = None
        if self.model.tendon_damping.any() or self.model.dof_damping.any():
            self._viscous = ViscousFriction(rig, self.model, self.batch)
        self._starts: WeakKeyDictionary[CranePlan, State] = WeakKeyDictionary()
        self._carried = [self.model.body(name).id for name in payload_bodies(rig)]
        self._turns = turns(rig)
        self._wind = Wind(rig, self.model, self.batch)
        self._follow: Callable[[], None] | None = None
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
        read = (self.encoders, self.tensions, self.margins, self.outputs, self.output_rates)
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
            self.base.start(ids, [self.start_of(plans[sim]) for sim in ids.tolist()])
            self.batch.forward(ids, self.stage)
            self._read()

    def at_rest(self, plan: CranePlan) -> Array:
        """Joints (nq,) where a plan begins."""
        return np.asarray(self.start_of(plan).qpos)

    def start_of(self, plan: CranePlan) -> State:
        """How a plan begins, its base in motion; kept, as many episodes may have the same plan."""
        if plan not in self._starts:
            rest = self.stretching.at_rest(self.model, plan.start, plan.inputs)
            rates = np.zeros_like(rest)
            if self.base is not None:
                rates = joint_state(self.rig, self.model, plan.start, plan.rates).qvel
            self._starts[plan] = State(rest, rates)
        return self._starts[plan]

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

    def _read(self) -> None:
        """Bring every attribute up to date."""
        if self._follow is None:
            self._follow = self._formulas().made()
        self._follow()

    def _mapped(self, step: Formulas) -> list[Value]:
        """What the affine map makes of the joints, (n, numbers) of each order."""
        names = joint_names(self.rig)
        joints = [step.see(self.batch.bind(name)) for name in ("qpos", "qvel", "qacc")]
        motion = {name: [part[[column]] for part in joints] for column, name in enumerate(names)}
        angles = [[motion[name] for name in names[own]] for own in angle_joints(self.rig)]
        parts = [joints, *(rotation(step, own) for own in angles)]
        parts += [way(step, self.rig, body, motion) for body in swing_bodies(self.rig)]
        parts.append([step.constant(float(order == 0)) for order in range(3)])
        every = step.join([part[order] for order in range(3) for part in parts])
        size = self._weights.shape[1]
        mapped = step.apply(self._map, every, 3 * size)
        return [mapped[range(order * size, (order + 1) * size)] for order in range(3)]

    def _map(self, joints: Array, out: Array) -> None:
        """One small product of matrices for each simulation."""
        numbers, size = self._weights.shape
        np.matmul(joints.reshape(-1, 3, numbers), self._weights, out.reshape(-1, 3, size))

    def _formulas(self) -> Formulas:
        """What follows from joints, tendons and the affine map."""
        step, rig = Formulas(self.num), self.rig
        gears = step.constant(1.0 / self.model.actuator_gear[:, 0])
        for name, attribute in (("length", "drive_positions"), ("velocity", "drive_rates")):
            moved = step.see(self.batch.bind(f"actuator_{name}"))
            step.keep(getattr(self, attribute), moved * gears)
        mapped = self._mapped(step)
        first, clear = len(rig.tension_names), len(self.geometry.reasons)
        vectors = [order[range(first + clear, order.width)] for order in mapped]
        tensions = self._forces.of(step, vectors, self._rubbing(step))
        if self._links is not None:
            tensions = step.join([tensions, self._links.of(step)])
        step.keep(self.tensions, tensions)
        margins = mapped[0][range(first, first + clear)]
        if self.geometry.hung:
            above, below = (
                step.see(
                    self.batch.bind("site_xpos"), [3 * self.model.site(p).id + 2 for p in side]
                )
                for side in zip(*self.geometry.hung, strict=True)
            )
            margins = step.join([above - below, margins[range(above.width, clear)]])
        step.keep(self.margins, step.join([tensions[self._pulling], margins]))
        step.keep(self.outputs, self._outputs.values(step, tensions))
        if self.output_rates.size:
            step.keep(self.output_rates, self._outputs.rates(step))
        return step

    def _rubbing(self, step: Formulas) -> Value | None:
        """Force of friction along each rope, (n, ropes), None where nothing can rub."""
        rubbing = [part.along(step) for part in (self._friction, self._viscous) if part is not None]
        return in_order(rubbing) if rubbing else None

    def _disturb(self, sim: int, scenario: Scenario) -> None:
        """Give a simulation its masses, friction and wind."""
        self._wind.set(sim, scenario)
        self._scale_masses(sim, self._carried, scenario.load_mass, self._turns)
        if self._friction is not None:
            self._friction.set(sim, scenario)
        if self._viscous is None and scenario.viscous:
            self._viscous = ViscousFriction(self.rig, self.model, self.batch)
            self._follow = None
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
