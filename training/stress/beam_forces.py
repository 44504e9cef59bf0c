"""What the weight and inertia of beams do at their ends, from moments about their centres."""

from collections.abc import Iterator, Mapping

import numpy as np

from ...models.rig.beams import beams
from ...models.rig.rig import Rig
from ...models.types import Array


def of_beams(rig: Rig, world: Mapping[str, Array]) -> Iterator[tuple[str, Array, Array]]:
    """For each end of a beam its name, the force (N, 3) on it, and the size of that (N,).

    A force at the centre is shared between the ends by the rule of the lever, and the moment that
    turns the beam is a pair of forces at the ends.  `world` has the points' motion, (3, N, 3) each.
    """
    for beam in beams(rig):
        first, second = beam.link.ends
        away = world[second][2] - world[first][2]
        centre = world[first][2] + beam.share * away
        down = -beam.link.mass * (centre + np.array([0.0, 0.0, rig.gravity]))
        pair = beam.moment / beam.length**2 * away
        size = beam.link.mass * (np.linalg.norm(centre, axis=1) + rig.gravity)
        size = size + np.linalg.norm(pair, axis=1)
        yield first, (1.0 - beam.share) * down + pair, size
        yield second, beam.share * down - pair, size
