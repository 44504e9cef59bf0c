"""What docs/how-to/other_tools.md shows runs; each tool's part where the tool is installed."""

import re
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
