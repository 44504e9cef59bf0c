"""Plants change during an episode as somebody says, at the very steps."""

from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec

import flatrig.envs as envs
from flatrig import models

OVERHEAD = "flatrig/OverheadCrane-v0"
LIGHT, WINDY = envs.Scenario(load_mass=0.6), envs.Scenario(load_mass=0.6, wind=20.0)


def held(**options):
    return envs.Feedforward(envs.PD(gym.make(OVERHEAD, **options)))


def follow(env, steps):
    return np.array([env.step(np.zeros(2))[0] for _ in range(steps)])


def test_changes_are_what_disturb_does_at_their_steps():
    env, other = held(changes=[(0.1, LIGHT), (0.3, WINDY)]), held()
    for one in (env, other):
        one.reset(seed=0)
    by_hand = [follow(other, 5)]
    other.unwrapped.task.disturb([LIGHT])
    by_hand.append(follow(other, 10))
    other.unwrapped.task.disturb([WINDY])
    by_hand.append(follow(other, 10))
    assert np.array_equal(follow(env, 25), np.concatenate(by_hand))
    assert env.unwrapped.task.scenarios == [WINDY]
    assert np.array_equal(env.reset(seed=0)[0], other.reset(seed=0)[0])  # as it was described
    assert env.unwrapped.task.scenarios == [envs.Scenario()]


def test_a_payload_that_is_set_down_is_missed_on_the_rope():
    rest = models.Move(start=(0, -4), goal=(0.01, -4), duration=2.0)
    env = held(reference=rest, hold=8.0, changes=((2.0, envs.Scenario(load_mass=0.5)),))
    env.reset(seed=0)
    pulls = [env.step(np.zeros(2))[4]["tension"][0] for _ in range(500)]
    assert pulls[95] == pytest.approx(981.0, rel=1e-3)
    assert np.mean(pulls[-50:]) == pytest.approx(490.5, rel=1e-3)


def test_a_function_draws_them_and_sets_the_start_a_vector_as_a_single_one():
    def gusty(generator, scenario):
        times = np.sort(generator.uniform(0.05, 0.4, 3)).tolist()
        winds = generator.uniform(0, 30, 3).tolist()
        calm = replace(scenario, wind=0.0, gust=0.0)
        steps = [(t, replace(calm, wind=w)) for t, w in zip(times, winds, strict=True)]
        return [(0.0, calm), *steps]

    options = {"disturbances": "standard", "changes": gusty}
    vector = envs.Feedforward(envs.PD(gym.make_vec(OVERHEAD, num_envs=3, nthread=1, **options)))
    env = held(**options)
    vector.reset(seed=4)
    env.reset(seed=5)
    assert env.unwrapped.task.scenarios[0].wind == 0.0
    several = np.array([vector.step(np.zeros((3, 2)))[0] for _ in range(25)])
    assert np.array_equal(follow(env, 25), several[:, 1])
    winds = {scenario.wind for scenario in vector.unwrapped.task.scenarios}
    assert len(winds) == 3
    assert 0.0 not in winds


def test_what_is_to_come_goes_on_from_a_state():
    env, other = held(changes=[(0.2, WINDY)]), held(changes=[])
    env.reset(seed=0)
    follow(env, 5)
    other.reset(options={"state": env.get_state()})
    assert np.array_equal(follow(env, 10), follow(other, 10))
    assert other.unwrapped.task.scenarios == [WINDY]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (3, r"changes: 3 is no time \[s\]"),
        ([(1.0, None)], "with a Scenario"),
        ([(1.0, 3)], "scenario is 3, it must be a Scenario"),
        ([(2.0, LIGHT), (1.0, LIGHT)], "after the one before"),
        ([(-1.0, LIGHT)], "is no time"),
        ([(0.5, envs.Scenario(winch_friction=3.0))], "made without"),
    ],
)
def test_wrong_changes_get_one_line(changes, message):
    with pytest.raises(models.OptionError, match=message) as caught:
        held(changes=changes)
    assert "\n" not in str(caught.value)
    with pytest.raises(models.OptionError, match=message):
        held(changes=lambda generator, scenario: changes).reset(seed=0)


def test_changes_stand_in_specs_as_plain_values():
    env = gym.make(OVERHEAD, changes=[(0.04, WINDY)], nthread=1)
    again = gym.make(EnvSpec.from_json(env.spec.to_json()))
    env.reset(seed=0)
    again.reset(seed=0)
    for _ in range(6):
        np.testing.assert_array_equal(env.step([0.1, 0.0])[0], again.step([0.1, 0.0])[0])
    assert again.unwrapped.task.scenarios[0] == WINDY
    with pytest.raises(models.OptionError, match="a Scenario has no 'load_mas'; did you mean"):
        gym.make(OVERHEAD, changes=[(1.0, {"load_mas": 0.6})])
