"""Index reduction by minimal extension (Y 5.14, 5.33, 5.107).

The servo constraints are appended twice more, differentiated once and twice.  As many dummy
derivatives make the system square again: of those coordinates x_J that the servo constraints
determine, new unknowns replace x_J' and x_J'' wherever they stand,

    F(x, ..., x', x'') = 0   with x_J' -> x_hat, x_J'' -> x_tilde,
    C x = gamma,  C x' = gamma',  C x'' = gamma''.

No projector is needed, and it makes no difference whether the coordinates are reduced first or
afterwards (figure Y 5.1).  The index falls by two.  The places of all bodies then follow at each
instant from algebraic equations where the index was 5 (5.37): whatever the step, their error is
rounding alone, and only velocities and inputs know of the scheme.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import scipy

from ...models.types import Array
from .direct import Direct
from .formulation import Evaluated, Instant


@dataclass(frozen=True, eq=False)
class Extension(Direct):
    """The direct equations, minimally extended, in whatever coordinates."""

    derivatives: ClassVar[int] = 2

    @cached_property
    def replaced(self) -> list[int]:
        """Coordinates whose derivatives become dummies: C has an inverse on them."""
        servo = self.mechanics.coordinates.servo
        *_, order = scipy.linalg.qr(servo, pivoting=True, mode="economic")
        return sorted(int(j) for j in order[: len(servo)])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the direct formulation's unknowns, then of the dummies."""
        dummies = [self.mechanics.coordinates.names[j] for j in self.replaced]
        hats = (f"{name} {mark}" for mark in ("hat", "tilde") for name in dummies)
        return (*super().names, *hats)

    @property
    def index(self) -> int:
        """Two less than that of the problem, but 3 where constraints are left: these stay as they
        are.
        """
        least = 3 if self.mechanics.coordinates.constraints else 1
        return max(super().index - 2, least)

    def evaluate(self, given: Array, z: Array, zd: Array, zdd: Array, slopes: bool) -> Evaluated:
        """The direct equations with dummies, then the derivatives of the servo constraints."""
        servo, (k, *_) = self.mechanics.coordinates.servo, self.mechanics.sizes
        a, core = len(servo), len(z) - 2 * len(servo)
        rate, acceleration = self.rates(z, zd, zdd)
        inner = super().evaluate(given, z[:core], rate, acceleration, slopes)
        residual = np.concatenate(
            (inner.residual, servo @ rate - given[1], servo @ acceleration - given[2])
        )
        if inner.jacobian is None:
            return Evaluated(residual, None)
        jacobian = np.zeros((3, len(z), len(z)))
        jacobian[:, :core, :core] = inner.jacobian
        for order in (1, 2):
            rows = slice(core + (order - 1) * a, core + order * a)
            jacobian[order, rows, :k] = servo
            jacobian[0, :, rows] = jacobian[order][:, self.replaced]
            jacobian[order][:, self.replaced] = 0.0
        return Evaluated(residual, jacobian)

    def moving(self, instant: Instant) -> tuple[Array, Array, Array]:
        """The same, then the dummies."""
        z, zd, zdd = super().moving(instant)
        dummies = instant.rate[self.replaced], instant.acceleration[self.replaced]
        none = np.zeros(2 * len(self.replaced))
        return np.concatenate((z, *dummies)), np.append(zd, none), np.append(zdd, none)

    def rates(self, z: Array, zd: Array, zdd: Array) -> tuple[Array, Array]:
        """Rates and accelerations of the coordinates, the dummies among them."""
        k, *_ = self.mechanics.sizes
        a = len(self.replaced)
        rate, acceleration = zd[:k].copy(), zdd[:k].copy()
        rate[self.replaced], acceleration[self.replaced] = z[-2 * a : -a], z[-a:]
        return rate, acceleration
