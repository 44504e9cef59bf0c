"""Beams: links that have a mass of their own, and what of it each end feels.

A slender body whose ends are a and b moves with the energy

    T = 1/2 m |c'|^2 + 1/2 J |d'|^2,    c = a + s (b - a),    d = (b - a) / L

with its mass m, the share s of its length L at which its centre is, and its moment of inertia J
about axes across through that centre; it does not spin about its own axis.  All is affine in its
ends, so that a beam needs no coordinates: of a uniform one, J = m L^2 / 12, the energy is that of
m/6 at either end and 2m/3 in the middle.
"""

from collections.abc import Sequence
from typing import NamedTuple

from .link import Link
from .rig import Rig

ROUNDING = 1e-12
"""Share of a beam's mass below which its ends are not coupled."""


class Beam(NamedTuple):
    """A link with a mass."""

    link: Link
    length: float
    """L [m]."""
    share: float
    """Where its centre is, from its first end, over L."""
    moment: float
    """J [kg m2]."""

    @property
    def shares(self) -> tuple[float, float]:
        """What of a force at the centre acts on its ends."""
        return (1.0 - self.share, self.share)

    @property
    def masses(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Forces on its two ends per acceleration of each [kg]."""
        mass, turning = self.link.mass, self.moment / self.length**2
        first, second = self.shares
        coupled = mass * first * second - turning
        if abs(coupled) < ROUNDING * mass:  # each end is the other's centre of oscillation
            coupled = 0.0
        return (mass * first**2 + turning, coupled), (coupled, mass * second**2 + turning)


def beams(rig: Rig) -> tuple[Beam, ...]:
    """The links of a rig that have a mass."""
    return tuple(_beam(rig, link) for link in rig.links if link.mass)


def _beam(rig: Rig, link: Link) -> Beam:
    length = rig.link_length(link)
    centre = 0.5 * length if link.centre is None else link.centre
    uniform = link.mass * length**2 / 12.0
    return Beam(link, length, centre / length, uniform if link.inertia is None else link.inertia)


def joined(rig: Rig) -> tuple[tuple[str, ...], ...]:
    """Names of points that beams join to one another, group by group."""
    groups: list[tuple[str, ...]] = []
    for link in rig.links:
        if link.mass:
            groups = _merged(groups, link.ends)
    return tuple(groups)


def _merged(groups: Sequence[tuple[str, ...]], ends: Sequence[str]) -> list[tuple[str, ...]]:
    """Groups of names, those that have one of these ends made one."""
    apart = [group for group in groups if set(group).isdisjoint(ends)]
    own = [name for group in groups if group not in apart for name in group]
    return [*apart, tuple(dict.fromkeys((*own, *ends)))]
