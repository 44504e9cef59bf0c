"""Rolling on a plate with spin by the flat output of K's proposition 5.

The output is (phi, theta, zeta), and everything, the contact point included, follows from it
without integration.  With A X as in K 2.83, and P = (sin(phi) cos(theta))', Q = -(cos(phi)
cos(theta))',

    y = A X,   zeta = Q y1 - P y2,   Q' y1 - P' y2 = zeta' + R theta phi'^2 cos(theta)

are two linear equations for y; their rates give psi (K 2.89), and y the contact point (K 2.87).
K's print lacks the R in 2.88 and has the sign of the contact point turned round.

The equations are singular wherever P Q' = Q P': at rest, and where the first body axis moves
straight on as seen from above.  So the output is planned over a path parameter, along which phi and
theta are linear, which keeps P Q' - Q P' away from zero for |theta| < 90 degrees; zeta is a quintic
that meets all end values; and the parameter goes from rest to rest.
"""

import contextlib
import itertools
import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from ...models.errors import PathError
from ...models.hand.move import HandMove
from ...models.types import Array
from ..series.products import compose, derivative, product, quotient
from ..series.rotation import rotation_of, rpy_angles, rpy_matrix, sine_cosine
from .orientation import Axes, in_axes
from .progress import ORDERS, share
from .without_spin import LARGEST_THETA

LEAST_TURN = math.pi / 2
"""Least change of phi over the path [rad]; with less the equations are nearly singular."""
TURNS = (-1, 0, 1)
"""Whole turns that are tried, added to phi and to psi at the end."""
TRIALS = 20
"""Number of other axes of the object that are tried."""
_LENGTH = 6
"""Coefficients of phi and theta: those of a pose, and three that differentiation costs."""


def _quintic(ends: Array) -> Array:
    """Coefficients from value, rate and second derivative at 0 and 1, (2, 3)."""
    (a, b, c), (p, q, r) = ends
    d0, d1, d2 = p - a - b - c / 2, q - b - c, r - c
    return np.array(
        [a, b, c / 2, 10 * d0 - 4 * d1 + d2 / 2, -15 * d0 + 7 * d1 - d2, 6 * d0 - 3 * d1 + d2 / 2]
    )


