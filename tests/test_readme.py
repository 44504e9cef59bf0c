"""What the README shows runs, and its example crane works everywhere."""

import re
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

from flatrig import envs, feedforward, models

ROOT = Path(__file__).resolve().parents[1]
PAGES = (*ROOT.glob("*.md"), *sorted((ROOT / "docs").rglob("*.md")))
TEXT = "\n".join(
    (ROOT / page).read_text(encoding="utf-8")
    for page in (
        "README.md",
        "docs/explanation/controllers.md",
        "docs/explanation/training.md",
        "docs/how-to/drive_a_crane.md",
    )
)
BLOCKS = re.findall(r"```python\n(.*?)```", TEXT, flags=re.DOTALL)


def test_there_are_examples():
    assert len(BLOCKS) == 8


@pytest.mark.parametrize("block", BLOCKS)
def test_python_blocks_run(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "README.md", "exec"), {})


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    targets = re.findall(r"\]\((?!https?:)([^)#]+)\)", page.read_text(encoding="utf-8"))
    assert [target for target in targets if not (page.parent / target).exists()] == []


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
