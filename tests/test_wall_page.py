"""The page docs/how-to/over_a_wall.md: what stands around, and ways over it."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import feedforward, models
from flatrig.models import Box, Move, PathError, Sphere
from flatrig.training.cli import main

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "how-to" / "over_a_wall.md"
CRANE = PAGE.with_suffix(".toml")
RIG, MOVE = models.load(CRANE)
SPACE = Move((0.0, 0.0, -4.0), (4.0, 2.0, -4.0), duration=8.0)


def test_the_page_shows_the_file_and_its_example_runs(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    text = PAGE.read_text()
    shown = text.split("```toml")[1].split("```")[0]
    assert tomllib.loads(shown) == tomllib.loads(CRANE.read_text())
    exec(text.split("```python")[1].split("```")[0], {})
    assert capsys.readouterr().out == "load is 0.1398 m from wall at 7.664 s\n"


def test_its_commands_say_what_the_page_says(monkeypatch, capsys, tmp_path):
    monkeypatch.chdir(ROOT)
    lines = PAGE.read_text().split("```sh")[1].split("```")[0].strip().splitlines()
    for line, status in zip(lines, (0, 1, 0), strict=True):
        command, _, said = line.partition("#")
        words = command.replace("wall.png", str(tmp_path / "wall.png")).split()[1:]
        assert main(words) == status
        assert said.strip() in capsys.readouterr().out
    assert (tmp_path / "wall.png").exists()


def test_how_near_a_way_comes_is_as_by_hand(capsys):
    """The load's distance from the wall's edge, from the parabola's own formula."""
    assert main(["analyse", str(CRANE), "--json"]) == 0
    near = json.loads(capsys.readouterr().out)["clearance"]
    s = np.linspace(0.0, 1.0, 200_001)[:, None]
    start, goal, rise = (np.array(v) for v in (MOVE.start, MOVE.goal, MOVE.rise))
    way = start + (goal - start) * s + 4.0 * rise * s * (1.0 - s)
    wall, tank = MOVE.obstacles
    outside = np.maximum(np.maximum(wall.low - way, way - wall.high), 0.0)
    by_hand = np.linalg.norm(outside, axis=1).min() - MOVE.load_radius
    assert near["distance_m"] == pytest.approx(by_hand, abs=1e-6)
    assert near["obstacle"] == "wall"
    assert isinstance(tank, Sphere)


def test_waypoints_are_passed_and_the_ends_are_at_rest():
    points = ((1.0, 1.0, -2.0), (3.0, 1.0, -2.5))
    path = feedforward.from_move(replace(SPACE, waypoints=points))
    times = np.linspace(0.0, path.duration, 4001)
    places = path.derivatives(times, 1)
    for point in (SPACE.start, *points, SPACE.goal):
        assert np.linalg.norm(places[0] - point, axis=1).min() < 2e-3
    assert_allclose(places[1][[0, -1]], 0.0, atol=1e-12)


def test_a_rise_keeps_the_profile_of_the_move():
    """Its middle is lifted when a straight way of the same profile is half done."""
    flat = replace(SPACE, profile="three_phase", blend=2.0)
    straight, lifted = (
        feedforward.from_move(replace(flat, rise=rise)) for rise in ((), (0.0, 0.0, 1.5))
    )
    times = np.linspace(0.0, 8.0, 41)
    s = straight.derivatives(times, 0)[0][:, 0] / 4.0
    found = lifted.derivatives(times, 0)[0] - straight.derivatives(times, 0)[0]
    assert_allclose(found[:, 2], 6.0 * s * (1.0 - s), atol=1e-12)
    assert_allclose(found[:, :2], 0.0, atol=1e-12)


def test_obstacles_are_written_and_read():
    curved = replace(MOVE, rise=(), waypoints=((4.0, 1.0, -3.0),))
    for move in (MOVE, curved):
        assert models.loads(models.dumps(RIG, move)) == (RIG, move)


WRONG = {
    "both": (lambda: replace(SPACE, rise=(0, 0, 1), waypoints=((1, 1, 1),)), "not both"),
    "short rise": (lambda: replace(SPACE, rise=(1.0,)), r"rise is \(1.0,\), it needs 3 numbers"),
    "short point": (lambda: replace(SPACE, waypoints=((1, 2),)), "a waypoint is .* needs 3"),
    "no obstacle": (lambda: replace(SPACE, obstacles=("wall",)), "it must be a Sphere or a Box"),
    "radius": (lambda: replace(SPACE, load_radius=-1.0), "load_radius is -1.0"),
    "centre": (
        lambda: Sphere("tank", (0, 0), 1.0),
        r"centre of tank is \(0, 0\), it must be three",
    ),
    "corners": (lambda: Box("hall", (0, 0, 0), (1, -1, 1)), "low of hall"),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_cannot_be_gets_one_line(case):
    build, message = WRONG[case]
    with pytest.raises(PathError, match=message):
        build()


FILES = {
    "radios": ("radius = 0.9", "radios = 0.9", "obstacle 'tank' has no 'radios'; did you mean"),
    "no radius": ("radius = 0.9", "", "obstacle 'tank' needs radius; a sphere has"),
    "in the move": ("rise =", "obstacles = []\nrise =", "obstacles stand beside the move"),
}


@pytest.mark.parametrize("case", FILES)
def test_wrong_files_get_one_line(case, capsys, tmp_path):
    old, new, message = FILES[case]
    file = tmp_path / "wrong.toml"
    file.write_text(CRANE.read_text().replace(old, new))
    assert main(["analyse", str(file)]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert said.count("\n") == 1
