"""Whether a path is accepted does not depend on the instants that are asked for."""

from dataclasses import replace

import numpy as np
import pytest

from flatrig import models
from flatrig.feedforward import over, rest_to_rest, solve
from flatrig.feedforward.exact.branch import GRIDS
from flatrig.models import PathError

POLE = rest_to_rest(
    (1.6558111, 3.4863616, -12.9847468, 2.5663536),
    (2.0711605, 4.5313646, -14.1823410, 2.5045063),
    8.152631494,
    order=6,
)
"""A Navy crane's: its tensions pass infinity twice within a hundredth of a second."""


@pytest.mark.parametrize("samples", [1, 2, 201, 5001])
def test_narrow_pole_is_seen_at_any_sampling(samples):
    with pytest.raises(PathError, match=r"at t = 3\.15[0-9]* s .* no value there that continues"):
        solve(models.navy_crane_3d(), POLE, np.linspace(0.0, POLE.duration, samples))


def test_trolley_that_leaves_its_rail_between_two_samples_is_refused():
    rig = models.rotary_crane()
    path = over((4.0, 0.0, -5.0), (4.0, 0.5, -5.0), (2.3, 0.0, 0.0), 6.0)
    grid = np.linspace(0.0, 6.0, GRIDS[0])
    fine = np.linspace(0.0, 6.0, 100_001)
    seen, furthest = (solve(rig, path, times).positions[:, 1].max() for times in (grid, fine))
    assert furthest - seen > 1e-6
    assert rig.rails[0].start < seen < rig.rails[0].end
    for share, accepted in ((0.7, False), (1.01, True)):
        rail = replace(rig.rails[0], end=seen + share * (furthest - seen))
        short = replace(rig, rails=(rail,))
        if accepted:
            solve(short, path, [0.0])
        else:
            with pytest.raises(PathError, match=r"trolley is at .* rail girder goes"):
                solve(short, path, [0.0])
