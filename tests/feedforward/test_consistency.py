"""References of one's own: what contradicts itself is found, and nothing else is."""

import re
from dataclasses import dataclass

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.feedforward import (
    along,
    base_at,
    beside,
    bisected,
    check,
    from_move,
    hold,
    over,
    rest_to_rest,
    sampled,
    scaled,
    shortest_duration,
    solve,
    three_phase,
)
from flatrig.feedforward.paths.consistency import is_own, verify_reference
from flatrig.models import PathError

START, GOAL = (0.0, -4.0), (5.0, -1.0)
NAMES = ("load.x", "load.z")
ZIGZAG = ((0, -4), (2, -2), (1, -3), (4, 1), (0, 2), (3, -3), (5, -1))


class Own:
    """Another path's derivatives, spoilt by `spoil(times, derivatives)`, under another order."""

    def __init__(self, path, spoil=lambda times, values: values, order=None):
        self.path, self.spoil = path, spoil
        self.order = path.order if order is None else order
        self.duration, self.size = path.duration, path.size
        self.start, self.goal = path.start, path.goal

    def derivatives(self, times, order):
        times = np.atleast_1d(times)
        return self.spoil(times, self.path.derivatives(times, order))

    def __call__(self, times):
        return self.derivatives(times, 0)[0]


def every_path():
    """Paths of every kind that the package makes, gentle and abrupt, far away and tiny."""
    for order in (0, 1, 2, 4, 6, 9, 20):
        yield rest_to_rest(START, GOAL, 3.0, order)
        for blend in (0.5, 0.25, 0.01, 1e-4, 1e-6):
            if order:
                yield three_phase(START, GOAL, 20.0, 20 * blend, order)
    for duration in (1e-6, 1e9):
        yield rest_to_rest(START, GOAL, duration, 6)
    yield rest_to_rest((-1e12, 0), (1e12, 1), 3.0)
    yield rest_to_rest((1e6, -30), (1e6 + 1, -30), 5.0)
    yield hold((1.0, 2.0))
    yield over(START, GOAL, (0, 2), 4.0)
    for order in (0, 1, 2, 4, 6, 10):
        for points in (ZIGZAG[:2], ZIGZAG[:3], ZIGZAG):
            yield along(points, 4.0, order)
            yield sampled(np.linspace(0, 3, len(points)), points, order)
    times = np.linspace(0, 3, 301)
    for path in (rest_to_rest(START, GOAL, 3.0, 9), three_phase(START, GOAL, 3.0, 0.7)):
        yield sampled(times, path(times))
        yield scaled(sampled(times, path(times)), 7.0)
    for name in models.CATALOGUE:
        yield from_move(models.default_move(models.make(name)))
    yield beside(rest_to_rest([0], [1], 3.0), three_phase([0], [1], 5.0, 1.1), hold([2.0]))
    navy = models.navy_crane_2d()
    yield bisected(navy, rest_to_rest((-6, -20), (-8, -17), 6.0, order=6))


def test_no_path_of_the_package_is_accused():
    """Looked at like a stranger's, up to the order that it claims; bases may move outside."""
    for path in every_path():
        assert is_own(path)
        base = base_at(path, 0.0)
        free = tuple(column for _, column in base.columns) if base else ()
        verify_reference(Own(path), tuple(f"output {i}" for i in range(path.size)), 8, free=free)


SOUND = {
    "polynomial": rest_to_rest(START, GOAL, 3.0),
    "three-phase": three_phase(START, GOAL, 20.0, 5.0),
    "short blends": three_phase(START, GOAL, 20.0, 0.5),
    "curve": along(ZIGZAG, 4.0),
}


@pytest.mark.parametrize("factor", [0.0, 0.9, 1.1, -1.0])
@pytest.mark.parametrize("path", SOUND.values(), ids=SOUND)
def test_a_wrong_derivative_is_found(path, factor):
    """And named with its output, its order, its time, what it is and what it should be."""
    said = r"derivative (\d) of (\S+) is (\S+) at (\S+) s, differences of (?:derivative (\d)|the"
    for k in range(1, 5):
        for column, name in enumerate(NAMES):

            def spoil(times, values, k=k, column=column):
                if len(values) > k:
                    values[k, :, column] *= factor
                return values

            with pytest.raises(PathError) as caught:
                verify_reference(Own(path, spoil), NAMES, 4)
            found = re.search(said + r" path) give (\S+)$", str(caught.value))
            assert found[1] == str(k)
            assert found[2] == name
            assert int(found[5] or 0) == k - 1
            truth = path.derivatives([float(found[4])], k)[k, 0, column]
            scale = np.abs(path.derivatives(np.linspace(0, path.duration, 999), k)[k]).max()
            assert float(found[6]) == pytest.approx(truth, abs=0.02 * scale)
            assert float(found[3]) == pytest.approx(factor * truth, abs=0.02 * scale)


