"""What docs/how-to/many_machines.md shows in Python runs, and its commands can be read."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

from flatrig.training.cli import _parse
from flatrig.training.jobs.choice import PACKAGES

PAGE = (Path(__file__).parents[1] / "docs/how-to/many_machines.md").read_text(encoding="utf-8")


def test_the_python_runs(tmp_path: Path) -> None:
    (block,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    lines = block.splitlines()
    cut = next(i for i, line in enumerate(lines) if line.startswith("folder"))
    body = "\n".join(f"    {line}" for line in lines[cut:])
    guarded = "\n".join(lines[:cut]) + f'\nif __name__ == "__main__":\n{body}\n    print(values)\n'
    (tmp_path / "script.py").write_text(guarded)
    done = subprocess.run(
        [sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert "16.0 4.0" in done.stdout
    assert done.stdout.endswith("[1.0, 2.0, 3.0]\n")


def test_the_commands_are_flatrigs() -> None:
    blocks = re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL)
    found = re.findall(r"flatrig ([^#\n]*)", "\n".join(blocks))
    assert len(found) == 7
    for words in found:
        assert _parse(shlex.split(words)).on in PACKAGES
