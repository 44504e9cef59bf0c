"""Sampled paths and CSV files: accuracy of their derivatives, what is refused and how."""

import re

import numpy as np
import pytest

from flatrig import models
from flatrig.feedforward import (
    along,
    beside,
    check,
    from_csv,
    from_move,
    input_uncertainty,
    rest_to_rest,
    sampled,
    scaled,
    solve,
    three_phase,
)
from flatrig.feedforward.paths.consistency import accept_rest
from flatrig.feedforward.paths.recordings import SampledPath
from flatrig.feedforward.paths.splines import least_squares
from flatrig.models.errors import PathError
from flatrig.models.rig.move import Move
from flatrig.training.cli import main

START, GOAL = (0.0, -4.0), (5.0, -1.0)


@pytest.mark.parametrize("order", [0, 1, 4, 6, 10])
@pytest.mark.parametrize("count", [2, 5, 40, 3001])
def test_sampled_reproduces_a_polynomial_of_its_degree(order, count):
    path = rest_to_rest(START, GOAL, 3.0, order)
    times = path.duration * np.linspace(0, 1, count) ** 1.2
    times[-1] = path.duration
    spline = sampled(times, path(times), order)
    moments = np.linspace(0, 3, 500)
    truth, computed = path.derivatives(moments, order), spline.derivatives(moments, order)
    for k in range(order + 1):
        assert np.abs(computed[k] - truth[k]).max() <= 1e-10 * np.abs(truth[k]).max()
    assert spline.knots == 1


def test_sampled_goes_through_few_points():
    points = np.array([[0.0, -4.0], [1.0, -2.5], [4.0, -3.0], [5.0, -1.0]])
    times = np.array([2.0, 3.0, 4.5, 5.0])
    path = sampled(times, points)
    assert path.duration == 3.0
    np.testing.assert_allclose(path(times - 2.0), points, atol=1e-12)
    assert path.deviation < 1e-12


@pytest.mark.parametrize(
    ("digits", "errors"),
    [(16, (1e-12, 1e-10, 1e-9, 1e-7, 2e-6)), (6, (2e-7, 2e-6, 2e-5, 2e-4, 1e-3))],
)
def test_sampled_keeps_the_fourth_derivative_of_a_recording(digits, errors):
    """3001 points of a path that is no polynomial of the spline's degree, as a file has them."""
    path = rest_to_rest(START, GOAL, 3.0, order=9)
    times = np.linspace(0, 3, 3001)
    spline = sampled(times, np.round(path(times), digits))
    moments = np.linspace(0, 3, 1777)
    truth, computed = path.derivatives(moments, 4), spline.derivatives(moments, 4)
    for k, error in enumerate(errors):
        assert np.abs(computed[k] - truth[k]).max() <= error * np.abs(truth[k]).max()
    assert spline.deviation <= 1e-6


def test_sampled_is_continuous_at_its_knots():
    path = sampled((0.0, 1.0, 1.5, 3.0), ((0, -4), (2, -2), (3, -3), (5, -1)))
    largest = np.abs(path.derivatives(np.linspace(0, 3, 999), 9)).max(axis=(1, 2))
    for knot in (1.0, 1.5):
        before, after = path.derivatives([knot - 1e-13, knot + 1e-13], 8).swapaxes(0, 1)
        assert (np.abs(after - before).max(axis=1) <= 1e-9 * largest[:9]).all()


def test_noisy_recording_needs_a_tolerance():
    path = rest_to_rest(START, GOAL, 3.0)
    times = np.linspace(0, 3, 1001)
    points = np.round(path(times), 3)
    with pytest.raises(PathError, match=r"scatter by about 0.0005 .* pass tolerance >= 0.000"):
        sampled(times, points)
    spline = sampled(times, points, tolerance=1e-3)
    error = spline.derivatives(times, 4) - path.derivatives(times, 4)
    assert np.abs(error[0]).max() < 1e-12


def test_a_recording_that_starts_with_a_jump_is_no_path():
    times = np.linspace(0.0, 40.0, 401)
    points = np.stack((np.full_like(times, 12.0), np.sin(0.8 * times)), axis=1)
    with pytest.raises(PathError, match=r"column 1 starts at a speed of 0\.79\d per second"):
        sampled(times, points)


def recording(path, rate, noise):
    """Points of a path at a rate [Hz], with noise of a standard deviation [m]."""
    times = np.linspace(0, path.duration, round(path.duration * rate) + 1)
    scatter = noise * np.random.default_rng(7).standard_normal((len(times), path.size))
    return times, path(times) + scatter


RECORDED = {
    "three-phase": three_phase(START, GOAL, 6.0, blend=1.3),
    "rest to rest": rest_to_rest(START, GOAL, 3.0, order=9),
    "curve": along((START, (2, -3.5), (3, -3), (4, -2), GOAL), 9.0, order=6),
}


