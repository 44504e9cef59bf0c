"""Platforms, combined and angular outputs, several falls, and pulleys without mass.

Numbers: Y 6.3.7 (CABLEV: a third of the weight in each rope), Y 6.1.1 (pulley without mass: T1 down
to -442 N in 3 s, end at -64.733 N m; the tagline halves the angle of the hoist rope).
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from flatrig import models
from flatrig.feedforward import analyse, equations_of, from_move, residuals, rest_to_rest, solve
from flatrig.feedforward.paths.turning import fixed_axis
from flatrig.feedforward.series.rotation import bryant, matrix
from flatrig.models import PathError, RigError
from flatrig.models.rig.manipulators import MANIPULATOR_MOVES


def test_rotation_series_against_scipy_and_back():
    angles = 0.4 * np.random.default_rng(0).normal(size=(7, 5, 3))
    rotation = matrix(angles)
    assert_allclose(bryant(rotation), angles, rtol=0, atol=1e-13)
    powers = 0.01 ** np.arange(7)
    expected = Rotation.from_euler("XYZ", np.tensordot(powers, angles, 1)).as_matrix()
    assert_allclose(np.tensordot(powers, rotation, 1), expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("name", list(MANIPULATOR_MOVES))
def test_cable_manipulator_follows_its_moves(name):
    rig, path = models.cable_manipulator(), from_move(MANIPULATOR_MOVES[name])
    analysis = analyse(rig)
    assert (analysis.index, analysis.reference_order, analysis.degrees_of_freedom) == (5, 4, 0)
    motion = solve(rig, path, np.linspace(0, 20, 401))
    assert residuals(motion, path).max() < 1e-9
    assert_allclose(motion.outputs, path(motion.times), rtol=0, atol=1e-12)
    assert_allclose(motion.tensions[0], 12.5 * 9.81 / 3)
    assert motion.tensions.min() > 20.0


def test_a_turn_about_a_fixed_axis_is_one():
    path = from_move(MANIPULATOR_MOVES["line and turn"])
    times = np.linspace(0, 20, 41)
    turned = Rotation.from_euler("XYZ", path(times)[:, 3:6]).as_rotvec()
    goal = Rotation.from_euler("XYZ", [-np.pi / 6, -np.pi / 4, np.pi / 3]).as_rotvec()
    assert_allclose(np.cross(turned, goal), 0, atol=1e-14)
    share = path(times)[:, 1] - 1.2
    assert_allclose(turned, np.outer(share / 3.8, goal), atol=1e-12)
    # Derivatives against central differences, away from where the profile's pieces join.
    step, times = 1e-3, np.linspace(0.3, 19.6, 31)
    derivatives = path.derivatives(times, 5)
    ahead, behind = (path.derivatives(times + side, 4) for side in (step, -step))
    assert_allclose(derivatives[1:5], ((ahead - behind) / (2 * step))[:4], atol=2e-6)


def test_a_turn_through_the_singular_place_of_its_angles_is_refused():
    path = rest_to_rest((0, 0, 0), (0, np.pi / 2, 0), 5.0)
    with pytest.raises(PathError, match="at t = 5 s the platform's beta is 90 degrees, where its"):
        fixed_axis(path, (0, 1, 2))
    # At no round fraction of the duration.
    through = rest_to_rest((0, -1.9, 0), (0, -1.1, 0), 5.0)
    share = (1.9 - np.pi / 2) / 0.8
    time = brentq(lambda t: through([t])[0, 1] + 1.9 - 0.8 * share, 0.0, 5.0)
    with pytest.raises(PathError, match=f"at t = {time:.4g} s the platform's beta is -90 degrees"):
        fixed_axis(through, (0, 1, 2))
    with pytest.raises(PathError, match=r"columns are \(0, 1, 3\), they must be three of 0 to 2"):
        fixed_axis(path, (0, 1, 3))


@pytest.mark.parametrize(
    ("start", "goal"),
    [
        ((2.25, 2.18, 1.96), (2.25, -0.17, -1.12)),  # past half a turn, lying on its back
        ((2.5, 0.3, -2.9), (-2.6, -0.2, 2.8)),
        ((np.pi, 0.2, 0.0), (np.pi, -0.9, 0.0)),  # upside down, where alpha stays half a turn
        ((0.0, 2.0, 0.0), (0.0, 3.0, 2 * np.pi)),
        ((0.3, -0.2, 7.0), (1.0, 0.4, 6.0)),
    ],
)
def test_angles_of_a_turn_start_as_they_are_given_and_do_not_jump(start, goal):
    path = fixed_axis(rest_to_rest(start, goal, 5.0), (0, 1, 2))
    times = np.linspace(0, 5, 2001)
    values, rates = path.derivatives(times, 1)
    assert_allclose(values[0], start, atol=1e-14)
    assert np.abs(np.diff(values, axis=0)).max() < 0.1
    assert_allclose(np.gradient(values, times, axis=0)[2:-2], rates[2:-2], atol=1e-3)
    given = Rotation.from_euler("XYZ", [start, goal])
    whole = (given[0].inv() * given[1]).as_rotvec()
    share = rest_to_rest((0,), (1,), 5.0)(times)
    turned = given[0] * Rotation.from_rotvec(whole * share)
    assert_allclose(Rotation.from_euler("XYZ", values).as_matrix(), turned.as_matrix(), atol=1e-14)


def test_a_platform_may_start_whole_turns_away():
    rig, move = models.cable_manipulator(), MANIPULATOR_MOVES["turn"]
    turns = np.array([0, 0, 0, 1, -2, 3, 0]) * 2 * np.pi
    plain = rest_to_rest(move.start, move.goal, 10.0)
    wound = rest_to_rest(move.start + turns, move.goal + turns, 10.0)
    times = np.linspace(0, 10, 21)
    assert_allclose(solve(rig, wound, times).inputs, solve(rig, plain, times).inputs, atol=1e-9)


@pytest.mark.parametrize("columns", [(5, 4, 3), (0, 1, 2), (3, 4, 6)])
def test_only_a_platforms_angles_turn_about_a_fixed_axis(columns):
    rig = models.cable_manipulator()
    path = from_move(replace(MANIPULATOR_MOVES["line and turn"], turning=columns))
    with pytest.raises(PathError, match="must be the angles alpha, beta and gamma of a platform"):
        solve(rig, path, 0.0)


def test_angles_of_a_platform_are_prescribed_together():
    rig = models.cable_manipulator()
    outputs = tuple(name for name in rig.outputs if name != "platform.beta")
    with pytest.raises(RigError, match="prescribe all three angles or none"):
        analyse(replace(rig, outputs=outputs, drives=rig.drives[:-1]))


def test_four_falls_carry_a_quarter_each():
    """The rope pays out four metres for one of the load, and the winch holds a quarter of it."""
    single = models.overhead_crane()
    (rope,) = single.ropes
    fourfold = replace(
        single, ropes=(replace(rope, falls=4, winch_inertia=rope.winch_inertia / 16),)
    )
    path = from_move(models.default_move("overhead_crane"))
    times = np.linspace(0, 3, 101)
    one, four = solve(single, path, times), solve(fourfold, path, times)
    assert_allclose(four.rope_lengths, 4.0 * one.rope_lengths)
    assert_allclose(four.tensions, one.tensions / 4.0)
    assert_allclose(four.inputs[:, 1], one.inputs[:, 1] / 4.0)
    assert_allclose(four.inputs[:, 0], one.inputs[:, 0], atol=1e-9)
    assert residuals(four, path).max() < 1e-9


def test_falls_are_a_whole_number():
    (rope,) = models.overhead_crane().ropes
    assert replace(rope, falls=4.0).falls == 4
    with pytest.raises(RigError, match=r"falls is 2\.5, it must be a whole number"):
        replace(rope, falls=2.5)
    with pytest.raises(RigError, match="falls is 0, it must be >= 1"):
        replace(models.overhead_crane(), ropes=(replace(rope, falls=0),))


@pytest.mark.parametrize("duration", [5.0, 3.0])
def test_pulley_without_mass_from_its_singular_start(duration):
    rig = models.navy_crane_2d(pulley_mass=0.0)
    path = rest_to_rest((0, -15), (-5, -12), duration)
    times = np.linspace(0, duration, 2001)
    motion = solve(rig, path, times)
    assert residuals(motion, path).max() < 1e-9
    assert_allclose(motion.inputs[0], [0, -98.1], atol=1e-9)
    assert_allclose(motion.inputs[-1], [-64.733, -98.1], atol=5e-4)
    lowest = motion.tensions[:, 0].min()
    if duration == 3.0:
        assert lowest == pytest.approx(-442, abs=0.5)
        assert times[motion.tensions[:, 0].argmin()] == pytest.approx(2.0, abs=0.05)
    else:
        assert lowest > -1e-9
    pulley, load = (
        motion.positions[:, [motion.column(f"{name}.{axis}") for axis in "xz"]]
        for name in ("pulley", "load")
    )
    assert_allclose(pulley[0], [0, -5], atol=1e-6)
    # Away from the places without tension AB halves the angle CBP (K, before remark 19).
    taut = motion.tensions[:, 0] > 1.0
    unit = [
        (end - pulley)[taut] / np.linalg.norm((end - pulley)[taut], axis=1, keepdims=True)
        for end in ((-5 * np.sqrt(3), -5.0), (0.0, 0.0), load)
    ]
    assert_allclose((unit[0] * unit[1]).sum(1), (unit[0] * unit[2]).sum(1), atol=1e-9)


def test_the_singular_start_does_not_depend_on_where_home_has_the_pulley():
    rig = models.navy_crane_2d(pulley_mass=0.0)
    lower = replace(rig, home={"pulley": (0, 0, -7.0), "load": (0, 0, -15.0)})
    path = rest_to_rest((0, -15), (-5, -12), 5.0)
    starts = [solve(one, path, [0.0, 1.0]).positions for one in (rig, lower)]
    assert_allclose(*starts, atol=1e-6)


def test_massless_crane_in_space_from_its_singular_start():
    rig = models.navy_crane_3d(pulley_mass=0.0)
    path = from_move(models.default_move(rig))
    motion = solve(rig, path, np.linspace(0, 20, 401))
    assert residuals(motion, path).max() < 1e-9
    assert not motion.slack
    assert_allclose(motion.inputs[0], [0, -98.1, 0], atol=1e-9)
    assert motion.positions[0, motion.column("pulley.z")] == pytest.approx(2.5, abs=1e-5)


def test_a_pulley_without_mass_that_hangs_straight_all_along_is_refused():
    rig = models.navy_crane_2d(pulley_mass=0.0)
    with pytest.raises(PathError, match="nothing determines its place; move sideways"):
        solve(rig, rest_to_rest((0, -15), (0, -10), 8.0), 0.0)


def test_equations_know_the_platforms_inertia():
    """1/2 q'Mq' of a platform that turns is 1/2 omega J omega."""
    rig = models.cable_manipulator(platform_inertia_x=0.9, platform_inertia_y=0.7)
    made = equations_of(rig)
    (orientation,) = made.orientations
    omega = np.array([0.3, -0.2, 0.5])  # in the platform's own axes, while it is upright
    rate = np.zeros(len(made.names))
    rate[list(orientation.directors)] = np.cross(omega, np.eye(3)).ravel()
    assert rate @ made.mass @ rate == pytest.approx(omega @ np.diag([0.9, 0.7, 1.5]) @ omega)