@pytest.mark.parametrize("order", [0, 1, 2, 3])
@pytest.mark.parametrize(
    "rough",
    [
        lambda order: rest_to_rest(START, GOAL, 3.0, order),
        lambda order: three_phase(START, GOAL, 20.0, 5.0, max(order, 1)),
        lambda order: along(ZIGZAG, 4.0, order),
        lambda order: feedforward.CurvedPath(
            feedforward.Waypoints(ZIGZAG, order), 4.0, feedforward.RestToRest(8)
        ),
    ],
)
def test_a_claim_of_too_many_derivatives_is_found_by_the_jump(rough, order):
    path = rough(order)
    verify_reference(Own(path), NAMES, 8)
    with pytest.raises(PathError, match=r"order says 4$") as caught:
        verify_reference(Own(path, order=4), NAMES, 4)
    assert f"derivative {path.order + 1} of load." in str(caught.value)
    assert f"the path has {path.order} continuous derivatives" in str(caught.value)


def nowhere(times, values):
    return values * np.where(times > 1, np.nan, 1.0)[:, None]


def endless(times, values):
    values[1, times > 3.0] = 1.0
    return values


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda times, values: values[:2], r"shape \(2, \d+, 2\), they must have shape \(5,"),
        (nowhere, r"reference's load.x is nan at 1\.\d+ s, it must be finite"),
        (endless, r"derivative 1 of load.x is 1 at 3.3 s, after its end, where it rests: .* be 0$"),
        (
            lambda times, values: values + 1.0,
            "load.x jumps from 6 to 5 at 3 s where it comes to rest",
        ),
    ],
)
def test_other_contradictions(spoil, said):
    with pytest.raises(PathError, match=said):
        verify_reference(Own(SOUND["polynomial"], spoil), NAMES, 4)


def tenth(times, values):
    if len(values) > 2:
        values[2] *= 1.1
    return values


def test_solve_check_and_planning_do_not_believe_blindly():
    rig = models.overhead_crane()
    path = Own(SOUND["polynomial"], tenth)
    said = "derivative 2 of load.x is .* differences of derivative 1 give"
    with pytest.raises(PathError, match=said):
        solve(rig, path, [1.0])
    with pytest.raises(PathError, match=said):
        solve(rig, scaled(path, 4.0), [1.0])
    with pytest.raises(PathError, match=said):
        shortest_duration(rig, path)
    report = check(rig, path)
    assert not report.feasible
    assert re.search(said, report.problems[0])
    assert report.motion is not None
    rough = check(rig, Own(rest_to_rest(START, GOAL, 3.0, order=2), order=4))
    assert "derivative 3 of load.x jumps from 0 to" in rough.problems[0]
    honest = check(rig, Own(rest_to_rest(START, GOAL, 3.0, order=2)))
    assert "2 continuous derivatives, rig overhead_crane needs 4" in honest.problems[0]
    assert not any("jumps" in problem for problem in honest.problems)
    assert check(rig, Own(SOUND["polynomial"])).feasible


def test_a_profile_or_curve_of_one_s_own_is_looked_at():
    class Bent:
        order, size = 4, 2

        def derivatives(self, s, order):
            values = np.zeros((order + 1, len(s), 2))
            values[0] = s[:, None]
            values[1:2] = 1.2
            return values

    path = feedforward.CurvedPath(Bent(), 3.0, feedforward.RestToRest(4))
    assert not is_own(path)
    with pytest.raises(PathError, match=r"derivative 1 of load\.x is"):
        verify_reference(path, NAMES, 4)


def test_one_instant_is_taken_at_its_word():
    """An operator's command: derivatives of now, whatever the time, as the path has them there."""
    rig, path, now = models.overhead_crane(), SOUND["polynomial"], 1.2
    command = Own(
        path, lambda times, values: values * 0.0 + path.derivatives([now], len(values) - 1)
    )
    with pytest.raises(PathError, match="jumps from"):
        solve(rig, command, 0.5)
    motion, truth = solve(rig, command, 0.5, verify=False), solve(rig, path, now)
    np.testing.assert_allclose(motion.inputs, truth.inputs, rtol=1e-12)


@dataclass
class Thawed(Own):
    path: object
    spoil = None


@pytest.mark.parametrize(
    ("reference", "said"),
    [
        ([0.0, 1.0], "the reference is a list, it must be a path; from_move makes one"),
        (Thawed(hold(START)), "the reference is a Thawed, which has no hash"),
        (Own(hold(START), order=4.5), "the reference's order is 4.5, it must be a whole number"),
    ],
)
def test_what_is_no_reference_gets_one_line(reference, said):
    for call in (
        lambda: solve(models.overhead_crane(), reference, 0.0),
        lambda: check(models.overhead_crane(), reference),
    ):
        with pytest.raises(PathError, match="^" + re.escape(said)):
            call()
    bare = Own(hold(START))
    del bare.duration, bare.goal
    with pytest.raises(PathError, match=r"Own, has no duration and no goal; feedforward\.Ref"):
        solve(models.overhead_crane(), bare, 0.0)
