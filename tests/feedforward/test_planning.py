"""Curved paths, obstacles, the pulley's height and time scaling, each against a second road."""

from dataclasses import replace

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.feedforward import (
    Box,
    CurvedPath,
    Polynomial,
    RestToRest,
    Sphere,
    ThreePhase,
    Waypoints,
    along,
    beside,
    bisected,
    clearance,
    massless,
    over,
    rest_to_rest,
    scaled,
    shortest_duration,
    three_phase,
)
from flatrig.models import OptionError, PathError, RigError, SmoothnessError

GRAVITY = 9.81
LARGEST_SLOPE_CHANGE = np.abs(RestToRest(4).derivatives(np.linspace(0, 1, 100_001), 2)[2]).max()
"""Of the profile of degree 9: the peak of c''."""


def rates(path, times, order, step=1e-4):
    """Derivative `order` from central differences of the one below."""
    ahead, behind = (path.derivatives(times + h, order - 1)[-1] for h in (step, -step))
    return (ahead - behind) / (2 * step)


# Curves


def test_a_parabola_is_the_composed_polynomial_with_all_its_derivatives():
    path = over((0, 0, -5), (4, 2, -3), rise=(0, 0, 2.5), duration=3.0, order=4)
    s = np.polynomial.Polynomial(RestToRest(4).coefficients)(np.polynomial.Polynomial([0, 1 / 3]))
    times = np.linspace(0, 1.5, 41)  # beyond, the sum of powers cancels
    exact = [4 * s, 2 * s, -5 + 2 * s + 10 * s * (1 - s)]
    for k, values in enumerate(path.derivatives(times, 6)):
        expected = np.column_stack([(p.deriv(k) if k else p)(times) for p in exact])
        scale = np.abs(expected).max()
        np.testing.assert_allclose(values, expected, rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(path([1.5])[0], (2, 1, -1.5), atol=1e-14)
    assert path.order == 4


def test_without_a_rise_it_is_the_straight_path():
    times = np.linspace(-1, 5, 61)
    curved = over((0, -4), (5, -1), (0, 0), 4.0, order=6).derivatives(times, 8)
    straight = rest_to_rest((0, -4), (5, -1), 4.0, order=6).derivatives(times, 8)
    for k in range(9):
        np.testing.assert_allclose(
            curved[k], straight[k], rtol=0, atol=1e-12 * np.abs(straight[k]).max()
        )


@pytest.mark.parametrize("count", [2, 4, 12])
def test_a_curve_passes_its_waypoints_and_is_as_smooth_as_it_says(count):
    angles = np.linspace(0, 2, count)
    points = np.column_stack((np.cos(angles), np.sin(angles), 0.3 * angles))
    path = along(points, duration=4.0, order=4)
    assert path.order == 4
    curve = Waypoints(tuple(map(tuple, points)), 4)
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    places = np.concatenate(([0], np.cumsum(chords) / chords.sum()))
    np.testing.assert_allclose(curve.derivatives(places, 0)[0], points, atol=1e-12)
    assert curve.order >= 4
    times = np.linspace(0.05, 3.95, 300)
    for k in (1, 2, 3, 4):
        exact = path.derivatives(times, k)[k]
        np.testing.assert_allclose(rates(path, times, k), exact, atol=2e-5 * np.abs(exact).max())
    np.testing.assert_allclose(path.derivatives([0, 4], 4)[1:], 0, atol=1e-11)
    np.testing.assert_allclose(path([-1, 0, 4, 9]), [points[0]] * 2 + [points[-1]] * 2, atol=1e-12)


def test_a_curve_may_be_rougher_than_its_profile():
    points = tuple((float(x), float(x**2 % 3)) for x in range(9))
    assert CurvedPath(Waypoints(points, 2), 3.0, RestToRest(6)).order == 2
    assert CurvedPath(Polynomial(points), 3.0, ThreePhase(0.25, 5)).order == 5


def test_the_rotary_crane_follows_a_curve():
    rig = models.rotary_crane()
    path = along([(5, 0, -5), (3, 3, -4), (-2, 2, -2)], duration=20.0)
    motion = feedforward.solve(rig, path, np.linspace(0, 20, 201))
    assert feedforward.residuals(motion, path).max() < 1e-9


def test_paths_side_by_side():
    load = rest_to_rest((0, -4), (5, -1), 3.0, order=6)
    height = three_phase([2.0], [1.0], 4.0, 1.0)
    both = beside(load, height)
    assert (both.order, both.duration, both.size) == (4, 4.0, 3)
    np.testing.assert_array_equal(both.goal, (5, -1, 1))
    times = np.linspace(-1, 5, 50)
    np.testing.assert_array_equal(both.derivatives(times, 4)[..., :2], load.derivatives(times, 4))
    np.testing.assert_array_equal(both.derivatives(times, 4)[..., 2:], height.derivatives(times, 4))
    assert hash(both) == hash(beside(load, height))


WRONG_PATHS = {
    "lengths differ": (lambda: over((0, -4), (5, -1), (0, 0, 1), 3.0), "rise 3"),
    "one waypoint": (lambda: along([(0, -4)], 3.0), "2 or more"),
    "twice the same": (lambda: along([(0, -4), (0, -4), (1, 1)], 3.0), "waypoints 0 and 1"),
    "ragged": (lambda: along([(0, -4), (1, 2, 3)], 3.0), "waypoint 1 has 3"),
    "not rows": (lambda: along(3.0, 3.0), "rows of numbers"),
    "not finite": (lambda: along([(0, -4), (np.nan, 1)], 3.0), "waypoint 1"),
    "no time": (lambda: over((0, -4), (5, -1), (0, 1), 0.0), "duration is 0 s"),
    "nothing beside": (lambda: beside(), "no path"),
    "radius": (lambda: Sphere("tank", (0, 0, 0), -1.0), "radius of tank is -1.0"),
    "centre": (lambda: Sphere("tank", (0, 0), 1.0), "centre of tank"),
    "box": (lambda: Box("hall", (0, 0, 0), (1, -1, 1)), "low of hall"),
}


@pytest.mark.parametrize("case", WRONG_PATHS)
def test_what_is_no_path_is_refused_in_one_line(case):
    make, expected = WRONG_PATHS[case]
    with pytest.raises(PathError, match=expected) as caught:
        make()
    assert "\n" not in str(caught.value)


# Obstacles


@pytest.mark.parametrize(
    "obstacle", [Sphere("tank", (0.3, -0.2, 0.1), 0.7), Box("hall", (-0.5, -1, 0), (1, 0.2, 0.4))]
)
def test_distances_of_segments_are_those_of_their_nearest_points(obstacle):
    generator = np.random.default_rng(3)
    begin, end = generator.uniform(-2, 2, (2, 200, 3))
    share = np.linspace(0, 1, 2001)[:, None, None]
    sampled = obstacle.distance(begin + share * (end - begin)).min(axis=0)
    found = obstacle.segment_distance(begin, end)
    assert (found <= sampled + 1e-12).all()
    np.testing.assert_allclose(found, sampled, atol=2.5e-3)
    assert (found < 0).sum() > 10
    assert (found > 0).sum() > 10


def test_distances_from_a_box():
    box = Box("hall", (0, 0, 0), (2, 4, 6))
    points = np.array([(-3, 2, 3), (5, 8, 3), (5, 8, 18), (1, 2, 3), (1.5, 2, 3), (2, 1, 1)])
    np.testing.assert_allclose(box.distance(points), (3, 5, 13, -1, -0.5, 0), atol=1e-15)


def test_clearance_of_a_straight_path_and_of_a_resting_rope():
    rig = models.overhead_crane()
    path = rest_to_rest((0, -4), (5, -4), 5.0)
    tank = Sphere("tank", (2.7, 0, -5.5), 0.4)
    nearest = clearance(rig, path, [tank, Sphere("far", (9, 0, -9), 0.1)], load_radius=0.3)
    assert nearest.distance == pytest.approx(1.5 - 0.4 - 0.3, abs=1e-9)
    assert (nearest.part, nearest.obstacle, nearest.clear) == ("load", "tank", True)
    assert path([nearest.time])[0, 0] == pytest.approx(2.7, abs=1e-4)
    resting = feedforward.hold((0, -4))
    post = Box("post", (1, -1, -3), (2, 1, -1))
    assert clearance(rig, resting, [post]).distance == pytest.approx(1.0, abs=1e-12)
    assert clearance(rig, resting, [post]).part == "rope hoist"
    alone = clearance(rig, resting, [post], ropes=False)
    assert alone.distance == pytest.approx(np.sqrt(2), abs=1e-12)


def test_a_parabola_clears_what_the_straight_path_hits():
    rig = models.overhead_crane()
    wall = Box("wall", (2.4, -1, -9), (2.6, 1, -3.6))
    straight = clearance(rig, rest_to_rest((0, -4), (5, -4), 5.0), [wall], load_radius=0.3)
    raised = clearance(rig, over((0, -4), (5, -4), (0, 2), 5.0), [wall], load_radius=0.3)
    # The parabola z = -2 - 2 (1 - 2 sigma)^2 is nearest to one of the wall's upper edges.
    sigma = np.linspace(0, 1, 1_000_001)
    edge = np.hypot(5 * sigma - 2.4, -2 - 2 * (1 - 2 * sigma) ** 2 + 3.6).min()
    assert not straight.clear
    assert "inside wall" in str(straight)
    assert raised.distance == pytest.approx(edge - 0.3, abs=1e-8)


def test_ropes_of_turning_and_moving_parts_are_where_they_are():
    rig = models.navy_crane_3d()
    move = models.default_move(rig)
    path = feedforward.from_move(move)
    motion = feedforward.solve(rig, path, [20.0])
    angle = motion.positions[0, motion.column("boom.angle")]
    middle = 0.5 * (np.array(rig.anchors[1].position) + 0)
    tip = np.array([np.cos(angle) * 2 * middle[0], np.sin(angle) * 2 * middle[0], 2 * middle[2]])
    pulley = motion.positions[0, [motion.column(f"pulley.{axis}") for axis in "xyz"]]
    ball = Sphere("ball", tuple(0.5 * (tip + pulley)), 0.05)
    found = clearance(rig, feedforward.hold(move.goal), [ball])
    assert found.part == "rope hoist"
    assert found.distance == pytest.approx(-0.05, abs=1e-6)


def test_clearance_needs_an_obstacle_and_a_radius():
    rig, path = models.overhead_crane(), rest_to_rest((0, -4), (5, -4), 5.0)
    with pytest.raises(PathError, match="no obstacle"):
        clearance(rig, path, [])
    with pytest.raises(PathError, match="load_radius is -1"):
        clearance(rig, path, [Sphere("tank", (0, 0, 0), 1.0)], load_radius=-1)


# The pulley's height


def test_in_a_plane_the_tagline_bisects_the_angle_of_the_hoist_rope():
    rig = models.navy_crane_2d()
    x, _, z = rig.home_point("P")
    path = bisected(rig, rest_to_rest((x - 2, z - 15), (x - 5, z - 12), 5.0, order=6))
    motion = feedforward.solve(rig, path, np.linspace(0, 5, 101))
    columns = {n: [motion.column(f"{n}.{a}") for a in "xz"] for n in ("pulley", "load")}
    pulley, load = (motion.positions[:, columns[name]] for name in ("pulley", "load"))
    to = {n: np.array(rig.home_point(n))[[0, 2]] - pulley for n in "AP"} | {"C": load - pulley}
    unit = {n: v / np.linalg.norm(v, axis=1)[:, None] for n, v in to.items()}
    middle = unit["P"] + unit["C"]
    cross = middle[:, 0] * unit["A"][:, 1] - middle[:, 1] * unit["A"][:, 0]
    assert np.abs(cross).max() < 1e-9
    assert np.abs(middle).max() > 0.1
    assert feedforward.residuals(motion, path).max() < 1e-9


def test_the_height_in_space_is_the_massless_crane_s_with_exact_derivatives():
    rig = models.navy_crane_3d()
    load = rest_to_rest((8, 0, -15), (-2, 4 * np.sqrt(3), -13), 20.0, order=8)
    path = bisected(rig, load)
    assert (path.order, path.size) == (6, 4)
    times = np.linspace(2, 18, 33)
    light = feedforward.solve(massless(rig), load, times)
    height = light.positions[:, light.column("pulley.z")]
    speed = light.velocities[:, light.column("pulley.z")]
    exact = path.derivatives(times, 6)
    np.testing.assert_allclose(exact[0, :, 3], height, atol=1e-12)
    np.testing.assert_allclose(exact[1, :, 3], speed, atol=1e-11)
    np.testing.assert_array_equal(exact[..., :3], load.derivatives(times, 6))
    for k in range(1, 7):
        np.testing.assert_allclose(
            rates(path, times, k, 1e-3), exact[k], atol=1e-4 * np.abs(exact[k]).max()
        )
    np.testing.assert_array_equal(path.derivatives([-1, 30], 6)[1:], 0)


def test_with_the_bisector_law_the_printed_move_in_space_is_feasible():
    rig = models.navy_crane_3d()
    move = models.PRINTED_MOVES["navy_crane_3d"]
    path = bisected(rig, rest_to_rest(move.start[:3], move.goal[:3], 20.0, order=8))
    np.testing.assert_allclose(path.start, move.start, atol=1e-6)
    assert feedforward.check(rig, path, rate=50.0).problems == ()


def test_what_has_no_such_pulley_is_refused():
    rig, load = models.navy_crane_2d(), rest_to_rest((-6, -20), (-8, -18), 5.0, order=6)
    with pytest.raises(RigError, match=r"no rope .suspenders..*did you mean suspension"):
        bisected(rig, load, rope="suspenders")
    with pytest.raises(RigError, match="no pulley 'pulley'"):
        bisected(models.overhead_crane(), load)
    with pytest.raises(PathError, match="has 3 columns, it needs 2"):
        bisected(rig, rest_to_rest((0, 0, 0), (1, 1, 1), 5.0))
    with pytest.raises(RigError, match="0 outputs of pulley"):
        bisected(replace(rig, outputs=("load.x", "load.z", "tagline.length")), load)
    with pytest.raises(RigError, match="2 outputs of pulley"):
        bisected(replace(rig, outputs=("load.x", "pulley.x", "pulley.z")), load)


# Time scaling


def test_a_scaled_path_is_the_path_in_another_time():
    slow = rest_to_rest((0, -4), (5, -1), 7.3, order=4)
    times = np.linspace(-1, 5, 101)
    for k, values in enumerate(scaled(slow, 3.0).derivatives(times, 6)):
        expected = rest_to_rest((0, -4), (5, -1), 3.0, order=4).derivatives(times, k)[k]
        np.testing.assert_allclose(values, expected, atol=1e-10 * np.abs(expected).max())
    np.testing.assert_array_equal(scaled(slow, 3.0)([3.0])[0], slow.goal)


def test_the_shortest_lift_is_limited_by_the_winch():
    rig = models.overhead_crane()
    path = rest_to_rest((0, -6), (0, -2), 9.0)
    mass, radius, limit = 100.0, 0.1, rig.drives[1].limit
    inertia = rig.ropes[0].inertia_along
    best = shortest_duration(rig, path, share=0.8)
    acceleration = (0.8 * limit / radius - mass * GRAVITY) / (mass + inertia)
    expected = np.sqrt(4 * LARGEST_SLOPE_CHANGE / acceleration)
    assert best.duration == pytest.approx(expected, rel=3e-4)
    assert best.limited_by == "drive winch"
    assert best.reference.duration == best.duration


def test_the_shortest_descent_is_limited_by_the_rope():
    rig = models.overhead_crane()
    best = shortest_duration(rig, rest_to_rest((0, -2), (0, -6), 0.5), margin=600.0)
    expected = np.sqrt(4 * LARGEST_SLOPE_CHANGE / (GRAVITY - 6.0))
    assert best.duration == pytest.approx(expected, rel=3e-4)
    assert best.limited_by == "rope hoist"
    motion = feedforward.solve(rig, best.reference, np.linspace(0, best.duration, 5001))
    assert motion.tensions.min() == pytest.approx(600.0, abs=0.5)


def test_the_shortest_duration_agrees_with_a_scan():
    rig = models.overhead_crane()
    path = rest_to_rest((0, -4), (5, -1), 3.0)
    best = shortest_duration(rig, path)
    durations = np.linspace(0.91, 1.51, 25) * best.duration
    feasible = [feedforward.check(rig, scaled(path, T)).feasible for T in durations]
    assert feasible == [bool(best.duration <= T) for T in durations]


def test_a_family_of_paths_may_be_given_instead_of_one():
    rig = models.overhead_crane()
    path = rest_to_rest((0, -4), (5, -1), 3.0)
    one = shortest_duration(rig, path)
    other = shortest_duration(rig, lambda T: rest_to_rest((0, -4), (5, -1), T))
    assert other.duration == pytest.approx(one.duration, rel=2e-4)
    assert other.limited_by == one.limited_by


def test_a_move_that_no_time_makes_possible_is_refused():
    rig = models.navy_crane_2d()
    path = feedforward.from_move(models.PRINTED_MOVES["navy_crane_2d"])
    with pytest.raises(PathError, match=r"even in .* the tension of rope tagline is -231"):
        shortest_duration(rig, path)
    crane, rough = models.overhead_crane(), rest_to_rest((0, -4), (5, -1), 3.0, order=2)
    with pytest.raises(SmoothnessError, match="needs 4"):
        shortest_duration(crane, rough)
    with pytest.raises(PathError, match=r"even in .* cannot follow the path"):
        shortest_duration(crane, rest_to_rest((0, -4), (5, 1), 3.0))
    with pytest.raises(OptionError, match=r"share is 1\.5"):
        shortest_duration(crane, rough, share=1.5)
    with pytest.raises(OptionError, match="margin is nan"):
        shortest_duration(crane, rough, margin=np.nan)
