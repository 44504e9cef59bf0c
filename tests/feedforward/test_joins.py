"""A motion that continues another one: on its branch, with its turns, without a jump."""

import copy
import math
import pickle
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import feedforward, models
from flatrig.feedforward import along, from_move, over, residuals, rest_to_rest, solve
from flatrig.models import PathError, RigError


@dataclass(frozen=True)
class Rest:
    """What is left of a path from some time on."""

    path: object
    since: float

    @property
    def order(self):
        return self.path.order

    @property
    def size(self):
        return self.path.size

    @property
    def duration(self):
        return self.path.duration - self.since

    @property
    def start(self):
        return self([0.0])[0]

    @property
    def goal(self):
        return self.path.goal

    def derivatives(self, times, order):
        return self.path.derivatives(np.maximum(times, 0.0) + self.since, order)

    def __call__(self, times):
        return self.derivatives(times, 0)[0]


def same(one, other, digits=1e-12):
    """Equal to some digits of the largest value, for each kind of number."""
    for name in ("positions", "velocities", "inputs", "tensions"):
        a, b = getattr(one, name), getattr(other, name)
        assert_allclose(a, b, rtol=0, atol=digits * np.abs(b).max(), err_msg=name)


@pytest.mark.parametrize("name", models.CATALOGUE)
def test_join_does_not_jump(name):
    rig = models.make(name)
    path = from_move(models.default_move(rig))
    cut = 0.37 * path.duration
    times = np.linspace(0.0, path.duration - cut, 7)
    whole = solve(rig, path, cut + times)
    begin = solve(rig, path, 0.0).at(cut)
    later = solve(rig, Rest(path, cut), times, begin=begin)
    same(later, whole)
    assert len(begin.unknowns) == len(feedforward.analyse(rig).unknowns)


@pytest.mark.parametrize("rise", [-4.0, -4.3, -4.6])
@pytest.mark.parametrize("duration", [8.0, 6.0, 5.0])
def test_swing_past_the_tower_can_be_cut_in_its_middle(rise, duration):
    """No rest at the place of the cut is on its branch."""
    rig = models.rotary_crane()
    path = over((4.0, 0.0, -5.0), (4.0, 0.0, -5.0), (rise, 0.0, 0.0), duration)
    rest, left = Rest(path, duration / 2), np.linspace(0.0, duration / 2, 5)
    whole = solve(rig, path, duration / 2 + left)
    later = solve(rig, rest, left, begin=whole.at(duration / 2))
    same(later, whole)
    assert residuals(later, rest).max() < 1e-12
    with pytest.raises(PathError, match=r"rest|cannot follow"):
        solve(rig, rest, left, verify=False)


def test_turns_of_a_frame_are_carried_on():
    rig = models.rotary_crane()
    around = [(5 * math.cos(a), 5 * math.sin(a), -5.0) for a in np.linspace(0, 1.5 * math.pi, 9)]
    path = along(around, 60.0, order=4)
    first = solve(rig, path, [30.0, 60.0])
    angle = first.column("bridge.angle")
    back = rest_to_rest(path.goal, (0.0, -4.0, -5.0), 20.0)
    second = solve(rig, back, [0.0, 20.0], begin=first.at(60.0))
    assert_allclose(second.positions[:, angle], 1.5 * math.pi, rtol=1e-9)
    assert_allclose(second.drive_positions[0], first.drive_positions[1], rtol=1e-9)
    anew = solve(rig, back, 0.0)
    assert_allclose(anew.positions[0, angle], -0.5 * math.pi, rtol=1e-9)


def test_state_outside_of_a_motion_is_rest():
    rig = models.overhead_crane()
    path = rest_to_rest((0, -4), (5, -1), 3.0)
    motion = solve(rig, path, 0.0)
    for time, place in ((-1.0, (0, -4)), (4.0, (5, -1))):
        state = motion.at(time)
        assert_allclose(state.derivatives, [place, *np.zeros((4, 2))], atol=1e-12)
    again = solve(rig, rest_to_rest((5, -1), (0, -4), 3.0), 0.0, begin=motion.at(4.0))
    same(again, solve(rig, path, 3.0))


def test_means_over_holds_continue_too():
    rig = models.overhead_crane()
    path = rest_to_rest((0, -4), (5, -1), 3.0)
    whole = solve(rig, path, [1.0, 1.5], hold=0.01)
    later = solve(rig, Rest(path, 1.0), [0.0, 0.5], hold=0.01, begin=whole.at(1.0))
    assert_allclose(later.inputs, whole.inputs, rtol=1e-11)


def test_motion_and_state_can_be_copied():
    rig = models.overhead_crane()
    path = rest_to_rest((0, -4), (5, -1), 3.0)
    motion = pickle.loads(pickle.dumps(solve(rig, path, 0.0)))
    begin = copy.deepcopy(motion.at(1.0))
    same(solve(rig, Rest(path, 1.0), 0.5, begin=begin), solve(rig, path, 1.5))


def test_wrong_joins_are_refused():
    rig = models.overhead_crane()
    path = rest_to_rest((0, -4), (5, -1), 3.0)
    motion = solve(rig, path, 0.0)
    with pytest.raises(PathError, match=r"load.x = 1.005.., .* continue has 0.7242.. at 1 s"):
        solve(rig, Rest(path, 1.1), 0.0, begin=motion.at(1.0))
    with pytest.raises(PathError, match=r"derivative 1 of load.x = 0, the .* has 4.1"):
        solve(rig, rest_to_rest((2.5, -2.5), (0, -4), 3.0), 0.0, begin=motion.at(1.5))
    with pytest.raises(PathError, match=r"starts with load.x = 0, .* has 2.5 at 1.5 s"):
        solve(rig, path, 0.0, begin=motion.at(1.5))
    with pytest.raises(PathError, match=r"jumps from 0 to .* where it leaves rest"):
        solve(rig, Rest(path, 1.0), 0.0)
    with pytest.raises(PathError, match=r"time 1 is -0.1 s, before 0 s"):
        solve(rig, Rest(path, 1.0), [0.0, -0.1], begin=motion.at(1.0))
    with pytest.raises(PathError, match=r"begin is 1\.0, it must be a State"):
        solve(rig, path, 0.0, begin=1.0)
    with pytest.raises(RigError, match=r"with other numbers"):
        solve(models.overhead_crane(load_mass=1.0), path, 0.0, begin=motion.at(0.0))
    with pytest.raises(RigError, match=r"not of rotary_crane"):
        solve(
            models.rotary_crane(), rest_to_rest((5, 0, -5), (4, 0, -5), 9.0), 0, begin=motion.at(0)
        )
    with pytest.raises(PathError, match=r"time is nan"):
        motion.at(math.nan)
    with pytest.raises(RigError, match=r"integrated"):
        replace(motion, branch=None).at(0.0)
