"""Wrong options, seeds and actions get one line, and change nothing."""

import warnings

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import models

OVERHEAD = "flatrig/OverheadCrane-v0"


def make(name=OVERHEAD, **options):
    return gym.make(name, **options)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"rate": 70.0}, "whole number"),
        ({"rate": 0.0}, "rate is 0"),
        ({"timestep": np.nan}, "timestep is nan"),
        ({"sensors": "all"}, "sensors is 'all'"),
        ({"hold": -1.0}, "hold is -1"),
        ({"hold": None}, "hold is None, it must be a finite number >= 0"),
        ({"hold": np.inf}, "hold is inf s"),
        ({"rate": "50"}, "rate is '50'"),
        ({"rate": True}, "rate is True"),
        ({"nthread": 1.5}, "nthread is 1.5, it must be a whole number >= 1"),
        ({"nthread": -1}, "nthread is -1"),
        ({"disturbances": {"wind": ("a", "b")}}, "wind is 'a'"),
        ({"disturbances": {"encoder_resolution": (0, 0.1)}}, "encoder_resolution is "),
        ({"disturbances": {3: 4}}, "no disturbance 3"),
        ({"reference": "circle"}, "reference is 'circle'"),
        ({"disturbances": {"winds": (0, 1)}}, "did you mean wind"),
        ({"disturbances": {"wind": (2, 1)}}, "low must not exceed"),
        ({"disturbances": 3}, "disturbances is 3"),
        ({"rig": 3}, "rig is 3"),
        ({"rig": "overhad"}, "no rig 'overhad'"),
        ({"render_mode": "ansi"}, "render_mode is 'ansi'"),
        ({"reference": models.Move(start=(0, -4), goal=(5, -1), duration=1.0)}, "cannot follow"),
        (
            {"reference": models.Move(start=(0, -4), goal=(5, -1), duration=2.0)},
            "would have to give",
        ),
        ({"reference": models.Move(start=(0, -4), goal=(50, -1), duration=9.0)}, "rail"),
    ],
)
def test_wrong_options_get_one_line(options, message):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(models.FlatrigError, match=message) as caught:
            make(**options)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scenarii": 1}, "did you mean scenario"),
        ({3: 1}, "no option 3"),
        (["scenario"], "must be a dictionary"),
        ({"scenario": 3}, "scenario is 3, it must be a Scenario"),
        ({"scenario": {"wind": 1.0}}, "must be a Scenario"),
        ({"reference": "random"}, "reference is 'random', it must be a Reference or a Move"),
        ({"reference": 3}, "reference is 3"),
        ({"scenario": envs.Scenario(load_mass=1.3, winch_friction=1.0)}, "made without"),
    ],
)
def test_wrong_reset_options_get_one_line_and_change_nothing(options, message):
    env, other = make(), make()
    env.reset(seed=0)
    other.reset(seed=0)
    with pytest.raises(models.FlatrigError, match=message) as caught:
        env.reset(options=options)
    assert "\n" not in str(caught.value)
    for _ in range(3):
        assert np.array_equal(env.step([0.1, -0.45])[0], other.step([0.1, -0.45])[0])
    assert env.unwrapped.task.scenarios == other.unwrapped.task.scenarios


def test_a_sampler_must_give_a_reference():
    with pytest.raises(models.OptionError, match="reference is None"):
        make(reference=lambda generator: None).reset()


@pytest.mark.parametrize("build", [lambda env: env, envs.PD, envs.Feedforward, envs.Residual])
@pytest.mark.parametrize(
    ("action", "message"),
    [
        ([0.0, 0.0, 0.0], r"shape \(3,\), it must have shape \(2,\)"),
        (0.0, "shape"),
        ("a", "must be finite numbers"),
        (None, "an action is None"),
        ([0.0, np.nan], r"actions must be finite: action 1 \(winch\) is nan"),
    ],
)
def test_wrong_actions_get_one_line(build, action, message):
    env = build(make())
    env.reset(seed=0)
    with pytest.raises(models.OptionError, match=message):
        env.step(action)


