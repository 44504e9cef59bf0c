"""`flatrig regress`: its stored baseline, resumption, and what it says."""

import math
from dataclasses import replace

import mujoco
import pytest

from flatrig import models
from flatrig.models import OptionError
from flatrig.models.mjcf import rig_model
from flatrig.training import cli
from flatrig.training.bench import accuracy
from flatrig.training.regress import baseline, crane_rows, hand_rows, quantities, row
from flatrig.training.regress import regression as regress
from flatrig.training.regress.baseline import Stored
from flatrig.training.regress.row import Row

KEY = ("rotary_crane", "RK4", 1e-2, "energy")
CRANE = ("error", "arrival", "tension", "tension rms", "energy", "momentum")


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    """One coarse step, short runs of hands, and MuJoCo's log as it was."""
    monkeypatch.setattr(crane_rows, "STEPS", (1e-2,))
    monkeypatch.setattr(hand_rows, "STEPS", (2e-3,))
    log = mujoco.MjLogConfig.get()
    yield
    log.set()


def test_the_shipped_baseline_holds_the_whole_catalogue(monkeypatch):
    monkeypatch.undo()
    stored, version = baseline.read()
    names = {*models.CATALOGUE, *models.HAND_CATALOGUE}
    missing = names - {key[0] for key in stored}
    assert not missing, f"flatrig regress {' '.join(sorted(missing))} --update stores their numbers"
    assert {key[0] for key in stored} == names
    for name in names:
        room = hand_rows if name in models.HAND_CATALOGUE else crane_rows
        expected = {(kind, step) for kind in rig_model.INTEGRATORS for step in room.STEPS}
        assert {key[1:3] for key in stored if key[0] == name} == expected
    assert {key[3] for key in stored} == set(quantities.QUANTITIES)
    assert version.count(".") == 2
    assert stored[KEY].value < baseline.CEILINGS[KEY]


def test_stored_bands_would_show_a_fault_of_half_a_percent():
    """Tension, energy and momentum that are nothing but rounding have no such band."""
    sharp = {"error", "arrival", "slip", "away", "turned", "force", "friction", "creep"}
    for key, (value, band) in baseline.read()[0].items():
        if key[3] in sharp and math.isfinite(value):
            assert band < 5e-3 * value, key


def test_departures_are_named():
    error = ("a", "RK4", 1e-3, "error"), ("b", "RK4", 1e-3, "error")
    stored = {KEY: Stored(3e-8, 1e-10), error[0]: Stored(1e-3, 1e-8), error[1]: Stored(math.inf, 0)}
    same = {key: entry.value for key, entry in stored.items()}
    assert baseline.departures(same, stored, {"a", "b", "rotary_crane"}) == []
    found = {KEY: 2e-7, error[0]: 1.00002e-3, error[1]: 0.1}
    texts = [str(one) for one in baseline.departures(found, stored, {"a", "b", "rotary_crane"})]
    assert texts == [
        "rotary_crane, RK4, 10 ms: energy 2e-07 J, stored is 3e-08 +- 1e-10 J",
        "a, RK4, 1 ms: error 0.00100002 m, stored is 0.001 +- 1e-08 m",
        "b, RK4, 1 ms: error 0.1 m, stored is inf m",
        "rotary_crane, RK4, 10 ms: energy 2e-07 J is not below 1e-07 J",
    ]
    assert baseline.departures({}, stored, {"c"}) == []
    (gone,) = baseline.departures({}, stored, {"a"})
    assert str(gone) == "a, RK4, 1 ms: error is missing, stored is 0.001 m"
    assert gone.size == math.inf


def test_a_number_that_does_not_repeat_says_nothing():
    key = ("a", "RK4", 1e-3, "error")
    assert baseline.departures({key: 0.9}, {key: Stored(0.1, math.inf)}, {"a"}) == []
    assert baseline.departures({key: math.inf}, {key: Stored(0.1, math.inf)}, {"a"}) == []
    assert len(baseline.departures({key: math.inf}, {key: Stored(0.1, 0.01)}, {"a"})) == 1


def test_storing_keeps_other_models(tmp_path):
    file = tmp_path / "stored.csv"
    one = {
        ("a", "RK4", 1e-3, "error"): Stored(1.0, 1e-8),
        ("a", "RK4", 1e-3, "energy"): Stored(math.inf, 0.0),
    }
    two = {("b", "EULER", 2e-3, "momentum"): Stored(0.25, math.inf)}
    baseline.write(file, one)
    baseline.write(file, two)
    assert baseline.read(file)[0] == one | two
    new = {("a", "RK4", 1e-3, "error"): Stored(2.0, 1e-8)}
    baseline.write(file, new)
    assert baseline.read(file)[0] == new | two


def test_what_is_no_baseline(tmp_path):
    with pytest.raises(OptionError, match="--update makes it"):
        baseline.read(tmp_path / "none.csv")
    other = tmp_path / "other.csv"
    baseline.write(other, {KEY: Stored(1.0, 0.5)})
    good = other.read_text()
    for text in (
        "",
        "a,b\n1,2\n3,4\n",
        "a,b,c\n",
        good.rpartition("rotary_crane")[0],
        good.replace(",1,", ",nan,"),
        good.replace(",0.5", ",-0.5"),
        good.replace(",0.5", ""),
        good.replace("energy", "colour"),
    ):
        assert text != good
        other.write_text(text)
        with pytest.raises(OptionError, match="not a table of flatrig regress"):
            baseline.read(other)


