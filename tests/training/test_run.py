"""`flatrig run`: one episode, whose table, figure and numbers are those of the environment."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from flatrig import models
from flatrig.envs import Scenario
from flatrig.training.cli import main
from flatrig.training.compare.chosen import chosen
from flatrig.training.simulate.one_episode import simulate


def episode_of(name: str, controller: str, scenario: Scenario):
    rig = models.make(name)
    choice = chosen(controller, "crane", rig)[0]
    return simulate(rig, models.default_move(rig), choice, scenario, hold=1.0)


def test_the_plant_as_described_keeps_to_its_plan() -> None:
    episode = episode_of("rotary", "ff+pd", Scenario())
    assert np.abs(episode.errors).max() < 1e-3
    assert episode.ended == ""
    assert episode.times[-1] == pytest.approx(21.0)


def test_energy_at_the_end_is_that_of_the_lifted_load() -> None:
    episode = episode_of("overhead", "ff+pd", Scenario(load_mass=1.2))
    rises = episode.outputs[-1, 1] - episode.outputs[0, 1]
    weight = 1.2 * episode.rig.loads[0].mass * 9.81
    assert episode.energy[-1, 1] == pytest.approx(weight * rises, rel=1e-6)
    # At rest at the end, but for what PD leaves of a swing.
    assert abs(episode.energy[-1, 0]) < 1e-2 * episode.energy[:, 0].max()


def test_the_table_holds_the_episode(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["run", "overhead", "--controller", "ff+pd", "--scenario", "load_mass=1.2", "--json"]
    assert main([*words, "--hold", "1", "-o", str(tmp_path / "out")]) == 0
    found = json.loads(capsys.readouterr().out)
    episode = episode_of("overhead", "ff+pd", Scenario(load_mass=1.2))
    with (tmp_path / "out" / "run.csv").open() as file:
        rows = list(csv.DictReader(file))
    for name, values in {
        "time": episode.times,
        "load.z": episode.outputs[:, 1],
        "load.x.planned": episode.planned[:, 0],
        "winch.input": episode.inputs[:, 1],
        "hoist.tension": episode.tensions[:, 0],
        "kinetic.energy": episode.energy[:, 0],
    }.items():
        np.testing.assert_allclose([float(row[name]) for row in rows], values, rtol=1e-8, atol=1e-8)
    distance = np.linalg.norm(episode.errors, axis=1)
    assert found["error_largest_m"] == pytest.approx(distance.max())
    assert found["scenario"] == {"load_mass": 1.2}
    with Image.open(tmp_path / "out" / "run.png") as picture:
        assert picture.size == (1536, 1056)


def test_an_early_end_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["run", "overhead", "--controller", "ff", "--scenario", "load_mass=2"]
    assert main([*words, "-o", str(tmp_path)]) == 1
    assert "the episode ended at 2.08 s: off the rail" in capsys.readouterr().err


WRONG = {
    "two": (["--controller", "pd,ff"], "one episode has one controller"),
    "no controller": (["--controller", "pdd"], "did you mean"),
    "scenario": (["--scenario", "wand=2"], "there is no 'wand'; did you mean wind?"),
    "both": (["--scenario", "wind=2", "--seed", "1"], "take one of them"),
    "hold": (["--hold", "-1"], "--hold is -1 s"),
    "file": (["-o", "run.csv"], "several files are written"),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_words_get_one_line(case: str, capsys: pytest.CaptureFixture[str]) -> None:
    words, message = WRONG[case]
    assert main(["run", "overhead", *words]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert said.count("\n") == 1
