"""Specs can be written as JSON, whatever rigs and moves they have, and read again."""

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec
from gymnasium.vector import AutoresetMode

import flatrig.envs as envs
from flatrig import models

OVERHEAD = "flatrig/OverheadCrane-v0"
MOVE = models.Move(start=(0, -4), goal=(1, -3), duration=3.0)
CRANE = models.overhead_crane(load_mass=90.0)


@pytest.mark.parametrize(
    "options",
    [
        {"rig": CRANE},
        {"rig": CRANE, "reference": MOVE},
        {"rig": models.dumps(CRANE, MOVE)},
        {"rig": "overhead_crane", "reference": MOVE, "rate": 100.0},
        {"rig": "rotary_crane", "disturbances": envs.Disturbances(wind=(1.0, 2.0))},
    ],
)
def test_a_spec_in_json_makes_the_same_environment(options):
    env = envs.Feedforward(gym.make(envs.OWN, **options))
    again = gym.make(EnvSpec.from_json(env.spec.to_json()))
    task, same = env.unwrapped.task, again.unwrapped.task
    assert (task.rig, task.period, task.disturbances) == (same.rig, same.period, same.disturbances)
    assert np.array_equal(env.reset(seed=1)[0], again.reset(seed=1)[0])
    action = np.full(env.action_space.shape, 0.01)
    assert np.array_equal(env.step(action)[0], again.step(action)[0])


def test_a_hands_move_goes_through_json_too():
    move = models.HandMove(goal=(0.1,), duration=2.5)
    env = gym.make("flatrig/TwoFingerHand-v0", reference=move)
    spec = EnvSpec.from_json(env.spec.to_json())
    assert spec.kwargs["reference"] == {"goal": [0.1], "duration": 2.5, "start": [0.0]}
    again = gym.make(spec)
    assert np.array_equal(env.reset(seed=1)[0], again.reset(seed=1)[0])
    assert again.unwrapped.task.planner.fixed.steps == env.unwrapped.task.planner.fixed.steps
    with pytest.raises(models.OptionError, match="a HandMove has no 'gaol'; did you mean goal"):
        gym.make("flatrig/TwoFingerHand-v0", reference={"gaol": (0.1,)})


def test_a_vectors_spec_keeps_its_mode_and_its_rig():
    vector = gym.make_vec(
        envs.OWN, num_envs=2, rig=CRANE, reference=MOVE, autoreset_mode=AutoresetMode.SAME_STEP
    )
    again = envs.make_vec(EnvSpec.from_json(envs.PD(vector).spec.to_json()))
    assert again.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    assert again.unwrapped.task.rig == CRANE
    assert np.array_equal(vector.reset(seed=0)[0], again.reset(seed=0)[0])


def test_what_has_no_text_is_refused_by_gymnasium_alone():
    env = gym.make(OVERHEAD, reference=lambda generator: MOVE)
    assert callable(env.spec.kwargs["reference"])
    with pytest.raises((TypeError, ValueError)):
        env.spec.to_json()


def test_the_length_of_episodes_is_known_where_all_are_as_long():
    env = gym.make(OVERHEAD, hold=0.5)
    assert env.spec.max_episode_steps == round(3.5 * 50) == env.unwrapped.task.planner.fixed.steps
    assert gym.make(OVERHEAD, reference="random").spec.max_episode_steps is None
    assert gym.make_vec(OVERHEAD, num_envs=2).spec.max_episode_steps == round(7.0 * 50)
    limited = gym.make(env.spec)
    assert isinstance(limited, gym.wrappers.TimeLimit)
    assert limited.spec.max_episode_steps == round(3.5 * 50)


def test_a_vector_truncates_where_it_is_told():
    single = envs.Feedforward(gym.make(OVERHEAD, max_episode_steps=5))
    vector = envs.Feedforward(gym.make_vec(OVERHEAD, num_envs=2, max_episode_steps=5))
    for env, shape in ((single, (2,)), (vector, (2, 2))):
        env.reset(seed=0)
        late = [np.all(env.step(np.zeros(shape))[3]) for _ in range(5)]
        assert late == [False] * 4 + [True]
    with pytest.raises(models.OptionError, match="max_episode_steps is 0"):
        gym.make_vec(OVERHEAD, num_envs=2, max_episode_steps=0)