@pytest.mark.parametrize("noise", [0.0, 1e-6, 1e-4])
@pytest.mark.parametrize("rate", [50, 500])
@pytest.mark.parametrize("name", RECORDED)
def test_what_a_recording_costs_in_the_inputs_is_known(name, rate, noise):
    """Against the inputs of the path that was recorded: never far too little, seldom too much."""
    path, rig = RECORDED[name], models.overhead_crane()
    spline = sampled(*recording(path, rate, noise), tolerance=max(1e-6, 7 * noise))
    times = np.linspace(0, path.duration, 1001)
    truth, motion = solve(rig, path, times), solve(rig, spline, times)
    error = np.abs(motion.inputs - truth.inputs).max(axis=0)
    largest = np.abs(truth.inputs).max(axis=0)
    estimate = input_uncertainty(motion, spline)
    assert (estimate >= error / 3).all()
    assert (estimate <= 4 * error + 0.03 * largest).all()


@pytest.mark.parametrize("noise", [0.0, 1e-6, 1e-4])
@pytest.mark.parametrize("rate", [50, 500])
@pytest.mark.parametrize("name", RECORDED)
def test_knots_are_chosen_for_the_highest_derivative(name, rate, noise):
    """Hardly any other number of pieces would have been better, judged by the path itself."""
    path = RECORDED[name]
    times, points = recording(path, rate, noise)
    moments = np.linspace(0, path.duration, 2001)
    truth = path.derivatives(moments, 4)[4]

    def error(derivative):
        return np.abs(derivative - truth).max() / np.abs(truth).max()

    chosen = error(
        sampled(times, points, tolerance=max(1e-6, 7 * noise)).derivatives(moments, 4)[4]
    )
    pieces = np.unique(np.geomspace(4, len(times) - 1, 16).round().astype(int))
    others = [least_squares(rate * times, points, 4, count) for count in pieces]
    best = min(error(rate**4 * spline(rate * moments, nu=4)) for spline in others)
    assert chosen <= 5 * best + 1e-6


def test_only_recordings_are_uncertain(tmp_path):
    rig, path = models.overhead_crane(), RECORDED["three-phase"]
    times = np.linspace(0, 6, 301)
    few = sampled((0.0, 2.0, 4.0, 6.0), ((0, -4), (2, -3), (3, -2), (5, -1)))
    for known in (path, few, scaled(path, 7.0)):
        assert input_uncertainty(solve(rig, known, times), known) is None
        assert all(part.uncertain == 0 for part in check(rig, known).sizing)
    recorded = sampled(*recording(path, 50, 0.0))
    motion = solve(rig, recorded, times)
    uncertain = input_uncertainty(motion, recorded)
    assert [part.uncertain for part in check(rig, recorded, rate=50).sizing] == list(uncertain)
    slow = scaled(recorded, 12.0)
    slower = input_uncertainty(solve(rig, slow, 2 * times), slow)
    assert 12 < uncertain[0] / slower[0] < 17  # as the fourth derivative, 2^4
    columns = beside(
        sampled(recorded.times, np.array(recorded.points)[:, :1]), rest_to_rest([-4], [-1], 6.0)
    )
    assert input_uncertainty(solve(rig, columns, times), columns)[0] > 0


@pytest.mark.parametrize("command", ["solve", "analyse"])
def test_commands_say_what_a_recording_costs(command, tmp_path, monkeypatch, capsys):
    times, points = recording(RECORDED["three-phase"], 50, 0.0)
    np.savetxt(tmp_path / "path.csv", np.column_stack((times, points)), delimiter=",")
    (tmp_path / "move.toml").write_text('[move]\nprofile = "sampled"\nsamples = "path.csv"\n')
    monkeypatch.chdir(tmp_path)
    assert main([command, "overhead", "--move", "move.toml"]) == 0
    said = re.search(r"inputs uncertain by about: trolley (\S+) N, winch", capsys.readouterr().out)
    assert 1 < float(said[1]) < 15
    assert main([command, "overhead"]) == 0
    assert "uncertain" not in capsys.readouterr().out


# CSV files


def write(folder, text):
    file = folder / "path.csv"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize("header", ["", "time,load.x,load.z\n", "\ufefftime, x, z\r\n\r\n"])
