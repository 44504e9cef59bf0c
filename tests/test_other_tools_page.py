"""The trainings that docs/how-to/other_tools.md shows, where their tools are installed."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[1] / "docs" / "how-to" / "other_tools.md"


def shown(kind: str, word: str) -> str:
    """The block of a kind in which a word stands."""
    blocks = re.findall(rf"```{kind}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    (found,) = (block for block in blocks if word in block)
    return str(found)


def ran(command: str, folder: Path, *more: str) -> str:
    """What a command of the page says, run by this Python."""
    words = [sys.executable, *shlex.split(command)[1:], *more]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_rl_zoo3_trains(tmp_path: Path) -> None:
    pytest.importorskip("rl_zoo3")
    (tmp_path / "crane.yml").write_text(shown("yaml", "env_wrapper"), encoding="utf-8")
    said = ran(shown("sh", "rl_zoo3.train"), tmp_path, "-n", "400", "--log-folder", "logs")
    lengths = re.findall(r"ep_len_mean\s*\|\s*(\d+)", said)
    assert lengths == ["350"]  # of an episode that does not end early
    assert list(tmp_path.glob("logs/ppo/*/flatrig-OverheadCrane-v0.zip"))


def test_ppo_in_one_file_trains() -> None:
    pytest.importorskip("torch")
    few = ["--total-timesteps", "720", "--num-envs", "1", "--num-steps", "360"]
    said = ran(shown("sh", "ppo_in_one_file"), PAGE.parents[2], *few, "--epochs", "1")
    first, second = re.findall(r"(\d+) steps, return ([\d.]+), \d+ steps/s", said)
    assert (first[0], second[0]) == ("360", "720")
    assert float(first[1]) > 100.0  # of 350: as much as feedforward and PD get, but for noise