def test_exit_status_and_what_is_said(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(row, "REPEATS", 1)
    out, file = tmp_path / "out", tmp_path / "stored.csv"
    arguments = ["regress", "overhead", "-o", str(out), "--baseline", str(file)]
    assert cli.main(arguments) == 2  # nothing is stored yet
    assert cli.main([*arguments, "--update"]) == 0
    pictures = {path.name for path in out.glob("*.png")}
    assert pictures == {"error.png", "tension.png", "drift.png"}
    monkeypatch.setattr(regress.regression_figures, "draw", lambda rows, folder: [])
    assert cli.main(arguments) == 0
    count = len(CRANE) * len(rig_model.INTEGRATORS)
    assert f"all in band, {count} numbers" in capsys.readouterr().out
    stored = baseline.read(file)[0]
    key = ("overhead_crane", "IMPLICIT", 1e-2, "arrival")
    baseline.write(file, {key: stored[key]})
    assert cli.main([*arguments, "--resume"]) == 0
    said = capsys.readouterr().out
    assert f"{count - 1} numbers of overhead_crane have no stored ones" in said
    assert "all in band, 1 numbers" in said
    value, band = stored[key]
    baseline.write(file, stored | {key: Stored(value + 1.1 * band, band)})
    assert cli.main([*arguments, "--resume"]) == 1
    said = capsys.readouterr().out
    assert "overhead_crane, IMPLICIT, 10 ms: arrival" in said
    assert f"1 of {count} numbers left their band" in said
    header, *rows = (out / "regress.csv").read_text().splitlines()
    assert len(rows) == count + len(rig_model.INTEGRATORS)  # and the costs
    assert all(line.count(",") == header.count(",") for line in rows)
    assert sum(line.endswith(",no") for line in rows) == 1


def test_only_the_largest_departures_are_listed(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(regress, "MOST_NAMED", 2)
    monkeypatch.setattr(regress.regression_figures, "draw", lambda rows, folder: [])
    file = tmp_path / "stored.csv"
    arguments = ["regress", "overhead", "-o", str(tmp_path), "--baseline", str(file)]
    place = ("overhead_crane", "RK4", 1e-2)
    wrong = {"error": 1e3, "arrival": 2.0, "energy": 1e-3}
    baseline.write(file, {(*place, name): Stored(value, 0.0) for name, value in wrong.items()})
    assert cli.main(arguments) == 1
    said = capsys.readouterr().out
    assert "and 1 more, all in" in said
    assert said.count("stored is") == 2


def test_a_hand_is_named_as_a_crane_is(tmp_path, monkeypatch, capsys):
    asked = []

    def rows(name, step, repeat):
        asked.append((name, step, repeat))
        return [Row(name, kind, step, 1.0, {"slip": 1.0}) for kind in rig_model.INTEGRATORS]

    monkeypatch.setattr(hand_rows, "rows", rows)
    arguments = ["regress", "ball-on-plate", "-o", str(tmp_path)]
    assert cli.main(arguments) == 1
    assert asked == [("ball_on_plate", 2e-3, False)]
    assert "is missing" in capsys.readouterr().out
    assert {path.name for path in tmp_path.glob("*.png")} == {"slip.png"}


def test_resuming_computes_only_what_is_missing_or_of_another_model(tmp_path, monkeypatch):
    computed = []

    def rows(unit):
        name, step, _ = unit
        computed.append(unit)
        return [Row(name, "RK4", step, 1.0, {"error": 1.0, "energy": math.inf}, {"error": 0.5})]

    monkeypatch.setattr(regress, "rows_of", rows)
    first = regress.measure(["overhead_crane"], tmp_path)
    again = regress.measure(["overhead_crane", "rotary_crane"], tmp_path, resume=True)
    assert computed == [("overhead_crane", 1e-2, False), ("rotary_crane", 1e-2, False)]
    assert again[0] == first[0]
    monkeypatch.setattr(regress, "make", lambda name: models.make(name, load_mass=90.0))
    regress.measure(["overhead_crane"], tmp_path, resume=True)
    assert computed[2:] == [("overhead_crane", 1e-2, False)]


def test_a_crane_that_is_registered_has_rows_by_itself(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(models.CATALOGUE, "_entries", dict(models.CATALOGUE._entries))
    monkeypatch.setattr(regress.regression_figures, "draw", lambda rows, folder: [])

    @models.CATALOGUE.add(move=models.default_move("overhead_crane"))
    def wall_crane():
        return replace(models.overhead_crane(), name="wall_crane")

    assert "wall_crane" in {case.label for case in accuracy.cases()}
    arguments = ["regress", "wall", "-o", str(tmp_path)]
    assert cli.main(arguments) == 0
    assert "30 numbers of wall_crane have no stored ones; --update" in capsys.readouterr().out
