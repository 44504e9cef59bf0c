"""Rolling on a plate without spin from one orientation to another (K 2.105 to 2.108).

Without spin phi' = psi' sin(theta).  psi is a cubic in theta whose second derivative vanishes at
the end, phi(theta) its integral in closed form, and theta goes from rest to rest:

    psi(theta) = psi_F + b0 (theta - theta_F) + b2 (theta - theta_F)^3 / 3
    phi(theta) = phi_F + int (b0 + b2 (theta - theta_F)^2) sin(theta) d theta

This fails where theta is the same at both ends or comes near +-90 degrees, and may turn the object
round several times.  But a constant rotation of the axes that the angles refer to in the object
changes neither w nor the rolling, so such a move is planned with other axes: of a fixed set those
for which the object turns least.  A mere turn about the vertical leaves theta alone in all axes,
and is planned in two legs.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from ...models.errors import PathError
from ...models.hand.move import HandMove
from ...models.types import Array
from ..series.products import derivative, product
from ..series.rotation import angular_velocity, rotation_of, rpy_angles, rpy_matrix, sine_cosine
from .orientation import Axes, in_axes
from .progress import ORDERS, share

LARGEST_THETA = math.radians(80.0)
"""Largest theta at an end [rad]; beyond it phi and psi turn fast while the object hardly does."""
SMALLEST_STEP = math.radians(2.0)
"""Least change of theta [rad]; the coefficients of psi divide by it."""
SAME = 1e-12
"""Angle below which two orientations are one [rad]."""
TRIALS = 200
"""Number of other axes of the object that are tried."""
LONG = 3 * math.pi
"""Turning of the object over a move, above which other axes are tried [rad]."""
MOST_TURNING = 6 * math.pi
"""Turning of the object above which two legs are tried [rad]."""


def _integral(theta: Array, goal: float) -> Array:
    """Integrals of sin(theta) times 1 and (theta - goal)^2, shape (2, ...)."""
    away = theta - goal
    return np.stack((-np.cos(theta), (2 - away**2) * np.cos(theta) + 2 * away * np.sin(theta)))


@dataclass(frozen=True)
class WithoutSpin:
    """The path in one choice of the object's axes.

    Raises
    ------
    PathError
        Theta is too near +-90 degrees, or hardly changes.
    """

    move: HandMove
    start: tuple[float, ...]
    """RPY angles of the axes at the beginning [rad]."""
    goal: tuple[float, ...]
    """RPY angles at the end [rad]."""
    axes: Axes | None = None
    """Constant rotation of the object in front of the angles' axes; None for none."""
    note: str = ""

    def __post_init__(self) -> None:
        ends = (self.start[1], self.goal[1])
        if max(map(abs, ends)) > LARGEST_THETA:
            raise PathError("theta comes near +-90 degrees, where RPY angles are singular")
        away = np.abs(np.subtract(self.start, self.goal))
        if away[1] < SMALLEST_STEP and away.max() > SAME:
            raise PathError("theta hardly changes, of which psi is to be a function")

    @cached_property
    def factors(self) -> Array:
        """b0 and b2, from psi and phi at both ends."""
        step = self.start[1] - self.goal[1]
        if abs(step) < SMALLEST_STEP:
            return np.zeros(2)
        ends = np.array([self.start[1], self.goal[1]])
        sines = _integral(ends, self.goal[1])
        matrix = np.array([[step, step**3 / 3], sines[:, 0] - sines[:, 1]])
        right = [self.start[2] - self.goal[2], self.start[0] - self.goal[0]]
        return np.asarray(np.linalg.solve(matrix, right))

    @property
    def coefficients(self) -> tuple[float, float, float, float]:
        """K's a0 .. a3 of psi as a polynomial in theta (2.105)."""
        b0, b2 = self.factors.tolist()
        end, last = self.goal[1], self.goal[2]
        a0 = last - b0 * end - b2 * end**3 / 3
        return (a0, b0 + b2 * end**2, -b2 * end, b2 / 3)

    def angles(self, times: Array, orders: int = ORDERS) -> Array:
        """Series of (phi, theta, psi) in the axes, (orders, N, 3)."""
        part = share(self.move, times, orders)
        theta = part * (self.goal[1] - self.start[1])
        theta[0] += self.start[1]
        away = theta.copy()
        away[0] -= self.goal[1]
        b0, b2 = self.factors
        square = product(away, away)
        psi = b0 * away + b2 * product(square, away) / 3
        psi[0] += self.goal[2]
        phi = np.empty_like(psi)
        both = _integral(theta[0], self.goal[1]) - _integral(np.array([self.goal[1]]), self.goal[1])
        phi[0] = self.goal[0] + b0 * both[0] + b2 * both[1]
        rate = product(sine_cosine(theta)[0][:-1], derivative(psi))
        phi[1:] = rate / np.arange(1, len(psi))[:, None]
        return np.stack((phi, theta, psi), axis=-1)

    def rotation(self, times: Array, orders: int = ORDERS) -> Array:
        """See `Turning`."""
        return in_axes(rpy_matrix(self.angles(times, orders)), self.axes)

    @property
    def turning(self) -> float:
        """How far the object turns altogether [rad]."""
        times = np.linspace(0.0, self.move.duration, 65)
        speed = np.linalg.norm(angular_velocity(self.rotation(times, 2))[0], axis=-1)
        return float(np.trapezoid(speed, times))


