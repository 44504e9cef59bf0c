"""What must hold of links and of held freedoms, checked when a rig is made.

Raises
------
RigError
    From every check: what is wrong, in one line.
"""

import math
from collections.abc import Iterable, Mapping

from ..errors import RigError, did_you_mean
from ..values import Vector
from .description import Description
from .link import Link

CLOSE = 1e-6
"""Share of its length by which a link's ends may be nearer or farther at home: it guards against
places written with few digits."""


def check_links(
    links: Iterable[Link], places: Mapping[str, Vector], frames: Mapping[str, str]
) -> None:
    """Links join two points of different bodies that are as far apart at home as they are long.

    Points are at `places` [m]; `frames` says in which frame or platform each anchor is fixed.
    """
    for link in links:
        label = f"link {link.name}"
        if len(link.ends) != 2:
            raise RigError(f"{label}: ends are {len(link.ends)} points, it must be 2")
        for end in link.ends:
            if end not in places:
                hint = did_you_mean(end, list(places))
                raise RigError(f"{label} names {end!r}, which does not exist{hint}")
        first, second = link.ends
        if first == second:
            raise RigError(f"{label}: both ends are {first!r}, it must join two points")
        if first in frames and frames[first] == frames.get(second):
            raise RigError(
                f"{label}: its ends {first} and {second} are both fixed in {frames[first]}, "
                "it must join two bodies"
            )
        _check_length(label, link, math.dist(places[first], places[second]))


def _check_length(label: str, link: Link, distance: float) -> None:
    first, second = link.ends
    if distance == 0:
        raise RigError(f"home of {label}: {first} and {second} coincide")
    if link.length is None:
        return
    if not link.length > 0:
        raise RigError(f"{label}: length is {link.length:g} m, it must be > 0")
    if abs(link.length - distance) > CLOSE * distance:
        how = "short" if link.length < distance else "long"
        raise RigError(
            f"{label}: length is {link.length:.7g} m, too {how} for its ends {first} and {second}, "
            f"which are {distance:.7g} m apart at home; leave length out or move one of them"
        )


def check_held(rig: Description) -> None:
    """Held coordinates are of loads and platforms, and nothing prescribes them."""
    free = [f"{part.name}.{axis}" for part in rig.hanging for axis in rig.axes]
    free += rig.platform_angles
    for name in rig.held:
        if name not in free:
            hint = did_you_mean(name, free)
            if name in rig.coordinate_names:
                hint = f"; it must be one of {', '.join(free)}"
            raise RigError(f"rig {rig.name}: {name!r} cannot be held{hint}")
        if rig.held.count(name) > 1:
            raise RigError(f"rig {rig.name}: {name!r} is held twice")
        for output in rig.outputs:
            if name in [coordinate for _, coordinate in rig.terms(output)]:
                raise RigError(
                    f"rig {rig.name}: {name!r} is held, output {output!r} cannot move it"
                )
    for platform in rig.platforms:
        turns = rig.turns_of(platform)
        if len(turns) == 2:
            (still,) = set(platform.angles) - {*turns}
            raise RigError(
                f"rig {rig.name}: of the angles of {platform.name} only {still!r} is held, it must "
                "be two, so that it turns about one axis, or all three"
            )
