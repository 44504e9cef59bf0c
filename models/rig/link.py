"""Slings, pendants and struts: what joins two points of a rig at a constant distance."""

from dataclasses import dataclass

from .parts import Part


@dataclass(frozen=True)
class Link(Part):
    """A sling, pendant or rod without mass of constant length between two points."""

    name: str
    """Name of the link."""
    ends: tuple[str, ...]
    """Names of the two anchors, trolleys or loads that it joins."""
    length: float | None = None
    """Its length [m]; the distance of its ends at home if left out."""
    pushes: bool = False
    """Whether it can push as well as pull: a strut or a hydraulic cylinder, not a sling."""
