"""What each part of the package loads, and which part may import which."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

SIMULATION = ["mujoco", "gymnasium"]
PLOTS = ["matplotlib"]
LEARNING = ["torch", "stable_baselines3"]

NOT_LOADED = {
    "flatrig": [*SIMULATION, *PLOTS, *LEARNING, "numpy"],
    "flatrig.models": [*SIMULATION, *PLOTS, *LEARNING],
    "flatrig.feedforward": [*SIMULATION, *PLOTS, *LEARNING],
    "flatrig.envs": [*PLOTS, *LEARNING],
    "flatrig.training": [*PLOTS, *LEARNING],
    "flatrig.training.cli": [*PLOTS, *LEARNING],
}

# training -> envs -> {feedforward, models}; feedforward -> models
MAY_IMPORT = {
    "models": {"models"},
    "feedforward": {"feedforward", "models"},
    "envs": {"envs", "feedforward", "models"},
    "training": {"training", "envs", "feedforward", "models"},
}


@pytest.mark.parametrize("module", NOT_LOADED)
def test_import_loads_only_what_it_needs(module: str, tmp_path: Path) -> None:
    code = f"import sys, {module}; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    loaded = {name.partition(".")[0] for name in done.stdout.split()}
    assert sorted(loaded & set(NOT_LOADED[module])) == []


def imported_parts(path: Path) -> set[str]:
    """Return the parts of the package that a file names in its imports, inside functions too."""
    package = ["flatrig", *path.relative_to(ROOT).parent.parts]
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            stem = ".".join([*base, *([node.module] if node.module else [])])
            names |= {f"{stem}.{alias.name}" for alias in node.names}
    parts = [name.split(".") for name in names]
    return {part[1] for part in parts if part[0] == "flatrig" and part[1:]} & set(MAY_IMPORT)


@pytest.mark.parametrize("part", MAY_IMPORT)
def test_imports_point_one_way(part: str) -> None:
    files = sorted((ROOT / part).rglob("*.py"))
    assert files
    wrong = {
        str(path.relative_to(ROOT)): sorted(imported_parts(path) - MAY_IMPORT[part])
        for path in files
        if imported_parts(path) - MAY_IMPORT[part]
    }
    assert wrong == {}
