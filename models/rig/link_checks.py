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
        distance = math.dist(places[first], places[second])
        _check_length(label, link, distance)
        _check_mass(label, link, distance)


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


def _check_mass(label: str, link: Link, length: float) -> None:
    """It is a beam with mass, centre and inertia that a beam can have, or none of them."""
    if link.mass < 0:
        raise RigError(f"{label}: mass is {link.mass:g} kg, it must be >= 0")
    for quantity, unit in (("centre", "m"), ("inertia", "kg m2")):
        value = getattr(link, quantity)
        if value is not None and not link.mass:
            raise RigError(
                f"{label}: {quantity} is {value:g} {unit} of a mass of 0 kg; give its mass, too"
            )
    if link.centre is not None and not 0 <= link.centre <= length:
        raise RigError(
            f"{label}: centre is {link.centre:g} m from its first end, it must be 0 to its length "
            f"{length:.7g} m"
        )
    if link.inertia is not None and link.inertia < 0:
        raise RigError(f"{label}: inertia is {link.inertia:g} kg m2, it must be >= 0")


def check_beams(rig: Description) -> None:
    """Of the ends of a beam one is a load, and loads there have a mass."""
    loads = {load.name: load for load in rig.loads}
    for link in rig.links:
        if not link.mass:
            continue
        own = [loads[end] for end in link.ends if end in loads]
        if not own:
            raise RigError(
                f"link {link.name}: mass is {link.mass:g} kg, and none of its ends "
                f"{' and '.join(link.ends)} is a load; a beam hangs, or make it a frame or platform"
            )
        for load in own:
            if not load.mass:
                raise RigError(
                    f"load {load.name}: mass is 0 kg, what hangs at the end of beam {link.name} "
                    "must have a mass > 0, such as its shackle's"
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
