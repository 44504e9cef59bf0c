"""How far a move keeps from what stands around: spheres and boxes.

    tank = Sphere("tank", centre=(2.5, 0, -4), radius=0.8)
    hall = Box("hall", low=(3, -2, -8), high=(6, 2, -4.5))
    nearest = clearance(rig, reference, (tank, hall), load_radius=0.5)
    nearest.distance, nearest.time, nearest.part, nearest.obstacle      # all in [m] and [s]

The load and platforms count as spheres of radius `load_radius` around their points, ropes as
straight segments without thickness from point to point of their path.  A distance is exact at each
sample, negative inside an obstacle, and the smallest is sought between the samples, too.

Limits: trolleys, girders and booms are not looked at, obstacles do not move, and an obstacle much
smaller than the way from sample to sample can be passed unseen: raise `rate`.  A planar rig moves
in the plane y = 0.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...models.errors import PathError
from ...models.rig.obstacles import Obstacle, check_radius
from ...models.rig.rig import Rig
from ..exact.motion import Motion
from ..exact.state import State
from ..paths.reference import Reference
from ..solving.inverse import solve
from ..solving.places import places_of
from .feasibility import instants

REFINEMENTS = 3
"""The smallest distance is sought anew between the samples beside it, so many times."""
BETWEEN = 65
"""Samples each time."""


@dataclass(frozen=True)
class Clearance:
    """The closest that a move comes to an obstacle."""

    distance: float
    """Smallest distance [m], negative where they overlap."""
    time: float
    """When it is that small [s]."""
    part: str
    """The load, platform or "rope NAME" that is closest."""
    obstacle: str
    """Name of the obstacle."""

    @property
    def clear(self) -> bool:
        """Whether nothing is touched."""
        return self.distance > 0

    def __str__(self) -> str:
        relation = f"{self.distance:.4g} m from" if self.clear else f"{-self.distance:.4g} m inside"
        return f"{self.part} is {relation} {self.obstacle} at {self.time:.4g} s"


def clearance(
    rig: Rig,
    reference: Reference,
    obstacles: Sequence[Obstacle],
    *,
    load_radius: float = 0.0,
    ropes: bool = True,
    rate: float = 200.0,
    begin: State | None = None,
) -> Clearance:
    """The smallest distance that the load, and the ropes too, keep from obstacles on a move.

    Parameters
    ----------
    rig
        A flat rig.
    reference
        Path of its outputs, which it can follow.
    obstacles
        One or more.
    load_radius
        Of the loads and platforms [m].
    ropes
        Whether ropes count.
    rate
        Samples per second, between which the smallest distance is then refined [Hz].
    begin
        State of the motion that the path continues, as for `solve`.

    Raises
    ------
    PathError
        There is no obstacle, the radius is not >= 0, or as `solve`.
    RigError, SmoothnessError
        As `solve`.
    OptionError
        The rate is not > 0, or makes more than a million samples.
    """
    if not obstacles:
        raise PathError("there is no obstacle to keep clear of")
    check_radius("load_radius", load_radius)
    times = instants(reference.duration, rate)
    step = times[1] - times[0]
    nearest = Clearance(math.inf, 0.0, "", "")
    for _ in range(1 + REFINEMENTS):
        motion = solve(rig, reference, times, begin=begin)
        closest = _closest(motion, obstacles, float(load_radius), ropes)
        nearest = min(nearest, closest, key=lambda candidate: candidate.distance)
        times = np.linspace(nearest.time - step, nearest.time + step, BETWEEN)
        times = np.clip(times, 0.0, reference.duration)
        step = 2.0 * step / (BETWEEN - 1)
    return nearest


def _closest(
    motion: Motion, obstacles: Sequence[Obstacle], load_radius: float, ropes: bool
) -> Clearance:
    """The smallest distance at the samples of a motion."""
    places = places_of(motion)
    candidates = []
    for obstacle in obstacles:
        for load in motion.rig.hanging:
            gaps = obstacle.distance(places[load.name]) - load_radius
            candidates.append((gaps, load.name, obstacle.name))
        for rope in motion.rig.ropes if ropes else ():
            for a, b in pairwise(rope.path):
                gaps = obstacle.segment_distance(places[a], places[b])
                candidates.append((gaps, f"rope {rope.name}", obstacle.name))
    gaps, part, name = min(candidates, key=lambda candidate: float(candidate[0].min()))
    i = int(gaps.argmin())
    return Clearance(float(gaps[i]), float(motion.times[i]), part, name)
