"""What README and docs show runs: Python, commands and tables; and their links lead somewhere."""

import os
import re
import tomllib
from pathlib import Path
from typing import Any

import pages
import pytest

from flatrig.training.cli import main

OWN_TESTS = {
    "docs/how-to/many_machines.md": "tests/test_machines_page.py",
    "docs/how-to/tick_by_tick.md": "tests/test_driving_page.py",
}
"""Pages whose Python a test of their own runs, step by step."""

AT_ONCE = {"analyse", "docs", "example", "export", "fingerprint", "list", "solve"}
"""Commands that take a second; of the others, which tests of their own run, options are tried."""

OTHER_PROGRAMS = {"cc", "export", "minari", "pip", "python", "ray", "ssh"}
"""What else stands in blocks of a shell."""

EXTRAS = {"onnx": "--onnx"}
"""Extras that options need."""


def told_of_ships(names: dict[str, Any], said: list[str]) -> None:
    assert said[0] == "()"
    low, high = map(float, said[1].split())
    assert (round(low), round(high)) == (891, 1073)


def told_of_spreaders(names: dict[str, Any], said: list[str]) -> None:
    assert said[0].startswith("True ")
    assert "rig yard_crane: box.y is held, but at t = " in said[1]
    assert said[2:] == ["3600.0 39240", "True", "True"]


def told_of_fmus(names: dict[str, Any], said: list[str]) -> None:
    """Two steps of 0.1 s, and the load is where the plan has it."""
    if "Crane" not in names:
        return
    crane = names["Crane"](instance_name="crane", resources="")
    assert crane.do_step(0.0, 0.1)
    assert crane.do_step(0.1, 0.1)
    assert crane.env.unwrapped.task.steps == 10
    planned = crane.env.unwrapped.task.rows.parts["outputs"][0]
    assert abs(planned - (crane.x, crane.z)).max() < 1e-4


CHECKS = {
    "docs/how-to/other_tools.md": told_of_fmus,
    "docs/how-to/ship.md": told_of_ships,
    "docs/how-to/spreader.md": told_of_spreaders,
}
"""What the Python of a page must come to."""


def shown(*kinds: str) -> list[str]:
    """Pages with blocks of some kinds."""
    return [page for page in pages.PAGES if any(pages.blocks(page, *kinds))]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with docs in it, as a reader's who is in a checkout."""
    (tmp_path / "docs").symlink_to(pages.ROOT / "docs")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.filterwarnings("ignore")  # of other tools
@pytest.mark.parametrize("page", shown("python", "sh"))
def test_what_a_page_shows_runs(
    page: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names: dict[str, Any] = {"missing": []}
    said = ""
    for kind, block in pages.blocks(page, "python", "sh"):
        capsys.readouterr()
        if kind == "sh":
            for words in pages.commands(block):
                follow(words)
        elif page not in OWN_TESTS:
            pages.execute(page, block, names)
            said += capsys.readouterr().out
    if page in CHECKS:
        CHECKS[page](names, said.splitlines())
    if names["missing"]:
        pytest.skip(f"{page}, in part: needs {', '.join(sorted(set(names['missing'])))}")


def follow(words: list[str]) -> None:
    """Run a command, or try its options."""
    while "=" in words[0]:
        words = words[1:]
    words = words[: words.index("&&")] if "&&" in words else words
    if words[0] == "make":
        makefile = (pages.ROOT / "Makefile").read_text(encoding="utf-8")
        assert f"\n{words[1]}:" in makefile
    elif words[0] != "flatrig":
        assert words[0] in OTHER_PROGRAMS, words
    elif words[1] in AT_ONCE and not needs(words):
        assert pages.command(words) in ((0, 1) if words[1] == "analyse" else (0,)), words
    else:
        pages.parsed(words)


def needs(words: list[str]) -> bool:
    """Whether a command needs an extra that is not installed."""
    return any(option in words and pages.missing(f"import {e}") for e, option in EXTRAS.items())


@pytest.mark.parametrize("page", shown("toml"))
def test_tables_are_toml(page: str) -> None:
    assert all(tomllib.loads(block) for _, block in pages.blocks(page, "toml"))


@pytest.mark.parametrize(("page", "test"), OWN_TESTS.items())
def test_tests_of_pages_name_them(page: str, test: str) -> None:
    assert Path(page).name in (pages.ROOT / test).read_text(encoding="utf-8")


@pytest.mark.parametrize("page", [*pages.PAGES, "CONTRIBUTING.md", "CHANGELOG.md"])
def test_links_lead_somewhere(page: str) -> None:
    text = (pages.ROOT / page).read_text(encoding="utf-8")
    here = (pages.ROOT / page).parent
    for target, place in re.findall(r"\]\((?!https?:)([^)#\s]*)#?([^)\s]*)\)", text):
        linked = here / target if target else pages.ROOT / page
        assert linked.exists(), target
        if place:
            assert place in anchors(linked), f"{target}#{place}"


def anchors(page: Path) -> set[str]:
    """What headings of a page are linked by."""
    heads = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    plain = (re.sub(r"[^\w\- ]", "", head.lower()) for head in heads)
    return {head.replace(" ", "-") for head in plain}


def test_every_page_is_in_a_table_of_contents() -> None:
    listed: set[str] = set()
    for page in pages.PAGES:
        text = (pages.ROOT / page).read_text(encoding="utf-8")
        for tree in re.findall(r"```{toctree}\n(.*?)```", text, flags=re.DOTALL):
            for line in tree.splitlines():
                name = re.sub(r".*<(.*)>", r"\1", line)
                place = os.path.normpath(Path(page).parent / name)
                listed.add(f"{Path(place).as_posix()}.md")
    assert [page for page in pages.PAGES if page not in listed] == ["docs/index.md"]


def test_pages_are_shown_by_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["docs"]) == 0
    listed = capsys.readouterr().out
    assert "how-to/ship " in listed
    assert "flatrig/RotaryCrane-v0 " in listed
    assert main(["docs", "ship"]) == 0
    assert capsys.readouterr().out == (pages.ROOT / "docs/how-to/ship.md").read_text("utf-8")
    assert main(["docs", "shp"]) == 2
    assert "did you mean ship?" in capsys.readouterr().err


def test_examples_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    from flatrig import models

    assert main(["example", "tower"]) == 0
    tower = capsys.readouterr().out
    assert tower == (pages.ROOT / "docs/how-to/tower_crane.toml").read_text("utf-8")
    assert main(["example", "navy-3d"]) == 0
    rig, move = models.loads(capsys.readouterr().out)
    assert (rig, move) == (models.navy_crane_3d(), models.default_move("navy_crane_3d"))
    assert main(["example"]) == 0
    assert "two_finger_hand" in capsys.readouterr().out
    assert main(["example", "towr"]) == 2
    assert "did you mean tower" in capsys.readouterr().err
