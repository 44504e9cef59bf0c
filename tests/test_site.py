"""The site of the documentation: what it is made of, and where Sphinx is installed, the site."""

import ast
import importlib
import importlib.util
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from types import ModuleType

import pytest

from flatrig import envs
from flatrig.models import Hand, HandMove, Move, Rig
from flatrig.models.rig.obstacles import OBSTACLES
from flatrig.models.rig.toml import PARTS, SEA
from flatrig.training.describe import documented, environment_page, toml_page

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("models", "feedforward", "envs", "training")


@pytest.fixture
def api(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "docs" / "site"))
    found = importlib.import_module("api")
    if not importlib.util.find_spec("sphinx"):
        missing = [extra for extra in found.EXTRAS if not importlib.util.find_spec(extra)]
        if missing:
            pytest.skip(f"needs {', '.join(missing)}, or sphinx, which does without")
    return found


def test_every_public_name_is_on_a_page(api: ModuleType, tmp_path: Path) -> None:
    api.write(tmp_path)
    text = "\n".join(path.read_text(encoding="utf-8") for path in tmp_path.glob("*.rst"))
    shown = set()
    for place, names in re.findall(
        r"currentmodule:: (\S+)\n\n\.\. (?:py:data|auto\w+):: (\w+)", text
    ):
        shown.add(id(api.thing(place, names)))
    for place in api.PACKAGES:
        for name in api.module(place).__all__:
            assert id(api.thing(place, name)) in shown, f"{place}.{name}"
    for page in ROOT.glob("docs/**/*.md"):
        found = re.findall(r"from (flatrig\.training\S*) import (.*)", page.read_text("utf-8"))
        for place, names in found:
            for name in names.split(", "):
                assert name in api.MODULES.get(place, ()), f"{page.name}: {place}.{name}"


def test_constants_say_what_they_are(api: ModuleType) -> None:
    for place, names in api.public().items():
        for name in names:
            assert "py:data" not in api.entry(place, name) or api.comment(place, name), name


def docstrings() -> Iterator[tuple[str, str]]:
    """Where each docstring of the package stands, and what it says."""
    for path in (path for room in ROOMS for path in sorted((ROOT / room).rglob("*.py"))):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.Module):
                where = f"{path.relative_to(ROOT)}: {getattr(node, 'name', '')}"
                yield where, ast.get_docstring(node) or ""


def test_no_text_follows_a_section_without_a_heading() -> None:
    """It would be read as one more parameter, or one more exception."""
    for where, text in docstrings():
        lines, section = text.split("\n"), ""
        for before, line, after in zip(["", *lines], lines, [*lines[1:], ""], strict=False):
            if after and not after.strip("-"):
                section = line
            elif section not in ("", "Notes") and line.strip("-") and not line.startswith(" "):
                assert after.startswith("    ") or before, f"{where}, after {section}: {line}"


@pytest.mark.parametrize(
    "name", [envs.OWN, "CableRobot", "NavyShipCrane", "TandemLift", "TwoFingerHand-v0"]
)
def test_pages_of_environments_tell_every_entry(name: str) -> None:
    text = environment_page.environment_page(name)
    env = environment_page.made(environment_page.full_id(name), sensors="full")
    entries = (*env.action_names, *env.observation_names, *env.reasons[1:])
    assert all(f"| `{entry}` |" in text for entry in entries)
    assert "nan" not in text


def test_units_of_observations_are_those_of_the_crane() -> None:
    page = environment_page.environment_page("rotarycrane")
    # The scales by hand: the load hangs 5 m below its trolley, a drive's error counts 0.05 of that.
    rate = (9.81 / 5.0) ** 0.5
    assert "| 8 | `winch.error` | reference - measured | 0.25 m |" in page
    assert f"| 5 | `winch.rate` | measured | {5.0 * rate:.4g} m/s |" in page
    assert f"| 34 | `hoist.tension` | pull of the rope or link | {100 * 9.81:.4g} N |" in page
    assert f"D = {0.0125 * 5.0:.4g} m" in page


def test_options_of_environments_are_all_told() -> None:
    for task in (envs.CraneTask, envs.HandTask):
        told = documented.parameter_texts(task)
        names = set(task.__init__.__annotations__) - {"return"}
        assert set(told) == names
        assert all(told.values())


def test_the_page_of_toml_has_every_field() -> None:
    text = toml_page.toml_page()
    for kind in (Rig, *PARTS.values(), *SEA.values(), *OBSTACLES, Move, Hand, HandMove):
        names = {item.name for item in fields(kind)}
        names -= {*PARTS, *SEA, "obstacles", "masses", "held", "fingers", "surface"}
        assert [name for name in names if f"| `{name}` |" not in text] == []
    assert "<class" not in text
    assert "typing." not in text


@pytest.mark.slow
def test_the_site_is_built_without_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("sphinx", reason="needs the extra docs; `make docs` builds the site")
    command = [sys.executable, str(ROOT / "docs" / "site" / "build.py"), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "html" / "docs" / "reference" / "environments" / "index.html").exists()
