"""Ropes that stretch or go slack in environments, against rigid ones and springs by hand."""

from dataclasses import replace
from functools import partial

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec

import flatrig.envs as envs
from flatrig import models
from flatrig.models import OptionError, Ropes

OVERHEAD = "flatrig/OverheadCrane-v0"
SOFT = {"elastic": Ropes("elastic", stiffness=2e5), "slack": Ropes("slack", stiffness=2e5)}
RUBBING = envs.Scenario(winch_friction=30.0, winch_viscous=20.0, trolley_friction=5.0)
GAINS = {"stiffness": [300.0, 60.0], "damping": [300.0, 30.0]}
"""Soft enough for a winch by itself: 50 Hz, and no load behind a rope that gives way."""


def made(ropes, name=OVERHEAD, **options):
    env = gym.make(name, ropes=ropes, nthread=1, sensors="full", **options)
    return envs.Feedforward(envs.PD(env, **GAINS))


def along(env, steps, scenario=None):
    """Tensions (steps, ropes) and distances from the path (steps,) without anybody acting."""
    env.reset(seed=0, options={"scenario": scenario} if scenario else None)
    said = [env.step(np.zeros(env.action_space.shape)) for _ in range(steps)]
    assert not any(one[2] for one in said)
    pulls = np.array([one[4]["tension"] for one in said])
    return pulls, np.array([np.linalg.norm(one[4]["load"] - one[4]["reference"]) for one in said])


@pytest.mark.parametrize("ropes", ["elastic", "slack", *SOFT.values()], ids=str)
def test_an_episode_begins_at_rest_with_the_rope_stretched_by_its_pull(ropes):
    still = models.Move(start=(0, -4), goal=(0, -4), duration=1.0)
    env = envs.Feedforward(gym.make(OVERHEAD, ropes=ropes, reference=still))
    env.reset(seed=0)
    task = env.unwrapped.task
    weight = task.rig.loads[0].mass * task.rig.gravity
    stretch = 4.0 - task.plant.qpos[0, -1]
    spring = models.mjcf.ropes.stiffness(task.plant.model, task.rig.ropes[0])
    assert stretch == pytest.approx(weight / spring, rel=1e-9)
    pulls, distances = along(env, 40)
    np.testing.assert_allclose(pulls, weight, rtol=1e-7)
    assert distances.max() < 1e-8


@pytest.mark.parametrize("kind", ["elastic", "slack"])
def test_stiff_ropes_are_rigid_ones_friction_and_all(kind):
    options = {"disturbances": envs.Disturbances(winch_friction=(0.0, 30.0)), "reference": None}
    rigid = along(made("rigid", **options), 120, RUBBING)
    given = along(made(kind, **options), 120, RUBBING)
    assert rigid[1].max() > 0.1  # m, through friction
    assert np.abs(given[1] - rigid[1]).max() < 2e-3
    assert np.abs(given[0] - rigid[0]).max() < 0.06 * rigid[0].max()


def test_a_rope_that_can_go_slack_does_and_is_caught_again():
    """Let go of the winch: the load falls with the spool until the winch holds it again."""
    ends = {}
    for kind in ("rigid", "slack"):
        env = gym.make(OVERHEAD, ropes=kind, nthread=1, cost=True)
        env.reset(seed=0)
        payout = np.array([0.0, 1.0])
        said = [env.step(payout) for _ in range(5)]
        ends[kind] = [env.unwrapped.reasons[one[4]["reason"]] for one in said]
        if kind == "slack":
            pulls = np.array([one[4]["tension"][0] for one in said])
            np.testing.assert_allclose(pulls, 0.0, atol=1e-9)
            assert said[-1][4]["cost"] == 1.0
            fallen = said[0][4]["load"][1] - said[-1][4]["load"][1]
            assert fallen == pytest.approx(9.81 * 0.1**2 / 2 - 9.81 * 0.02**2 / 2, rel=1e-6)
            caught = [env.step(np.array([0.0, -1.0]))[4]["tension"][0] for _ in range(40)]
            assert max(caught) > 981.0
    assert "slack" in ends["rigid"]
    assert ends["slack"] == [""] * 5


def test_vectors_states_and_specs_have_them_too():
    env = made(SOFT["slack"], disturbances="standard")
    env.reset(seed=2)
    for _ in range(5):
        env.step(np.array([0.1, -0.1]))
    state = env.get_state()
    again = gym.make(EnvSpec.from_json(env.spec.to_json()))
    controllers = [partial(envs.PD, **GAINS), envs.Feedforward]
    vector = envs.make_vec(
        OVERHEAD, 2, wrappers=controllers, ropes=SOFT["slack"], nthread=1, sensors="full",
        disturbances="standard",
    )  # fmt: skip
    again.reset()
    vector.reset()
    again.set_state(state)
    vector.set_state([state] * 2)
    for _ in range(5):
        action = np.array([-0.2, 0.1])
        seen = env.step(action)[0]
        np.testing.assert_array_equal(again.step(action)[0], seen)
        np.testing.assert_array_equal(vector.step(np.tile(action, (2, 1)))[0], [seen] * 2)
    with pytest.raises(OptionError, match="ropes"):
        made("elastic").set_state(state)


@pytest.mark.parametrize(
    ("ropes", "message"),
    [
        ("elstic", "ropes cannot be 'elstic'; did you mean elastic"),
        (3, "ropes is 3, it must be a word or models.Ropes"),
        ({"kind": "elastic", "stifness": 3}, "ropes have no 'stifness'; did you mean stiffness"),
        (Ropes("elastic", stiffness=1e9), "with these elastic ropes it must be below"),
    ],
)
def test_wrong_ropes_get_one_line(ropes, message):
    with pytest.raises(models.FlatrigError) as caught:
        gym.make(OVERHEAD, ropes=ropes)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_more_ropes_than_joints_go_slack_and_rub_too():
    env = gym.make(envs.OWN, rig="cable_robot", ropes="slack", disturbances="standard", nthread=1)
    env = envs.Feedforward(envs.PD(env))
    env.reset(seed=1)
    pulls = np.array([env.step(np.zeros(8))[4]["tension"] for _ in range(5)])
    stiff = {"rig": "cable_robot", "disturbances": "standard", "nthread": 1}
    rigid = envs.Feedforward(envs.PD(gym.make(envs.OWN, **stiff)))
    rigid.reset(seed=1)
    expected = np.array([rigid.step(np.zeros(8))[4]["tension"] for _ in range(5)])
    np.testing.assert_allclose(pulls, expected, rtol=5e-3)


def test_gears_that_lose_power_are_refused_where_ropes_give_way():
    rig = models.overhead_crane()
    drives = [replace(drive, efficiency=0.9) for drive in rig.drives]
    with pytest.raises(OptionError, match="loses nothing with slack ropes; take rigid ones"):
        gym.make(OVERHEAD, rig=replace(rig, drives=tuple(drives)), ropes="slack")
