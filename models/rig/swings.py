"""Loads that swing on a link: which they are, and how their bodies turn in a MuJoCo model.

A load that no rope touches and that hangs on a link swings about the link's other end: two hinges,
in a plane one, turn the link.  Its length is then exact, without a constraint.  Loads that links
join to one another make a tree, each below the one before: the links that the tree leaves over
join a body to one of its ancestors, so that their tendons stay on one chain.  A beam turns with the
load at its end, which therefore swings on the other end whatever ropes there are.

The first hinge turns about `across`, the second about the one at right angles to it and to the link
at home; they fall together where the link lies along `across`, a right angle from home.  For a beam
that lies level it is the vertical, so that it turns as it likes until it stands upright.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..types import Array
from ..values import Vector
from .beams import joined
from .frames import inwards
from .link import Link
from .rig import WORLD, Frame, Load, Rig

LEVEL = 0.7
"""Part of a beam's direction along z up to which it is level."""


class Tie(NamedTuple):
    """What keeps points of a rig together, so that their bodies have to be on one chain."""

    label: str
    """Such as "rope hoist" or "link strut"."""
    points: tuple[str, ...]


@dataclass(frozen=True)
class Swing:
    """A load that swings on a link."""

    load: Load
    link: Link
    upper: str
    """Name of the point that it swings about."""
    parent: str | None
    """Name of the body that has this point; None for the world."""
    frame: Frame | None
    """In whose axes this body stands at home."""
    pivot: Vector
    """The point in the body's axes [m]."""
    length: float
    """Of the link [m]."""
    rest: Vector
    """Unit vector along the link at home, away from the point, in the axes of the body's frame."""
    axes: tuple[Vector, ...]
    """Of the hinges, at home; the first one is `across`."""

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the hinges."""
        return tuple(f"{self.load.name}.swing{i + 1}" for i in range(len(self.axes)))

    @property
    def reach(self) -> Vector:
        """The load in its body's axes [m]."""
        x, y, z = (self.length * part for part in self.rest)
        return (x, y, z)


@lru_cache(maxsize=64)
def swinging(rig: Rig) -> tuple[tuple[str, ...], ...]:
    """Names of loads that hang on links alone or at the end of a beam.

    Those together that links join to one another.
    """
    linked = {end for link in rig.links for end in link.ends}
    borne = linked - _roped(rig) | _on_beams(rig)
    free = [p.name for p in rig.loads if p.name in borne and p.mass > 0]
    groups = [[name] for name in free]
    for link in rig.links:
        both = [group for group in groups if not set(link.ends).isdisjoint(group)]
        if len(both) == 2:
            groups = [group for group in groups if group not in both] + [both[0] + both[1]]
    held = [group for group in groups if outside(rig, group)]
    return tuple(tuple(sorted(group, key=free.index)) for group in held)


def _roped(rig: Rig) -> set[str]:
    """Names of the points that ropes run through."""
    return {point for rope in rig.ropes for point in rope.path}


def _on_beams(rig: Rig) -> set[str]:
    """Names of what swings on beams: of those that beams join, all but one that something holds."""
    loads, roped = {load.name for load in rig.loads}, _roped(rig)
    found: set[str] = set()
    for group in joined(rig):
        held = [name for name in group if name not in loads] or [n for n in group if n in roped]
        found |= {*group} - {*held[:1]}
    return found & loads


def outside(rig: Rig, group: Sequence[str]) -> tuple[str, ...]:
    """Points that links join to a group of loads."""
    ends = [link.ends for link in rig.links if not set(link.ends).isdisjoint(group)]
    return tuple(dict.fromkeys(end for pair in ends for end in pair if end not in group))


