"""Whether a path is accepted does not depend on the instants that are asked for."""

from dataclasses import replace

import numpy as np
import pytest

from flatrig import models
from flatrig.feedforward import over, rest_to_rest, solve
from flatrig.feedforward.exact.branch import GRIDS
from flatrig.models import Drive, Frame, Load, PathError, Rail, Rig, Rope, Trolley

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


@pytest.mark.parametrize("samples", [1, 151])
def test_load_that_passes_free_fall_at_an_instant_is_refused(samples):
    """Its rope's multiplier changes its sign, no determinant does, on whatever grid: one falls
    with the square of that multiplier and rises again within a millionth of the move."""
    rig = Rig(
        name="sloping",
        frames=(Frame("frame", "sliding", 7e3, (0.36, 0.8, 0.48)),),
        rails=(Rail("rail", (0.96, 0.0, -0.28), frame="frame"),),
        masses=(Trolley("trolley", 1.3e3, "rail"), Load("load", 1.3)),
        ropes=(Rope("hoist", ("trolley", "load"), 0.06, 2e-3),),
        drives=tuple(Drive(part, on=part, limit=1e6) for part in ("frame", "trolley", "hoist")),
        outputs=("load.x", "load.y", "load.z"),
        home={"trolley": 0.13, "load": (0.13, 0.0, -0.27)},
    )
    path = rest_to_rest((0.12, 0.11, -0.21), (0.21, 0.10, -0.39), 0.00258)
    with pytest.raises(PathError, match="rope hoist would grow beyond all bounds"):
        solve(rig, path, np.linspace(0.0, path.duration, samples))
    slow = rest_to_rest(path.start, path.goal, 2.0)
    assert not solve(rig, slow, np.linspace(0.0, 2.0, samples)).slack
