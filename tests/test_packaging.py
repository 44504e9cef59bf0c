"""The wheel holds every package of the checkout, its data, and nothing else."""

import os
import posixpath
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

import pytest

ROOT = Path(__file__).resolve().parents[1]

# Folders at the top that hold no package, and of which only `DATA` ships.
NOT_SHIPPED = {"build", "dist", "docs", "results", "runs", "tests"}
AT_THE_TOP = ("CITATION.cff", "LICENSE", "__init__.py", "py.typed")
DATA = (
    "*.md",
    "CITATION.cff",
    "docs/*.md",
    "docs/*/*.md",
    *(f"docs/how-to/*.{ending}" for ending in ("py", "toml")),
    "docs/images/*",
    "docs/reference/reproduced/*",
    "models/*.xml",
    "models/*.toml",
    "training/policies/*",
    "training/baselines/*",
    *(f"training/drive/*.{ending}" for ending in ("css", "html", "js")),
)


def package_folders() -> Iterator[Path]:
    """Yield each folder of the checkout that holds Python files meant to ship."""
    for folder, subfolders, files in os.walk(ROOT):
        here = Path(folder)
        subfolders[:] = [
            name
            for name in subfolders
            if not name.startswith((".", "__"))
            and not name.endswith(".egg-info")
            and not (here == ROOT and name in NOT_SHIPPED)
            and not (here / name / "pyvenv.cfg").exists()
        ]
        if any(name.endswith(".py") for name in files):
            yield here.relative_to(ROOT)


def shipped_files() -> set[str]:
    """Return the paths, relative to the checkout, that the wheel has to hold."""
    code = {path for folder in package_folders() for path in (ROOT / folder).glob("*.py")}
    data = {path for pattern in DATA for path in ROOT.glob(pattern) if path.is_file()}
    return {path.relative_to(ROOT).as_posix() for path in code | data} | {"py.typed"}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[zipfile.ZipFile]:
    """Build the wheel from a copy, so that the checkout stays as it is, and open it."""
    source, out = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("wheel")
    for path in (*ROOT.glob("*.md"), *map(ROOT.joinpath, ("pyproject.toml", *AT_THE_TOP))):
        shutil.copy(path, source)
    for top in sorted({"docs", *(folder.parts[0] for folder in package_folders() if folder.parts)}):
        ignore = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / top, source / top, ignore=ignore)
    command = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation"]
    command += ["--no-index", "--disable-pip-version-check", "--wheel-dir", str(out), str(source)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    (path,) = out.glob("flatrig-*.whl")
    with zipfile.ZipFile(path) as opened:
        yield opened


def test_wheel_holds_the_packages_their_data_and_nothing_else(wheel: zipfile.ZipFile) -> None:
    held = {PurePosixPath(name) for name in wheel.namelist() if ".dist-info/" not in name}
    assert {path.parts[0] for path in held} == {"flatrig"}
    assert {path.relative_to("flatrig").as_posix() for path in held} == shipped_files()


def test_links_of_the_pages_travel(wheel: zipfile.ZipFile) -> None:
    """What pages link to is in the wheel, but for tests and what is no part of the package."""
    names = set(wheel.namelist())
    pages = [name for name in names if name.endswith(".md")]
    assert "flatrig/docs/how-to/ship.md" in pages
    for page in pages:
        text = wheel.read(page).decode()
        for target in re.findall(r"\]\((?!https?:)([^)#\s]+)", text):
            linked = posixpath.normpath(posixpath.join(posixpath.dirname(page), target))
            assert linked in names or linked.startswith("flatrig/tests/"), (page, target)


def test_every_package_folder_has_an_init_file() -> None:
    assert [f for f in package_folders() if not (ROOT / f / "__init__.py").exists()] == []


def test_no_module_stands_at_the_root() -> None:
    assert [path.name for path in ROOT.glob("*.py")] == ["__init__.py"]


def test_wheel_declares_command_and_licence(wheel: zipfile.ZipFile) -> None:
    info = {PurePosixPath(n).name: n for n in wheel.namelist() if ".dist-info/" in n}
    assert "flatrig = flatrig.training.cli:main" in wheel.read(info["entry_points.txt"]).decode()
    assert wheel.read(info["LICENSE"]) == (ROOT / "LICENSE").read_bytes()
    required = [
        line.removeprefix("Requires-Dist: ")
        for line in wheel.read(info["METADATA"]).decode().splitlines()
        if line.startswith("Requires-Dist: ") and "extra ==" not in line
    ]
    assert not [line for line in required if line.startswith(("torch", "stable"))]
