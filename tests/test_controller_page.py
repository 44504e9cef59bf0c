"""The loop in docs/how-to/controller.md, compiled with what `flatrig export` writes."""

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.training.cli import main

PAGE = Path(__file__).resolve().parents[1] / "docs" / "how-to" / "controller.md"
COMPILER = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)


@pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
def test_the_loop_of_the_page_is_solve(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (block,) = re.findall(r"```c\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
    Path("loop.c").write_text(block)
    assert main(["export", "overhead", "--c", "crane.c"]) == 0
    strict = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
    subprocess.run([COMPILER, *strict, "loop.c", "crane.c", "-lm"], check=True)
    done = subprocess.run(["./a.out"], capture_output=True, text=True, check=True)
    inputs = np.array([line.split(",") for line in done.stdout.splitlines()], dtype=float)
    rig = models.make("overhead_crane")
    path = feedforward.rest_to_rest((0, -4), (5, -1), 3.0, order=4)
    solved = feedforward.solve(rig, path, np.arange(3001) * 1e-3)
    assert np.abs(inputs - solved.inputs).max() <= 1e-9 * np.abs(solved.inputs).max()
