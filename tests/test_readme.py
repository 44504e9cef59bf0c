"""The README's example crane works everywhere."""

from pathlib import Path

import gymnasium as gym
import numpy as np

from flatrig import envs, feedforward, models

ROOT = Path(__file__).resolve().parents[1]


def test_one_s_own_crane_gets_everything_from_its_file():
    rig, move = models.load(ROOT / "docs" / "how-to" / "workshop_crane.toml")
    reference = feedforward.from_move(move)
    motion = feedforward.solve(rig, reference, np.linspace(0, reference.duration, 101))
    assert not motion.slack
    assert models.compile(rig).nu == 3
    env = gym.make("flatrig/OverheadCrane-v0", rig=rig, reference=reference)
    env = envs.Feedforward(envs.PD(env))
    _, info = env.reset(seed=0)
    largest, over = 0.0, False
    while not over:
        _, _, terminated, over, info = env.step(np.zeros(3))
        assert not terminated
        largest = max(largest, float(np.linalg.norm(info["load"] - info["reference"])))
    assert largest < 1e-3
