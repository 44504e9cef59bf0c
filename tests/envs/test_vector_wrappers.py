"""Every vector wrapper of Gymnasium stands around native vectors, with controllers below."""

import warnings

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import wrappers as single
from gymnasium.spaces import Box, Dict
from gymnasium.vector.utils import batch_space
from gymnasium.wrappers import vector as several

import flatrig.envs as envs

NUM = 2
FINE = Box(-1.0, 1.0, (2,), np.float32)


def pictures(env):
    """Observations as pictures, which some wrappers are for."""
    space = Box(0, 255, (6, 5, 3), np.uint8)

    def drawn(seen):
        return np.resize(np.abs(255 * np.tanh(seen)), (NUM, 6, 5, 3)).astype(np.uint8)

    return several.TransformObservation(env, drawn, batch_space(space, NUM), space)


def by_name(env):
    """Observations as a dictionary."""
    space = Dict({"seen": env.single_observation_space})
    return several.TransformObservation(env, lambda o: {"seen": o}, batch_space(space, NUM), space)


def movie(env, tmp_path):
    pytest.importorskip("moviepy")
    return several.RecordVideo(env, str(tmp_path))


def window(env):
    pytest.importorskip("pygame")
    return several.HumanRendering(env)


def converted(name, env):
    pytest.importorskip("array_api_compat")
    if name == "ArrayConversion":
        return several.ArrayConversion(env, env_xp=np, target_xp=np)
    if name == "NumpyToTorch":
        pytest.importorskip("torch")
        return several.NumpyToTorch(env)
    # These two are for environments in jax: so is this one, above NumPy.
    numpy = pytest.importorskip("jax.numpy")
    return getattr(several, name)(several.ArrayConversion(env, env_xp=np, target_xp=numpy))


BUILD = {
    "VectorizeTransformObservation": lambda env: several.VectorizeTransformObservation(
        env, single.ReshapeObservation, shape=(env.single_observation_space.shape[0], 1)
    ),
    "VectorizeTransformAction": lambda env: several.VectorizeTransformAction(
        env, single.TransformAction, func=lambda action: 0.5 * action, action_space=FINE
    ),
    "VectorizeTransformReward": lambda env: several.VectorizeTransformReward(
        env, single.TransformReward, func=lambda reward: 2.0 * reward
    ),
    "DictInfoToList": several.DictInfoToList,
    "TransformObservation": lambda env: several.TransformObservation(env, np.tanh),
    "FilterObservation": lambda env: several.FilterObservation(by_name(env), ["seen"]),
    "FlattenObservation": lambda env: several.FlattenObservation(pictures(env)),
    "GrayscaleObservation": lambda env: several.GrayscaleObservation(pictures(env)),
    "ResizeObservation": lambda env: (
        pytest.importorskip("cv2") and several.ResizeObservation(pictures(env), (3, 3))
    ),
    "ReshapeObservation": lambda env: several.ReshapeObservation(
        env, (env.single_observation_space.shape[0], 1)
    ),
    "RescaleObservation": lambda env: several.RescaleObservation(
        env, env.single_observation_space.low / 100.0, env.single_observation_space.high / 100.0
    ),
    "DtypeObservation": lambda env: several.DtypeObservation(env, np.float32),
    "NormalizeObservation": several.NormalizeObservation,
    "TransformAction": lambda env: several.TransformAction(env, lambda actions: 0.5 * actions),
    "ClipAction": several.ClipAction,
    "RescaleAction": lambda env: several.RescaleAction(env, -2.0, 2.0),
    "TransformReward": lambda env: several.TransformReward(env, np.sqrt),
    "ClipReward": lambda env: several.ClipReward(env, 0.0, 0.5),
    "NormalizeReward": several.NormalizeReward,
    "RecordEpisodeStatistics": several.RecordEpisodeStatistics,
    "RecordVideo": movie,
    "HumanRendering": window,
    **{
        name: (lambda env, name=name: converted(name, env))
        for name in ("ArrayConversion", "JaxToNumpy", "JaxToTorch", "NumpyToTorch")
    },
}
DRAWN = {"RecordVideo", "HumanRendering"}


def test_none_of_gymnasium_is_left_out():
    assert set(BUILD) == set(several.__all__)


@pytest.mark.parametrize("name", BUILD)
def test_it_stands_around_a_native_vector(name, tmp_path, monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    mode = "rgb_array" if name in DRAWN else None
    short = {"hold": 0.0, "disturbances": "standard", "render_mode": mode}
    vector = gym.make_vec("flatrig/OverheadCrane-v0", num_envs=NUM, **short)
    vector = envs.Feedforward(envs.PD(vector))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        build = BUILD[name]
        vector = build(vector, tmp_path) if name == "RecordVideo" else build(vector)
    seen, info = vector.reset(seed=1)
    actions = vector.action_space.sample() * 0
    if name.endswith("ToTorch"):
        import torch

        actions = torch.as_tensor(actions)
    for _ in range(3):
        seen, rewards, terminated, _, info = vector.step(actions)
    assert len(rewards) == NUM
    assert not terminated.any()
    shape = vector.observation_space.shape
    assert shape is None or tuple(seen.shape) == shape
    load = [one["load"] for one in info] if isinstance(info, list) else info["load"]
    assert len(load) == NUM
    assert vector.unwrapped.spec is not None
    assert [wrapper.name for wrapper in vector.spec.additional_wrappers] == ["PD", "Feedforward"]
    vector.close()


def test_episodes_are_counted_alike_in_every_mode():
    counted = []
    for mode in gym.vector.AutoresetMode:
        vector = gym.make_vec("flatrig/OverheadCrane-v0", num_envs=NUM, autoreset_mode=mode)
        vector = several.RecordEpisodeStatistics(vector)
        vector.reset(seed=1)
        lengths = []
        for _ in range(40):
            *_, terminated, _, info = vector.step(np.tile([0.0, 1.0], (NUM, 1)))
            if terminated.any():
                lengths += info["episode"]["l"][terminated].tolist()
                if mode is gym.vector.AutoresetMode.DISABLED:
                    vector.reset(options={"reset_mask": terminated})
        counted.append(lengths)
    assert counted[0][:4] == counted[1][:4] == counted[2][:4]
