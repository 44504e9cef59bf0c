"""Limits of drives and ends of ropes: check, sizing, durations, programs, streams, environments."""

from dataclasses import replace
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from scipy.optimize import brentq

from flatrig import envs, feedforward, models
from flatrig.models.errors import OptionError, PathError
from flatrig.models.friction import Friction

CRANE = models.overhead_crane()
ASIDE = models.Move((0.0, -4.0), (5.0, -4.0), 4.0)
LIFT = models.Move((0.0, -4.0), (0.0, -1.0), 3.0)


def driven(trolley=None, winch=None, rope=None, friction=None):
    """The overhead crane with limits on its two drives and its rope."""
    first, second = CRANE.drives
    (hoist,) = CRANE.ropes
    masses = CRANE.masses
    if friction is not None:
        masses = (replace(CRANE.trolleys[0], friction=friction), *CRANE.loads)
    return replace(
        CRANE,
        masses=masses,
        drives=(replace(first, **trolley or {}), replace(second, **winch or {})),
        ropes=(replace(hoist, **rope or {}),),
    )


def trolley_speed(duration, move, gravity=9.81):
    """Largest speed of the trolley above a load that moves level: x' + L x''' / g, by hand."""
    path = feedforward.from_move(replace(move, duration=duration))
    x = path.derivatives(np.linspace(0.0, duration, 4001), 3)[:, :, 0]
    return np.abs(x[1] + 4.0 * x[3] / gravity).max()


def test_the_shortest_duration_keeps_a_speed_limit():
    rig = driven({"speed": 2.0})
    best = feedforward.shortest_duration(rig, feedforward.from_move(ASIDE))
    slowest = brentq(lambda duration: trolley_speed(duration, ASIDE) - 2.0, 3.0, 20.0)
    assert best.limited_by == "speed of drive trolley"
    assert best.duration == pytest.approx(slowest, rel=3e-4)
    assert feedforward.check(rig, best.reference).feasible
    free = feedforward.shortest_duration(CRANE, feedforward.from_move(ASIDE))
    assert free.duration < 0.9 * best.duration


PEAK = 15.0 / 8.0
"""Largest slope of the blend 10 s^3 - 15 s^4 + 6 s^5."""


def test_sentences_name_the_quantity_and_its_limit():
    quintic = feedforward.rest_to_rest((0.0, -4.0), (0.0, -1.0), duration=3.0, order=2)
    rope_speed = 3.0 * PEAK / 3.0
    slow = driven(winch={"speed": 0.9 * rope_speed / 0.1, "gear": 1.0})
    motion = feedforward.check(slow, quintic).motion
    report = feedforward.check(slow, feedforward.from_move(LIFT))
    said = [problem for problem in report.problems if "a speed of" in problem]
    assert len(said) == 1
    assert "drive winch would need a speed of" in said[0]
    assert f"its limit is {0.9 * rope_speed / 0.1:.4g} rad/s" in said[0]
    assert not report.sizing[1].within
    speeds = np.abs(motion.drive_velocities[:, 1]).max() / 0.1
    assert speeds == pytest.approx(rope_speed / 0.1, rel=1e-4)


@pytest.mark.parametrize(
    ("quantity", "gear"), [("speed", 1.0), ("acceleration", 4.0), ("power", 1.0), ("rate", 4.0)]
)
def test_each_limit_is_that_of_the_motor(quantity, gear):
    """Found by hand from the rope's motion: the motor turns gear/r as fast, and takes r/gear."""
    path = feedforward.from_move(LIFT)
    times = feedforward.check(CRANE, path).motion.times
    plain = feedforward.solve(CRANE, path, times)
    torque, turn = plain.inputs[:, 1] / gear, gear / 0.1
    most = {
        "speed": np.abs(plain.drive_velocities[:, 1]).max() * turn,
        "acceleration": np.abs(plain.accelerations[:, plain.driven[1]]).max() * turn,
        "power": np.abs(torque * plain.drive_velocities[:, 1] * turn).max(),
        "rate": np.abs(np.diff(torque) / np.diff(times)).max(),
    }[quantity]
    for share, feasible in ((1.001, True), (0.999, False)):
        rig = driven(winch={quantity: share * most, "gear": gear})
        report = feedforward.check(rig, path)
        assert report.feasible == feasible, report.problems
        assert any(quantity in problem for problem in report.problems) != feasible


def test_a_jump_of_friction_is_no_rate():
    rig = driven({"rate": 1e3}, friction=Friction(50.0, 10.0))
    assert feedforward.check(rig, feedforward.from_move(ASIDE)).feasible


def test_asymmetric_limits_are_kept_on_their_sides():
    path = feedforward.from_move(LIFT)
    lowest = feedforward.solve(CRANE, path, np.linspace(0.0, 3.0, 1501)).inputs[:, 1].min()
    enough = driven(winch={"limit": 1.0, "lower": 1.001 * lowest})
    report = feedforward.check(enough, path)
    assert report.feasible
    assert report.sizing[1].largest == pytest.approx(-lowest)
    assert report.sizing[1].limit == pytest.approx(-1.001 * lowest)
    weak = feedforward.check(driven(winch={"limit": 1.0, "lower": 0.999 * lowest}), path)
    assert any(f"its limit is {0.999 * lowest:.4g} N m" in problem for problem in weak.problems)
    best = feedforward.shortest_duration(enough, path)
    assert best.limited_by == "drive winch"
    assert best.duration == pytest.approx(3.0, rel=2e-3)


