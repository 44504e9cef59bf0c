"""What a stream says at each tick."""

from dataclasses import dataclass

from ...models.rig.rig import Rig
from ...models.types import Array
from ..series.products import factorials
from .evaluation import Evaluated


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


@dataclass(frozen=True, eq=False)
class Ahead:
    """What would follow from a stop, at N instants."""

    times: Array
    """After now [s], shape (N,)."""
    derivatives: Array
    """Outputs and their derivatives, shape (order+1, N, outputs)."""
    inputs: Array
    """At these instants [N] or [N m], shape (N, inputs)."""
    positions: Array
    """Coordinates [m] or [rad], shape (N, coordinates)."""
    velocities: Array
    """Their rates, shape (N, coordinates)."""


def ahead_of(times: Array, taylor: Array, found: Evaluated) -> Ahead:
    """What follows at some times (N,), from Taylor coefficients (orders, N, outputs)."""
    positions, velocities = (rows.T.copy() for rows in found.rows[:2])
    derivatives = taylor * factorials(len(taylor))[:, None, None]
    return Ahead(times, derivatives, found.inputs.T.copy(), positions, velocities)


def sample_of(
    rig: Rig,
    names: tuple[str, ...],
    time: float,
    velocity: Array,
    taylor: Array,
    found: Evaluated,
) -> Sample:
    """The sample of a tick.

    Parameters
    ----------
    rig
        That is driven.
    names
        Of its coordinates.
    time
        When the tick begins [s].
    velocity
        What was let through, shape (outputs,).
    taylor
        Of the outputs as the tick begins and at its middle, shape (orders, 2, outputs).
    found
        The rig at these two instants.
    """
    positions, velocities, accelerations = (rows[:, 0].copy() for rows in found.rows[:3])
    driven = [names.index(rig.driven(drive).coordinate) for drive in rig.drives]
    return Sample(
        time=time,
        velocity=velocity,
        inputs=found.inputs[:, 1].copy(),
        derivatives=taylor[:, 0] * factorials(len(taylor))[:, None],
        tensions=found.tensions[:, 0].copy(),
        drive_positions=positions[driven],
        drive_velocities=velocities[driven],
        coordinate_names=names,
        positions=positions,
        velocities=velocities,
        accelerations=accelerations,
    )
