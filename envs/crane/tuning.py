"""Gains of the PD controller that follow from the rig.

What drives feel is the inertia C = (B^T M^-1 B)^-1 of their coordinates, with the mass matrix M of
all joints and the drives' directions B, while the load may swing (Khatib, IEEE J. Robotics and
Automation 3, 1987, (51)).  A trolley feels its own mass where the rope hangs straight, and more
where it slants; the two ropes of a roped trolley feel the load together, and only the trolley and
their drums against each other.  Towards the moving reference, gains are forces along these
coordinates that give every drive a frequency omega and a damping ratio zeta of `TUNING`:

    stiffness K_ij = omega_i C_ij omega_j
    damping   D_ij = 2 sqrt(zeta_i omega_i) C_ij sqrt(zeta_j omega_j)

with C where the plan has the crane to be.  So whatever motion drives make together has about these
frequencies: the hard directions get much force and the easy ones little, and nowhere does a stiff
drive meet the small inertia of another's motion.  Both matrices are symmetric and positive.

A load that is 15 % heavier than the rig's then pulls no drive further than 0.15 g / omega^2, 20 mm
for the winches' 8.6 rad/s.  Trolleys and booms, which share loads with winches, have the same: then
no motion they make together is quicker, and inputs may come two periods of 20 ms late, as in
scenarios of `Disturbances.standard`.  With three, the overhead crane's ropes go slack in one
scenario of twelve, and in all with trolleys at 10 rad/s.

Towards a fixed set point errors are of the size of the whole move, and lower frequencies with more
damping swing least.  There, gains are one number for each drive, from the diagonal of C at home.
Drives that move one thing together have common motions in which far less inertia meets the same
stiffness.  Where the quickest of them would have more than `COMMON` times the squared frequency of
a drive alone, all gains are made that much softer: lambda is the smallest eigenvalue of C with its
diagonal scaled to 1, and gains are multiplied by min(1, `COMMON` lambda).  Then a roped trolley
that is asked to go 5 m at once keeps its ropes taut.
"""

from typing import Any

import mujoco
import numpy as np

from ...models.mjcf.armature import tendon_jacobian
from ...models.mjcf.rig_state import joint_state
from ...models.rig.frames import rises
from ...models.rig.rig import Frame, Rope, Trolley
from ...models.types import Array
from ..gains import Gains, Track
from .plan import CranePlan
from .plant import Plant

TUNING: dict[Track, dict[type, tuple[float, float]]] = {
    "moving": {Rope: (8.6, 0.6), Trolley: (8.6, 0.6), Frame: (3.0, 0.7)},
    "set point": {Rope: (3.0, 1.0), Trolley: (4.0, 2.0), Frame: (1.0, 2.0)},
}
"""omega [rad/s] and zeta of winches, trolleys and frames."""

COMMON = 2.0
"""Most that a common motion's squared frequency may be of a drive's alone, at a set point."""

IMMOBILE = 1e-10
"""Mobility of drives' common motion, over the largest, below which it is rounding."""


def gains_of(plant: Plant, track: Track = "moving") -> Gains:
    """Gains of each drive alone at home."""
    frequency, ratio = _tuning(plant, track)
    coupled = inertia_matrices(plant, plant.home[None])[0]
    scale = np.sqrt(np.diag(coupled))
    inertia = np.diag(coupled) / _gears(plant)
    if track == "set point":
        shares = np.linalg.eigvalsh(coupled / np.outer(scale, scale))
        quickest = float(shares[max(0, len(shares) - plant.model.nv)])
        inertia = inertia * min(1.0, COMMON * quickest)
    return Gains(frequency**2 * inertia, 2.0 * ratio * frequency * inertia)


