"""A rigid payload under a hook, as two point masses that move as it does."""

from typing import NamedTuple

from ..errors import RigError
from ..values import number


class TwoMasses(NamedTuple):
    """Point masses at the ends of a link without mass: one at the hook, one below it."""

    upper: float
    """At the hook, to be added to its own mass [kg]; negative where the payload is compact."""
    lower: float
    """At the centre of oscillation [kg]."""
    length: float
    """From the hook to the centre of oscillation [m]."""


def two_masses(mass: float, below: float, inertia: float) -> TwoMasses:
    """What swings about a hook as a rigid payload does.

    A body that hangs from one point and is as hard to turn about each axis across moves as two
    point masses with its mass, centre and moment: one at the hook and one at the centre of
    oscillation, l = b + I/(m b) below it.  That point is a flat output of the crane; the body does
    not spin about its own axis.

    Parameters
    ----------
    mass
        Of the payload [kg].
    below
        How far its centre of mass hangs below the hook [m].
    inertia
        Its moment about axes across, through its centre of mass [kg m2]; 0 for a point mass.

    Raises
    ------
    RigError
        Mass or distance are not > 0, or the inertia is negative.
    """
    for label, value in (("mass", mass), ("below", below)):
        if not number(f"a payload's {label}", value) > 0:
            raise RigError(f"a payload's {label} is {value:g}, it must be > 0")
    if number("a payload's inertia", inertia) < 0:
        raise RigError(f"a payload's inertia is {inertia:g} kg m2, it must be >= 0")
    length = below + inertia / (mass * below)
    lower = mass * below / length
    return TwoMasses(mass - lower, lower, length)
