"""Streams in MuJoCo: under random commands with PD, and gentle ones with nothing measured."""

import numpy as np
import pytest

from flatrig import models
from flatrig.feedforward import Stream
from flatrig.models.mjcf import rig_model
from flatrig.models.mjcf.rig_state import points
from flatrig.models.mjcf.simulate import run
from flatrig.training.bench.governed import Drive, commands, drive
from flatrig.training.cli import main


@pytest.mark.parametrize("name", ["overhead_crane", "rotary_crane"])
def test_what_nobody_could_follow_is_followed_as_far_as_can_be(name):
    found = drive(Drive(name, 3, 4.0))
    assert found.wrong == []
    assert found.delivered > 0.5
    assert found.inputs <= 0.951
    assert found.tension > 0.0
    assert found.distance < 1e-5


@pytest.mark.parametrize(("name", "seconds"), [("overhead_crane", 4.0), ("rotary_crane", 2.0)])
def test_gentle_commands_at_a_kilohertz_need_no_feedback(name, seconds):
    """Nothing is measured; the benchmark's own goal is 1e-6 m after 20 s."""
    assert drift(name, seconds) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", ["overhead_crane", "rotary_crane"])
def test_gentle_commands_need_no_feedback_for_twenty_seconds(name):
    assert drift(name, 20.0) < 1e-6


def drift(name, seconds):
    """How far the load is from its reference in the end [m]."""
    rig = models.make(name)
    stream = Stream(rig, models.default_move(rig).start, rate=1000.0)
    ticks = round(seconds * stream.rate)
    gentle = 0.15 * commands(rig, 1, ticks // 10).repeat(10, axis=0)
    samples = [stream.tick(velocity) for velocity in gentle]
    model = rig_model.compile(rig, timestep=stream.period, visuals=False)
    first = samples[0]
    start = dict(zip(first.coordinate_names, first.positions, strict=True))
    state = rig_model.joint_state(rig, model, start, tensions=first.tensions)
    course = run(model, state.qpos, state.qvel, np.array([sample.inputs for sample in samples]))
    place = points(rig, course.qpos[-1:], course.qvel[-1:])["load"][0, 0]
    axes = ["xyz".index(axis) for axis in rig.axes]
    return float(np.abs(place[axes] - stream.outputs).max())


def test_table_of_streams(capsys):
    assert main(["bench", "stream", "--rig", "overhead", "--seeds", "1", "--seconds", "1"]) == 0
    assert "overhead_crane" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["--seeds", "0"], "--seeds is 0, it must be > 0"),
        (["--seconds", "0.5"], "--seconds is 0.5, it must be >= 1"),
        (["--rig", "rotery"], "rotary_crane"),
    ],
)
def test_wrong_options_get_a_line(arguments, line, capsys):
    assert main(["bench", "stream", *arguments]) != 0
    assert line in capsys.readouterr().err


def test_options_of_streams_are_for_streams(capsys):
    assert main(["bench", "--seeds", "3"]) != 0
    assert "--seeds is for `flatrig bench stream`" in capsys.readouterr().err