def gains_along(plant: Plant, plan: CranePlan) -> Array:
    """Stiffness and damping side by side at every step of a plan until arrival.

    Returns
    -------
    Array
        Inputs over their limits for each error of a drive's position, then of its rate,
        shape (steps, drives, 2 drives).
    """
    frequency, ratio = _tuning(plant, "moving")
    inertia = inertia_along(plant, plan)
    damping = np.sqrt(2.0 * ratio * frequency)
    factors = (np.outer(frequency, frequency), np.outer(damping, damping))
    forces = np.concatenate([inertia * factor for factor in factors], axis=2)
    return np.asarray(forces / forces_of(plant)[:, None])


def inertia_along(plant: Plant, plan: CranePlan) -> Array:
    """C at every step of a plan until arrival, shape (steps, drives, drives)."""
    coordinates: dict[str, Any] = dict(plan.course)
    joints = joint_state(plant.rig, plant.model, coordinates).qpos
    return inertia_matrices(plant, np.asarray(joints))


def inertia_matrices(plant: Plant, joints: Array) -> Array:
    """Forces along the drives' coordinates per acceleration of these, (N, drives, drives).

    Parameters
    ----------
    plant
        Of the rig.
    joints
        Where it is, shape (N, joints).
    """
    masses, gradients = gradients_of(plant, joints)
    if plant.model.neq:  # ropes that are constraints leave but some ways free
        free = _free_ways(plant.model, joints)
        masses, gradients = free.swapaxes(1, 2) @ masses @ free, gradients @ free
    mobility = gradients @ np.linalg.solve(masses, gradients.swapaxes(1, 2))
    drives, joints_of = gradients.shape[1:]
    if drives > joints_of:  # more ropes than freedoms: none feels what cannot move
        return np.asarray(np.linalg.pinv(mobility, rcond=IMMOBILE, hermitian=True))
    return np.asarray(np.linalg.inv(mobility))


def gradients_of(plant: Plant, joints: Array) -> tuple[Array, Array]:
    """Mass matrices, and how drives' coordinates change with joints, where joints are (N, joints).

    Returns
    -------
    tuple[Array, Array]
        Shapes (N, joints, joints) and (N, drives, joints).
    """
    model = plant.model
    data = mujoco.MjData(model)
    masses = np.zeros((len(joints), model.nv, model.nv))
    moments = np.zeros((len(joints), model.nu, model.nv))
    for mass, moment, position in zip(masses, moments, joints, strict=True):
        data.qpos[:] = position
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fullM(model, data, mass)
        mujoco.mju_sparse2dense(
            moment, data.actuator_moment, data.moment_rownnz, data.moment_rowadr,
            data.moment_colind,
        )  # fmt: skip
    # A motor's moment is its gear times the gradient of its coordinate.
    gradients = moments / _gears(plant)[:, None]
    return masses, gradients


def _free_ways(model: mujoco.MjModel, joints: Array) -> Array:
    """Directions of joints (N, joints) that no equality forbids, (N, joints, directions)."""
    data, ways = mujoco.MjData(model), []
    for position in joints:
        data.qpos[:] = position
        mujoco.mj_fwdPosition(model, data)
        held = tendon_jacobian(model, data)[model.eq_obj1id]
        ways.append(np.linalg.svd(held)[2][len(held) :].T)
    return np.array(ways)


def forces_of(plant: Plant) -> Array:
    """Force along each drive's coordinate that its whole limit gives, shape (drives,)."""
    limits: Array = np.array([drive.largest for drive in plant.rig.drives])
    return _gears(plant) * limits


def kind_of(part: Frame | Trolley | Rope) -> type:
    """How a driven part is tuned: a boom, which shares loads with winches, as a trolley."""
    return Trolley if isinstance(part, Frame) and rises(part) else type(part)


def _tuning(plant: Plant, track: Track) -> tuple[Array, Array]:
    kinds = [kind_of(plant.rig.driven(drive)) for drive in plant.rig.drives]
    frequency, ratio = np.array([TUNING[track][kind] for kind in kinds]).T
    return frequency, ratio


def _gears(plant: Plant) -> Array:
    return np.array(plant.model.actuator_gear[:, 0])
