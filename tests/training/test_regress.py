"""`flatrig regress`: its numbers, bands, stored baseline, resumption, and what it says."""

import dataclasses
import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.models import OptionError
from flatrig.models.mjcf import rig_model
from flatrig.training import cli
from flatrig.training.bench import accuracy
from flatrig.training.regress import baseline
from flatrig.training.regress import regression as regress
from flatrig.training.regress.row import Row
from flatrig.training.simulate import drift

KEY = ("rotary_crane", "RK4", 1e-2, "energy")


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    monkeypatch.setattr(regress, "STEPS", (1e-2,))
    monkeypatch.setattr(regress, "SUMMARY_STEP", 1e-2)


def test_the_free_rotary_crane_has_the_energy_and_momentum_of_the_source():
    """Y 2.87 to 2.91 with table 2.1, the load turning with the bridge."""
    free = drift.free_motion("rotary_crane")
    model = rig_model.compile(free.rig, timestep=1e-2, visuals=False)
    start = rig_model.joint_state(free.rig, model, free.coordinates, free.rates)
    energy, momentum = drift._conserved(model, *start, drift.cyclic(model))
    inertia = 16.67 + 2.08 + 0.26 + (50 + 3 + 10) * 1.5**2
    assert_allclose(momentum, [inertia], rtol=1e-12)
    assert_allclose(energy, inertia / 2 - 10 * 9.81 * 5, rtol=1e-12)
    lost = drift.drift(model, free)
    assert lost.energy < 1e-7
    assert lost.momentum < 1e-9


@pytest.mark.parametrize(
    ("name", "joints"),
    [
        ("overhead_crane", ["trolley.position"]),
        ("rotary_crane", ["bridge.angle"]),
        ("gantry_crane", ["gantry.position", "trolley.position"]),
        ("navy_crane_2d", []),
    ],
)
def test_what_has_a_momentum_that_stays(name, joints):
    rig = models.make(name)
    model = rig_model.compile(rig, timestep=1e-3, visuals=False)
    assert [model.joint(int(i)).name for i in drift.cyclic(model)] == joints
    found = drift.drift(model, drift.Free(rig, {}, {}))
    assert found.energy < 1e-9
    assert math.isnan(found.momentum) if not joints else found.momentum < 1e-12


def test_the_shipped_baseline_holds_the_whole_catalogue(monkeypatch):
    monkeypatch.undo()
    stored, version = baseline.read()
    missing = set(models.CATALOGUE) - {key[0] for key in stored}
    assert not missing, f"flatrig regress {' '.join(sorted(missing))} --update stores their numbers"
    assert {key[0] for key in stored} == set(models.CATALOGUE)
    assert {key[1] for key in stored} == set(rig_model.INTEGRATORS)
    assert {key[2] for key in stored} == set(regress.STEPS)
    assert version.count(".") == 2
    assert stored[KEY] < baseline.CEILINGS[KEY]


def test_mujoco_computes_what_is_stored(tmp_path):
    names = ["overhead_crane", "rotary_crane"]
    rows = regress.measure(names, tmp_path)
    found = {key: value for row in rows for key, value in row.numbers().items()}
    assert len(found) == 2 * 4 * len(rig_model.INTEGRATORS)
    stored = {key: value for key, value in baseline.read()[0].items() if key[2] == 1e-2}
    assert baseline.departures(found, stored, names) == []


def test_departures_are_named():
    stored = {KEY: 3e-8, ("a", "RK4", 1e-3, "error"): 1e-3, ("b", "RK4", 1e-3, "error"): math.inf}
    same = baseline.departures(stored, stored, {"a", "b", "rotary_crane"})
    assert same == []
    found = {KEY: 2e-7, ("a", "RK4", 1e-3, "error"): 1.06e-3, ("b", "RK4", 1e-3, "error"): 0.1}
    texts = [str(one) for one in baseline.departures(found, stored, {"a", "b", "rotary_crane"})]
    assert texts == [
        "rotary_crane, RK4, 10 ms: energy 2e-07 J, stored is 3e-08 +- 3e-09 J",
        "a, RK4, 1 ms: error 0.00106 m, stored is 0.001 +- 5e-05 m",
        "b, RK4, 1 ms: error 0.1 m, stored is inf m",
        "rotary_crane, RK4, 10 ms: energy 2e-07 J is not below 1e-07 J",
    ]
    assert baseline.departures({}, stored, {"c"}) == []
    (gone,) = baseline.departures({}, stored, {"a"})
    assert str(gone) == "a, RK4, 1 ms: error is missing, stored is 0.001 m"


def test_rounding_is_no_departure():
    key = ("a", "RK4", 1e-3, "energy")
    assert baseline.departures({key: 9e-13}, {key: 2e-12}, {"a"}) == []