def test_csv(tmp_path, header):
    file = write(tmp_path, header + "0, 0, -4\n1.5,2,-2\n\n3,5,-1\n")
    assert from_csv(file) == sampled((0, 1.5, 3), ((0, -4), (2, -2), (5, -1)))
    assert from_csv(str(file), 2, size=2).order == 2


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "path.csv has 0 point(s), a path needs 2 or more"),
        ("t,x\n0,1\n", "path.csv has 1 point(s), a path needs 2 or more"),
        ("t,x\n0,1\n1,a\n", "path.csv line 3, column 2 is 'a', it must be a number"),
        ("0,abc\n1,2\n", "path.csv line 1, column 2 is 'abc', it must be a number"),
        ("0,1\n1,\n", "path.csv line 2, column 2 is '', it must be a number"),
        ("t,x\n0,1\n\n1,nan\n", "path.csv line 4, column 2 is nan, it must be finite"),
        ("0,1\ninf,2\n", "path.csv line 2, column 1 is inf, it must be finite"),
        ("0,1\n1,2\n1,3\n", "path.csv line 3: time 1 s follows 1 s, times must increase"),
        ("0,1\n1,2,3\n", "path.csv line 2 has 3 columns, the first has 2"),
        ("0\n1\n", "path.csv has 1 columns, it needs a time and at least one output"),
    ],
)
def test_csv_errors(tmp_path, text, message):
    with pytest.raises(PathError) as caught:
        from_csv(write(tmp_path, text))
    assert str(caught.value).endswith(message)
    assert "\n" not in str(caught.value)


def test_csv_with_other_outputs_or_unreadable(tmp_path):
    with pytest.raises(PathError, match="has 2 columns, it needs a time and 3 outputs"):
        from_csv(write(tmp_path, "0,1\n1,2\n"), size=3)
    with pytest.raises(PathError, match=r"cannot read .*missing.csv: No such file"):
        from_csv(tmp_path / "missing.csv")
    with pytest.raises(PathError, match="cannot read"):
        from_csv(tmp_path)
    (tmp_path / "picture.csv").write_bytes(b"\x89PNG\xff\xfe\x00")
    with pytest.raises(PathError, match="is not a text file: byte 0x89 at 0"):
        from_csv(tmp_path / "picture.csv")


def test_from_sampled_move(tmp_path):
    file = str(write(tmp_path, "0,0,-4\n3,5,-1\n"))
    assert from_move(Move(profile="sampled", samples=file, order=5)) == from_csv(file, 5)
    with pytest.raises(PathError, match="has 3 columns, it needs a time and 1 outputs"):
        from_move(Move(start=(0.0,), profile="sampled", samples=file))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sampled([0], [[1]]), "the path has 1 point(s), it needs 2 or more"),
        (lambda: sampled([0, 1], [[1], [np.nan]]), "point 1, column 2 is nan, it must be finite"),
        (lambda: sampled([0, 0], [[1], [2]]), "point 1: time 0 s follows 0 s, times must increase"),
        (lambda: sampled([0, 1], [1, 2]), "points have shape (2,), for 2 times they need shape"),
        (lambda: sampled([0, 1], [[1], ["a"]]), "points must be numbers"),
        (lambda: sampled([0, 1], [[1], [2]], 11), "order is 11, it must be a whole number from 0"),
        (lambda: sampled([0, 1], [[1], [2]], tolerance=-1), "tolerance is -1, it must be finite"),
        (lambda: sampled([0, 1], [[1], [2]], tolerance="x"), "tolerance is 'x', it must be finite"),
        (lambda: sampled([0, 1], [[1], [2]], tolerance=None), "tolerance is None, it must be fin"),
        (lambda: sampled([0, 1], [[1], [2e12]]), "point 1, column 2 is 2e+12, it must be within"),
        (lambda: sampled([-1e308, 1e308], [[1], [2]]), "point 0, column 1 is -1e+308, it must be"),
        (lambda: SampledPath((0, 1), ((1,), (2, 3))), "points must be numbers, of shape (N, size)"),
        (lambda: SampledPath((0, "a"), ((1,), (2,))), "times must be numbers in s"),
        (lambda: sampled([0, 1], [[1], [2]]).derivatives([0], 31), "order of the derivatives is"),
        (lambda: sampled([0, 1e-300], [[1], [2]]), "duration is 1e-300 s, it must be > 0"),
        (lambda: sampled([0, 1e-300, 1], [[1], [2], [3]]), "the points are too unevenly spaced"),
    ],
)
def test_errors(call, message):
    with pytest.raises(PathError, match="^" + re.escape(message)) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_a_column_that_does_not_move_starts_at_rest():
    """The spline's rounding of a constant is no motion, however small the others' derivatives."""
    times = np.linspace(0.0, 40.0, 401)
    moving = rest_to_rest((0.0,), (6.0,), 40.0, order=4)(times)[:, 0]
    path = sampled(times, np.column_stack((moving, np.full_like(times, -12.0))), order=4)
    derivatives = path.derivatives(np.linspace(-1.0, 41.0, 85), 4)
    assert (derivatives[0, :, 1] == -12.0).all()
    assert not derivatives[1:, :, 1].any()
    accept_rest(path, ("load.x", "load.z"), 4)
