"""What a script sees of a command: its exit status, one line on stderr, and JSON on stdout."""

import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.training.as_json import json_text, plain
from flatrig.training.cli import main
from flatrig.training.compare.contenders import BASE, CONTENDERS

DOCS = Path(__file__).resolve().parents[2] / "docs" / "reference" / "command_line.md"
QUICK = ["--duration", "2"]
"""In which the overhead crane cannot make its move."""
CHANGE = f"change of rmse against {BASE}"
LOOSE = """
name = "loose"
dimensions = 2
outputs = ["load.x", "load.z"]
home = {trolley = 0.0, hook = [0.0, 0.0, -8.0], load = [0.0, 0.0, -11.0]}
rails = [{name = "beam", direction = [1.0, 0.0, 0.0]}]
trolleys = [{name = "trolley", mass = 500.0, rail = "beam"}]
loads = [{name = "hook", mass = 200.0}, {name = "load", mass = 2000.0}]
ropes = [
    {name = "hoist", path = ["trolley", "hook"], drum_radius = 0.2, winch_inertia = 5.0},
    {name = "lower", path = ["hook", "load"], drum_radius = 1.0, winch_inertia = 1.0},
]
drives = [
    {name = "trolley", on = "trolley", limit = 8e3},
    {name = "hoist", on = "hoist", limit = 8e3},
]
move = {start = [0.0, -11.0], goal = [10.0, -9.0], duration = 12.0, order = 6}
"""
PULLS = "finger1 leaves its friction cone by up to"

