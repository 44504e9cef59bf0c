"""Slings, pendants, struts and beams: what joins two points of a rig at a constant distance."""

from dataclasses import dataclass

from .parts import Part


@dataclass(frozen=True)
class Link(Part):
    """A sling, pendant, rod or beam of constant length between two points.

    A beam is a slender body: it turns with its ends and does not spin about its own axis.
    """

    name: str
    """Name of the link."""
    ends: tuple[str, ...]
    """Names of the two anchors, trolleys or loads that it joins."""
    length: float | None = None
    """Its length [m]; the distance of its ends at home if left out."""
    pushes: bool = False
    """Whether it can push as well as pull: a strut or a hydraulic cylinder, not a sling.  What has
    a mass always can."""
    mass: float = 0.0
    """Its mass [kg]: that of a beam; a sling has next to none."""
    centre: float | None = None
    """How far its centre of mass is from its first end [m]; the middle if left out."""
    inertia: float | None = None
    """Moment of inertia about axes across, through its centre of mass [kg m2]; that of a uniform
    beam, mass length^2 / 12, if left out."""
