"""What a stream says at each tick."""

from dataclasses import dataclass

import numpy as np

from ...models.types import Array
from ..exact.naming import named_motion, platform_angles
from ..exact.problem import Problem
from ..exact.taylor import Solution
from ..series.products import factorials


@dataclass(frozen=True, eq=False)
class Sample:
    """One tick of a stream, in SI units; names of coordinates as in `Motion.coordinate_names`."""

    time: float
    """When the tick begins [s]."""
    velocity: Array
    """What was let through of the command [m/s] or [rad/s], shape (outputs,)."""
    inputs: Array
    """To be held during the tick [N] or [N m], exact at its middle, shape (inputs,)."""
    derivatives: Array
    """Outputs and their derivatives as the tick begins, shape (order+1, outputs)."""
    tensions: Array
    """Of the ropes as the tick begins [N], shape (ropes,)."""
    drive_positions: Array
    """What an encoder on each drive should read as the tick begins, shape (drives,)."""
    drive_velocities: Array
    """Rates of `drive_positions`, shape (drives,)."""
    coordinate_names: tuple[str, ...]
    """Of what follows."""
    positions: Array
    """Coordinates as the tick begins [m] or [rad], shape (coordinates,)."""
    velocities: Array
    """Their rates, shape (coordinates,)."""
    accelerations: Array
    """Their second derivatives, shape (coordinates,)."""


def sample_of(
    problem: Problem,
    time: float,
    velocity: Array,
    taylor: Array,
    solution: Solution,
    angles: dict[str, float],
) -> Sample:
    """The sample of a tick.

    Parameters
    ----------
    problem
        Of the rig.
    time
        When the tick begins [s].
    velocity
        What was let through, shape (outputs,).
    taylor
        Of the outputs as the tick begins and at its middle, shape (orders, 2, outputs).
    solution
        At these two instants.
    angles
        Of the turning frames, to within half a turn.
    """
    equations = problem.equations
    n, m = len(equations.names), len(equations.constraint_names)
    state = np.array([[w[0][:1], w[1][:1], 2.0 * w[2][:1]] for w in solution.series[:n]])
    forces = np.array([w[0] for w in solution.series[n:]]).T
    near = {name: np.array([angle]) for name, angle in angles.items()}
    platforms = platform_angles(equations, state, taylor[:, :1])
    motion = named_motion(
        equations, np.array([time]), state, near, platforms, forces[:1, :m], forces[1:, m:]
    )
    return Sample(
        time=time,
        velocity=velocity,
        inputs=motion.inputs[0],
        derivatives=taylor[:, 0] * factorials(len(taylor))[:, None],
        tensions=motion.tensions[0],
        drive_positions=motion.drive_positions[0],
        drive_velocities=motion.drive_velocities[0],
        coordinate_names=motion.coordinate_names,
        positions=motion.positions[0],
        velocities=motion.velocities[0],
        accelerations=motion.accelerations[0],
    )