@dataclass(frozen=True)
class WithSpin:
    """The path for RPY angles at both ends, whole turns included.

    Raises
    ------
    PathError
        Theta is too near +-90 degrees, or phi hardly turns.
    """

    move: HandMove
    start: tuple[float, ...]
    """RPY angles of the axes at the beginning [rad]."""
    goal: tuple[float, ...]
    """RPY angles at the end, whole turns included [rad]."""
    radius: float
    """Radius of the ball [m]."""
    touch: tuple[float, float]
    """Contact point on the plate at the end, from where it begins [m]."""
    axes: Axes | None = None
    """Constant rotation of the object in front of the angles' axes; None for none."""
    note: str = ""

    def __post_init__(self) -> None:
        if max(abs(self.start[1]), abs(self.goal[1])) > LARGEST_THETA:
            raise PathError("theta comes near +-90 degrees, where the flat output is singular")
        if abs(self.goal[0] - self.start[0]) < LEAST_TURN:
            raise PathError("phi turns too little for the flat output to be regular")

    def _outputs(self, place: Array) -> tuple[Array, Array]:
        """Series of phi and theta over the path parameter, (6, N) each."""
        start, rate = np.array(self.start), np.subtract(self.goal, self.start)
        phi, theta = np.zeros((2, _LENGTH, len(place)))
        for i, series in enumerate((phi, theta)):
            series[0], series[1] = start[i] + rate[i] * place, rate[i]
        return phi, theta

    @cached_property
    def zeta(self) -> Array:
        """Coefficients of the quintic, (6,)."""
        phi, theta = self._outputs(np.array([0.0, 1.0]))
        p, q, bulge = self._moving(phi, theta)
        psi = np.array([self.start[2], self.goal[2]])
        x, y = np.array([0.0, self.touch[0]]), np.array([0.0, self.touch[1]])
        cosine, sine = np.cos(phi[0]), np.sin(phi[0])
        level = np.cos(theta[0])
        y1 = self.radius * (theta[0] * cosine + psi * sine * level) - x
        y2 = self.radius * (theta[0] * sine - psi * cosine * level) - y
        rate1 = self.radius * (-theta[0] * phi[1] * sine + psi * p[0])
        rate2 = self.radius * (theta[0] * phi[1] * cosine + psi * q[0])
        value = q[0] * y1 - p[0] * y2
        rate = q[1] * y1 - p[1] * y2 - bulge[0]
        second = 2 * (q[2] * y1 - p[2] * y2) + q[1] * rate1 - p[1] * rate2 - bulge[1]
        return _quintic(np.stack((value, rate, second), axis=1))

    def _moving(self, phi: Array, theta: Array) -> tuple[Array, Array, Array]:
        """Series of P, Q and R theta phi'^2 cos(theta), one coefficient shorter."""
        (sf, cf), (_, ct) = sine_cosine(phi), sine_cosine(theta)
        p, q = derivative(product(sf, ct)), -derivative(product(cf, ct))
        rate = derivative(phi)
        bulge = self.radius * product(product(theta, ct)[:-1], product(rate, rate))
        return p, q, bulge

    def _states(self, place: Array) -> tuple[Array, Array]:
        """Series of the RPY angles (ORDERS, N, 3) and contact point (ORDERS, N, 2) along it."""
        phi, theta = self._outputs(place)
        p, q, bulge = self._moving(phi, theta)
        powers = np.polynomial.polynomial.Polynomial(self.zeta)
        zeta = np.array([powers.deriv(k)(place) / math.factorial(k) for k in range(5)])
        right = derivative(zeta) + bulge[:4]
        p_rate, q_rate = derivative(p), derivative(q)
        p, q, zeta = p[:4], q[:4], zeta[:4]
        singular = product(p, q_rate) - product(q, p_rate)
        y1 = quotient(product(p, right) - product(p_rate, zeta), singular)
        y2 = quotient(product(q, right) - product(q_rate, zeta), singular)

        (sf, cf), (_, ct) = sine_cosine(phi), sine_cosine(theta)
        turn = product(theta[:ORDERS], derivative(phi)[:ORDERS])
        first = derivative(y1) / self.radius + product(turn, sf[:ORDERS])
        second = derivative(y2) / self.radius - product(turn, cf[:ORDERS])
        p, q = p[:ORDERS], q[:ORDERS]
        psi = quotient(product(p, first) + product(q, second), product(p, p) + product(q, q))

        phi, theta, sf, cf, ct = (part[:ORDERS] for part in (phi, theta, sf, cf, ct))
        level = product(psi, ct)
        x = self.radius * (product(theta, cf) + product(level, sf)) - y1[:ORDERS]
        y = self.radius * (product(theta, sf) - product(level, cf)) - y2[:ORDERS]
        return np.stack((phi, theta, psi), axis=-1), np.stack((x, y), axis=-1)

    def rotation(self, times: Array, orders: int = ORDERS) -> Array:
        """See `Turning`."""
        part = share(self.move, times, orders)
        angles = compose(self._states(part[0])[0][:orders], part)
        return in_axes(rpy_matrix(angles), self.axes)

    def swept(self, times: Array) -> Array:
        """Integral of the angular velocity, as far as the contact point shows it, (N, 3)."""
        x, y = self._states(share(self.move, times)[0])[1][0].T
        return np.stack((-y, x, np.zeros_like(x)), axis=-1) / self.radius

    @property
    def length(self) -> float:
        """Length of the contact point's way over the plate [m]."""
        contact = self._states(np.linspace(0.0, 1.0, 129))[1][0]
        return float(np.linalg.norm(np.diff(contact, axis=0), axis=1).sum())


def with_spin(move: HandMove, radius: float) -> WithSpin:
    """Of the paths with a few whole turns more or less, the one that rolls least.

    Where theta is too near +-90 degrees, it is planned in other axes of the object, which change
    nothing else.

    Raises
    ------
    PathError
        No axes tried give a path.
    """
    best = _least_rolling(move, move.start, move.goal, radius, None)
    if best is not None:
        turned = best.goal != move.goal
        note = "with whole turns added, so that the flat output is regular"
        return replace(best, note=note) if turned else best
    first, last = rotation_of(move.start), rotation_of(move.goal)
    note = "planned in other axes of the object, since in its own theta comes near +-90 degrees"
    paths = []
    for trial in Rotation.random(TRIALS, rng=np.random.default_rng(0)).as_matrix():
        start, goal = rpy_angles(np.array([first @ trial.T, last @ trial.T])).tolist()
        axes = tuple(map(tuple, trial.tolist()))
        path = _least_rolling(move, tuple(start), tuple(goal), radius, axes)
        if path is not None:
            paths.append(replace(path, note=note))
    if not paths:
        raise PathError("no path with spin was found between the two orientations")
    return min(paths, key=lambda path: path.length)


def _least_rolling(
    move: HandMove,
    start: tuple[float, ...],
    goal: tuple[float, ...],
    radius: float,
    axes: Axes | None,
) -> WithSpin | None:
    """The best of the whole turns in given axes, if any."""
    paths = []
    for turns in itertools.product(TURNS, TURNS):
        phi, psi = (goal[i] + 2 * math.pi * k for i, k in zip((0, 2), turns, strict=True))
        end = (phi, goal[1], psi)
        with contextlib.suppress(PathError):
            paths.append(WithSpin(move, start, end, radius, move.touch or (0.0, 0.0), axes))
    return min(paths, key=lambda path: path.length, default=None)
