"""The luffing crane of docs/how-to/luffing_crane.md, luffed by a rope and by a torque."""

import re
from dataclasses import replace
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.training.simulate.open_loop import open_loop

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "how-to"
TEXT = (FOLDER / "luffing_crane.toml").read_text(encoding="utf-8")


def by_torque() -> str:
    """The file without its luffing rope, with the page's drive."""
    (drive,) = re.findall(
        r"```toml\n(.*?)```", (FOLDER / "luffing_crane.md").read_text(), flags=re.DOTALL
    )
    text = re.sub(r'\[\[ropes\]\]\nname = "luffing".*?\n\n', "", TEXT, flags=re.DOTALL)
    return re.sub(r'\[\[drives\]\]\nname = "luff".*?\n\n', drive + "\n", text, flags=re.DOTALL)


@pytest.mark.parametrize("text", [TEXT, by_torque()], ids=["rope", "torque"])
def test_it_is_solved_compiled_and_runs_in_an_environment(text: str) -> None:
    rig, move = models.loads(text)
    assert move is not None
    assert len(rig.ropes) + ('on = "boom"' in text) == 2
    assert models.loads(models.dumps(rig, move)) == (rig, move)
    reference = feedforward.from_move(move)
    assert feedforward.check(rig, reference).problems == ()
    run = open_loop(rig, feedforward.from_move(replace(move, duration=8.0)))
    assert run.distance.max() < 1e-3  # a boom under given inputs falls away from its path
    env = envs.Feedforward(envs.PD(gym.make("flatrig/Rig-v0", rig=rig, reference=reference)))
    env.reset(seed=0)
    for _ in range(100):
        *_, terminated, _, info = env.step(np.zeros(3))
        assert not terminated
    assert np.linalg.norm(info["load"] - info["reference"]) < 1e-4
