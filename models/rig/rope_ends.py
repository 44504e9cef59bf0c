"""Where ropes end: what a drum holds, what is left on it, and blocks that meet."""

import math
from typing import NamedTuple

from .lengths import own_spans
from .rig import Rig, Rope


class RopeEnd(NamedTuple):
    """A length of a rope, as a sum of coordinates, and what it may be."""

    what: str
    """Such as "rope hoist" or "the last span of rope hoist"."""
    terms: tuple[tuple[float, str], ...]
    """Factor and name of each coordinate in the length."""
    low: float
    """Least length [m]."""
    high: float
    """Largest length [m]."""


def rope_ends(rig: Rig) -> tuple[RopeEnd, ...]:
    """The lengths of a rig's ropes that are limited."""
    ends = []
    for rope in rig.ropes:
        if rope.shortest > 0 or math.isfinite(rope.longest):
            whole = ((1.0, rope.coordinate),)
            ends.append(RopeEnd(f"rope {rope.name}", whole, rope.shortest, rope.longest))
        if rope.two_block > 0:
            what = f"the last span of rope {rope.name}"
            ends.append(RopeEnd(what, last_span(rig, rope), rope.two_block, math.inf))
    return tuple(ends)


def last_span(rig: Rig, rope: Rope) -> tuple[tuple[float, str], ...]:
    """The length of a rope's last span as a sum of coordinates, (factor, name) of each."""
    last, own = len(rope.path) - 1, own_spans(rig, rope)
    if last in own:
        return ((1.0, f"{rope.name}.span{last}"),)
    share = 1.0 / rope.falls
    return ((share, rope.coordinate), *((-share, f"{rope.name}.span{i}") for i in own))
