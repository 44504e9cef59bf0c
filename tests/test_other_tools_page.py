"""What docs/how-to/other_tools.md shows runs; each tool's part where the tool is installed."""

import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

PAGE = Path(__file__).parents[1] / "docs" / "how-to" / "other_tools.md"
TOOLS = ("stable_baselines3", "torchrl", "minari", "onnxruntime", "pythonfmu")


def code() -> list[str]:
    return re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def needed(block: str) -> str:
    return next((tool for tool in TOOLS if f"from {tool}" in block), "")


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("index", range(len(code())))
def test_what_the_page_shows_runs(index: int) -> None:
    block = code()[index]
    if tool := needed(block):
        pytest.importorskip(tool)
    names: dict[str, Any] = {}
    exec("import gymnasium as gym\nfrom flatrig import envs\n" + block, names)
    if "Crane" in names:  # the FMU: two steps of 0.1 s, and the load is where the plan has it
        crane = names["Crane"](instance_name="crane", resources="")
        assert crane.do_step(0.0, 0.1)
        assert crane.do_step(0.1, 0.1)
        assert crane.env.unwrapped.task.steps == 10
        planned = crane.env.unwrapped.task.rows.parts["outputs"][0]
        assert abs(planned - (crane.x, crane.z)).max() < 1e-4


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
