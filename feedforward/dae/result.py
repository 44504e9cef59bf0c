"""What an integration gives: the motion, what it cost, and where it ended if it failed."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...models.types import Array
from ..exact.inverse import turning_angle
from ..exact.motion import Motion, find_slack
from ..paths.reference import Reference
from ..series.rotation import bryant
from .formulation import Formulation
from .newton import Counters
from .schemes import State
from .start import start_angles


@dataclass(frozen=True)
class Failure:
    """Where and why an integration ended early."""

    time: float
    """Last instant that was reached [s]."""
    step: float
    """Step that failed from there [s]."""
    reason: str
    """Why it failed, in words."""

    def __str__(self) -> str:
        return f"no step of {self.step:.3g} s from {self.time:.6g} s: {self.reason}"


@dataclass(frozen=True, eq=False)
class Integration:
    """A motion found by stepping through time."""

    motion: Motion
    """Motion at the steps, up to the last one that succeeded."""
    formulation: str
    """Name of the formulation."""
    scheme: str
    """Name of the scheme."""
    counters: Counters
    """What the integration cost."""
    failure: Failure | None
    """Where and why it ended early; None if the end of the path was reached."""


def motion_of(
    equations: Formulation, times: Array, states: list[State], reference: Reference
) -> Motion:
    """The motion through N states along a reference, angles counted from those at its start."""
    problem = equations.mechanics.coordinates.problem
    e, rig, angles = problem.equations, problem.rig, start_angles(problem, reference)
    parts = [_polynomial(equations, state) for state in states]
    series = np.array([part.series for part in parts]).swapaxes(0, 1)
    multipliers = np.array([part.multipliers for part in parts])
    columns = {name: series[:, :, i] for i, name in enumerate(e.names)}
    hidden = {i for _, *pair in e.turning for i in pair}
    for name, cos, sin in e.turning:
        near = np.unwrap(np.arctan2(series[0, :, sin], series[0, :, cos]))
        turns = np.round((angles[name] - near[0]) / (2.0 * np.pi))
        columns[name] = turning_angle(
            series[..., cos], series[..., sin], near + 2.0 * np.pi * turns
        )
    for orientation in e.orientations:
        hidden |= set(orientation.directors)
        columns |= _bryant(series[..., list(orientation.directors)], orientation.angles)
    free = (name for i, name in enumerate(e.names) if i not in hidden)
    names = tuple(dict.fromkeys((*rig.coordinate_names, *free)))
    kinematics = np.array([columns[name] for name in names]).transpose(1, 2, 0)
    tensions = e.tensions(series[0], multipliers)
    return Motion(
        rig=rig,
        times=times,
        coordinate_names=names,
        positions=kinematics[0],
        velocities=kinematics[1],
        accelerations=kinematics[2],
        inputs=np.array([part.inputs for part in parts]),
        tensions=tensions,
        multipliers=multipliers,
        slack=find_slack(rig, times, tensions),
    )


class _Polynomial(NamedTuple):
    """A state in the polynomial coordinates of the equations."""

    series: Array
    """Coordinates and their two derivatives, shape (3, n)."""
    multipliers: Array
    """Multipliers of all constraints, shape (m,)."""
    inputs: Array
    """Inputs, shape (b,)."""


def _polynomial(equations: Formulation, state: State) -> _Polynomial:
    """Multipliers of constraints that the coordinates satisfy by themselves follow from the
    equations of motion, in the sense of least squares.
    """
    mechanics = equations.mechanics
    rows = list(mechanics.coordinates.multipliers)
    rate, acceleration = equations.rates(*state)
    forces = mechanics.forces(state.z, rate, acceleration)
    place = forces.place
    multipliers = np.zeros(len(forces.gradient))
    _, multipliers[rows], inputs = mechanics.split(state.z)
    eliminated = [k for k in range(len(multipliers)) if k not in rows]
    if eliminated:
        pulls = forces.gradient[eliminated].T
        multipliers[eliminated] = np.linalg.lstsq(pulls, -forces.unbalanced, rcond=None)[0]
    series = np.array([place.q, place.slope @ rate, place.second(rate, acceleration)])
    return _Polynomial(series, multipliers, inputs)


def _bryant(directors: Array, names: tuple[str, str, str]) -> dict[str, Array]:
    """Bryant angles, (3, N) each, of nine directors with two derivatives (3, N, 9)."""
    factorials = np.array([1.0, 1.0, 2.0])[:, None]
    rotation = directors.reshape(3, -1, 3, 3).swapaxes(-1, -2) / factorials[..., None, None]
    angles = bryant(rotation)
    angles[0] = np.unwrap(angles[0], axis=0)
    return {name: angles[..., i] * factorials for i, name in enumerate(names)}
