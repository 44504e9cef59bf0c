"""The bench of worlds counts steps, and says what is missing."""

import importlib.util

import pytest

from flatrig import models
from flatrig.training.bench import world_speed
from flatrig.training.cli import main


def test_without_its_packages_one_line_names_the_extra(monkeypatch, capsys):
    find = importlib.util.find_spec
    monkeypatch.setattr(
        "importlib.util.find_spec", lambda name: None if name == "warp" else find(name)
    )
    assert main(["bench", "warp"]) == 2
    said = capsys.readouterr().err
    assert "worlds need the package warp: pip install 'flatrig[warp]'" in said
    assert len(said.splitlines()) == 1


@pytest.mark.filterwarnings("ignore")
def test_worlds_are_timed_beside_c(monkeypatch):
    pytest.importorskip("mujoco_warp")
    monkeypatch.setattr(world_speed, "SIZES", (1, 2))
    monkeypatch.setattr(world_speed, "STEPS", 1)
    lines = world_speed.speed_table(models.make("overhead"), 1)
    sizes, worlds, c = (list(column.cells) for column in lines.columns)
    assert sizes == ["1", "2"]
    assert all(float(speed) > 0 for speed in (*worlds, *c))
