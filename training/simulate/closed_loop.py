"""Runs of a rig in MuJoCo under PD on its encoders, many at once.

    regulator = feedforward.Regulator(rig, set_point, stiffness, damping)
    course = closed_loop(regulator, values, rates, duration=20.0)
    regulator.energy(course.values, course.rates)       # (samples, runs), falls

The springs and dampers are put into the model's actuators, so that MuJoCo evaluates them within
its steps: the controller is continuous in time, as in the theory, and nothing but rounding and the
integrator's fourth order stands between a run and dW/dt = -sum d y'^2.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import ArrayLike

from ...feedforward import Motion, Regulator
from ...models import Rig
from ...models.errors import ModelError
from ...models.mjcf import rig_model
from ...models.rig.open_tensions import TENSION
from ...models.types import Array

THREADS = 2
"""Number of threads of a batch."""
ACCELERATIONS = int(mujoco.mjtStage.mjSTAGE_ACC)
"""Stage that makes accelerations and forces those of the new state."""
STICKING = (0.9999, 0.9999, 0.001, 0.5, 2.0)
"""`solimp` of a winch's dry friction: with MuJoCo's own a stuck rope creeps at 1e-3 m/s."""


@dataclass(frozen=True, eq=False)
class Course:
    """S samples of N runs."""

    rig: Rig
    times: Array
    """Instants of the samples [s], shape (S,)."""
    values: Mapping[str, Array]
    """Every coordinate in `Rig.coordinate_names` [m] or [rad], each (S, N)."""
    rates: Mapping[str, Array]
    """Rate of every coordinate [m/s] or [rad/s], each (S, N)."""
    tensions: Array
    """Rope tensions without a winch's dry friction [N], shape (S, N, ropes); a real rope has none
    below 0."""
    inputs: Array
    """Forces and torques of the drives [N, N m], shape (S, N, drives)."""

    @property
    def outputs(self) -> Array:
        """The rig's outputs, shape (S, N, outputs)."""
        pulls = zip(self.rig.tension_names, np.moveaxis(self.tensions, -1, 0), strict=False)
        values = {**self.values, **{name + TENSION: pull for name, pull in pulls}}
        columns = [
            np.sum([factor * values[name] for factor, name in terms], axis=0)
            for terms in map(self.rig.terms, self.rig.outputs)
        ]
        return np.stack(columns, axis=-1)


def closed_loop(
    regulator: Regulator,
    values: Mapping[str, ArrayLike],
    rates: Mapping[str, ArrayLike],
    duration: float,
    *,
    timestep: float = 1e-3,
    every: int = 1,
    massless: float | None = None,
    reference: Motion | None = None,
    each_step: Callable[[mujoco.MjModel, Batch, int], None] | None = None,
) -> Course:
    """Run from N initial states.

    Parameters
    ----------
    regulator
        The rig and its controller.
    values
        Initial coordinates of frames, trolleys and loads by name, each (N,).
    rates
        Their initial rates, each (N,).
    duration
        Duration of the run [s].
    timestep
        Time step of the simulation [s].
    every
        Steps from one sample to the next.
    massless
        Mass that stands in for massless loads [kg], as in `models.compile`.
    reference
        To follow instead of resting at the set point (K 3.88), sampled in the middle of
        every step; it is held over the step, so that inputs told at its end lag half a step.
    each_step
        Told of model, batch and number of each step ahead; may add to `batch.ctrl`.

    Raises
    ------
    ModelError
        The simulation breaks down, or MuJoCo cannot hold the rig.
    """
    rig, rubs = regulator.rig, each_step is not None
    model = rig_model.compile(
        rig, timestep=timestep, visuals=False, friction=rubs, massless=massless
    )
    _fit_springs(model, regulator)
    model.tendon_solimp_fri[:] = STICKING
    model.tendon_solref_fri[:, 0] = 4.0 * timestep
    batch = _batch(model, rig_model.joint_state(rig, model, values, rates))
    live = [batch.bind(name) for name in ("ctrl", "qpos", "qvel", "qacc", "actuator_force")]
    ctrl, *recorded = live
    commands = command(regulator, regulator.rest if reference is None else reference)
    ctrl[:] = commands[0]
    batch.forward()
    record = [[part.copy() for part in recorded]]
    steps = round(duration / timestep)
    stride = every if reference is None and not rubs else 1
    for k in range(0, steps, stride):
        ctrl[:] = commands[min(k, len(commands) - 1)]
        if each_step is not None:
            each_step(model, batch, k)
        batch.step(None, stride, ACCELERATIONS)
        if (k + stride) % every == 0:
            record.append([part.copy() for part in recorded])
    if batch.warning.any():
        raise ModelError(
            f"{rig.name}: the simulation breaks down; a smaller time step or smaller gains may help"
        )
    return _course(rig, model, every * timestep, record)


def command(regulator: Regulator, motion: Motion) -> Array:
    """Inputs along a motion and what springs and dampers pull towards, (S, drives)."""
    springs = regulator.stiffness * motion.drive_positions
    dampers = regulator.damping * motion.drive_velocities
    return np.asarray(motion.inputs + regulator.radii * (springs + dampers))


def _fit_springs(model: mujoco.MjModel, regulator: Regulator) -> None:
    """Let the actuators feel their own length and speed, which have the gear 1/radius."""
    model.actuator_biastype[:] = mujoco.mjtBias.mjBIAS_AFFINE
    model.actuator_biasprm[:, 1] = -(regulator.radii**2) * regulator.stiffness
    model.actuator_biasprm[:, 2] = -(regulator.radii**2) * regulator.damping


def _batch(model: mujoco.MjModel, start: rig_model.State) -> Batch:
    """Simulations in the given states."""
    qpos, qvel = (np.atleast_2d(part) for part in start)
    batch = Batch(model, len(qpos), min(THREADS, len(qpos)), persistent=True)
    batch.reset(stage=int(mujoco.mjtStage.mjSTAGE_NONE))
    batch.qpos, batch.qvel = qpos, qvel
    return batch


def _course(rig: Rig, model: mujoco.MjModel, interval: float, record: list[list[Array]]) -> Course:
    qpos, qvel, qacc, inputs = (np.stack(part) for part in zip(*record, strict=True))
    values, rates = rig_model.coordinates(rig, model, rig_model.State(qpos, qvel))
    tensions = rig_model.tensions(rig, qpos, qvel, qacc, inputs)
    times = np.arange(len(qpos), dtype=np.float64) * interval
    return Course(rig, times, values, rates, tensions, inputs)
