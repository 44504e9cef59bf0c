"""Exact feedforward against closed forms, and what it refuses."""

import dataclasses

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from flatrig import feedforward, models
from flatrig.feedforward import analyse, residuals, rest_to_rest, solve, three_phase
from flatrig.models import PathError, RigError, SmoothnessError

G = 9.81
OVERHEAD = rest_to_rest((0, -4), (5, -1), duration=3.0, order=4)
ROTARY = three_phase((5, 0, -5), (-2, 2, -2), duration=20.0, blend=5.0)


def close(actual, desired):
    """Equal to 1e-10 of the quantity's size along the path."""
    assert_allclose(actual, desired, rtol=0, atol=1e-10 * np.abs(desired).max())


def foot(x, z):
    """x - z x'' / (z'' + g), where the rope meets the rail, with two derivatives.

    The arguments hold a path and its four derivatives, shape (5, N).
    """
    n0, n1, n2 = x[2], x[3], x[4]
    d0, d1, d2 = z[2] + G, z[3], z[4]
    q0 = n0 / d0
    q1 = (n1 - q0 * d1) / d0
    q2 = (n2 - 2 * q1 * d1 - q0 * d2) / d0
    return np.array(
        [
            x[0] - z[0] * q0,
            x[1] - z[1] * q0 - z[0] * q1,
            x[2] - z[2] * q0 - 2 * z[1] * q1 - z[0] * q2,
        ]
    )


def rope(*chords):
    """Length of a rope along chords, each with two derivatives (3, N), likewise."""
    length = np.sqrt(sum(c[0] ** 2 for c in chords))
    rate = sum(c[0] * c[1] for c in chords) / length
    second = (sum(c[1] ** 2 + c[0] * c[2] for c in chords) - rate**2) / length
    return np.array([length, rate, second])


def test_overhead_crane_is_its_closed_form():
    times = np.linspace(-0.5, 3.5, 4001)
    motion = solve(models.overhead_crane(), OVERHEAD, times)
    x, z = OVERHEAD.derivatives(times, 4).transpose(2, 0, 1)
    s = foot(x, z)
    length = rope(x[:3] - s, z[:3])
    multiplier = -100 * (z[2] + G) / z[0]
    close(motion.positions[:, :2], np.array([s[0], length[0]]).T)
    close(motion.velocities[:, :2], np.array([s[1], length[1]]).T)
    close(motion.accelerations[:, :2], np.array([s[2], length[2]]).T)
    close(motion.inputs[:, 0], 10 * s[2] + 100 * x[2])
    close(motion.inputs[:, 1], 0.1 * (10 * length[2] - multiplier * length[0]))
    close(motion.tensions[:, 0], multiplier * length[0])
    close(motion.multipliers[:, 0], multiplier)


def test_overhead_crane_at_half_time():
    motion = solve(models.overhead_crane(), OVERHEAD, 1.5)
    assert_allclose(motion.inputs, [[6.8701, -92.5752]], atol=5e-5)
    assert_allclose(motion.multipliers, [[392.4]], rtol=1e-12)


@pytest.mark.parametrize("build", [models.rotary_crane, models.rotary_crane_small])
def test_rotary_crane_is_its_closed_form(build):
    rig = build()
    m, m_t, bridge = rig.loads[0].mass, rig.trolleys[0].mass, rig.frames[0].inertia
    winch = rig.ropes[0].inertia_along
    times = np.linspace(0, 20, 2001)
    motion = solve(rig, ROTARY, times)
    x, y, z = ROTARY.derivatives(times, 4).transpose(2, 0, 1)
    px, py = foot(x, z), foot(y, z)
    s = rope(px, py)
    phi = np.unwrap(np.arctan2(py[0], px[0]))
    phi1 = (px[0] * py[1] - py[0] * px[1]) / s[0] ** 2
    phi2 = (px[0] * py[2] - py[0] * px[2] - 2 * s[0] * s[1] * phi1) / s[0] ** 2
    length = rope(x[:3] - px, y[:3] - py, z[:3])
    force = -m * (z[2] + G) / z[0]
    close(motion.positions[:, :3], np.array([phi, s[0], length[0]]).T)
    close(motion.velocities[:, :3], np.array([phi1, s[1], length[1]]).T)
    close(motion.accelerations[:, :3], np.array([phi2, s[2], length[2]]).T)
    across = x[0] * np.sin(phi) - y[0] * np.cos(phi)
    along = s[0] - x[0] * np.cos(phi) - y[0] * np.sin(phi)
    torque = (bridge + m_t * s[0] ** 2) * phi2 + 2 * m_t * s[0] * s[1] * phi1
    close(motion.inputs[:, 0], torque + force * across * s[0])  # (5.73), (5.137)
    close(motion.inputs[:, 1], m_t * (s[2] - s[0] * phi1**2) + force * along)
    close(motion.inputs[:, 2], 0.1 * (winch * length[2] - force * length[0]))


