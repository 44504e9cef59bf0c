"""Paths that start moving, and the stops and new goals that rigs reach on them."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.interpolate import BPoly

from flatrig import models
from flatrig.feedforward import (
    analyse,
    check,
    clearance,
    connected,
    from_move,
    rest_to_rest,
    shortest_duration,
    solve,
    stopped,
)
from flatrig.feedforward.paths.consistency import verify_reference
from flatrig.models import PathError, Sphere

START = np.random.default_rng(3).normal(size=(7, 2))
PATH = rest_to_rest((0, -4), (5, -1), 3.0, order=6)


class Foreign:
    """A path that is not the package's own, so that its derivatives are compared."""

    def __init__(self, path):
        self.path = path

    def __getattr__(self, name):
        return getattr(self.path, name)

    def derivatives(self, times, order):
        return self.path.derivatives(times, order)


@pytest.mark.parametrize("order", range(7))
def test_connected_is_the_hermite_polynomial(order):
    path = connected(START, (1.0, -2.0), 1.7, order)
    times = np.linspace(0.0, 1.7, 11)
    ends = np.zeros((order + 1, 2))
    ends[0] = 1.0, -2.0
    for column in range(2):
        rows = [START[: order + 1, column], ends[:, column]]
        other = BPoly.from_derivatives([0.0, 1.7], rows)
        for k, found in enumerate(path.derivatives(times, order + 1)[..., column]):
            truth = other(times, nu=k)
            assert_allclose(found, truth, rtol=0, atol=1e-10 * np.abs(truth).max())
    assert_allclose(path.derivatives([0.0], order)[:, 0], START[: order + 1], rtol=0, atol=0)
    assert not path.derivatives([1.7], order)[1:].any()
    assert not path.derivatives([1.8], order + 3)[1:].any()


def test_connected_joins_as_its_polynomial_does():
    path = connected(START, (1.0, -2.0), 1.7)
    soon = path.derivatives([1e-12], 7)[:, 0]
    sizes = np.abs(path.derivatives(np.linspace(0.0, 1.7, 9), 6)).max(axis=(1, 2))
    assert (np.abs(soon[:7] - START - 1e-12 * soon[1:]).max(axis=1) <= 1e-13 * sizes).all()


@pytest.mark.parametrize("order", [1, 4, 6])
def test_stopped_is_its_path_at_a_falling_pace(order):
    at, duration = 1.2, 0.9
    path = stopped(PATH, at, duration, order)
    n = order - 1

    def pace(t):
        s = t / duration
        blend = s**order * sum(math.comb(n + k, k) * (1 - s) ** k for k in range(order))
        return 1.0 - blend

    for t in (0.0, 0.3, 0.7, 0.9):
        sigma = at + quad(pace, 0.0, t, epsabs=1e-13)[0]
        assert_allclose(path([t]), PATH([sigma]), rtol=1e-12)
        slope = pace(t) * PATH.derivatives([sigma], 1)[1]
        assert_allclose(path.derivatives([t], 1)[1], slope, rtol=1e-10, atol=1e-12)
    joined = path.derivatives([0.0], order)
    assert_allclose(joined, PATH.derivatives([at], order), rtol=1e-12)
    assert_allclose(path.goal, PATH([at + duration / 2])[0], rtol=1e-13)
    assert not path.derivatives([duration, 2.0], order)[1:].any()


@pytest.mark.parametrize(
    "path", [connected(START, (1, -2), 1.7), stopped(PATH, 1.2, 0.9), stopped(PATH, 2.0, 5.0, 3)]
)
def test_derivatives_belong_together(path):
    verify_reference(Foreign(path), ("x", "z"), path.order, moving=True)
    with pytest.raises(PathError, match="leaves rest"):
        verify_reference(Foreign(path), ("x", "z"), path.order)


def test_stop_beyond_the_end_of_a_path_reaches_its_goal():
    assert_allclose(stopped(PATH, 2.9, 1.0).goal, PATH.goal, rtol=0, atol=0)


