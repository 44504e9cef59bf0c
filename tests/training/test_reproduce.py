"""`flatrig reproduce`: the registry, and the figures that are quick to make."""

import numpy as np
import pytest
from PIL import Image

from flatrig.training import cli, plots
from flatrig.training.reproduce import figures_k3_loop, kiss_crane
from flatrig.training.reproduce.entry import Sheet, entries, entry
from flatrig.training.reproduce.figures_y_captions import NOTES
from flatrig.training.tables import table

ENTRIES = entries()


@pytest.mark.parametrize("argv", [["reproduce"], ["reproduce", "K3.21", "--list"]])
def test_the_list_names_every_entry(argv, capsys):
    assert cli.main(argv) == 0
    said = capsys.readouterr().out
    for known in ENTRIES.values():
        assert known.name in said
        assert known.title in said


@pytest.mark.parametrize("name", ENTRIES)
def test_entries_are_named_and_titled(name):
    assert ENTRIES[name].name == name
    assert ENTRIES[name].title
    assert callable(ENTRIES[name].make)


def test_entries_stand_in_the_order_of_their_numbers():
    names = [*ENTRIES]
    assert names.index("K2.19") < names.index("K3.13") < names.index("Y2.7") < names.index("Y2.10")
    assert set().union(*NOTES) <= set(names)


def test_a_new_entry_is_one_function(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr("flatrig.training.reproduce.entry._REGISTERED", {})

    @entry("Z9.1", "nothing at all, twice", "No machine, [2] numbers.")
    def nothing():
        figure, _ = plots.figure(2.0, 2.0)
        columns = {"time": np.array([0.0, 1.0]), "what, exactly": ["none", "none"]}
        return Sheet(table("Nothing", "", "how much", rows=[("here", "0")]), figure, columns)

    assert cli.main(["reproduce"]) == 0
    assert "nothing at all, twice" in capsys.readouterr().out
    assert cli.main(["reproduce", "z9.1", "-o", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "how much" in said
    assert "Z9.1: No machine, [2] numbers." in said
    for suffix in (".png", ".csv"):
        assert f"wrote {tmp_path / 'Z9.1'}{suffix}" in said
    assert (tmp_path / "Z9.1.csv").read_text() == 'time,"what, exactly"\n0,none\n1,none\n'
    assert cli.main(["reproduce", "all", "--page", str(tmp_path / "page.md")]) == 0
    page = (tmp_path / "page.md").read_text()
    assert "No machine, [2] numbers.\n\n![Z9.1: nothing at all, twice](page/Z9.1.png)" in page
    assert (tmp_path / "page" / "Z9.1.png").exists()


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