def test_roped_crane_moves_as_the_overhead_crane_and_both_ropes_pull():
    times = np.linspace(0, 3, 501)
    plain = solve(models.overhead_crane(), OVERHEAD, times)
    roped = solve(models.roped_overhead_crane(), OVERHEAD, times)
    hoist, s = plain.rope_lengths[:, 0], plain.positions[:, 0]
    close(roped.positions[:, 0], s)
    close(roped.rope_lengths, np.array([s + 2, hoist + 8 - s]).T)
    close(roped.tensions[:, 1], plain.tensions[:, 0])
    # The ropes' difference accelerates the trolley: m_t s'' = T2 - T1 + T2 (x - s) / l.
    swing = (plain.outputs[:, 0] - s) / hoist
    pull = roped.tensions[:, 1] * (1 + swing) - 10 * plain.accelerations[:, 0]
    close(roped.tensions[:, 0], pull)
    for column, inertia in ((0, 10.0), (1, 10.0)):
        speedup = roped.accelerations[:, roped.column(["pull.length", "hoist.length"][column])]
        close(roped.inputs[:, column], 0.1 * (inertia * speedup - roped.tensions[:, column]))


@pytest.mark.parametrize("name", list(models.CATALOGUE))
def test_every_equation_is_satisfied_to_rounding(name):
    reference = feedforward.from_move(models.default_move(name))
    times = np.linspace(0, reference.duration, 1001)
    motion = solve(models.make(name), reference, times)
    assert residuals(motion, reference).max() < 1e-9
    wrong = dataclasses.replace(motion, inputs=motion.inputs * 1.001)
    assert residuals(wrong, reference).max() > 1e-5  # the check can fail


@pytest.mark.parametrize("name", list(models.CATALOGUE))
def test_structure(name):
    """The Navy crane in space needs six derivatives (K theorem 3), as does a double pendulum."""
    analysis = analyse(models.make(name))
    six = "navy_crane_3d", "navy_ship_crane", "double_pendulum_crane"
    expected = (7, 6) if name in six else (5, 4)
    expected = (3, 2) if name == "cable_robot" else expected  # its ropes hold every freedom
    assert (analysis.index, analysis.reference_order) == expected
    assert analysis.flat
    assert analysis.degrees_of_freedom == 0


@pytest.mark.parametrize("name", models.CATALOGUE)
def test_the_way_back_takes_the_same_inputs(name):
    """Without friction time has no direction, however the ropes grow and shrink on the way."""
    rig, move = models.make(name), models.default_move(name)
    sea = [
        dataclasses.replace(w, phase=np.pi - w.phase - 2.0 * np.pi * move.duration / w.period)
        for w in move.waves
    ]
    back = dataclasses.replace(move, start=move.goal, goal=move.start, waves=sea)
    times = np.linspace(0, move.duration, 101)
    there, home = (solve(rig, feedforward.from_move(m), times) for m in (move, back))
    close(home.inputs, there.inputs[::-1])
    close(home.tensions, there.tensions[::-1])


def test_samples_do_not_depend_on_each_other():
    rig = models.rotary_crane()
    times = np.array([13.0, 2.0, 19.5, 2.0, 0.0])
    together = solve(rig, ROTARY, times)
    for i, time in enumerate(times):
        alone = solve(rig, ROTARY, [time])
        assert_allclose(together.inputs[i], alone.inputs[0], rtol=1e-12, atol=1e-10)
        assert_allclose(together.positions[i], alone.positions[0], rtol=1e-12, atol=1e-13)


def test_the_bridge_turns_on_past_half_a_turn():
    """Three quarters of a circle: the angle must not jump at pi."""
    times = np.linspace(0, 30, 60)
    angle = rest_to_rest([0.0], [1.5 * np.pi], 30.0)(times)[:, 0]
    points = np.array([4 * np.cos(angle), 4 * np.sin(angle), np.full(60, -3.0)]).T
    reference = feedforward.sampled(times, points)
    at = np.linspace(0, 30, 301)
    motion = solve(models.rotary_crane(), reference, at)
    assert motion.positions[-1, 0] == pytest.approx(1.5 * np.pi, abs=1e-9)
    assert np.abs(np.diff(motion.positions[:, 0])).max() < 0.1
    single = solve(models.rotary_crane(), reference, [29.0])
    assert_allclose(single.positions[0, 0], motion.positions[290, 0], rtol=1e-9)