@pytest.mark.parametrize("name", models.CATALOGUE)
def test_stop_and_new_goal_join_without_a_jump(name):
    rig = models.make(name)
    move = models.default_move(rig)
    path = from_move(move)
    at = 0.4 * path.duration
    here = solve(rig, path, at)
    begin = here.at(at)
    away = connected(begin, move.goal, path.duration)
    for reference in (stopped(path, at, path.duration / 2), away):
        there = solve(rig, reference, 0.0, begin=begin)
        largest = np.abs(solve(rig, path, np.linspace(0, path.duration, 11)).inputs).max()
        assert_allclose(there.inputs, here.inputs, rtol=0, atol=1e-12 * largest)
        assert_allclose(there.accelerations, here.accelerations, rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize(
    ("name", "duration", "limit"),
    [
        ("overhead_crane", 1.034, "drive winch"),
        ("rotary_crane", 1.590, "drive bridge"),
        ("cable_manipulator", 1.913, "drive gantry"),
    ],
)
def test_shortest_stop_from_the_middle_of_a_move(name, duration, limit):
    """Within a fifth of what free polynomials took; these are at most 18 percent longer."""
    rig = models.make(name)
    path = from_move(models.default_move(rig))
    at = path.duration / 2
    begin = solve(rig, path, at).at(at)
    order = analyse(rig).reference_order
    best = shortest_duration(rig, lambda t: stopped(path, at, t, order), begin=begin)
    assert_allclose(best.duration, duration, rtol=1e-3)
    assert best.limited_by == limit
    report = check(rig, best.reference, begin=begin)
    assert report.feasible, report.problems
    early = check(rig, stopped(path, at, 0.95 * best.duration), begin=begin)
    assert any(limit in problem for problem in early.problems)


def test_navy_crane_stops_in_four_seconds():
    rig = models.navy_crane_3d()
    path = from_move(models.default_move(rig))
    at = path.duration / 2
    begin = solve(rig, path, at).at(at)
    assert check(rig, stopped(path, at, 4.1), 50.0, begin=begin).feasible
    assert not check(rig, stopped(path, at, 3.9), 50.0, begin=begin).feasible


def test_distances_are_those_of_the_way_that_is_left():
    rig = models.overhead_crane()
    path = rest_to_rest((0, -4), (5, -1), 3.0)
    begin = solve(rig, path, 1.5).at(1.5)
    ball = Sphere("ball", (5.0, 0.0, -1.0), 0.1)
    stop = stopped(path, 1.5, 1.0)
    gap = clearance(rig, stop, [ball], ropes=False, begin=begin).distance
    assert_allclose(gap, math.dist(stop.goal, (5, -1)) - 0.1, rtol=1e-9)


def test_what_moves_is_refused_without_what_it_continues():
    rig = models.overhead_crane()
    path = rest_to_rest((0, -4), (5, -1), 3.0)
    stop = stopped(path, 1.5, 1.0)
    for wrong in (lambda: solve(rig, stop, 0.0), lambda: shortest_duration(rig, stop)):
        with pytest.raises(PathError, match=r"starts moving, derivative 1 of load.x .*begin="):
            wrong()


@pytest.mark.parametrize(
    ("wrong", "line"),
    [
        (lambda: connected(START, (1, 2), 1.0, 7), "7 derivatives are given, order 7 needs 8"),
        (lambda: connected(START, (1, 2, 3), 1.0), "2 columns and goal 3 coordinates"),
        (lambda: connected([[math.nan, 0]], (1, 2), 1.0), "finite numbers of shape"),
        (lambda: connected(START, (1, 2), 0.0), "duration is 0 s"),
        (lambda: connected(START, (1, 2), 1.0, -1), "order is -1"),
        (lambda: stopped(PATH, math.inf, 1.0), "at is inf, it must be a finite"),
        (lambda: stopped(PATH, 1.0, -1.0), "duration is -1 s"),
        (lambda: stopped(PATH, 1.0, 1.0, 0), "order is 0, it must be a whole number from 1"),
    ],
)
def test_wrong_numbers_are_refused(wrong, line):
    with pytest.raises(PathError, match=line):
        wrong()
