"""The blocks of code in a page of Markdown, run as a reader would run them."""

import ast
import contextlib
import importlib.util
import io
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from flatrig.training.cli import _parse, main

ROOT = Path(__file__).resolve().parents[1]
PAGES = [
    path.relative_to(ROOT).as_posix()
    for path in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
]
"""Every page but CONTRIBUTING.md, whose recipes tests/test_recipes.py follows."""
OWN = {"flatrig.envs.warp": "mujoco_warp"}
"""What a module of flatrig's own needs."""


def blocks(page: str, *kinds: str) -> Iterator[tuple[str, str]]:
    """Kind and text of each block of code of a page, in order."""
    text = (ROOT / page).read_text(encoding="utf-8")
    for kind, block in re.findall(r"^```(\w*)\n(.*?)^```$", text, re.DOTALL | re.MULTILINE):
        if not kinds or kind in kinds:
            yield kind, block


def missing(block: str) -> list[str]:
    """What a block of Python imports that is not installed."""
    names: list[str] = []
    for node in ast.walk(ast.parse(block)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names.append(str(node.module))
    tops = {name.partition(".")[0] for name in names}
    tops |= {OWN[name] for name in names if name in OWN}
    return sorted(top for top in tops if importlib.util.find_spec(top) is None)


def commands(block: str) -> Iterator[list[str]]:
    """The commands of a block of a shell, as words; comments are left out."""
    joined = block.replace("\\\n", " ")
    for line in joined.splitlines():
        if words := shlex.split(line, comments=True):
            yield words


def command(words: list[str]) -> int:
    """Run `flatrig ...`, with `> FILE` if there is one; returns the exit status."""
    if ">" not in words:
        return main(words[1:])
    place = words.index(">")
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        status = main(words[1:place])
    Path(words[place + 1]).write_text(said.getvalue(), encoding="utf-8")
    return status


def parsed(words: list[str]) -> Any:
    """The options of `flatrig ...`, which is not run; a mistake in them ends the test."""
    return _parse(words[1:])


def execute(page: str, block: str, names: dict[str, Any]) -> None:
    """Run a block of Python with the names of those before, if what it needs is installed.

    What is not installed is added to `names["missing"]`.
    """
    lacking = missing(block)
    names["missing"] += lacking
    if not lacking:
        exec(compile(block, page, "exec"), names)
