"""What an integration gives: the motion, what it cost, and where it ended if it failed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..inverse import _angle
from ..motion import Motion, find_slack
from ..rotation import bryant
from .formulation import Formulation
from .newton import Counters
from .schemes import State

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Failure:
    """Where and why an integration ended early."""

    time: float
    """Last instant that was reached [s]."""
    step: float
    """Step that failed from there [s]."""
    reason: str

    def __str__(self) -> str:
        return f"no step of {self.step:.3g} s from {self.time:.6g} s: {self.reason}"


@dataclass(frozen=True, eq=False)
class Integration:
    """A motion found by stepping through time."""

    motion: Motion
    """At the steps, up to the last one that succeeded."""
    formulation: str
    scheme: str
    counters: Counters
    failure: Failure | None
    """None if the end of the path was reached."""


def motion_of(
    equations: Formulation, times: Array, states: list[State], angles: dict[str, float]
) -> Motion:
    """Name the unknowns of N states; `angles` are those of the turning frames at the start.

    Multipliers of constraints that the coordinates satisfy by themselves follow from the equations
    of motion, in the sense of least squares.
    """
    c = equations.mechanics.coordinates
    e, rig = c.equations, c.rig
    n = len(e.names)
    series = np.empty((3, len(times), n))
    multipliers = np.zeros((len(times), len(e.constraint_names)))
    inputs = np.empty((len(times), e.input_constant.shape[1]))
    kept = list(c.multipliers)
    lost = [k for k in range(multipliers.shape[1]) if k not in kept]
    for i, state in enumerate(states):
        rate, acceleration = equations.rates(*state)
        forces = equations.mechanics.forces(state.z, rate, acceleration)
        slope, bend = forces.place.slope, forces.place.bend
        series[:, i] = forces.place.q, slope @ rate, slope @ acceleration
        if bend is not None:
            series[2, i] += bend @ rate @ rate
        _, multipliers[i, kept], inputs[i] = equations.mechanics.split(state.z)
        if lost:
            pulls = forces.gradient[lost].T
            multipliers[i, lost] = np.linalg.lstsq(pulls, -forces.unbalanced, rcond=None)[0]
    columns = {name: series[:, :, i] for i, name in enumerate(e.names)}
    hidden = {i for _, *pair in e.turning for i in pair}
    for name, cos, sin in e.turning:
        near = np.unwrap(np.arctan2(series[0, :, sin], series[0, :, cos]))
        turns = np.round((angles[name] - near[0]) / (2.0 * np.pi))
        columns[name] = _angle(series[..., cos], series[..., sin], near + 2.0 * np.pi * turns)
    for orientation in e.orientations:
        hidden |= set(orientation.directors)
        columns |= _bryant(series[..., list(orientation.directors)], orientation.angles)
    free = (name for i, name in enumerate(e.names) if i not in hidden)
    names = tuple(dict.fromkeys((*rig.coordinate_names, *free)))
    positions, velocities, accelerations = np.array([columns[name] for name in names]).transpose(
        1, 2, 0
    )
    ones = np.ones((len(times), 1))
    lengths = np.hstack((series[0], ones))
    tensions = np.zeros((len(times), len(rig.ropes)))
    for i, (rope, spans, rows) in enumerate(zip(rig.ropes, e.spans, e.span_lengths, strict=True)):
        falls = rope.falls if len(spans) == 1 else 1
        tensions[:, i] = multipliers[:, spans[0]] * (lengths @ rows[0]) / falls
    return Motion(
        rig=rig,
        times=times,
        coordinate_names=names,
        positions=positions,
        velocities=velocities,
        accelerations=accelerations,
        inputs=inputs,
        tensions=tensions,
        multipliers=multipliers,
        slack=find_slack(rig, times, tensions),
    )


def _bryant(directors: Array, names: tuple[str, str, str]) -> dict[str, Array]:
    """Bryant angles, (3, N) each, of nine directors with two derivatives (3, N, 9)."""
    factorials = np.array([1.0, 1.0, 2.0])[:, None]
    rotation = directors.reshape(3, -1, 3, 3).swapaxes(-1, -2) / factorials[..., None, None]
    angles = bryant(rotation)
    angles[0] = np.unwrap(angles[0], axis=0)
    return {name: angles[..., i] * factorials for i, name in enumerate(names)}
