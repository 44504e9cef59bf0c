"""More ropes than freedoms: what tensions are left open, and what says them.

A load in space has three freedoms and a platform six.  Where more driven ropes go straight to one
of them, its motion leaves some tensions open: as many as outputs "ROPE.tension" may say, and what
they do not say follows from the least squares of force densities, see `Rig.distribution`.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..errors import RigError, did_you_mean
from ..types import Array
from ..values import Vector
from .description import Description
from .parts import Load, Platform, Rope

TENSION = ".tension"
"""Ends the name of an output that is the tension of a link, or of a rope at its winch."""


class Redundant(NamedTuple):
    """A load or platform with more ropes than freedoms."""

    body: Load | Platform
    ropes: tuple[Rope, ...]
    """The driven ropes that go straight to it."""
    freedoms: int
    prescribed: tuple[str, ...]
    """Names of those whose tensions are outputs."""

    @property
    def open(self) -> int:
        """Tensions that neither its motion nor an output says; negative if there are too many."""
        return len(self.ropes) - self.freedoms - len(self.prescribed)


def redundant_bodies(rig: Description) -> tuple[Redundant, ...]:
    """What has more ropes than freedoms."""
    driven, found = {drive.on for drive in rig.drives}, []
    for body in rig.hanging:
        own = {body.name} | {anchor.name for anchor in rig.anchors if anchor.frame == body.name}
        ropes = tuple(
            rope
            for rope in rig.ropes
            if rope.name in driven and len(rope.path) == 2 and len(own & set(rope.path)) == 1
        )
        names = [f"{body.name}.{axis}" for axis in rig.axes]
        names += rig.angles_of(body) if isinstance(body, Platform) else ()
        freedoms = len([name for name in names if name not in rig.held])
        if len(ropes) > freedoms:
            said = tuple(rope.name for rope in ropes if rope.name + TENSION in rig.outputs)
            found.append(Redundant(body, ropes, freedoms, said))
    return tuple(found)


def distributed(rig: Description) -> tuple[Redundant, ...]:
    """What has open tensions that `Rig.distribution` says, where outputs leave room for them.

    With as many outputs as drives there is none, such as where lengths of ropes are named that
    follow from the motion of what they hold: that can be described and not be solved.
    """
    found = tuple(body for body in redundant_bodies(rig) if body.open > 0)
    left = sum(body.open for body in found)
    return found if len(rig.outputs) + left == len(rig.drives) else ()


def check_counts(rig: Description) -> None:
    """As many outputs and open tensions as drives, and distributed ropes that are redundant.

    Raises
    ------
    RigError
        There are more or fewer, or `distribution` names another rope.
    """
    bodies = redundant_bodies(rig)
    for found in bodies:
        if found.open < 0:
            raise RigError(
                f"rig {rig.name}: {len(found.prescribed)} tensions of ropes to {found.body.name} "
                f"are outputs, of {len(found.ropes)} ropes for {found.freedoms} freedoms only "
                f"{len(found.ropes) - found.freedoms} are open"
            )
    left, outputs, drives = sum(found.open for found in bodies), len(rig.outputs), len(rig.drives)
    if drives not in (outputs, outputs + left):
        hint = f" (and {left} open tensions of more ropes than freedoms)" if left else ""
        raise RigError(
            f"rig {rig.name}: {outputs} outputs{hint} for {drives} drives, "
            "exact feedforward needs as many of one as of the other"
        )
    known = [rope.name for found in distributed(rig) for rope in found.ropes]
    for name, tension in rig.distribution.items():
        if name not in known:
            reason = did_you_mean(name, known) if known else "; this rig has none"
            raise RigError(
                f"distribution names {name!r}, which is none of more ropes than freedoms{reason}"
            )
        if isinstance(tension, tuple) or tension < 0:
            raise RigError(f"distribution of {name} is {tension}, it must be a tension >= 0 [N]")


def wanted_densities(rig: Description, places: Mapping[str, Vector]) -> dict[str, float]:
    """Force densities that ropes should have [N/m], their wanted tension over length at home.

    By name, those left out of the distribution 0; `places` [m] are of the points at home.
    """
    densities = {}
    for found in redundant_bodies(rig):
        for rope in found.ropes:
            span = np.subtract(places[rope.path[0]], places[rope.path[1]])
            wanted = rig.distribution.get(rope.name, 0.0)
            assert isinstance(wanted, float)
            densities[rope.name] = wanted * rope.falls / float(np.linalg.norm(span))
    return densities


def structure_at_home(rig: Description, found: Redundant, places: Mapping[str, Vector]) -> Array:
    """Forces and moments of unit tensions on a body, (freedoms, ropes), moments over its size.

    `places` [m] are those of all points and of the body at home.  What is held is left out.
    """
    centre = np.array(places[found.body.name])
    columns, arms = [], []
    for rope in found.ropes:
        inner = _end_at(rig, rope, found.body.name)
        outer = next(point for point in rope.path if point != inner)
        way = np.subtract(places[outer], places[inner])
        arm = np.subtract(places[inner], centre)
        arms.append(float(np.linalg.norm(arm)))
        force = way / np.linalg.norm(way)
        columns.append(np.concatenate((force, np.cross(arm, force))))
    size = max(arms) or 1.0
    names = [f"{found.body.name}.{axis}" for axis in "xyz"]
    turns: Sequence[str] = ("", "", "")
    if isinstance(found.body, Platform):
        angles = rig.angles_of(found.body)
        turns = angles if len(angles) == 3 else ("", angles[0], "")
    free = [f"{found.body.name}.{axis}" for axis in rig.axes]
    rows = [i for i, name in enumerate(names) if name in free and name not in rig.held]
    rows += [3 + i for i, name in enumerate(turns) if name and name not in rig.held]
    scale = np.repeat([1.0, 1.0 / size], 3)
    return np.asarray((np.array(columns).T * scale[:, None])[rows])


def _end_at(rig: Description, rope: Rope, body: str) -> str:
    """Which of a straight rope's points is on a body."""
    on = {anchor.name: anchor.frame for anchor in rig.anchors}
    return next(point for point in rope.path if on.get(point, point) == body)


SINGULAR = 1e8
"""Condition number of a body's ropes at home from which some force or moment on it is none that
they can hold; a geometry that is one by its symmetry has 1e16, useful ones below 1e3."""


def check_structure(rig: Description, places: Mapping[str, Vector]) -> None:
    """Refuse ropes that leave a body at home a freedom that none of them holds.

    Raises
    ------
    RigError
        Their geometry is singular; says its condition number.
    """
    for found in redundant_bodies(rig):
        values = np.linalg.svd(structure_at_home(rig, found, places), compute_uv=False)
        condition = float(values[0] / values[-1]) if values[-1] > 0 else np.inf
        if not condition < SINGULAR:
            raise RigError(
                f"rig {rig.name}: the {len(found.ropes)} ropes to {found.body.name} are in a "
                f"singular place at home (condition number {condition:.1e}), where they leave a "
                f"motion of its {found.freedoms} free; move its corners or their winches apart"
            )
