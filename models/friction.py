"""Friction of a winch: Coulomb, static, viscous, and the dip between them that Stribeck found.

    friction = Friction(coulomb=0.1, viscous=0.5, static=0.15, stribeck_velocity=0.02)
    friction.force(velocity)        # along the rope, against it: what a compensation adds
    friction.dry(velocity)          # how much of it does not grow with speed

Starting takes more force than going on; as the rope begins to run, friction first falls (K calls
it negative viscous), then rises with speed (K remark 31):

    F(v) = (coulomb + (static - coulomb) exp(-(v / stribeck_velocity)^2)) sign(v) + viscous v

Limits: a force is needed for v = 0 too, so `force` replaces sign(v) by tanh(v / width), which is
within 4 % of it beyond two widths and zero at rest.  It cannot hold a rope still; where sticking
matters, as in a plant, take `dry` for the largest friction that the rest can bear.
"""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike

from .errors import OptionError
from .types import Array
from .values import bounded, reals

REST = 1e-8
"""Speed below which a part stands still [m/s, rad/s]: it guards against a sign that only rounding
has chosen, and makes less than a micrometre in a minute."""


@dataclass(frozen=True)
class Friction:
    """A law of friction along a rope, or of any other drive in its own units.

    Raises
    ------
    OptionError
        A value is not a finite number >= 0 (the velocities: > 0), or static friction
        is less than Coulomb friction.
    """

    coulomb: float = 0.0
    """Coulomb friction, while slipping [N]."""
    viscous: float = 0.0
    """Viscous friction per speed [N s/m]."""
    static: float | None = None
    """Static friction, to be overcome from rest [N]; as `coulomb` if left out."""
    stribeck_velocity: float = 0.01
    """Speed at which the surplus of static friction has fallen to a third [m/s]."""
    width: float = 1e-3
    """Speed within which the sign is smoothed [m/s]."""

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name == "static" and value is None:
                continue
            if field.name in ("stribeck_velocity", "width"):
                plain = bounded(f"friction: {field.name}", value, above=0, rule="> 0")
            else:
                plain = bounded(f"friction: {field.name}", value, least=0, rule=">= 0")
            object.__setattr__(self, field.name, plain)
        if self.static is not None and self.static < self.coulomb:
            raise OptionError(
                f"friction: static is {self.static:g} N, it must be >= coulomb, {self.coulomb:g} N"
            )

    def dry(self, velocity: ArrayLike) -> Array:
        """Magnitude without the viscous part [N], of the shape of `velocity` [m/s]."""
        speed = reals("velocity", velocity, error=OptionError)
        surplus = 0.0 if self.static is None else self.static - self.coulomb
        return np.asarray(self.coulomb + surplus * np.exp(-((speed / self.stribeck_velocity) ** 2)))

    def force(self, velocity: ArrayLike) -> Array:
        """Force against the motion [N], of the sign and the shape of `velocity` [m/s]."""
        speed = reals("velocity", velocity, error=OptionError)
        return np.asarray(self.dry(speed) * np.tanh(speed / self.width) + self.viscous * speed)

    def sliding(self, velocity: ArrayLike) -> Array:
        """Coulomb and viscous friction with the exact sign, none of the first at rest [N]."""
        speed = reals("velocity", velocity, error=OptionError)
        return self.coulomb * direction(speed) + self.viscous * speed


def direction(velocity: Array) -> Array:
    """1, 0 or -1: the sign of a speed, zero within `REST`."""
    return np.asarray((velocity > REST) * 1.0 - (velocity < -REST) * 1.0)
