"""The move as exact feedforward makes it in MuJoCo: nothing measured, nothing corrected."""

import time
from dataclasses import dataclass

import mujoco
import numpy as np

from ...envs.crane.payloads import payloads
from ...feedforward import Motion, Reference, solve
from ...feedforward.exact.losses import losses_of
from ...models import Rig, Ropes
from ...models.mjcf import rig_model
from ...models.mjcf.rig_state import points
from ...models.mjcf.simulate import accelerations, run
from ...models.rig.idealised import with_ideal_gears
from ...models.types import Array

STAND_IN = 1e-5
"""Mass that stands in for that of a massless pulley, over that of all loads; `flatrig accuracy`
says how far the motion then is from the massless one."""
AT_ONCE = 1000
"""States whose tensions are found at once, so that a long run does not fill the memory."""


@dataclass(frozen=True, eq=False)
class OpenLoop:
    """A run at K + 1 instants, one time step apart."""

    times: Array
    """Instants [s], shape (K + 1,)."""
    qpos: Array
    """Joint positions of the model, shape (K + 1, nq)."""
    qvel: Array
    """Joint velocities, shape (K + 1, nv)."""
    distance: Array
    """Distance of the load or platform that is farthest from its place [m], shape (K + 1,)."""
    motion: Motion
    """What `solve` says at the same instants."""
    model: mujoco.MjModel
    """The model that ran."""
    seconds: float
    """Time that its steps took [s]."""

    def tensions(self) -> Array:
        """Rope tensions in MuJoCo under the exact inputs of each instant [N], (K + 1, ropes)."""
        inputs, losses = self.motion.inputs, losses_of(self.motion.rig)
        if losses is not None:
            inputs = losses.through_gears(inputs, self.motion.drive_velocities)
        tensions = []
        for begin in range(0, len(self.times), AT_ONCE):
            part = slice(begin, begin + AT_ONCE)
            state = (self.qpos[part], self.qvel[part])
            acceleration = accelerations(self.model, *state, inputs[part])
            tensions.append(rig_model.tensions(self.motion.rig, *state, acceleration, inputs[part]))
        return np.concatenate(tensions)


@dataclass(frozen=True, eq=False)
class Prepared:
    """A move's exact motion and inputs for one time step, ready for any model of the rig."""

    times: Array
    """Instants [s], shape (K + 1,)."""
    motion: Motion
    """The exact motion at these instants."""
    inputs: Array
    """Inputs at the middle of each step [N, N m], shape (K, drives)."""

    def run(self, model: mujoco.MjModel) -> OpenLoop:
        """The move in a model of that time step.

        Raises
        ------
        ModelError
            The simulation breaks down.
        """
        motion = self.motion
        start = dict(zip(motion.coordinate_names, motion.positions[0], strict=True))
        rates = None
        if any(frame.given for frame in motion.rig.frames):  # which may move from the start on
            rates = dict(zip(motion.coordinate_names, motion.velocities[0], strict=True))
        first = rig_model.joint_state(motion.rig, model, start, rates, motion.tensions[0])
        begin = time.perf_counter()
        state = run(model, first.qpos, first.qvel, self.inputs)
        seconds = time.perf_counter() - begin
        distance = _distance(motion, state.qpos)
        return OpenLoop(self.times, state.qpos, state.qvel, distance, motion, model, seconds)


def prepare(rig: Rig, reference: Reference, timestep: float, hold: float = 0.0) -> Prepared:
    """Solve a move for held inputs; parameters and errors as `open_loop`."""
    steps = round((reference.duration + hold) / timestep)
    times = np.arange(steps + 1, dtype=np.float64) * timestep
    middles = solve(rig, reference, times[:-1] + 0.5 * timestep)
    inputs, losses = middles.inputs, losses_of(rig)
    if losses is not None:  # MuJoCo's motors lose nothing
        inputs = losses.through_gears(inputs, middles.drive_velocities)
    return Prepared(times, solve(rig, reference, times), inputs)


def open_loop(
    rig: Rig,
    reference: Reference,
    timestep: float = 1e-3,
    hold: float = 0.0,
    massless: float | None = None,
    ropes: str | Ropes = "rigid",
) -> OpenLoop:
    """Run the move, the inputs of each step taken at its middle and held.

    What gears lose is taken off as planned speeds have it.

    Parameters
    ----------
    rig
        The description.
    reference
        Path of its outputs.
    timestep
        Time step of the simulation and of the held inputs [s].
    hold
        How long to go on after arrival [s].
    massless
        Mass that stands in for that of a massless pulley [kg]; `STAND_IN` if left out.
    ropes
        Ropes of the model, as for `models.compile`; the inputs stay those of rigid ones.

    Raises
    ------
    FlatrigError
        The rig cannot follow the path, or MuJoCo cannot hold the rig.
    """
    prepared, mass = prepare(rig, reference, timestep, hold), massless or stand_in(rig)
    model = rig_model.compile(
        with_ideal_gears(rig), timestep=timestep, visuals=False, massless=mass, ropes=ropes
    )
    return prepared.run(model)


def stand_in(rig: Rig) -> float | None:
    """A mass for MuJoCo in place of a massless pulley's [kg]; None if the rig has none."""
    if all(load.mass > 0 for load in rig.loads):
        return None
    return STAND_IN * rig.weight / rig.gravity


def _distance(motion: Motion, qpos: Array) -> Array:
    """How far the worst load or platform is from its place, free pulleys left aside, (N,) [m]."""
    rig = motion.rig
    places = points(rig, qpos, np.zeros_like(qpos))
    axes = ["xyz".index(axis) for axis in rig.axes]
    distances = []
    for part in payloads(rig):
        columns = [motion.column(f"{part.name}.{axis}") for axis in rig.axes]
        offset = places[part.name][0][:, axes] - motion.positions[:, columns]
        distances.append(np.linalg.norm(offset, axis=-1))
    return np.asarray(np.max(distances, axis=0))
