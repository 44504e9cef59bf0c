"""All cranes and hands in one table: lines, files, the page, resumption, and mistakes."""

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from flatrig.training.cli import main
from flatrig.training.compare import compare_all
from flatrig.training.compare.all_report import cells_of, heads_of, lines_of, score_rows
from flatrig.training.compare.contenders import BASE, CONTENDERS, Contender


def estimate(value: float) -> dict[str, float]:
    return {"mean": value, "low": 0.9 * value, "high": 1.1 * value}


def score(error: float, ratio: float | None = None) -> dict[str, Any]:
    return {
        "rmse": estimate(error), "median": error, "worst": 2 * error, "settled": 0.5,
        "early_ends": 1, "hold": [error] * 6, "drift": estimate(1.0), "against": "b",
        "ratio": ratio and estimate(ratio), "worse": ratio and 0.25,
    }  # fmt: skip


CRANE = {
    "rig": "tall_crane",
    "sets": [
        {"name": "own", "title": "", "episodes": 4, "controllers": {
            "a": score(0.1), "b": score(0.2), "c": score(0.3), "d": score(0.4, 2.0)}},
        {"name": "random", "title": "", "episodes": 4, "controllers": {
            "a": score(0.3, 3.0), "b": score(0.1), "c": score(0.05), "d": score(0.02, 0.2)}},
    ],
}  # fmt: skip


@pytest.fixture
def contenders(monkeypatch: pytest.MonkeyPatch) -> None:
    made = [
        Contender("a", lambda env: env),
        Contender("b", lambda env: env),
        Contender("c", lambda env: env, sensors="full"),
        Contender("d", lambda env: env, sensors="encoders", learned=True),
    ]
    names = {entry.name: entry for entry in made}
    monkeypatch.setattr("flatrig.training.compare.all_report.CONTENDERS", names)


@pytest.mark.usefixtures("contenders")
def test_each_set_of_sensors_has_its_best_and_its_learned_controller() -> None:
    lines = list(lines_of(CRANE))
    assert [(line.sensors, line.controller, line.learned) for line in lines] == [
        ("encoders", "b", False),
        ("encoders", "d", True),
        ("full", "c", False),
    ]
    assert heads_of(["own", "random"], full=True) == [
        "own", "random", "worst 5 %", "ratio", "worse", "early ends",
    ]  # fmt: skip
    learned = cells_of(lines[1], ["own", "random"], full=True)
    assert learned == ["400", "20.0", "40.0", "0.20 [0.18, 0.22]", "25 %", "2"]
    assert cells_of(lines[1], ["random"]) == ["20.0", "40.0", "0.20", "2"]
    assert cells_of(lines[0], ["own"]) == ["200", "", "2"]


def test_the_csv_has_a_row_for_each_crane_set_and_controller() -> None:
    columns, rows = score_rows([CRANE])
    table = [dict(zip(columns, row, strict=True)) for row in rows]
    assert [(row["set"], row["controller"]) for row in table] == [
        (name, controller) for name in ("own", "random") for controller in "abcd"
    ]
    assert table[7]["ratio mean"] == 0.2
    assert table[7]["rmse low"] == pytest.approx(0.018)
    assert table[5]["ratio mean"] is None


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two models of all, and two controllers."""
    for name, model in (("CATALOGUE", "overhead_crane"), ("HAND_CATALOGUE", "ball_on_plate")):
        monkeypatch.setattr(compare_all, name, [model])
    two = {name: CONTENDERS[name] for name in ("PD, moving", BASE)}
    monkeypatch.setattr("flatrig.training.compare.contenders.CONTENDERS", two)


@pytest.mark.usefixtures("few")
def test_all_are_compared_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    page = tmp_path / "docs/reference/comparison.md"
    argv = ["compare", "all", "--scenarios", "1", "--episodes", "1", "--sets", "reversed"]
    argv += ["-o", str(tmp_path / "out"), "--page", str(page)]
    assert main(argv) == 0
    out = capsys.readouterr().out
    assert "encoders: FF + PD" in out
    assert "ball on plate" in out
    text = page.read_text()
    assert "| overhead | encoders | FF + PD |" in text
    assert "| ball on plate | PD, moving |" in text
    assert "`flatrig compare all --scenarios 1 --episodes 1 --sets reversed --page" in text
    assert (tmp_path / "docs/images/comparison.png").read_bytes().startswith(b"\x89PNG")
    with (tmp_path / "out/comparison.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["set"] for row in rows] == ["own"] * 2 + ["reversed"] * 2
    first = json.loads((tmp_path / "out/comparison.json").read_text())
    alone = json.loads((tmp_path / "out/overhead_crane/summary.json").read_text())
    assert first["cranes"] == [alone]
    error = alone["sets"][0]["controllers"][BASE]["rmse"]["mean"]
    assert float(rows[1]["rmse mean"]) == pytest.approx(error, rel=1e-5)

    def none(*_: object) -> None:
        raise AssertionError("it is kept already")

    monkeypatch.setattr(compare_all, "_of_crane", none)
    monkeypatch.setattr(compare_all, "_of_hand", none)
    assert main([*argv, "--resume", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == first


@pytest.mark.usefixtures("few")
def test_one_that_fails_does_not_stop_the_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def failing(_: object) -> None:
        raise ValueError("no such luck")

    monkeypatch.setattr(compare_all, "_of_crane", failing)
    monkeypatch.setattr(compare_all, "_of_hand", failing)
    assert main(["compare", "all", "--scenarios", "1", "-o", str(tmp_path)]) == 1
    told = capsys.readouterr().err
    assert "not compared: overhead_crane: no such luck" in told
    assert "not compared: ball_on_plate: no such luck" in told
    assert json.loads((tmp_path / "comparison.json").read_text()) == {"cranes": [], "hands": []}


@pytest.mark.parametrize(
    ("argv", "complaint"),
    [
        (["all", "--goal", "1"], "--goal is for one crane or hand, not for all"),
        (["all", "--policy", "a"], "--policy is for one crane or hand, not for all"),
        (["all", "--sets", "owl"], "no set of episodes 'owl'"),
        (["overhead", "--page", "a.md"], "--page is for `flatrig compare all`, not for overhead"),
        (["two-finger", "--sets", "own"], "are for cranes"),
    ],
)
def test_mistakes_are_said_in_one_line(
    argv: list[str], complaint: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["compare", *argv, "-o", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert complaint in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()
