"""Second roads to a motion: what judges a stressed case, none of it taken from the solver.

    worst_residual(motion, reference)    # of the equations, from the motion's named results alone
    from_equations(motion)               # accelerations under its inputs, by the index-1 equations
    from_mujoco(motion)                  # the same, by MuJoCo
    jump(rig, reference, motion)         # whether it hops from one branch to another
    energy(rig, values, rates)           # kinetic and potential, from the description

All but the last are errors that must be small; they raise nothing but what MuJoCo's model raises.
"""

from collections.abc import Mapping

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from ...feedforward import Motion, Reference, equations_of, redundant, residuals, solve
from ...models import Rig
from ...models.mjcf import rig_model as mjcf
from ...models.mjcf.rig_state import points
from ...models.mjcf.simulate import accelerations
from ...models.rig.chain import joint_names
from ...models.rig.frames import about_axis
from ...models.rig.lengths import rope_lengths
from ...models.types import Array
from .forces import Seen, few_of, model_of
from .given_forces import smooth_twin

FINER, DEPTH = 32, 5
"""A step in which a jump is suspected is divided so often, up to so many times over."""
SMOOTH = 1e-3
"""Share of a coordinate's range that it may be off its Hermite interpolation in one step."""
FLAT = 1e-6
"""A smaller share of the largest coordinate is no range."""


def worst_residual(motion: Motion, reference: Reference) -> float:
    """The largest of `feedforward.residuals`."""
    return float(residuals(motion, reference).max())


def from_equations(motion: Motion) -> float:
    """Accelerations of the index-1 equations under the motion's inputs, against the motion's."""
    equations = equations_of(motion.rig)
    few = few_of(motion)
    values, rates = (
        {name: table[few, motion.column(name)] for name in motion.rig.coordinate_names}
        for table in (motion.positions, motion.velocities)
    )
    second, _ = equations.accelerations(*redundant(equations, values, rates), motion.inputs[few])
    errors = []
    for i, name in enumerate(equations.names):
        if name in motion.rig.coordinate_names:
            expected = motion.accelerations[few, motion.column(name)]
            errors.append(np.abs(second[:, i] - expected))
    return _relative(motion, np.max(errors, axis=0), few)


def from_mujoco(motion: Motion) -> float:
    """MuJoCo's accelerations under the motion's inputs, against the motion's.

    Inputs from 1e10 on MuJoCo takes for a mistake: such a motion is not compared.

    Raises
    ------
    ModelError
        MuJoCo cannot hold the rig.
    """
    motion, few = smooth_twin(motion), few_of(motion)
    rig = motion.rig
    if np.abs(motion.inputs[few]).max() >= mujoco.mjMAXVAL:
        return 0.0
    model = model_of(rig)
    values, rates = (
        {name: table[few, motion.column(name)] for name in rig.coordinate_names}
        for table in (motion.positions, motion.velocities)
    )
    state = mjcf.joint_state(rig, model, values, rates)
    turn = accelerations(model, *state, motion.inputs[few])
    world = points(rig, *state, turn)
    second = {f"{name}.length": length[2] for name, length in rope_lengths(rig, world).items()}
    for load in rig.hanging:
        second |= {
            f"{load.name}.{axis}": world[load.name][2][:, "xyz".index(axis)] for axis in rig.axes
        }
    own = [frame.coordinate for frame in rig.frames]
    own += rig.platform_angles
    second |= {name: turn[:, joint_names(rig).index(name)] for name in own}
    errors = [
        np.abs(column - motion.accelerations[few, motion.column(name)])
        for name, column in second.items()
    ]
    return _relative(motion, np.max(errors, axis=0), few)


def jump(rig: Rig, reference: Reference, motion: Motion) -> float:
    """The largest part of a coordinate's range that one step leaves unexplained.

    Positions must continue each other as their rates and accelerations say.  Where they do not the
    step is divided; a hop to another branch of the solutions stays as large as it is.
    """
    size = np.maximum(np.ptp(motion.positions, axis=0), FLAT * np.abs(motion.positions).max())
    for _ in range(DEPTH):
        jumps = _unexplained(motion) / size
        worst = int(jumps.max(axis=1).argmax())
        if jumps[worst].max() <= SMOOTH:
            break
        begin, end = motion.times[worst : worst + 2].tolist()
        times = np.linspace(begin, end, FINER + 1)
        motion = solve(rig, reference, times)
    return float(jumps.max())


def _unexplained(motion: Motion) -> Array:
    """By what every step differs from the Hermite rule of fifth order, (N - 1, coordinates)."""
    step = np.diff(motion.times)[:, None]
    mean = 0.5 * (motion.velocities[1:] + motion.velocities[:-1])
    bend = np.diff(motion.accelerations, axis=0) / 12.0
    return np.asarray(np.abs(np.diff(motion.positions, axis=0) - step * mean + step**2 * bend))


def energy(rig: Rig, values: Mapping[str, ArrayLike], rates: Mapping[str, ArrayLike]) -> Array:
    """Kinetic and potential energy, (N,) [J], from coordinates and their rates, each (N,)."""
    equations = equations_of(rig)
    arrays = [
        {name: np.asarray(column, dtype=float) for name, column in columns.items()}
        for columns in (values, rates)
    ]
    place, rate = redundant(equations, *arrays)
    kinetic = 0.5 * np.einsum("...i,ij,...j->...", rate, equations.mass, rate)
    return np.asarray(kinetic - place @ equations.force)


def allowance(motion: Motion) -> float:
    """What rounding and points that are not quite points may do to accelerations, relative.

    A rope's direction is known to the rounding of places over the rope's shortest span, and that
    turns its tension; MuJoCo's point masses turn with their frame.
    """
    rig = motion.rig
    turned = Seen(motion).rounding
    pulled = 1.0 + np.abs(motion.tensions).max() / rig.weight
    inertias = [
        about_axis(frame) for frame in rig.frames if frame.kind == "turning" and not frame.given
    ]
    points = len(rig.masses) * mjcf.POINT_INERTIA / min(inertias, default=np.inf)
    return float(turned * pulled + points)


def _relative(motion: Motion, error: Array, few: Array) -> float:
    """Over gravity and the largest acceleration at that instant."""
    size = motion.rig.gravity + np.abs(motion.accelerations[few]).max(axis=1)
    return float((error / size).max())
