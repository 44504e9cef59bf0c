"""Minari records episodes with all that their infos tell."""

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs

minari = pytest.importorskip("minari")
pytest.importorskip("jax")  # Minari needs it to record
pytest.importorskip("h5py")

OVERHEAD = "flatrig/OverheadCrane-v0"
PLATE = "flatrig/BallOnPlate-v0"


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", [OVERHEAD, PLATE])
def test_episodes_are_recorded_with_their_infos(name, tmp_path, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    env = envs.Feedforward(envs.PD(gym.make(name, disturbances="standard")))
    recorder = minari.DataCollector(env, record_infos=True)
    told = []
    for seed in range(2):
        told.append([recorder.reset(seed=seed)[1]])
        for _ in range(5):
            told[-1].append(recorder.step(np.zeros(env.action_space.shape, np.float32))[4])
    data = recorder.create_dataset(
        "flatrig/trial-v0", algorithm_name="feedforward + PD", author="flatrig",
        author_email="-", code_permalink="-", requirements=[],
    )  # fmt: skip
    assert data.total_episodes == 2
    for episode, infos in zip(data.iterate_episodes(), told, strict=True):
        assert set(episode.infos) == set(infos[0])
        for key, values in episode.infos.items():
            assert np.array_equal(values, [info[key] for info in infos])
