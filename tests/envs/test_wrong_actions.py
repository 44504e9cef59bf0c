"""An action that cannot be: the line says in which row and which, and nothing has changed."""

from fractions import Fraction

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import models

OVERHEAD = "flatrig/OverheadCrane-v0"
BUILDS = [lambda env: env, envs.PD, envs.Feedforward, envs.Residual]
NAN, INF = np.nan, np.inf


@pytest.mark.parametrize("build", BUILDS)
@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({(3, 1): NAN}, "actions must be finite: row 3, action 1 (winch) is nan"),
        ({(0, 0): -INF}, "actions must be finite: row 0, action 0 (trolley) is -inf"),
        (
            {(1, 0): INF, (1, 1): NAN, (2, 0): NAN, (3, 0): NAN, (3, 1): NAN},
            "actions must be finite: row 1, action 0 (trolley) is inf; row 1, action 1 (winch) is "
            "nan; row 2, action 0 (trolley) is nan and 2 more",
        ),
    ],
)
def test_the_rows_are_named_and_all_go_on_as_if_nothing_had_been(build, wrong, message):
    vector, other = (build(gym.make_vec(OVERHEAD, num_envs=4)) for _ in range(2))
    for env in (vector, other):
        env.reset(seed=0)
    actions = np.tile([0.01, -0.49], (4, 1))
    bad = actions.copy()
    for place, value in wrong.items():
        bad[place] = value
    with pytest.raises(models.OptionError) as error:
        vector.step(bad)
    assert str(error.value) == message
    for found, expected in zip(vector.step(actions)[:2], other.step(actions)[:2], strict=True):
        assert np.array_equal(found, expected)


@pytest.mark.parametrize("build", BUILDS)
@pytest.mark.parametrize(
    ("action", "message"),
    [
        ([0.0, INF], "actions must be finite: action 1 (winch) is inf"),
        ([0.0, 1j], "an action is [0.0, 1j], it must be finite numbers"),
        (np.array([0.0, 1j]), "an action is array([0.+0.j, 0.+1.j]), it must be finite numbers"),
        ([0.0, None], "an action is [0.0, None], it must be finite numbers"),
        ([True, False], "an action is [True, False], it must be finite numbers"),
        (["0", "0"], "an action is ['0', '0'], it must be finite numbers"),
        ([[0.0], [0.0, 1.0]], "an action is [[0.0], [0.0, 1.0]], it must be numbers, as many in "),
    ],
)
def test_what_is_no_number_is_none_for_one_crane_too(build, action, message):
    env = build(gym.make(OVERHEAD))
    env.reset(seed=0)
    with pytest.raises(models.OptionError) as error:
        env.step(action)
    assert str(error.value).startswith(message)


def test_every_kind_of_real_number_is_an_action():
    env, other = (gym.make(OVERHEAD) for _ in range(2))
    env.reset(seed=0)
    other.reset(seed=0)
    expected = env.step([0.0, -0.5])
    found = other.step([np.int8(0), Fraction(-1, 2)])
    assert np.array_equal(expected[0], found[0])
    assert expected[1] == found[1]


def test_a_hand_names_its_motors():
    vector = gym.make_vec("flatrig/BallOnPlate-v0", num_envs=2)
    vector.reset(seed=0)
    names = vector.unwrapped.action_names
    actions = np.zeros((2, len(names)))
    actions[1, -1] = NAN
    last = len(names) - 1
    with pytest.raises(models.OptionError, match=rf"row 1, action {last} \({names[last]}\) is nan"):
        vector.step(actions)


@pytest.mark.parametrize("build", BUILDS)
def test_a_crane_that_begins_anew_may_be_told_anything(build):
    vector = build(gym.make_vec(OVERHEAD, num_envs=2, hold=0.0))
    vector.reset(seed=0)
    task = envs.task_of(vector)
    over = np.zeros(2, bool)
    while not over.any():
        action = [[0.3, 1.0], [0.0, -0.49]]  # the first is driven off its path
        over = np.logical_or(*vector.step(action)[2:4])
    actions = np.where(over[:, None], NAN, [0.0, -0.49])
    vector.step(actions)
    assert (task.steps[over] == 0).all()


@pytest.mark.parametrize("value", [Fraction(3, 2), np.float32(1.5), 1.5])
def test_scenarios_and_ranges_take_every_real_number(value):
    scenario = envs.Scenario(load_mass=value, delay=Fraction(2))
    assert scenario == envs.Scenario(load_mass=1.5, delay=2)
    assert type(scenario.load_mass) is float
    assert type(scenario.delay) is int
    for wrong in (1.5j, "1.5", True, None):
        with pytest.raises(models.OptionError, match="scenario: load_mass is"):
            envs.Scenario(load_mass=wrong)
