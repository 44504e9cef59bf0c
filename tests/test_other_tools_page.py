"""What docs/how-to/other_tools.md shows runs; each tool's part where the tool is installed."""

import re
from pathlib import Path
from typing import Any

import pytest

PAGE = Path(__file__).parents[1] / "docs" / "how-to" / "other_tools.md"
TOOLS = ("stable_baselines3", "torchrl", "minari")


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
