"""What each part of the package loads, and which part may import which."""

import subprocess
import sys
from pathlib import Path

import pytest
import rooms

SIMULATION = ["mujoco", "gymnasium"]
PLOTS = ["matplotlib"]
LEARNING = ["torch", "stable_baselines3"]
SLOW = ["scipy.interpolate", "scipy.linalg", "scipy.optimize", "scipy.sparse", "scipy.stats"]

NOT_LOADED = {
    "flatrig": [*SIMULATION, *PLOTS, *LEARNING, "numpy"],
    "flatrig.models": [*SIMULATION, *PLOTS, *LEARNING, *SLOW],
    "flatrig.feedforward": [*SIMULATION, *PLOTS, *LEARNING, *SLOW],
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

CRANES_APART_FROM_HANDS = {
    "envs": {"envs/crane", "envs/hand"},
    "envs/crane": {"envs/hand"},
    "envs/hand": {"envs/crane"},
    "models/rig": {"models/hand"},
    "models/hand": {"models/rig"},
}

PARALLEL_ROOMS = (["models/hand", "models/rig"], ["envs/crane", "envs/hand"])


@pytest.mark.parametrize("module", NOT_LOADED)
def test_import_loads_only_what_it_needs(module: str, tmp_path: Path) -> None:
    code = f"import sys, {module}; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    loaded = set(done.stdout.split())
    assert sorted(loaded & set(NOT_LOADED[module])) == []


@pytest.fixture(scope="module")
def graph() -> rooms.Graph:
    """Which file imports which."""
    return rooms.arrows()


@pytest.mark.parametrize("part", MAY_IMPORT)
def test_imports_point_one_way(part: str, graph: rooms.Graph) -> None:
    inside = {file: taken for file, taken in graph.items() if file.split("/")[0] == part}
    assert inside
    allowed = MAY_IMPORT[part]
    assert [(f, t) for f in inside for t in graph[f] if t.split("/")[0] not in allowed] == []


def test_no_imports_run_in_a_circle(graph: rooms.Graph) -> None:
    assert rooms.circles(graph) == []


def test_rooms_have_an_order(graph: rooms.Graph) -> None:
    """Where no circle joins rooms, they can be put one above the other: no arrow runs up."""
    assert rooms.circles(rooms.between_rooms(graph)) == []


@pytest.mark.parametrize("room", CRANES_APART_FROM_HANDS)
def test_cranes_and_hands_share_a_core_that_knows_neither(room: str, graph: rooms.Graph) -> None:
    forbidden = CRANES_APART_FROM_HANDS[room]
    inside = [file for file in graph if rooms.room_of(file) == room]
    assert inside
    assert [(f, t) for f in inside for t in graph[f] if rooms.room_of(t) in forbidden] == []


def test_a_file_name_stands_once() -> None:
    """Unless it is one role, played for cranes in one room and for hands in its neighbour."""
    places: dict[str, list[str]] = {}
    for file in rooms.files():
        folder, _, name = file.rpartition("/")
        places.setdefault(name, []).append(folder)
    for name in ("__init__.py", "__main__.py"):
        places.pop(name, None)
    several = {name: folders for name, folders in places.items() if len(folders) > 1}
    assert {name: f for name, f in several.items() if sorted(f) not in PARALLEL_ROOMS} == {}


def test_circles_and_arrows_are_seen(tmp_path: Path) -> None:
    """The walk itself: imports inside functions, of modules, of names, and through doors."""
    for name, text in {
        "models/__init__.py": "from .a import x",
        "models/a.py": "x = 1\ndef f():\n    from .rig import b",
        "models/rig/__init__.py": "",
        "models/rig/b.py": "from ..a import x",
        "envs/c.py": "import flatrig.models.a\nfrom ..models import x",
    }.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    small = rooms.arrows(tmp_path)
    assert small["envs/c.py"] == {"models/a.py", "models/__init__.py"}
    assert rooms.circles(small) == [["models/a.py", "models/rig/b.py"]]
    assert rooms.between_rooms(small)["envs"] == {"models"}
    assert rooms.circles(rooms.between_rooms(small)) == [["models", "models/rig"]]