ENDS = [
    ({"shortest": 1.5}, "rope hoist is 1.* m long, it can be 1.5 m to inf m"),
    ({"two_block": 1.5}, "the last span of rope hoist is 1.* m long, it can be 1.5 m to inf m"),
]


@pytest.mark.parametrize(("rope", "message"), ENDS)
def test_a_rope_past_its_end_is_refused(rope, message, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    rig, path = driven(rope=rope), feedforward.from_move(LIFT)
    with pytest.raises(PathError, match=message):
        feedforward.solve(rig, path, np.linspace(0.0, 3.0, 31))
    (problem,) = feedforward.check(rig, path).problems
    assert problem.startswith(message.split(" is ", maxsplit=1)[0] + " would be 1 m long at 3 s")
    for in_c in (False, True):
        stepper = feedforward.Stepper(rig, (0.0, -2.0), in_c=in_c)
        still = np.zeros((stepper.order + 1, 2))
        still[0] = 0.0, -1.4
        with pytest.raises(PathError, match="a rope would be longer or shorter than it can be"):
            stepper.step(still, 1.0)
    stream = feedforward.Stream(rig, (0.0, -3.0))
    lengths = [stream.tick((0.0, 3.0)).positions for _ in range(300)]
    column = stream.tick((0.0, 0.0)).coordinate_names.index("hoist.length")
    assert 1.5 - 1e-9 < min(place[column] for place in lengths) < 1.7


def test_a_stream_keeps_speed_limits():
    rig = driven({"speed": 0.8}, {"power": 500.0})
    stream = feedforward.Stream(rig, (0.0, -4.0))
    samples = [stream.tick((3.0, 2.0)) for _ in range(200)]
    speeds = np.array([sample.drive_velocities for sample in samples])
    power = np.array([sample.inputs for sample in samples])[:, 1] * speeds[:, 1] / 0.1
    assert 0.95 * 0.75 < np.abs(speeds[:, 0]).max() < 0.95 * 0.801
    assert 400.0 < np.abs(power).max() < 500.0


LAB = Path(__file__).parents[2] / "docs" / "how-to" / "lab_crane.toml"


def test_a_lab_crane_needs_what_its_friction_takes():
    rig, move = models.load(LAB)
    report = feedforward.check(rig, feedforward.from_move(move))
    assert report.feasible
    assert report.friction
    assert [part.largest for part in report.sizing] == pytest.approx(
        [26.97, 22.07, 0.443], rel=1e-3
    )
    env = envs.Feedforward(envs.PD(gym.make("flatrig/Rig-v0", rig=str(LAB))))
    env.reset(seed=0)
    for _ in range(150):
        *_, ended, _, info = env.step(np.zeros(3))
        assert not ended
        assert np.linalg.norm(info["load"] - info["reference"]) < 1e-4
    text = models.dumps(rig, move)
    assert models.loads(text) == (rig, move)


def episode(rig, actions, move=LIFT, **options):
    env = gym.make("flatrig/Rig-v0", rig=rig, reference=move, **options)
    env.reset(seed=0)
    infos = [env.step(action)[-1] for action in actions]
    return env.unwrapped.task, np.array([info["input"] for info in infos])


def test_episodes_clip_to_limits_changes_and_power():
    rig = driven({"limit": 100.0, "lower": -50.0}, {"rate": 200.0})
    actions = np.array([[1.0, -0.5], [-1.0, 0.5], [-1.0, 0.5]])
    task, inputs = episode(rig, actions)
    np.testing.assert_allclose(inputs[:, 0], [100.0, -50.0, -50.0])
    np.testing.assert_allclose(np.diff(inputs[:, 1]), 200.0 * task.period)
    task, inputs = episode(driven({"power": 5.0}), np.tile([1.0, -0.5], (8, 1)))
    speed = task.plant.drive_rates[0, 0]
    assert np.abs(inputs[-1, 0] * speed) < 1.5 * 5.0  # by the speed as the period begins
    assert np.abs(inputs[-1, 0]) < 0.1 * task.limits[0]


def test_episodes_need_a_plan_within_the_limits():
    with pytest.raises(OptionError, match=r"give a speed of .* m/s even without disturbances"):
        gym.make("flatrig/Rig-v0", rig=driven({"speed": 1.0}), reference=ASIDE)


def test_random_friction_adds_to_what_is_described():
    rig = driven({"limit": 2000.0}, friction=Friction(20.0, 40.0))
    ranges = {"trolley_friction": (5.0, 5.0), "trolley_viscous": (7.0, 7.0)}
    env = envs.Feedforward(gym.make("flatrig/Rig-v0", rig=rig, disturbances=ranges))
    env.reset(seed=0)
    plant = env.unwrapped.task.plant
    trolley = plant.model.joint("trolley.position").dofadr[0]
    assert plant.batch.expand("dof_frictionloss")[0, trolley] == 25.0
    assert plant.batch.expand("dof_damping")[0, trolley] == 47.0
    plain = envs.Feedforward(gym.make("flatrig/Rig-v0", rig=rig, reference=ASIDE))
    plain.reset(seed=0)
    for _ in range(200):
        *_, info = plain.step(np.zeros(2))
    assert np.linalg.norm(info["load"] - info["reference"]) < 0.02
