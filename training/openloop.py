"""The move as exact feedforward makes it in MuJoCo: nothing measured, nothing corrected."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..feedforward import Reference, solve
from ..models import Rig, mjcf
from ..models.run import run

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class OpenLoop:
    """A run at K + 1 instants, one time step apart."""

    times: Array
    """[s], shape (K + 1,)."""
    qpos: Array
    """Joint positions of the model, shape (K + 1, nq)."""
    distance: Array
    """Of the outputs from their reference [m], shape (K + 1,)."""


def open_loop(
    rig: Rig, reference: Reference, timestep: float = 1e-3, hold: float = 0.0
) -> OpenLoop:
    """Run the move, the inputs of each step taken at its middle and held.

    Args:
        rig: the description.
        reference: path of its outputs.
        timestep: of the simulation and of the held inputs [s].
        hold: how long to go on after arrival [s].

    Raises:
        FlatrigError: the rig cannot follow the path, or MuJoCo cannot hold the rig.
    """
    steps = round((reference.duration + hold) / timestep)
    times = np.arange(steps + 1) * timestep
    start = solve(rig, reference, 0.0)
    columns = dict(zip(start.coordinate_names, start.positions[0], strict=True))
    model = mjcf.compile(rig, timestep=timestep, visuals=False)
    first = mjcf.joint_state(rig, model, columns)
    inputs = solve(rig, reference, times[:-1] + 0.5 * timestep).inputs
    state = run(model, first.qpos, first.qvel, inputs)
    values, _ = mjcf.coordinates(rig, model, state)
    outputs = np.column_stack([values[name] for name in rig.outputs])
    distance = np.asarray(np.linalg.norm(outputs - reference(times), axis=1))
    return OpenLoop(np.asarray(times, dtype=np.float64), state.qpos, distance)
