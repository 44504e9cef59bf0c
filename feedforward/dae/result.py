"""What an integration gives: the motion, what it cost, and where it ended if it failed."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...models.types import Array
from ..exact.branch import turning_angles
from ..exact.motion import Motion
from ..exact.naming import bryant_angles, named_motion
from ..paths.reference import Reference
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
    e = problem.equations
    parts = [_polynomial(equations, state) for state in states]
    series = np.array([part.series for part in parts]).transpose(2, 1, 0)
    angles = turning_angles(e, series[:, 0], start_angles(problem, reference))
    platforms: dict[str, Array] = {}
    for orientation in e.orientations:
        platforms |= bryant_angles(orientation, series)
    for values in platforms.values():
        values[0] = np.unwrap(values[0])
    multipliers = np.array([part.multipliers for part in parts])
    inputs = np.array([part.inputs for part in parts])
    return named_motion(e, times, series, angles, platforms, multipliers, inputs)


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
        pulls = forces.push[eliminated].T
        multipliers[eliminated] = np.linalg.lstsq(pulls, -forces.unbalanced, rcond=None)[0]
    series = np.array([place.q, place.slope @ rate, place.second(rate, acceleration)])
    return _Polynomial(series, multipliers, inputs)