def ties(rig: Rig) -> tuple[Tie, ...]:
    """Ropes, links between other than swinging loads, and groups of those with two ends or more."""
    groups = swinging(rig)
    loose = {name for group in groups for name in group}
    bearers = {name: outside(rig, group) for group in groups for name in group}
    found = []
    for rope in rig.ropes:
        points = [bearers.get(point, (point,)) for point in rope.path]
        found.append(Tie(f"rope {rope.name}", tuple(name for part in points for name in part)))
    for link in rig.links:
        if loose.isdisjoint(link.ends):
            found.append(Tie(f"link {link.name}", link.ends))
    for group in groups:
        ends = outside(rig, group)
        names = [link.name for link in rig.links if not set(link.ends).isdisjoint(group)]
        found += [Tie(f"link {name}", ends) for name in names] if len(ends) > 1 else []
    return tuple(found)


def swings(rig: Rig, frames: Mapping[str, Frame | None]) -> tuple[Swing, ...]:
    """The loads that swing, each after what it swings on.

    `frames` has for all other bodies, each after its parent, in whose axes they are.
    """
    found: list[Swing] = []
    order = [None, *frames]
    for group in swinging(rig):
        left, ends = set(group), outside(rig, group)
        beams = [end for end in ends if any(_bears(link, end, left) for link in rig.links)]
        last = max(ends, key=lambda end: order.index(body_of(rig, end)))
        for root in beams or [last]:
            body = body_of(rig, root)
            frame = None if body is None else frames[body]
            found += _from(rig, root, left, frame, _pivot(rig, root))
    return tuple(found)


def _bears(link: Link, end: str, loads: set[str]) -> bool:
    """Whether a link is a beam from this end to one of the loads."""
    return link.mass > 0 and end in link.ends and not loads.isdisjoint(link.ends)


def body_of(rig: Rig, point: str) -> str | None:
    """Name of the body that has a point; None for the world."""
    anchor = next((part for part in rig.anchors if part.name == point), None)
    if anchor is None:
        return point
    return None if anchor.frame == WORLD else anchor.frame


def _pivot(rig: Rig, point: str) -> Vector:
    """A point in the axes of the body that has it, where that is none that swings."""
    anchor = next((part for part in rig.anchors if part.name == point), None)
    return (0.0, 0.0, 0.0) if anchor is None else anchor.position


def _from(
    rig: Rig, upper: str, left: set[str], frame: Frame | None, pivot: Vector
) -> Iterator[Swing]:
    """Loads below a point, depth first; those found are taken from what is `left`."""
    for link in sorted(rig.links, key=lambda link: not link.mass):  # beams need their own load
        lower = next((end for end in link.ends if end != upper), upper)
        if upper not in link.ends or lower not in left:
            continue
        left.remove(lower)
        rest = _rest(rig, frame, upper, lower)
        load = next(part for part in rig.loads if part.name == lower)
        parent, length = body_of(rig, upper), rig.link_length(link)
        axes = _axes(rig, rest, level=bool(link.mass))
        swing = Swing(load, link, upper, parent, frame, pivot, length, rest, axes)
        yield swing
        yield from _from(rig, lower, left, frame, swing.reach)


def _rest(rig: Rig, frame: Frame | None, upper: str, lower: str) -> Vector:
    """Unit vector from one point to another at home, in a frame's axes."""
    ends = [inwards(rig.frames, frame, rig.home_of, rig.home_point(p)) for p in (upper, lower)]
    way = np.subtract(ends[1], ends[0])
    return _tidy(way / np.linalg.norm(way))


def _axes(rig: Rig, rest: Vector, level: bool) -> tuple[Vector, ...]:
    """Axes of the hinges of a link that lies along `rest` at home, or of one that may be level."""
    if rig.dimensions == 2:
        return ((0.0, 1.0, 0.0),)
    along = np.array(rest)
    unit = np.eye(3)[2 if level and abs(along[2]) < LEVEL else np.abs(along).argmin()]
    across = unit - (unit @ along) * along
    across /= np.linalg.norm(across)
    return (_tidy(across), _tidy(np.cross(along, across)))


def _tidy(values: Array) -> Vector:
    """Three numbers without the last digit's noise, so that exported scenes stay readable."""
    x, y, z = (float(f"{value:.15g}") + 0.0 for value in values)
    return (x, y, z)