NO = {
    "weak drive": (["analyse", "overhead", *QUICK], "drive trolley would need 1969 N at"),
    "weak drive, table": (["solve", "overhead", *QUICK, "-o", "a"], "drive trolley would need"),
    "slack rope": (["solve", "navy-2d", "--move", "printed", "-o", "a"], "rope tagline would have"),
    "rough path": (["analyse", "overhead", "--order", "2"], "rig overhead_crane needs 4"),
    "rough path, table": (["solve", "overhead", "--order", "2", "-o", "a", "--force"], "needs 4"),
    "through the rail": (["analyse", "overhead", "--goal", "5", "1"], "t = 1."),
    "through the rail, table": (["solve", "overhead", "--goal", "5", "1", "-o", "a"], "t = 1."),
    "past the rail's end": (["solve", "overhead", "--goal", "9", "-1", "-o", "a"], "rail beam"),
    "compared": (["compare", "overhead", *QUICK, "-o", "a"], "drive trolley would need"),
    "filmed": (["render", "overhead", *QUICK, "-o", "a.png"], "drive trolley would need"),
    "trained on": (["train", "overhead", *QUICK, "-o", "a"], "drive trolley would need"),
    "pulling finger": (["analyse", "three-finger", "--move", "printed"], PULLS),
    "pulling finger, table": (["solve", "three-finger", "--move", "printed", "-o", "a"], PULLS),
    "pulling finger, compared": (
        ["compare", "ball-on-plate", "--duration", "0.1", "-o", "a"],
        "of its friction at the best squeeze",
    ),
    "weak motor": (
        ["solve", "two-finger", "--set", "mass=50", "-o", "a"],
        "motor left.slide1 would need",
    ),
    "off the plate": (
        ["solve", "ball-in-corner", "--set", "plate_radius=0.005", "-o", "a"],
        "cannot make the move: from t =",
    ),
}


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("case", NO)
def test_a_move_that_cannot_be_made_is_no_for_every_command(
    case: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    if "finger" in case or "motor" in case:
        pytest.importorskip("clarabel")
    monkeypatch.setattr("importlib.util.find_spec", lambda name: True)  # of training's packages
    argv, why = NO[case]
    assert main(argv) == 1
    err = capsys.readouterr().err
    assert err.startswith("flatrig: the move is not feasible: ")
    assert why in err
    assert err.count("\n") == 1
    assert not list(Path().iterdir())


@pytest.mark.parametrize(
    "argv",
    [
        ["solve", "overhead", *QUICK, "-o", "a.csv"],
        ["solve", "navy-2d", "--move", "printed", "--hold", "-o", "a.csv"],
        ["render", "overhead", *QUICK, "-o", "a.png"],
    ],
    ids=" ".join,
)
def test_force_goes_on_all_the_same(
    argv: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    blank = np.zeros((4, 12, 3), np.uint8)
    monkeypatch.setattr("flatrig.models.looks.render.backend", lambda: "")
    monkeypatch.setattr("flatrig.training.film.filming.Film.strip", lambda self: blank)
    assert main([*argv, "--force"]) == 0
    out, err = capsys.readouterr()
    assert f"wrote {argv[-1]}" in out
    assert re.fullmatch(r"flatrig: warning: the move is not feasible: .* more problem\S*\n", err)
    assert Path(argv[-1]).exists()


def told(capsys: pytest.CaptureFixture[str], *argv: str, status: int = 0) -> dict[str, Any]:
    """What a command says as JSON; there is nothing else on stdout, nor NaN in it."""
    assert main([*argv, "--json"]) == status
    out, err = capsys.readouterr()
    found = json.loads(out, parse_constant=pytest.fail)
    assert isinstance(found, dict)
    assert err.startswith("flatrig: ") if status or found.get("feasible", True) is None else not err
    page = DOCS.read_text(encoding="utf-8")
    assert [key for key in keys(found) if f"`{key}`" not in page] == []
    return found


def keys(value: Any) -> Iterator[str]:
    """All keys in it, but not the controllers' names."""
    if isinstance(value, list):
        for entry in value:
            yield from keys(entry)
    elif isinstance(value, dict):
        for key, entry in value.items():
            yield key
            yield from keys(list(entry.values()) if key in ("controllers", CHANGE) else entry)


def test_the_catalogue_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    found = told(capsys, "list")
    assert [crane["name"] for crane in found["cranes"]] == list(models.CATALOGUE)
    assert [hand["name"] for hand in found["hands"]] == list(models.HAND_CATALOGUE)
    crane = found["cranes"][0]
    assert crane["outputs"] == ["load.x", "load.z"]
    assert [each["unit"] for each in crane["inputs"]] == ["N", "N m"]
    assert crane["move"]["duration_s"] == 3.0


@pytest.mark.parametrize("duration", [3.0, 2.0])
def test_an_analysis_as_json(duration: float, capsys: pytest.CaptureFixture[str]) -> None:
    move = models.Move((0, -4), (5, -1), duration)
    argv = ("analyse", "overhead", "--duration", str(duration), "--equations", "--shortest")
    found = told(capsys, *argv, status=int(duration < 3))
    rig, path = models.overhead_crane(), feedforward.from_move(move)
    motion = feedforward.solve(rig, path, np.linspace(0, duration, 2001))
    assert found["feasible"] is (duration == 3.0)
    assert len(found["problems"]) == (2 if duration < 3 else 0)
    assert found["friction_counted"] is False
    assert found["structure"]["index"] == 5
    for drive, inputs in zip(found["drives"], motion.inputs.T, strict=True):
        assert drive["largest"] == pytest.approx(np.abs(inputs).max(), rel=1e-4)
    (rope,) = found["ropes"]
    assert rope["tension_lowest_N"] == pytest.approx(motion.tensions.min(), rel=1e-4)
    (trolley,) = found["trolleys"]
    assert trolley["rail_end_m"] == 8.0
    assert 2.0 < found["shortest"]["duration_s"] < 3.0
    assert len(found["equations"]) == found["structure"]["equations"]


def test_an_analysis_without_a_motion_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    found = told(capsys, "analyse", "overhead", "--goal", "5", "1", "--shortest", status=1)
    assert found["feasible"] is False
    assert found["drives"] == found["ropes"] == found["trolleys"] == []
    assert found["shortest"] is None
    slack = told(capsys, "analyse", "navy-2d", "--move", "printed", status=1)["slack"]
    assert slack[0]["rope"] == "tagline"
    assert min(part["lowest_N"] for part in slack) == pytest.approx(-9177, abs=1)


def test_a_crane_that_is_not_flat_is_an_answer(capsys: pytest.CaptureFixture[str]) -> None:
    """A second winch, between hook and load, which no drive holds still."""
    Path("loose.toml").write_text(LOOSE)
    found = told(capsys, "analyse", "loose.toml", "--shortest", status=1)
    assert found["structure"]["flat"] is False
    assert found["feasible"] is False
    assert found["shortest"] is None
    assert "is not flat" in found["problems"][0]
    assert main(["solve", "loose.toml"]) == 2  # there is nothing to solve


def test_an_analysis_of_a_hand_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("clarabel")
    found = told(capsys, "analyse", "two-finger")
    assert found["feasible"] is True
    assert found["structure"]["flat"] is True
    assert found["least_norm"][0]["friction_used"] is None  # it does not press
    assert found["in_cones"][0]["friction_used"] == pytest.approx(0.8, abs=1e-6)
    assert len(found["motors"]) == 4
    found = told(capsys, "analyse", "three-finger", "--move", "printed", status=1)
    assert found["structure"]["flat"] is None
    assert found["in_cones"] is found["motors"] is None
    assert PULLS in found["problems"][0]


def test_without_a_solver_it_is_not_known_whether_a_hand_can(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "clarabel", None)
    assert told(capsys, "analyse", "two-finger")["feasible"] is None


@pytest.mark.parametrize(
    ("name", "module", "duration"),
    [("roped-overhead", "compare_cranes", "3"), ("two-finger", "compare_hands", "1")],
)
def test_a_comparison_as_json(
    name: str,
    module: str,
    duration: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    few = {name: CONTENDERS[name] for name in ("feedforward", BASE)}
    monkeypatch.setattr("flatrig.training.compare.contenders.CONTENDERS", few)
    monkeypatch.setattr(f"flatrig.training.compare.{module}.draw", lambda *_: None)
    found = told(capsys, "compare", name, "--nominal", "--duration", duration, "-o", "out")
    assert found == json.loads(Path("out/summary.json").read_text())
    assert set(found["controllers"]) == {BASE, "feedforward"}
    for metrics in found["controllers"].values():
        assert set(metrics) == set(found["units"])
        assert set(metrics["rmse"]) == {"mean", "low", "high"}
    assert found["controllers"][BASE]["largest"]["mean"] < 0.01


def test_a_mistake_leaves_stdout_empty(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyse", "overheat", "--json"]) == 2
    assert capsys.readouterr().out == ""


def test_what_json_has_no_number_for_is_null() -> None:
    facts = {"a": math.nan, "b": [np.inf, np.float64(1.5)], "c": np.array([[1, 2]]), "d": (True,)}
    assert plain(facts) == {"a": None, "b": [None, 1.5], "c": [[1, 2]], "d": [True]}
    assert json.loads(json_text(facts)) == plain(facts)
