"""What `check` says about moves that can be made and moves that cannot."""

import re
from pathlib import Path

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.feedforward import RestToRest, check, from_move, rest_to_rest
from flatrig.models import OptionError, PathError, RigError
from flatrig.training.cli import main

GRAVITY = 9.81


@pytest.mark.parametrize("name", models.CATALOGUE)
def test_the_catalogue_s_moves_are_feasible(name):
    rig = models.make(name)
    report = check(rig, from_move(models.default_move(rig)), rate=50.0)
    assert report.problems == ()
    assert report.feasible
    assert report.smooth
    assert [part.drive for part in report.sizing] == list(rig.input_names)
    assert all(part.within and 0 <= part.spare <= 1 for part in report.sizing)


def test_the_printed_move_of_the_planar_navy_crane():
    """Y 6.1.2: the tagline would push, and would still at the final rest pose."""
    rig = models.navy_crane_2d()
    report = check(rig, from_move(models.printed_move(rig)), rate=2000.0)
    assert not report.feasible
    assert report.smooth
    assert {part.rope for part in report.slack} == {"tagline"}
    assert min(part.lowest for part in report.slack) == pytest.approx(-9177, abs=1)
    assert "rope tagline would have to push at rest at the goal (-231.3 N)" in str(report.problems)
    assert re.search(r"drive tagline would need 990\S* N m at 2.04", str(report.problems))


def test_the_printed_move_of_the_navy_crane_in_space():
    """Y 6.2.2: four derivatives are too few, and the suspension rope would push."""
    rig = models.navy_crane_3d()
    report = check(rig, from_move(models.printed_move(rig)))
    assert not report.smooth
    assert report.problems[0].startswith("the path has 4 continuous derivatives")
    assert report.problems[0].endswith("needs 6")
    (slack,) = report.slack
    assert slack.rope == "suspension"
    assert slack.lowest == pytest.approx(-405, abs=0.5)
    assert slack.end - slack.start > 10.0
    assert report.motion.tensions[-1, 1] == pytest.approx(-6.859, abs=1e-3)


def test_the_printed_move_of_the_crane_with_a_massless_pulley():
    """Y 6.1.1: in 3 s the tagline would push down to -442 N, in 5 s it need not."""
    rig = models.navy_crane_2d(pulley_mass=0)
    report = check(rig, from_move(models.printed_move(rig)))
    (slack,) = report.slack
    assert (slack.rope, round(slack.lowest)) == ("tagline", -442)
    assert 1.5 < slack.start < 2.0 < slack.end < 2.5
    assert report.motion.tensions[0] == pytest.approx((0, 981), abs=1e-6)
    assert check(rig, from_move(models.default_move(rig))).feasible


def test_sizing_of_a_lift_in_closed_form():
    rig = models.overhead_crane()
    (rope,), mass, height, duration = rig.ropes, 100.0, 3.0, 4.0
    report = check(rig, rest_to_rest((0, -5), (0, -2), duration), rate=5000.0)
    s = np.linspace(0, 1, 20_001)
    _, speed, slope = RestToRest(4).derivatives(s, 2)
    speed, acceleration = height * speed / duration, height * slope / duration**2
    pull = mass * (GRAVITY + acceleration) + rope.inertia_along * acceleration
    trolley, winch = report.sizing
    radius = rope.drum_radius
    assert winch.largest == pytest.approx(radius * np.abs(pull).max(), rel=1e-6)
    assert winch.when == pytest.approx(duration * s[pull.argmax()], abs=1e-3)
    assert winch.rms == pytest.approx(radius * np.sqrt(np.mean(pull**2)), rel=1e-3)
    assert winch.speed == pytest.approx(speed.max() / radius, rel=1e-6)
    assert winch.rpm == pytest.approx(60 * speed.max() / radius / (2 * np.pi), rel=1e-6)
    assert winch.power == pytest.approx((pull * speed).max(), rel=1e-6)
    assert winch.braking == pytest.approx(0, abs=1e-9)
    assert (winch.unit, trolley.unit, trolley.rpm) == ("N m", "N", None)
    assert trolley.largest == pytest.approx(0, abs=1e-9)
    down = check(rig, rest_to_rest((0, -2), (0, -5), duration), rate=5000.0).sizing[1]
    lowered = mass * GRAVITY - (mass + rope.inertia_along) * acceleration
    assert down.braking == pytest.approx((lowered * speed).max(), rel=1e-6)


