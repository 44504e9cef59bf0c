"""Cranes that users described in files of their own: planned, simulated and run as environments."""

from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

from flatrig import envs, models

FILES = sorted((Path(__file__).resolve().parents[1] / "field").glob("*.toml"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_crane_from_a_file_follows_its_plan_in_mujoco(file):
    env = gym.make("flatrig/Rig-v0", rig=str(file))
    of_place = [not name.endswith(".tension") for name in models.load(file)[0].outputs]
    env = envs.Feedforward(envs.PD(env))
    env.reset(seed=0)
    error, over = 0.0, False
    while not over:
        _, _, terminated, truncated, info = env.step(np.zeros(env.action_space.shape))
        error = max(error, np.abs(info["load"] - info["reference"])[of_place].max())
        over = terminated or truncated
    assert not terminated
    # Inputs held for 20 ms are all that stands between the plan and the plant: 4e-6 to 5e-5 m, rad.
    assert error < 1e-4
