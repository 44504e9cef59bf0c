"""Free motion of a model, and what of its energy and momentum an integrator loses or makes.

    motion = free_motion("rotary_crane")
    energy, momentum = drift(model, motion)

No input acts, the winches run free, and loads fall: the sum of kinetic and potential energy stays,
and so does the momentum of every joint on which neither the masses nor gravity depend, such as the
angular momentum about a turning frame's axis.

The rotary crane's is Y's example (2.90, 2.91, table 2.1); the others start at home, every joint
pushed a little.
"""

from collections.abc import Callable
from typing import NamedTuple

import mujoco
import numpy as np

from ...models import Rig, make
from ...models.mjcf import rig_model
from ...models.mjcf.simulate import run
from ...models.types import Array

DURATION = 1.0
"""Duration of a run [s]."""
PUSH = 0.1
"""Speed of every joint at the start [m/s] or [rad/s]."""
INSTANTS = 100
"""Instants of a run, at most, at which energy and momentum are looked at."""
SAME = 1e-12
"""Largest change of mass matrix or weight, over their largest entry, that is rounding."""


class Free(NamedTuple):
    """A rig let go."""

    rig: Rig
    coordinates: dict[str, float]
    """Coordinates at the start [m] or [rad]; none for a rig at home whose joints are pushed."""
    rates: dict[str, float]
    """Rates at the start [m/s] or [rad/s]."""


class Drift(NamedTuple):
    """Largest departures from the start."""

    energy: float
    """Largest change of the energy [J]."""
    momentum: float
    """Largest change of a joint's momentum, over that at the start; NaN where none is conserved."""


def free_motion(name: str) -> Free:
    """The start for a rig of the catalogue."""
    if name != "rotary_crane":
        return Free(make(name), {}, {})
    masses = {"trolley_mass": 53.0, "load_mass": 10.0}  # m2 and m3 move with s
    inertias = {"bridge_inertia": 16.67 + 2.08 + 0.26, "winch_inertia": 0.02}
    at = {"bridge.angle": 0.0, "trolley.position": 1.5, "load.x": 1.5, "load.y": 0.0}
    rates = {"bridge.angle": 1.0, "load.y": 1.5}
    return Free(make(name, **masses, **inertias), at | {"load.z": -5.0}, rates)


def drift(
    model: mujoco.MjModel, free: Free, change: Callable[[Array], Array] = np.asarray
) -> Drift:
    """Let the rig go in its model.

    Parameters
    ----------
    model
        The rig's model.
    free
        The rig with its start.
    change
        Changes joint positions (nq,) and velocities (nv,) of the start, as noise does.

    Raises
    ------
    ModelError
        The simulation breaks down.
    """
    qpos, qvel = model.key_qpos[0], np.full(model.nv, PUSH)
    if free.coordinates:
        qpos, qvel = rig_model.joint_state(free.rig, model, free.coordinates, free.rates)
    steps = round(DURATION / model.opt.timestep)
    state = run(model, change(qpos), change(qvel), np.zeros((steps, model.nu)))
    instants = np.unique(np.linspace(0, steps, INSTANTS + 1).astype(int))
    joints = cyclic(model)
    rows = [_conserved(model, state.qpos[i], state.qvel[i], joints) for i in instants]
    energy, momentum = map(np.array, zip(*rows, strict=True))
    departure = np.abs(momentum - momentum[0]) / np.abs(momentum[0])
    worst = float(departure.max()) if len(joints) else float("nan")
    return Drift(float(np.abs(energy - energy[0]).max()), worst)


def cyclic(model: mujoco.MjModel) -> Array:
    """Joints on which neither mass matrix nor weight depends, their numbers (n,)."""
    generator = np.random.default_rng(0)
    base = model.key_qpos[0] + generator.uniform(-0.3, 0.3, model.nq)
    mass, weight = _mass_and_weight(model, base)
    joints = []
    for joint in range(model.nv):
        moved = base.copy()
        moved[joint] += 0.5
        other, pull = _mass_and_weight(model, moved)
        same = np.abs(other - mass).max() <= SAME * np.abs(mass).max()
        free = np.abs(weight[joint]) <= SAME * np.abs(weight).max()
        if same and free and np.abs(pull - weight).max() <= SAME * np.abs(weight).max():
            joints.append(joint)
    return np.array(joints, dtype=int)


def _mass_and_weight(model: mujoco.MjModel, qpos: Array) -> tuple[Array, Array]:
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    return _mass_matrix(model, data), data.qfrc_bias - data.qfrc_passive


def _conserved(
    model: mujoco.MjModel, qpos: Array, qvel: Array, joints: Array
) -> tuple[float, Array]:
    """Energy [J], and the momenta of some joints."""
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_fwdPosition(model, data)
    momentum = _mass_matrix(model, data) @ qvel
    weights = model.body_mass * (1.0 - model.body_gravcomp)
    height = -float(weights @ (data.xipos @ model.opt.gravity))
    return 0.5 * float(qvel @ momentum) + height, momentum[joints]


def _mass_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full
