"""Algorithms of stable-baselines3 train through the native vector, and see what others would."""

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import models

sb3 = pytest.importorskip("stable_baselines3")

from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor  # noqa: E402

from flatrig.envs.sb3 import VecEnv  # noqa: E402

OVERHEAD = "flatrig/OverheadCrane-v0"
SHORT = {
    "reference": models.Move(start=(0, -4), goal=(0.2, -4.1), duration=0.9),
    "hold": 0.02,
    "disturbances": "standard",
}


def small(**network):
    return {"policy_kwargs": {"net_arch": [8], **network}, "device": "cpu", "seed": 0}


def controlled(env):
    return envs.Residual(envs.Feedforward(envs.PD(env)), fraction=0.1)


def vector(number, **options):
    vector = gym.make_vec(OVERHEAD, num_envs=number, autoreset_mode="SameStep", **options)
    return VecEnv(controlled(vector))


def test_episodes_are_those_of_dummy_vec_env_to_the_last_bit():
    ours = vector(3, **SHORT)
    theirs = DummyVecEnv([lambda: controlled(gym.make(OVERHEAD, **SHORT))] * 3)
    for env in (ours, theirs):
        env.seed(7)
    assert np.array_equal(ours.reset(), theirs.reset().astype(float))
    rng, ended = np.random.default_rng(0), 0
    for _ in range(50):
        actions = rng.uniform(-1, 1, (3, 2)).astype(np.float32)
        mine, others = ours.step(actions), theirs.step(actions)
        for own, other in zip(mine[:3], others[:3], strict=True):
            assert own.dtype == other.dtype
            assert np.array_equal(own, other)
        for own, other in zip(mine[3], others[3], strict=True):
            assert (
                own["TimeLimit.truncated"] == other["TimeLimit.truncated"]
                if ("terminal_observation" in own)
                else not own.get("TimeLimit.truncated", False)
            )
            assert {*own, "TimeLimit.truncated"} == set(other)
            assert all(np.array_equal(own[name], other[name]) for name in own)
            ended += "terminal_observation" in own
        for own, other in zip(ours.reset_infos, theirs.reset_infos, strict=True):
            assert own["scenario"].tolist() == other["scenario"].tolist()
    assert ended == 3
    assert mine[3][0]["load"].shape == (2,)


def test_what_ends_early_is_no_time_limit():
    env = vector(2)
    env.reset()
    env.env.unwrapped.task.plant.qvel[0, 1] = np.nan
    _, _, over, infos = env.step(np.zeros((2, 2), np.float32))
    assert over.tolist() == [True, False]
    assert infos[0]["TimeLimit.truncated"] is False
    assert env.get_attr("reasons")[0][infos[0]["reason"]] == "not finite"


def test_attributes_methods_options_and_wrappers_are_the_vectors():
    env = vector(2, disturbances="standard", render_mode=None)
    scenario = envs.Scenario(load_mass=1.2)
    env.set_options([{"scenario": scenario}, {}])
    env.seed(1)
    env.reset()
    first, second = env.env.unwrapped.task.scenarios
    assert first == scenario != second
    assert env.reset_infos[0]["scenario"][0] == 1.2
    assert env.get_attr("num_envs", indices=1) == [2]
    env.set_attr("remark", "kept")
    assert env.get_attr("remark") == ["kept", "kept"]
    assert env.env_method("__repr__")[0] == repr(env.env)
    assert env.env_is_wrapped(envs.laws.VectorController) == [True, True]
    assert env.env_is_wrapped(gym.vector.VectorRewardWrapper) == [False, False]
    assert env.get_images() == [None, None]
    env.close()


@pytest.mark.parametrize(
    "env",
    [
        pytest.param(lambda: gym.make(OVERHEAD), id="single"),
        pytest.param(lambda: gym.make_vec(OVERHEAD, num_envs=2), id="next step"),
    ],
)
def test_other_environments_are_refused_in_one_line(env):
    with pytest.raises(models.OptionError, match='autoreset_mode="SameStep"') as caught:
        VecEnv(env())
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("PPO", {"n_steps": 32, "batch_size": 32, "n_epochs": 1}),
        ("SAC", {"learning_starts": 50, "batch_size": 16}),
        ("TD3", {"learning_starts": 50, "batch_size": 16}),
    ],
)
def test_it_trains(name, options):
    env = VecMonitor(vector(4, **SHORT))
    model = getattr(sb3, name)("MlpPolicy", env, **options, **small())
    before = [value.clone() for value in model.policy.parameters()]
    model.learn(256)
    assert any((old != new).any() for old, new in zip(before, model.policy.parameters()))  # noqa: B905
    assert [episode["l"] for episode in model.ep_info_buffer] == [46] * 4
    action, _ = model.predict(env.reset())
    assert action.shape == (4, 2)


def test_a_recurrent_policy_trains():
    contrib = pytest.importorskip("sb3_contrib")
    model = contrib.RecurrentPPO(
        "MlpLstmPolicy", vector(4, **SHORT), n_steps=32, batch_size=32, n_epochs=1,
        **small(lstm_hidden_size=8),
    )  # fmt: skip
    model.learn(256)
    assert model.num_timesteps == 256
