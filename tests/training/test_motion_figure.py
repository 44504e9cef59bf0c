"""Figures of moves: what they show is what the motion holds."""

from pathlib import Path

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.training.cli import main
from flatrig.training.describe.motion_figure import draw

SIDE, SECOND, TENSIONS, INPUTS, SPEEDS, LENGTHS = range(6)


def figure_of(name: str):
    rig = models.make(name)
    report = feedforward.check(rig, feedforward.from_move(models.default_move(rig), rig))
    return report, draw(report, "a move").axes


def lines_of(axes) -> dict[str, np.ndarray]:
    """The labelled lines of a panel."""
    handles, labels = axes.get_legend_handles_labels()
    return {label: np.array(line.get_ydata()) for line, label in zip(handles, labels, strict=True)}


@pytest.mark.parametrize("name", ["navy_crane_2d", "luffing_crane"])
def test_a_figure_shows_the_motion(name: str) -> None:
    report, axes = figure_of(name)
    motion = report.motion
    assert list(lines_of(axes[TENSIONS])) == list(motion.rig.tension_names)
    for line, lengths in zip(lines_of(axes[LENGTHS]).values(), motion.rope_lengths.T, strict=True):
        np.testing.assert_array_equal(line, lengths)
    shares = [np.abs(line).max() for line in lines_of(axes[INPUTS]).values()]
    spare = [100.0 * (1.0 - size.spare) for size in report.sizing]
    np.testing.assert_allclose(shares, spare, rtol=1e-9)
    for line in lines_of(axes[SPEEDS]).values():  # without limits, of the largest
        assert np.abs(line).max() == pytest.approx(100.0)
    of_load = lines_of(axes[SIDE])["load"]
    np.testing.assert_allclose(of_load, motion.positions[:, motion.column("load.z")], atol=1e-9)


def test_places_are_where_ropes_are_as_long_as_they_are() -> None:
    """The hoisting rope of the planar Navy crane, from its points and from the equations."""
    rig = models.make("cable_robot")
    move = feedforward.from_move(models.default_move(rig), rig)
    motion = feedforward.solve(rig, move, np.linspace(0.0, move.duration, 7))
    places = feedforward.places_of(motion)
    for rope, lengths in zip(rig.ropes, motion.rope_lengths.T, strict=True):
        a, b = (places[name] for name in rope.path)
        np.testing.assert_allclose(np.linalg.norm(a - b, axis=1), lengths, rtol=1e-12)


def test_commands_write_the_figure(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    for command in ("analyse", "solve"):
        picture = tmp_path / f"{command}.svg"
        assert main([command, "overhead", "--plot", str(picture)]) == 0
        assert f"wrote {picture}" in capsys.readouterr().out.replace("\n", "")
        assert picture.read_text().startswith("<?xml")
    assert main(["analyse", "overhead", "--plot", str(tmp_path / "a.gif")]) == 2
    assert "a figure is a .png, .svg or .pdf file" in capsys.readouterr().err
    assert main(["analyse", "two-finger", "--plot", str(tmp_path / "a.png")]) == 2
    assert "--plot is for cranes" in capsys.readouterr().err
