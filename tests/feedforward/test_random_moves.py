"""Random moves: solved to rounding exactly when the closed form says that they can be followed."""

import numpy as np
import pytest

from flatrig import models
from flatrig.feedforward import residuals, rest_to_rest, solve
from flatrig.models import PathError

FINE = 2001
"""Samples by which the closed form judges a move."""


def random_end(rig, rng):
    """A load position under the rail."""
    height = -rng.uniform(0.2, 8.0)
    if rig.dimensions == 2:
        return (rng.uniform(-2, 8), height)
    angle, radius = rng.uniform(-np.pi, np.pi), rng.uniform(0.6, 7.5)
    return (radius * np.cos(angle), radius * np.sin(angle), height)


def can_follow(rig, reference):
    """Whether the rope always pulls and its foot x - z x'' / (z'' + g) stays on the rail."""
    times = np.linspace(0, reference.duration, FINE)
    path, _, second = reference.derivatives(times, 2)
    lift = second[:, -1] + rig.gravity
    if lift.min() <= 0:
        return False
    foot = path[:, :-1] - path[:, -1:] * second[:, :-1] / lift[:, None]
    place = foot[:, 0] if rig.dimensions == 2 else np.linalg.norm(foot, axis=1)
    rail = rig.rails[0]
    return bool((place >= rail.start).all() and (place <= rail.end).all())


@pytest.mark.parametrize("name", ["overhead_crane", "rotary_crane"])
def test_random_moves_are_solved_or_refused_rightly(name):
    rng = np.random.default_rng(3)
    rig = models.make(name)
    counts = {True: 0, False: 0}
    for _ in range(150):
        duration = 10 ** rng.uniform(0, 1.5)
        start, goal = random_end(rig, rng), random_end(rig, rng)
        reference = rest_to_rest(start, goal, duration, order=int(rng.integers(4, 8)))
        times = np.sort(rng.uniform(0, duration, int(10 ** rng.uniform(0, 3))))
        feasible = can_follow(rig, reference)
        counts[feasible] += 1
        if feasible:
            motion = solve(rig, reference, times)
            assert residuals(motion, reference).max() < 1e-9
            assert (motion.rope_lengths > 0).all()
            assert (motion.tensions > 0).all()
        else:
            with pytest.raises(PathError):
                solve(rig, reference, times)
    assert min(counts.values()) > 10
