"""Cranes with goals in their observations, and hindsight experience replay with them."""

import copy

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import flatrig.envs as envs
from flatrig import models

OVERHEAD = "flatrig/OverheadCrane-v0"
SHORT = models.Move(start=(0, -4), goal=(0.2, -4.1), duration=0.9)
SOON = {"reference": SHORT, "hold": 0.02, "disturbances": "standard"}


def goals(env, **options):
    return envs.GoalConditioned(envs.Feedforward(envs.PD(env)), **options)


@pytest.mark.filterwarnings("ignore")
def test_gymnasium_finds_nothing_wrong_and_the_goal_is_where_the_move_ends():
    env = goals(gym.make(OVERHEAD, disturbances="standard", sensors="full"))
    check_env(env, skip_render_check=True)
    seen, info = env.reset(seed=0)
    assert not info["is_success"]
    assert seen["desired_goal"] == pytest.approx(models.default_move("overhead").goal)
    assert np.array_equal(seen["achieved_goal"], info["load"])
    assert not any("error" in name or "ahead" in name for name in env.observation_names)
    assert len(env.observation_names) == len(seen["observation"])
    seen, reward, *_, info = env.step(np.zeros(2))
    assert reward == env.compute_reward(seen["achieved_goal"], seen["desired_goal"], {})
    own = env.compute_reward(seen["achieved_goal"], seen["achieved_goal"], info)
    assert own == 1.0 > reward > 0.0
    many = env.compute_reward(np.tile(seen["achieved_goal"], (3, 1)), np.zeros((3, 2)), [{}] * 3)
    assert many.shape == (3,)


def test_rewards_halve_where_tracking_does_and_are_sparse_on_request():
    env = goals(gym.make(OVERHEAD), within=0.1)
    near = 4.0 / 80.0  # the crane's typical length
    assert goals(gym.make(OVERHEAD)).compute_reward([near, 0.0], [0.0, 0.0], {}) == pytest.approx(
        0.5
    )
    rewards = env.compute_reward([[0.09, 0.0], [0.0, 0.11]], np.zeros((2, 2)), None)
    assert rewards.tolist() == [0.0, -1.0]
    env.reset(seed=0)
    again, twin = gym.make(env.spec), copy.deepcopy(env)
    assert again.compute_reward([0.09, 0.0], [0.0, 0.0], {}) == 0.0
    again.reset(options={"state": env.get_state()})
    seen = [one.step(np.zeros(2))[0]["achieved_goal"] for one in (env, again, twin)]
    assert np.array_equal(seen[0], seen[1])
    assert np.array_equal(seen[0], seen[2])


@pytest.mark.parametrize("mode", gym.vector.AutoresetMode)
def test_vectors_are_single_environments_side_by_side(mode):
    vector = goals(gym.make_vec(OVERHEAD, num_envs=2, autoreset_mode=mode, nthread=1, **SOON))
    single = goals(gym.make(OVERHEAD, **SOON))
    seen = vector.reset(seed=3)[0]
    assert all(vector.observation_space[name].contains(value) for name, value in seen.items())
    single.reset(seed=4)
    for _ in range(46):
        several = vector.step(np.full((2, 2), 0.01))
        alone = single.step(np.full(2, 0.01))
    assert several[3].all()
    assert several[1][1] == alone[1]
    last = several[4]["final_obs"][1] if "final_obs" in several[4] else {
        name: value[1] for name, value in several[0].items()
    }  # fmt: skip
    assert all(np.array_equal(last[name], alone[0][name]) for name in last)
    told = several[4].get("final_info", several[4])
    assert told["is_success"][1] == alone[4]["is_success"]
    if mode is gym.vector.AutoresetMode.NEXT_STEP:
        assert vector.step(np.zeros((2, 2)))[1].tolist() == [0.0, 0.0]
    made = envs.make_vec(vector.spec)
    assert made.observation_space == vector.observation_space


@pytest.mark.parametrize("several", [False, True])
def test_hindsight_experience_replay_trains(several):
    sb3 = pytest.importorskip("stable_baselines3")
    from flatrig.envs.sb3 import VecEnv

    if several:
        vector = gym.make_vec(OVERHEAD, num_envs=4, autoreset_mode="SameStep", **SOON)
        env = VecEnv(envs.GoalConditioned(envs.Residual(envs.PD(vector))))
    else:
        env = envs.GoalConditioned(envs.Residual(envs.PD(gym.make(OVERHEAD, **SOON))))
    model = sb3.SAC(
        "MultiInputPolicy", env, replay_buffer_class=sb3.HerReplayBuffer, learning_starts=200,
        batch_size=16, policy_kwargs={"net_arch": [8]}, device="cpu", seed=0,
    )  # fmt: skip
    model.learn(240)
    samples = model.replay_buffer.sample(64)
    distance = np.linalg.norm(
        samples.next_observations["achieved_goal"] - samples.observations["desired_goal"], axis=1
    )
    lever, near = (env.env.unwrapped if several else env.unwrapped).task.goal_levers()
    assert lever.tolist() == [1.0, 1.0]
    expected = 1.0 / (1.0 + (distance / near) ** 2)
    assert samples.rewards.numpy()[:, 0] == pytest.approx(expected, rel=1e-4)


def test_hands_and_wrong_distances_are_refused_in_one_line():
    with pytest.raises(models.OptionError, match="GoalConditioned is for outputs of cranes"):
        envs.GoalConditioned(gym.make("flatrig/BallOnPlate-v0"))
    with pytest.raises(models.OptionError, match="within is 0"):
        goals(gym.make(OVERHEAD), within=0)
