"""Gains of the PD controller that follow from the rig.

The inertia m_i that drive i moves is the diagonal of (B^T M^-1 B)^-1 at home, with the mass matrix
M and the drives' directions B: what the drive has to accelerate there while the other drives hold
their coordinates and the load may swing.  With the frequency omega and the damping ratio zeta of
`TUNING`, as if the drive moved that inertia alone,

    stiffness k_i = m_i omega^2        damping d_i = 2 zeta omega m_i

A trolley's inertia is its own, since the load below it swings: 10 kg in the overhead crane.

Drives that move one thing together, as the two ropes of a roped trolley do, have common motions in
which far less inertia meets the same stiffness.  Where the quickest of them would have more than
`COMMON` times the squared frequency of a drive alone, all gains are made that much softer:
lambda is the smallest eigenvalue of the drives' inertia matrix with its diagonal scaled to 1, and
gains are multiplied by min(1, `COMMON` lambda).

The numbers were chosen once, for 50 Hz, on scenarios of `Disturbances.standard`, whose inputs come
up to two periods late: stiffer winches make ropes slack in some of them, softer drives track worse,
and nothing is left for a third period of delay.  Towards a fixed set point errors are of the size
of the whole move, and lower frequencies with more damping swing least.
"""

import mujoco
import numpy as np

from ...models.rig.rig import Frame, Rope, Trolley
from ...models.types import Array
from ..gains import Gains, Track
from .plant import Plant

TUNING: dict[Track, dict[type, tuple[float, float]]] = {
    "moving": {Rope: (5.5, 0.5), Trolley: (10.0, 0.7), Frame: (3.0, 0.7)},
    "set point": {Rope: (3.0, 1.0), Trolley: (4.0, 2.0), Frame: (1.0, 2.0)},
}
"""omega [rad/s] and zeta of winches, trolleys and frames."""

COMMON: dict[Track, float] = {"moving": 3.0, "set point": 2.0}
"""Moving: a rope's damping 2 zeta omega then grows to about a trolley's, which stands two periods
of delay.  Set point: a roped trolley that is asked to go 5 m at once keeps its ropes taut."""


def gains_of(plant: Plant, track: Track = "moving") -> Gains:
    """Gains for the drives of a plant's rig."""
    kinds = [type(plant.rig.driven(drive)) for drive in plant.rig.drives]
    frequency, ratio = np.array([TUNING[track][kind] for kind in kinds]).T
    inertia, quickest = _inertias(plant)
    inertia *= min(1.0, COMMON[track] * quickest)
    return Gains(frequency**2 * inertia, 2.0 * ratio * frequency * inertia)


def inertias(plant: Plant) -> Array:
    """Input per acceleration of each drive's own coordinate at home, (drives,)."""
    return _inertias(plant)[0]


def _inertias(plant: Plant) -> tuple[Array, float]:
    """The same, and the smallest eigenvalue of their matrix with its diagonal scaled to 1."""
    model = plant.model
    data = mujoco.MjData(model)
    data.qpos[:] = plant.home
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    moments = np.zeros((model.nu, model.nv))
    mujoco.mju_sparse2dense(
        moments, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind
    )
    # A motor's moment is its gear times the gradient of its coordinate.
    gears = model.actuator_gear[:, 0]
    gradients = moments / gears[:, None]
    coupled = np.linalg.inv(gradients @ np.linalg.solve(mass, gradients.T))
    scale = np.sqrt(np.diag(coupled))
    quickest = float(np.linalg.eigvalsh(coupled / np.outer(scale, scale))[0])
    return np.asarray(np.diag(coupled) / gears), quickest