def test_a_start_away_from_home_stays_on_home_s_branch():
    path = rest_to_rest((-3, 1, -2), (-2, 3, -2), duration=15.0)
    motion = solve(models.rotary_crane(), path, np.linspace(0, 15, 51))
    assert (motion.positions[:, motion.column("trolley.position")] > 0).all()
    assert (motion.rope_lengths > 0).all()


@pytest.mark.parametrize("start", [(-5, 0, -5), (-4, 0.3, -2), (-4, -0.3, -2)])
def test_a_start_behind_the_tower_is_reached_around_it(start):
    path = rest_to_rest(start, (-4, 1.8, -2), duration=10.0)
    motion = solve(models.rotary_crane(), path, np.linspace(0, 10, 51))
    assert residuals(motion, path).max() < 1e-9
    assert (motion.positions[:, motion.column("trolley.position")] > 0).all()


def test_many_turns_are_followed():
    """Fifteen turns in 200 s: finer than the first grid along the path."""
    times = np.linspace(0, 200, 1501)
    angle = rest_to_rest([0.0], [30 * np.pi], 200.0, order=6)(times)[:, 0]
    points = np.array([4 * np.cos(angle), 4 * np.sin(angle), np.full(len(times), -3.0)]).T
    reference = feedforward.sampled(times, points)
    motion = solve(models.rotary_crane(), reference, np.linspace(0, 200, 801))
    assert residuals(motion, reference).max() < 1e-9
    assert motion.positions[-1, 0] == pytest.approx(30 * np.pi, abs=1e-6)


def test_times_in_any_order_or_none():
    rig = models.roped_overhead_crane(load_mass=5.0, trolley_mass=50.0)
    path = rest_to_rest((0, -4), (5, -4), duration=4.0)
    times = np.linspace(0, 4, 401)
    forward, backward = solve(rig, path, times), solve(rig, path, times[::-1])
    assert forward.slack == backward.slack
    assert solve(rig, path, []).inputs.shape == (0, 2)
    assert residuals(solve(rig, path, []), path).shape == (0, 11)


def test_at_rest_outside_the_path():
    rig = models.overhead_crane()
    motion = solve(rig, OVERHEAD, [-1.0, 10.0])
    assert_allclose(motion.inputs, [[0, -98.1], [0, -98.1]], rtol=1e-14, atol=1e-12)
    assert_array_equal(motion.velocities, 0)


def test_slack_is_named_with_its_interval():
    """A light load's rope cannot accelerate a heavy trolley: the other would have to push."""
    path = rest_to_rest((0, -4), (5, -4), duration=4.0)
    rig = models.roped_overhead_crane(load_mass=5.0, trolley_mass=50.0)
    motion = solve(rig, path, np.linspace(0, 4, 4001))
    tension = motion.tensions[:, 0]
    inside = np.zeros(len(tension), bool)
    for slack in motion.slack:
        assert slack.rope == "pull"
        inside |= (motion.times > slack.start) & (motion.times < slack.end)
    assert (tension[inside] <= 0).all()
    assert (tension[~inside] > 0).all()
    assert min(slack.lowest for slack in motion.slack) == tension.min() < 0
    assert "rope pull would have to push from" in str(motion.slack[0])


def test_refuses_a_reference_that_is_not_smooth_enough():
    with pytest.raises(SmoothnessError, match=r"has 2 continuous derivatives.*needs 4"):
        solve(models.overhead_crane(), rest_to_rest((0, -4), (5, -1), 3.0, order=2), [0.0])


def test_refuses_a_path_through_the_rail_with_time_and_place():
    path = rest_to_rest((0, -4), (5, 1), duration=10.0)
    crossing = r"cannot follow the path at t = 6\.\d+ s \(load.x = .*, load.z = .*\)"
    with pytest.raises(PathError, match=crossing):
        solve(models.overhead_crane(), path, np.linspace(0, 10, 1001))
    with pytest.raises(PathError, match="cannot follow"):
        solve(models.overhead_crane(), path, [9.0])  # alone, beyond the rail


@pytest.mark.parametrize("thing", ["overhead_crane", None, models.overhead_crane])
def test_what_is_no_rig_is_refused_in_one_line(thing):
    with pytest.raises(RigError, match=r"it must be a Rig; models.make\(name\) makes one"):
        solve(thing, OVERHEAD, 0.0)


def test_a_move_beyond_the_boom_names_the_rail():
    with pytest.raises(PathError, match=r"trolley is at 7\.\d+ m, rail beam goes from"):
        solve(models.gantry_crane(), rest_to_rest((5, 0, -5), (9, 0, -5), 20), 0.0)