def test_storing_keeps_other_models(tmp_path):
    file = tmp_path / "stored.csv"
    one = {("a", "RK4", 1e-3, "error"): 1.0, ("a", "RK4", 1e-3, "energy"): math.inf}
    two = {("b", "EULER", 2e-3, "momentum"): 0.25}
    baseline.write(file, one)
    baseline.write(file, two)
    assert baseline.read(file)[0] == one | two
    baseline.write(file, {("a", "RK4", 1e-3, "error"): 2.0})
    assert baseline.read(file)[0] == {("a", "RK4", 1e-3, "error"): 2.0} | two


def test_what_is_no_baseline(tmp_path):
    with pytest.raises(OptionError, match="--update makes it"):
        baseline.read(tmp_path / "none.csv")
    other = tmp_path / "other.csv"
    baseline.write(other, {KEY: 1.0})
    good = other.read_text()
    empty = good.rpartition("rotary_crane")[0]
    for text in ("", "a,b\n1,2\n3,4\n", "a,b,c\n", empty, good.replace(",1,", ",nan,")):
        assert text != good
        other.write_text(text)
        with pytest.raises(OptionError, match="not a table of flatrig regress"):
            baseline.read(other)


def test_exit_status_and_what_is_said(tmp_path, capsys):
    out, file = tmp_path / "out", tmp_path / "stored.csv"
    arguments = ["regress", "overhead", "-o", str(out), "--baseline", str(file)]
    assert cli.main(arguments) == 2  # nothing is stored yet
    assert cli.main([*arguments, "--update"]) == 0
    assert cli.main([*arguments, "--resume"]) == 0
    assert "all in band" in capsys.readouterr().out
    stored = baseline.read(file)[0]
    key = ("overhead_crane", "IMPLICIT", 1e-2, "arrival")
    baseline.write(file, {key: stored[key]})
    assert cli.main([*arguments, "--resume"]) == 0
    said = capsys.readouterr().out
    assert "19 numbers of overhead_crane have no stored ones" in said
    assert "all in band, 1 numbers" in said
    baseline.write(file, stored | {key: 1.2 * stored[key]})
    assert cli.main([*arguments, "--resume"]) == 1
    said = capsys.readouterr().out
    assert "overhead_crane, IMPLICIT, 10 ms: arrival" in said
    assert "1 of 20 numbers left their band" in said
    header, *rows = (out / "regress.csv").read_text().splitlines()
    assert len(rows) == len(rig_model.INTEGRATORS)
    assert all(line.count(",") == header.count(",") for line in rows)
    assert {path.name for path in out.glob("*.png")} == {"error.png", "drift.png"}


def test_resuming_computes_only_what_is_missing_or_of_another_model(tmp_path, monkeypatch):
    computed = []

    def row(unit):
        name, step = unit
        computed.append(unit)
        return [Row(name, "RK4", step, 1.0, 1.0, math.inf, math.nan, 1.0)]

    monkeypatch.setattr(regress, "_rows", row)
    first = regress.measure(["overhead_crane"], tmp_path)
    again = regress.measure(["overhead_crane", "rotary_crane"], tmp_path, resume=True)
    assert computed == [("overhead_crane", 1e-2), ("rotary_crane", 1e-2)]
    assert_allclose(dataclasses.astuple(again[0])[2:], dataclasses.astuple(first[0])[2:])
    monkeypatch.setattr(regress, "make", lambda name: models.make(name, load_mass=90.0))
    regress.measure(["overhead_crane"], tmp_path, resume=True)
    assert computed[2:] == [("overhead_crane", 1e-2)]


def test_a_run_that_breaks_down_is_infinite(tmp_path):
    rig, free = models.overhead_crane(), drift.free_motion("overhead_crane")
    reference = regress.from_move(models.default_move(rig))
    exact = regress.prepare(rig, reference, 1e-2)
    wild = dataclasses.replace(exact, inputs=1e12 * exact.inputs)
    row = regress._row(rig, reference, wild, free, "RK4", 1e-2)
    assert row.error == row.arrival == math.inf
    assert np.isfinite(row.energy)
    assert len(row.numbers()) == len(baseline.ROUNDING)
    regress.write_rows(tmp_path / "rows.csv", [row])
    (_, line) = (tmp_path / "rows.csv").read_text().splitlines()
    assert line.startswith("overhead_crane,RK4,0.01,inf,inf,")
    assert line.endswith(",,")


def test_a_crane_that_is_registered_has_rows_by_itself(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(models.CATALOGUE, "_entries", dict(models.CATALOGUE._entries))

    @models.CATALOGUE.add(move=models.default_move("overhead_crane"))
    def wall_crane():
        return dataclasses.replace(models.overhead_crane(), name="wall_crane")

    assert "wall_crane" in {case.label for case in accuracy.cases()}
    arguments = ["regress", "wall", "-o", str(tmp_path)]
    assert cli.main(arguments) == 0
    assert "20 numbers of wall_crane have no stored ones; --update" in capsys.readouterr().out
