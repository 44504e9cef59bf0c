"""What friction and gears take away between a motor and what it drives, and what slows the rest.

    losses = losses_of(rig)                       # None if nothing rubs and gears lose nothing
    losses.asked(needed, speeds)                  # inputs for the same motion, (N, drives)
    losses.delivered(inputs, speeds)              # what of inputs moves the rig, the inverse

Friction of what a drive acts on is no part of the equations: the drive stands where it rubs and
adds it to the input,

    u = (needed + arm (F sign(v) + d v)) * efficiency^-s,   s = sign(u v),

with the coordinate's speed v, Coulomb friction F, viscous friction d and the arm of `Rig.arm`; a
gear loses the same share of power whichever way it passes.  What no drive acts on rubs by viscous
friction alone, a constant matrix of the equations of motion.

Limits: the sign is exact, so inputs jump where a part starts, stops or turns back; at rest nothing
is asked for, where real friction may hold anything up to F.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...models.friction import Friction, direction
from ...models.rig.rig import Frame, Rig
from ...models.types import Array


@dataclass(frozen=True, eq=False)
class Losses:
    """Losses at the drives of one rig, all arrays of shape (drives,)."""

    arms: Array
    """See `Rig.arm` [m] or [1]."""
    coulomb: Array
    """Along the driven coordinates [N] or [N m]."""
    viscous: Array
    """Along the driven coordinates [N s/m] or [N m s]."""
    efficiency: Array
    """Of the gears [1]."""

    def asked(self, needed: Array, speeds: Array) -> Array:
        """Inputs that move the rig as `needed` does without losses.

        Inputs (N, drives), speeds of the driven coordinates (N, drives).
        """
        way = direction(speeds)
        inputs = needed + self.arms * (self.coulomb * way + self.viscous * speeds)
        return np.asarray(inputs * self.efficiency ** -(np.sign(inputs) * way))

    def delivered(self, inputs: Array, speeds: Array) -> Array:
        """What of the inputs moves the rig, all of shape (N, drives)."""
        rubbed = self.coulomb * direction(speeds) + self.viscous * speeds
        return np.asarray(self.through_gears(inputs, speeds) - self.arms * rubbed)

    def through_gears(self, inputs: Array, speeds: Array) -> Array:
        """What gears pass on of inputs, before friction, all of shape (N, drives)."""
        return np.asarray(inputs * self.efficiency ** (np.sign(inputs) * direction(speeds)))

    def smooth(self, inputs: Array, speeds: Array) -> Array:
        """The same inputs without what jumps: Coulomb friction and the gears' losses."""
        return self.delivered(inputs, speeds) + self.arms * self.viscous * speeds


@lru_cache(maxsize=256)
def losses_of(rig: Rig) -> Losses | None:
    """Losses at a rig's drives; None where there are none."""
    laws = [rig.driven(drive).friction for drive in rig.drives]
    efficiency = np.array([drive.efficiency for drive in rig.drives])
    if all(law == Friction() for law in laws) and (efficiency == 1.0).all():
        return None
    return Losses(
        arms=np.array([rig.arm(drive) for drive in rig.drives]),
        coulomb=np.array([law.coulomb for law in laws]),
        viscous=np.array([law.viscous for law in laws]),
        efficiency=efficiency,
    )


def rubs(rig: Rig) -> bool:
    """Whether a rig is described with friction, drag or gears that lose power."""
    dragged = any(load.drag for load in rig.loads)
    rubbed = any(part.friction != Friction() for part in rig.drivable)
    return losses_of(rig) is not None or dragged or rubbed


def damping(rig: Rig, names: list[str]) -> Array | None:
    """Viscous friction of what no drive acts on, and drag of loads, shape (n, n).

    Of coordinates by their names; None where there is none.  A turning frame's cosine c and sine s
    have it both, since its rate is the square root of c'^2 + s'^2.
    """
    driven = {drive.on for drive in rig.drives}
    diagonal = dict.fromkeys(names, 0.0)
    for part in rig.drivable:
        if part.name not in driven:
            turning = isinstance(part, Frame) and part.kind == "turning"
            columns = ("cos", "sin") if turning else (part.coordinate.split(".")[1],)
            diagonal |= {f"{part.name}.{column}": part.friction.viscous for column in columns}
    for load in rig.loads:
        diagonal |= {f"{load.name}.{axis}": load.drag for axis in rig.axes}
    values = np.array([diagonal[name] for name in names])
    return np.diag(values) if values.any() else None
