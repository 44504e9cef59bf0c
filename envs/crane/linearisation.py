"""Linear models of a crane along its plans: what a control period makes of small deviations.

    lineariser = Lineariser(rig, period=0.02)
    course = planned(rig, lineariser.model, plan, load_mass=1.1)
    model = lineariser.along([course])

With z the joints and their rates minus the planned ones, v the inputs over their limits minus the
planned ones, and w disturbances, a control period that begins at step k makes of them

    z' = A z + B v + G w,            y = H q

with the outputs y minus the planned ones, and the joints q, the first half of z.  Disturbances are
horizontal forces on all that hangs, one for each direction, and the Coulomb friction of winches,
trolleys and frames, against the speeds that are planned: all over the weight of what hangs.
Viscous friction and drag that a rig is described with are in A; its dry friction and the losses of
its gears jump with the speed and are in none of them, but in the planned inputs.

The columns are differences of whole control periods, simulated side by side in one batch, at knots
along the plan; between knots they are interpolated.
"""

from collections.abc import Sequence

import mujoco
import numpy as np
from mujoco.batch import Batch

from ...models.mjcf import rig_model
from ...models.rig.idealised import without_jumps
from ...models.rig.rig import Rig
from ...models.types import Array
from ..common import NOTHING
from ..formulas import Formulas
from .courses import Course
from .friction_forces import Places
from .linear_model import LinearModel
from .outputs import Outputs, sources
from .payloads import payload_bodies, payload_weight, payloads, turns

FRICTIONS = ("winch_friction", "trolley_friction", "frame_friction")
"""Frictions that are disturbances, as scenarios call them."""
SPACING = 0.1
"""Time from one knot to the next [s]: a coarse grid fails where a frame turns fast."""
SUBSTEPS = 1
"""Steps of a control period: a crane swings so slowly that one of fourth order is enough."""
STATE_STEP, INPUT_STEP, FORCE_STEP = 1e-5, 1e-3, 1e-3
"""Steps of the differences: of joints and their rates, of inputs over their limits, and of forces
over the weight, in which a period is affine but for what the deviation itself changes."""
SHARP = 0.01
"""Speed at which friction has three quarters of its size [m/s, rad/s]: it has a direction only
where something is planned to move."""
ENDLESS = 1e3
"""Room of a trolley whose rail has no end [m]."""
ROOM = 1024
"""About how many simulations run side by side."""


