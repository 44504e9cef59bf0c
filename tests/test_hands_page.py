"""What docs/explanation/hands.md shows runs."""

import re
from pathlib import Path

import pytest

from flatrig.training.cli import main

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE = (DOCS / "explanation" / "hands.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)


@pytest.fixture(autouse=True)
def _beside_the_docs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "docs").symlink_to(DOCS)
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("index", range(len(BLOCKS)))
def test_python_blocks_run(index: int) -> None:
    if "in_cones" in BLOCKS[index]:
        pytest.importorskip("clarabel")
    exec(compile(BLOCKS[index], "hands.md", "exec"), {})


def test_the_file_of_a_hand_is_solved() -> None:
    pytest.importorskip("clarabel")
    assert main(["solve", "docs/how-to/pinch.toml", "--rate", "100", "-o", "motion.csv"]) == 0
    assert Path("motion.csv").read_text(encoding="utf-8").count("\n") == 202