def test_refuses_free_fall():
    path = rest_to_rest((0, -1), (0, -9), duration=1.5)
    with pytest.raises(PathError, match=r"cannot follow the path at t = 0\.\d+ s"):
        solve(models.overhead_crane(), path, np.linspace(0, 1.5, 301))


def test_refuses_a_rope_whose_winch_would_have_to_be_infinitely_far_away():
    """The load falls sideways: nothing but a horizontal rope of endless length does not lift it."""
    rig = models.overhead_crane()
    endless = dataclasses.replace(rig.rails[0], start=-1e9, end=1e9)
    rig = dataclasses.replace(rig, rails=(endless,))
    with pytest.raises(PathError, match="rope hoist would grow beyond all bounds"):
        solve(rig, rest_to_rest((0, -4), (5, -1), duration=0.9), [0.0])
    # So fast that the samples show the slack rope and not how far the trolley went before.
    with pytest.raises(PathError, match=r"at t = 0\.050\d+ s .* rope hoist goes slack there"):
        solve(rig, rest_to_rest((0, -4), (5, -1), duration=0.1), [0.0])


def test_refuses_a_trolley_beyond_its_rail():
    path = rest_to_rest((0, -4), (9, -4), duration=10.0)
    with pytest.raises(PathError, match=r"trolley is at 8.* rail beam goes from -2 m to 8 m"):
        solve(models.overhead_crane(), path, np.linspace(0, 10, 1001))


def test_refuses_a_path_through_the_tower():
    path = rest_to_rest((5, 0, -5), (-5, 0, -5), duration=20.0)
    with pytest.raises(PathError, match="cannot follow"):
        solve(models.rotary_crane(), path, np.linspace(0, 20, 2001))


def test_refuses_the_wrong_number_of_columns_and_bad_times():
    with pytest.raises(PathError, match=r"the reference is a Move, .*from_move makes one"):
        solve(models.overhead_crane(), models.default_move("overhead"), [0.0])
    with pytest.raises(PathError, match=r"has 3 columns.*needs 2: load.x, load.z"):
        solve(models.overhead_crane(), ROTARY, [0.0])
    for times, message in [
        ([0.0, np.nan], r"times\[1\] is NaN"),
        ([0.0, np.inf], "time 1 is inf, it must be finite"),
        (["now"], "times"),
        ([[0.0, 1.0]], "shape"),
    ]:
        with pytest.raises(PathError, match=message):
            solve(models.overhead_crane(), OVERHEAD, times)


def test_refuses_outputs_that_contradict_each_other():
    rig = dataclasses.replace(models.overhead_crane(), outputs=("trolley.position", "hoist.length"))
    with pytest.raises(RigError, match="not flat: its outputs leave 2 degrees of freedom"):
        solve(rig, OVERHEAD, [0.0])
    roped = dataclasses.replace(
        models.roped_overhead_crane(), outputs=("trolley.position", "pull.length")
    )
    with pytest.raises(RigError, match=r"structurally singular.*pull.length is one equation too"):
        analyse(roped)
    angle = dataclasses.replace(models.rotary_crane(), outputs=("bridge.angle", "load.x", "load.z"))
    assert analyse(angle).degrees_of_freedom == 2


@pytest.mark.parametrize(
    ("name", "goal", "message"),
    [
        ("gantry_crane", (9, 0, -5), "rope pull would pass through its own winch at outer"),
        ("gantry_crane", (-1, 0, -5), "rope hoist would pass through its own winch at inner"),
        ("cantilever_crane", (9, 0, -5), "rope pull would pass through its own winch at outer"),
    ],
)
def test_refuses_a_rope_that_would_pass_through_its_winch(name, goal, message):
    rig = models.make(name)
    endless = dataclasses.replace(rig.rails[0], start=-50.0, end=50.0)
    rig = dataclasses.replace(rig, rails=(endless,))
    with pytest.raises(PathError, match=f"cannot follow the path at t = .* s .*: {message}"):
        solve(rig, rest_to_rest((5, 0, -5), goal, 20), 0.0)


def test_csv(tmp_path):
    motion = solve(models.overhead_crane(), OVERHEAD, np.linspace(0, 3, 11))
    motion.to_csv(tmp_path / "made" / "torques.csv")
    table = np.genfromtxt(
        tmp_path / "made" / "torques.csv", delimiter=",", names=True, deletechars=""
    )
    assert_array_equal(table["time"], motion.times)
    assert_array_equal(table["winch"], motion.inputs[:, 1])
    assert_array_equal(table["hoist.tension"], motion.tensions[:, 0])
    assert_array_equal(table["load.z_ddot"], motion.accelerations[:, 3])
    assert [path.name for path in (tmp_path / "made").iterdir()] == ["torques.csv"]