@pytest.mark.parametrize("build", [lambda env: env, envs.PD, envs.Feedforward, envs.Residual])
def test_wrong_actions_for_a_vector_get_one_line(build):
    vector = build(gym.make_vec(OVERHEAD, num_envs=3))
    vector.reset(seed=0)
    with pytest.raises(models.OptionError, match=r"shape \(2,\), it must have shape \(3, 2\)"):
        vector.step([0.0, -0.5])


def test_an_episode_must_begin_before_a_step():
    with pytest.raises(models.OptionError, match="call reset before step"):
        make().step([0.0, -0.5])
    vector = gym.make_vec(OVERHEAD, num_envs=2)
    vector.reset(options={"reset_mask": np.array([True, False])})
    with pytest.raises(models.OptionError, match="call reset before step"):
        vector.step(np.tile([0.0, -0.5], (2, 1)))
    vector.reset(options={"reset_mask": np.array([False, True])})
    vector.step(np.tile([0.0, -0.5], (2, 1)))


def test_vector_seeds_masks_and_lists():
    vector = gym.make_vec(OVERHEAD, num_envs=3, disturbances="standard")
    first, _ = vector.reset(seed=[4, 5, 6])
    again, _ = vector.reset(seed=4)
    assert np.array_equal(first, again)
    vector.step(np.tile([0.0, -0.5], (3, 1)))
    mask = np.array([True, False, False])
    partly, _ = vector.reset(options={"reset_mask": mask}, seed=[4, None, None])
    assert np.array_equal(partly[0], first[0])
    assert not np.array_equal(partly[1], first[1])
    again, _ = vector.reset(seed=np.int64(4))
    assert np.array_equal(first, again)
    scenarios = np.array([envs.Scenario(load_mass=mass) for mass in (0.8, 1.0, 1.2)])
    vector.reset(options={"scenarios": scenarios, "reset_mask": None})
    assert vector.unwrapped.task.scenarios == scenarios.tolist()
    present, _, _, _, before = vector.step(np.tile([0.0, -0.5], (3, 1)))
    still, info = vector.reset(seed=0, options={"reset_mask": np.zeros(3, dtype=bool)})
    assert np.array_equal(still, present)
    assert np.array_equal(info["load"], before["load"])
    assert vector.unwrapped.task.scenarios == scenarios.tolist()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"seed": [1, 2]}, "seed has 2 entries for 3"),
        ({"seed": -3}, "seed is -3, it must be a whole number >= 0"),
        ({"seed": 1.5}, "seed is 1.5"),
        ({"seed": [1, 2, "a"]}, "seed is 'a'"),
        ({"options": {"scenarios": [envs.Scenario()]}}, "scenarios has 1 entries for 3"),
        ({"options": {"scenarios": envs.Scenario()}}, "one for each"),
        ({"options": {"scenarios": [None, None, 3]}}, "scenario is 3"),
        ({"options": {"references": "abc"}}, "reference is 'a'"),
        ({"options": {"references": []}}, "references has 0 entries"),
        ({"options": {"reset_mask": np.ones(5, bool)}}, "it must be 3 booleans"),
        ({"options": {"reset_mask": [0, 2]}}, "it must be 3 booleans"),
        ({"options": {"reset_mask": [1, 0, 1]}}, "it must be 3 booleans"),
    ],
)
def test_wrong_seeds_masks_and_lists_get_one_line(given, message):
    vector = gym.make_vec(OVERHEAD, num_envs=3)
    vector.reset(seed=0)
    with pytest.raises(models.OptionError, match=message) as caught:
        vector.reset(**given)
    assert "\n" not in str(caught.value)


def test_wrong_options_of_a_vector_get_one_line():
    for options, message in (
        ({"num_envs": 0}, "number of simulations is 0"),
        ({"render_mode": "human"}, "render_mode is 'human', it must be rgb_array"),
    ):
        with pytest.raises(models.OptionError, match=message):
            envs.CraneVectorEnv("overhead_crane", **options)
    for seed in (-1, "a"):
        with pytest.raises(models.OptionError, match="seed is"):
            make().reset(seed=seed)
