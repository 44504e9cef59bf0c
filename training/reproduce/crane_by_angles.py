"""The free rotary crane in five generalised coordinates, by the midpoint rule (Y 2.4.1).

    times, coordinates, rates = run(place=1.5, step=1e-4)

The coordinates are the girder's angle, the trolley's place, the rope's length and two swing
angles (Y 2.75).  Everything is written in the girder's axes, in which neither the mass matrix nor
the forces know its angle.
"""

import numpy as np

from ...feedforward.multibody.free_crane import DRUM_RADIUS, INERTIA, MASS
from ...models.errors import OptionError
from ...models.types import Array

GRAVITY = 9.81
TURNING = sum(INERTIA[name][2] for name in ("girder", "trolley", "winch"))
"""Moment of inertia of what turns with the girder, about its own axes [kg m^2]."""
WINDING = INERTIA["winch"][1] / DRUM_RADIUS**2
"""The winch's inertia as a mass on the rope [kg]."""
CARRIED = MASS["trolley"] + MASS["winch"]
"""Mass of what slides along the girder, without the load [kg]."""
ROUNDS, ENOUGH = 50, 1e-14
"""Most iterations of the midpoint rule, and the change over the state's size that ends them: a few
units of rounding, so that what is lost of energy and momentum is the rule's own."""


def run(
    place: float = 1.5, length: float = 5.0, spin: float = 1.0, *, step: float, duration: float = 1
) -> tuple[Array, Array, Array]:
    """Times (N,), coordinates (N, 5) and rates (N, 5) of the crane let go (Y 2.90, 2.91).

    Parameters
    ----------
    place
        Place of the trolley at the start [m].
    length
        Length of the rope at the start [m].
    spin
        Angular velocity of the girder at the start [rad/s].
    step
        Time step [s].
    duration
        Duration of the run [s].

    Raises
    ------
    OptionError
        The step is too long for the iteration.
    """
    steps = round(duration / step)
    state = np.zeros((steps + 1, 10))
    state[0, [1, 2, 5]] = place, length, spin
    with np.errstate(all="ignore"):
        for k in range(steps):
            state[k + 1] = _midpoint(state[k], step)
    return step * np.arange(steps + 1.0), state[:, :5], state[:, 5:]


def load(coordinates: Array) -> Array:
    """World positions (N, 3) of the load from coordinates (N, 5) (Y 2.79)."""
    angle, place, length, first, second = coordinates.T
    along = place + length * np.sin(second)
    across = -length * np.cos(second) * np.sin(first)
    cos, sin = np.cos(angle), np.sin(angle)
    down = -length * np.cos(second) * np.cos(first)
    return np.stack((along * cos - across * sin, along * sin + across * cos, down), axis=-1)


def conserved(coordinates: Array, rates: Array) -> tuple[float, float]:
    """Energy [J] and angular momentum about the vertical [kg m^2/s] of one state."""
    mass, _ = _equations(coordinates, rates)
    momentum = mass @ rates
    height = load(coordinates[None])[0, 2]
    return float(0.5 * rates @ momentum + MASS["load"] * GRAVITY * height), float(momentum[0])


def _midpoint(state: Array, step: float) -> Array:
    """One step of the midpoint rule (Y 2.89)."""
    change = step * _rate(state)
    for _ in range(ROUNDS):
        before, change = change, step * _rate(state + 0.5 * change)
        if np.abs(change - before).max() <= ENOUGH * (1 + np.abs(state).max()):
            return state + change
    raise OptionError(f"a step of {step:g} s is too long for the midpoint rule's iteration")


def _rate(state: Array) -> Array:
    mass, force = _equations(state[:5], state[5:])
    return np.concatenate((state[5:], np.linalg.solve(mass, force)))


def _equations(coordinates: Array, rates: Array) -> tuple[Array, Array]:
    """Mass matrix (5, 5) and force (5,) of Y 2.17, from the load's place in the girder's axes."""
    _, place, length, *angles = coordinates
    turn, slide, pay, *swing = rates
    (s1, s2), (c1, c2) = np.sin(angles), np.cos(angles)
    rope = np.array((s2, -s1 * c2, -c1 * c2))
    first, second = np.array((0.0, -c1 * c2, s1 * c2)), np.array((c2, s1 * s2, c1 * s2))
    arm = length * rope + (place, 0.0, 0.0)
    slope = np.array(
        ((-arm[1], arm[0], 0.0), (1.0, 0.0, 0.0), rope, length * first, length * second)
    )
    # What the load's acceleration is without second derivatives, in turning axes, less gravity.
    moved = slope[1:].T @ rates[1:]
    mixed = np.array((0.0, c1 * s2, -s1 * s2))
    flat = np.array((0.0, rope[1], rope[2]))
    bent = -flat * swing[0] ** 2 + 2 * mixed * swing[0] * swing[1] - rope * swing[1] ** 2
    curved = length * bent + 2 * pay * (first * swing[0] + second * swing[1])
    curved += turn * np.array((-2 * moved[1] - turn * arm[0], 2 * moved[0] - turn * arm[1], 0.0))
    curved[2] += GRAVITY
    mass = MASS["load"] * slope @ slope.T
    mass[[0, 1, 2], [0, 1, 2]] += (TURNING + CARRIED * place**2, CARRIED, WINDING)
    force = -MASS["load"] * slope @ curved
    force[0] -= 2 * CARRIED * place * slide * turn
    force[1] += CARRIED * place * turn**2
    return mass, force