@dataclass(frozen=True)
class TwoLegs:
    """Two paths one after the other, at rest in between."""

    first: WithoutSpin
    second: WithoutSpin
    note: str

    def rotation(self, times: Array, orders: int = ORDERS) -> Array:
        """See `Turning`."""
        half = self.first.move.duration
        early = (times < half)[:, None, None]
        later = self.second.rotation(times - half, orders)
        return np.asarray(np.where(early, self.first.rotation(times, orders), later))

    @property
    def turning(self) -> float:
        """How far the object turns altogether [rad]."""
        return self.first.turning + self.second.turning


def without_spin(move: HandMove) -> WithoutSpin | TwoLegs:
    """The path in the object's own axes if there is one that is not long, else in the best others.

    Where the two ends differ by a turn about the vertical, theta is the same in all axes; then
    the object goes through a third orientation.

    Raises
    ------
    PathError
        No axes tried give a path.
    """
    try:
        own = WithoutSpin(move, move.start, move.goal)
        if own.turning <= LONG:
            return own
        reason = f"the object would turn by {own.turning:.3g} rad altogether"
    except PathError as error:
        reason = str(error)
    random = np.random.default_rng(0)
    first, last = rotation_of(move.start), rotation_of(move.goal)
    trials = Rotation.random(TRIALS, rng=random).as_matrix()
    note = f"planned in other axes of the object, since in its own {reason}"
    paths = [path for axes in trials if (path := _in_axes(move, axes, first, last, note))]
    best: WithoutSpin | TwoLegs | None = min(paths, key=lambda path: path.turning, default=None)
    if best is None or best.turning > MOST_TURNING:
        best = _two_legs(move, first, last, trials, f"{note}; at rest once in between")
    return best


def _in_axes(
    move: HandMove, axes: Array, first: Array, last: Array, note: str
) -> WithoutSpin | None:
    """The path between two orientations in other axes, the shorter way round for phi and psi."""
    ends = rpy_angles(np.array([first @ axes.T, last @ axes.T]))
    ends[1] -= 2 * math.pi * np.round((ends[1] - ends[0]) / (2 * math.pi))
    start, goal = (tuple(end) for end in ends.tolist())
    try:
        return WithoutSpin(move, start, goal, tuple(map(tuple, axes.tolist())), note)
    except PathError:
        return None


def _two_legs(move: HandMove, first: Array, last: Array, trials: Array, note: str) -> TwoLegs:
    """The best path through one of the trials as a third orientation."""
    half = replace(move, duration=move.duration / 2)
    paths = []
    for axes, middle in zip(trials, trials[::-1], strict=True):
        begin = _in_axes(half, axes, first, middle, note)
        end = _in_axes(half, axes, middle, last, note)
        if begin and end:
            paths.append(TwoLegs(begin, end, note))
    best = min(paths, key=lambda path: path.turning, default=None)
    if best is None:
        raise PathError("no path without spin was found between the two orientations")
    return best