class Lineariser:
    """Makes linear models of one rig; keeps the simulations in which it takes differences.

    Parameters
    ----------
    rig
        The crane.
    period
        Of control [s].
    massless
        Stands in for the mass of free pulleys that have none [kg], see `flatrig.models.compile`.
    timestep
        Of the simulation [s]; by default a share of the period.
    nthread
        Threads of the simulation.
    room
        About how many simulations run side by side.
    """

    def __init__(
        self,
        rig: Rig,
        period: float,
        *,
        massless: float | None = None,
        timestep: float | None = None,
        nthread: int = 1,
        room: int = ROOM,
    ) -> None:
        self.rig, self.period, self.massless = rig, period, massless
        # Where dry friction holds a part still no small push moves it: that is no linear model.
        smooth = without_jumps(rig)
        self.stride = max(1, round(SPACING / period))
        substeps = SUBSTEPS if timestep is None else max(1, round(period / timestep))
        self._substeps = substeps
        self.model = model = rig_model.compile(
            smooth, timestep=period / substeps, visuals=False, massless=massless
        )
        # Slides and hinges only: joints are numbers, and so are their deviations.
        assert model.nq == model.nv
        self.axes = 1 if rig.dimensions == 2 else 2
        self._limits = np.array([drive.largest for drive in rig.drives])
        self._weight = payload_weight(rig)
        self._loads = [model.body(part.name).id for part in payloads(rig)]
        self._carried = [model.body(name).id for name in payload_bodies(rig)]
        self._states, self._drives = 2 * model.nv, len(self._limits)
        self.disturbances = self.axes + len(FRICTIONS)
        self._copies = 1 + self._states + self._drives + self.disturbances
        self._points = max(1, room // self._copies)
        self._batch = Batch(model, self._points * self._copies, nthread, persistent=True)
        self._factors = np.ones(self._points * self._copies)
        self._bind()

    def along(self, courses: Sequence[Course]) -> LinearModel:
        """Linear models along courses, taken together."""
        knots = [_knots(len(course.states) - 1, self.stride) for course in courses]
        states = np.concatenate([c.states[own] for c, own in zip(courses, knots, strict=True)])
        inputs = np.concatenate([c.inputs[own] for c, own in zip(courses, knots, strict=True)])
        counts = [len(own) for own in knots]
        masses = np.repeat([course.load_mass for course in courses], counts)
        transition, outputs, drives = self.at(states, inputs, masses)
        # One after the other, made as long as the longest by repeating their last.
        most = max(counts)
        first = np.cumsum([0, *counts[:-1]])
        rows = first[:, None] + np.minimum(np.arange(most), np.array(counts)[:, None] - 1)
        return LinearModel(
            np.concatenate(knots)[rows].astype(float), transition[rows], outputs[rows],
            drives[rows], self._rooms(states)[rows], self._trolleys, self.stride, self._drives,
            self.axes, self.period,
        )  # fmt: skip

    def _rooms(self, states: Array) -> Array:
        """How far trolleys are from the ends of their rails, (N, trolleys)."""
        places = states[:, : self.model.nv] @ self._trolleys.T
        rails = [self.rig.rail(trolley.rail) for trolley in self.rig.trolleys]
        starts, ends = np.array([(rail.start, rail.end) for rail in rails]).reshape(-1, 2).T
        return np.asarray(np.minimum(np.minimum(places - starts, ends - places), ENDLESS))

    def at(self, states: Array, inputs: Array, load_masses: Array) -> tuple[Array, Array, Array]:
        """[A B G], H, and drive positions by joints, at N points.

        Parameters
        ----------
        states, inputs, load_masses
            Joints and rates (N, 2 joints), inputs over their limits (N, drives), and masses of
            payloads over the rig's (N,), to hold over one period.

        Returns
        -------
        tuple
            Shapes (N, states, states + inputs + disturbances), (N, outputs, joints) and
            (N, drives, joints).
        """
        parts = [
            self._some(*(values[np.minimum(np.arange(first, first + self._points), len(states) - 1)]
                         for values in (states, inputs, load_masses)))
            for first in range(0, len(states), self._points)
        ]  # fmt: skip
        columns, outputs, drives = (
            np.concatenate(part)[: len(states)] for part in zip(*parts, strict=True)
        )
        return columns, outputs, drives

    def _bind(self) -> None:
        batch = self._batch
        self._qpos, self._qvel, self._ctrl = (batch.bind(n) for n in ("qpos", "qvel", "ctrl"))
        self._push, self._force = batch.bind("xfrc_applied"), batch.bind("qfrc_applied")
        self._ropes = batch.bind("ten_J")
        self._lengths, self._gears = batch.bind("actuator_length"), self.model.actuator_gear[:, 0]
        self._masses = batch.expand("body_mass")
        self._inertias = batch.expand("body_inertia") if turns(self.rig) else None
        self._outputs, look = np.zeros((batch.nsim, len(self.rig.outputs))), Formulas(batch.nsim)
        look.keep(self._outputs, Outputs(self.rig, self.model, batch).values(look))
        self._look = look.made()
        self._at = Places(self.rig, self.model)
        self._trolleys = np.zeros((len(self.rig.trolleys), self.model.nv))
        for row, trolley in enumerate(self.rig.trolleys):
            for _, joint, factor in sources(self.rig, self.model)[trolley.coordinate]:
                self._trolleys[row, joint] += factor

    def _some(self, states: Array, inputs: Array, load_masses: Array) -> tuple[Array, Array, Array]:
        """The same for as many points as there is room for."""
        joints, first = self.model.nv, 1 + self._states
        every = self._by_point
        self._load(np.repeat(load_masses, self._copies))
        state = np.repeat(states[:, None], self._copies, axis=1)
        state[:, 1:first] += STATE_STEP * np.eye(self._states)
        every(self._qpos)[...], every(self._qvel)[...] = state[..., :joints], state[..., joints:]
        held = np.repeat(inputs[:, None], self._copies, axis=1)
        held[:, first : first + self._drives] += INPUT_STEP * np.eye(self._drives)
        every(self._ctrl)[...] = held * self._limits
        self._batch.forward(None, int(mujoco.mjtStage.mjSTAGE_POS))
        self._look()
        slopes, drives = (
            ((places[:, 1 : 1 + joints] - places[:, :1]) / STATE_STEP).swapaxes(1, 2)
            for places in (every(self._outputs), every(self._lengths / self._gears))
        )
        self._disturb(states[:, joints:])
        self._batch.step(None, self._substeps, NOTHING)
        after = np.concatenate((every(self._qpos), every(self._qvel)), axis=2)
        columns = after[:, 1:] - after[:, :1]
        steps = np.repeat(
            (STATE_STEP, INPUT_STEP, FORCE_STEP), (self._states, self._drives, self.disturbances)
        )
        return (columns / steps[:, None]).swapaxes(1, 2), slopes, drives

    def _by_point(self, values: Array) -> Array:
        """A live array of all simulations, (points, copies, ...)."""
        return values.reshape(self._points, self._copies, *values.shape[1:])

    def _load(self, factors: Array) -> None:
        """Give every simulation its load."""
        bodies = self._carried
        self._masses[:, bodies] = factors[:, None] * self.model.body_mass[bodies]
        if self._inertias is not None:
            self._inertias[:, bodies] = factors[:, None, None] * self.model.body_inertia[bodies]
        changed = np.flatnonzero(factors != self._factors)
        if changed.size:
            self._batch.set_const(changed.astype(np.int32))
        self._factors = factors

    def _disturb(self, rates: Array) -> None:
        """Let each of the last copies feel one disturbance; positions are up to date."""
        size, first = FORCE_STEP * self._weight, 1 + self._states + self._drives
        push, force = self._by_point(self._push), self._by_point(self._force)
        push[...], force[...] = 0.0, 0.0
        for axis in range(self.axes):
            # `payloads` share a wind as scenarios blow it: the same force on each.
            push[:, first + axis, self._loads, axis] = size
        for index, rubs in enumerate(self._rubbing(rates)):
            force[:, first + self.axes + index] = size * rubs

    def _rubbing(self, rates: Array) -> list[Array]:
        """Joint forces of unit friction of winches, trolleys and frames, (points, joints) each."""
        model, at = self.model, self._at
        ropes = self._by_point(self._ropes)[:, 0]
        frictions = [np.zeros_like(rates) for _ in FRICTIONS]
        for index, tendons in enumerate((at.winches, at.sums)):
            for tendon in tendons:
                start, count = model.ten_J_rowadr[tendon], model.ten_J_rownnz[tendon]
                along = np.zeros_like(rates)
                along[:, model.ten_J_colind[start : start + count]] = ropes[
                    :, start : start + count
                ]
                speed = (along * rates).sum(axis=1, keepdims=True)
                frictions[index] -= along * np.tanh(speed / SHARP)
        for index, joints in ((1, at.slides), (2, at.frames)):
            frictions[index][:, joints] -= np.tanh(rates[:, joints] / SHARP)
        return frictions


def _knots(steps: int, stride: int) -> Array:
    """Steps of the knots of a course: evenly, and the last."""
    return np.append(np.arange(0, steps, stride), steps)
