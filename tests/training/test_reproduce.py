"""`flatrig reproduce`: the registry, and the figures that are quick to make."""

import importlib

import numpy as np
import pytest
from PIL import Image

from flatrig.training import cli
from flatrig.training.reproduce import figures_k3_loop, kiss_crane
from flatrig.training.reproduce.index import ENTRIES


@pytest.mark.parametrize("argv", [["reproduce"], ["reproduce", "K3.21", "--list"]])
def test_the_list_names_every_entry(argv, capsys):
    assert cli.main(argv) == 0
    said = capsys.readouterr().out
    for name, entry in ENTRIES.items():
        assert name in said
        assert entry.title in said


@pytest.mark.parametrize("name", ENTRIES)
def test_entries_name_functions(name):
    module, _, function = ENTRIES[name].function.partition(":")
    loaded = importlib.import_module(f"flatrig.training.reproduce.{module}")
    assert callable(getattr(loaded, function))


def test_an_unknown_name_is_one_line(capsys, tmp_path):
    assert cli.main(["reproduce", "K3.2", "-o", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "nothing to reproduce called 'K3.2'; did you mean" in said
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("name", "duration"), [("k3.15", 1.2), ("K3.16", 1.2), ("K3.18", 0.8)])
def test_a_figure_comes_with_its_numbers(name, duration, capsys, tmp_path):
    assert cli.main(["reproduce", name, "-o", str(tmp_path / "new")]) == 0
    stem = tmp_path / "new" / name.upper()
    picture, numbers = stem.with_name(f"{stem.name}.png"), stem.with_name(f"{stem.name}.csv")
    assert picture.stat().st_size < 200_000
    with Image.open(picture) as image:
        assert image.size[0] > 500
    columns = np.genfromtxt(numbers, delimiter=",", names=True)
    assert columns["time"][-1] == pytest.approx(duration)
    assert all(np.isfinite(columns[column]).all() for column in columns.dtype.names)
    assert f"wrote {picture}" in capsys.readouterr().out


def test_a_moving_reference_settles_in_half_the_time_of_a_fixed_set_point():
    """K 3.5: about 2.5 s, the time of the move, against about 5 s and more than three swings."""
    reference, fixed, tracking = figures_k3_loop.study()
    goal = np.array(kiss_crane.GOAL)
    away = (np.linalg.norm(run.outputs[:, 0, :3] - goal, axis=1) for run in (fixed, tracking))
    late, soon = (reference.times[np.flatnonzero(each > 0.01)[-1]] for each in away)
    assert soon < kiss_crane.TRAVEL
    assert 4.0 < late < 7.0
    assert fixed.tensions.min() > 0
    assert tracking.tensions.min() > 0
    start = tracking.outputs[0, 0, :2] - reference.outputs[0, :2]
    assert start == pytest.approx(kiss_crane.START_ERROR)