def test_everything_wrong_is_said_at_once():
    rig = models.overhead_crane()
    report = check(rig, rest_to_rest((0, -4), (9, -1), 2.0, order=3))
    said = "\n".join(report.problems)
    assert "3 continuous derivatives" in said
    assert "trolley would be at 9 m at 2 s, rail beam goes from -2 m to 8 m" in said
    assert "drive trolley would need" in said
    assert report.motion.rig is rig
    assert all("\n" not in problem for problem in report.problems)


def test_a_path_without_a_solution_says_where_it_ends():
    report = check(models.overhead_crane(), rest_to_rest((0, -4), (5, 1), 3.0))
    assert report.motion is None
    assert report.sizing == ()
    assert re.search(r"at t = 1\.\d+ s \(load.x = ", report.obstructed)
    assert report.problems == (report.obstructed,)


def test_what_is_wrong_with_rig_or_rate_is_raised():
    path = rest_to_rest((0, -4), (5, -1), 3.0)
    rig = models.overhead_crane()
    for rate, said in ((0.0, "rate is 0.0 Hz"), (np.nan, "rate is nan"), (1e12, "samples")):
        with pytest.raises(OptionError, match=said):
            check(rig, path, rate=rate)
    with pytest.raises(PathError, match="3 columns"):
        check(rig, rest_to_rest((0, 0, -4), (5, 1, -1), 3.0))
    with pytest.raises(RigError, match="no printed move"):
        models.printed_move("overhead")


def test_analyse_reports_a_printed_move(capsys):
    assert main(["analyse", "navy-crane-3d", "--move", "printed"]) == 1
    out = capsys.readouterr().out
    assert "problem: the path has 4 continuous derivatives" in out
    assert "problem: rope suspension would have to push from" in out
    assert "What the drives need" in out
    assert "The move is not feasible." in out


def test_analyse_takes_a_move_from_a_file(capsys, tmp_path):
    file = tmp_path / "move.toml"
    file.write_text("[move]\nstart = [0.0, -6.0]\ngoal = [0.0, -2.0]\nduration = 9.0\n")
    assert main(["analyse", "overhead", "--move", str(file), "--shortest"]) == 0
    out = capsys.readouterr().out
    assert "(0, -6) to (0, -2) m in 9 s" in out
    assert "The move is feasible without friction." in out
    duration = float(re.search(r"shortest duration for this path is (\S+) s", out)[1])
    crane = models.overhead_crane()
    shorter = rest_to_rest((0, -6), (0, -2), 0.99 * duration)
    assert not check(crane, shorter).feasible
    assert check(crane, rest_to_rest((0, -6), (0, -2), 1.001 * duration)).feasible


def test_analyse_says_so_where_no_duration_helps(capsys):
    assert main(["analyse", "navy_crane_2d", "--move", "printed", "--shortest"]) == 1
    out = capsys.readouterr().out
    assert re.search(r"No duration is enough: .* rope tagline is -231", out)
    assert main(["analyse", "overhead", "--duration", "1e6", "--order", "3"]) == 1
    assert "problem: the path has 3 continuous derivatives" in capsys.readouterr().out


WRONG_FILES = {
    "none": (None, "No such file"),
    "not TOML": ("start = [", "not TOML"),
    "no move": ("[moves]\n", "has no [move]"),
    "wrong name": ("[move]\nstrat = [0.0]\n", "did you mean start"),
}


@pytest.mark.parametrize("case", WRONG_FILES)
def test_a_file_without_a_move_gets_one_line(case, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text, said = WRONG_FILES[case]
    if text is not None:
        Path("move.toml").write_text(text)
    assert main(["analyse", "overhead", "--move", "move.toml"]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert said in err


def test_reports_are_of_the_path_that_was_given():
    rig = models.navy_crane_3d()
    path = from_move(models.printed_move(rig))
    report = check(rig, path, rate=20.0)
    assert report.reference is path
    assert report.order_needed == feedforward.analyse(rig).reference_order == 6
