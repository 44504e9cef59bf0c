"""Streams: what is said tick by tick is what `solve` says of the path that was commanded."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.feedforward import Commanded, Stream, analyse, base_at, connected, from_move, solve
from flatrig.feedforward.exact.problem import problem_of
from flatrig.feedforward.series.products import factorials
from flatrig.feedforward.streaming.command_filter import CommandFilter
from flatrig.feedforward.streaming.prediction import of_stops
from flatrig.models import OptionError, PathError, RigError

OWN = Path(__file__).parents[2] / "docs" / "how-to"


def commands(rig, count, speed=0.3, hold=20, seed=1):
    """Random velocities, shape (count, outputs), of angles a tenth."""
    angles = {angle for platform in rig.platforms for angle in platform.angles}
    scale = speed * np.array([0.1 if name in angles else 1.0 for name in rig.outputs])
    draws = np.random.default_rng(seed).uniform(-1, 1, (count // hold + 1, len(scale)))
    return np.repeat(draws * scale, hold, axis=0)[:count]


def driven(stream, velocities):
    return [stream.tick(velocity) for velocity in velocities]


def agree(stream, samples, digits=1e-11):
    """What the samples say is what `solve` says of the stream's reference."""
    times = np.array([sample.time for sample in samples])
    middles = times + 0.5 * stream.period
    instants = np.concatenate((times, middles))
    motion = solve(stream.rig, stream.reference, instants, begin=stream.begin)
    n = len(times)
    for name in ("positions", "velocities", "tensions", "drive_positions", "drive_velocities"):
        truth = getattr(motion, name)[:n]
        said = np.array([getattr(sample, name) for sample in samples])
        assert_allclose(said, truth, rtol=0, atol=digits * np.abs(truth).max(), err_msg=name)
    truth = motion.inputs[n:]
    said = np.array([sample.inputs for sample in samples])
    assert_allclose(said, truth, rtol=0, atol=digits * np.abs(truth).max())
    return motion


@pytest.mark.parametrize("order", [1, 4, 6])
def test_filter_is_its_differential_equation(order):
    """(T s + 1)^n y' = v, applied to what the filter says its derivatives are."""
    filter = CommandFilter(0.4, order)
    rng = np.random.default_rng(order)
    state = rng.normal(size=(order + 2, 3))
    derivatives = filter.readout(order + 1) @ state
    weights = np.polynomial.polynomial.polypow([1.0, 0.4], order)
    assert_allclose(weights @ derivatives[1:], state[-1], rtol=1e-10, atol=1e-12)
    later = filter.step(0.7) @ state
    assert_allclose(filter.advanced(state[None], np.array([0.7]))[0], later, rtol=1e-12)
    soon = filter.readout(1) @ filter.step(0.7 + 1e-6) @ state
    slope = (soon - filter.readout(1) @ later) / 1e-6
    assert_allclose(slope, (filter.readout(2) @ later)[1:], rtol=1e-4, atol=1e-5)
    assert_allclose((filter.readout(order) @ filter.state_of(derivatives)), derivatives[:-1])
    stop = filter.step(filter.resting()) @ filter.state_of(derivatives)
    assert_allclose(stop[0], filter.rest(state), rtol=1e-12)
    assert np.abs(stop[1:]).max() < 1e-12


def test_what_is_foreseen_of_a_command_is_its_moment_and_a_stop():
    """By matrix exponentials there, in closed form here."""
    filter, moment = CommandFilter(0.4, 4), 0.01
    prediction = of_stops(problem_of(models.rotary_crane()), filter, moment, moment)
    state = np.random.default_rng(0).normal(size=(6, 3))
    command = np.array([1.0, -2.0, 0.5])
    foreseen = prediction.taylor(state, command[None], 0.0)[:, 0] * factorials(5)[:, None, None]
    held, stop = state.copy(), (filter.step(moment) @ np.vstack((state[:-1], command)))
    held[-1], stop[-1] = command, 0.0
    states, knots = np.array([held, stop]), np.array([0.0, moment])
    path = Commanded(filter, knots, states, 60.0)
    truth = path.derivatives(prediction.offsets, 4)
    sizes = np.abs(truth).max(axis=1, keepdims=True)
    assert_allclose(foreseen / sizes, truth / sizes, rtol=0, atol=1e-11)


@pytest.mark.parametrize("name", models.CATALOGUE)
def test_ticks_are_the_solution_of_what_was_commanded(name):
    rig = models.make(name)
    move = models.default_move(rig)
    base = base_at(from_move(move), 0.0)
    stream = Stream(rig, move.start, base=base, rate=20.0, lag=0.5)
    samples = driven(stream, commands(rig, 40))
    assert any(np.abs(sample.velocity).max() > 0.05 for sample in samples)
    agree(stream, samples)


@pytest.mark.parametrize("file", ["tower_crane.toml", "workshop_crane.toml"])
def test_cranes_of_ones_own_are_driven_likewise(file):
    rig, move = models.load(OWN / file)
    stream = Stream(rig, move.start, rate=20.0, lag=0.5)
    agree(stream, driven(stream, commands(rig, 40)))


def test_stream_takes_over_from_a_motion_and_hands_back():
    rig = models.rotary_crane()
    path = from_move(models.default_move(rig))
    before = solve(rig, path, 8.0)
    stream = Stream(rig, before.at(8.0), rate=100.0)
    assert_allclose(stream.state.derivatives, before.at(8.0).derivatives, rtol=0, atol=1e-12)
    samples = driven(stream, commands(rig, 30))
    agree(stream, samples)
    largest = np.abs(before.inputs).max()
    start = solve(rig, stream.reference, 0.0, begin=stream.begin)
    assert_allclose(start.inputs, before.inputs, rtol=0, atol=1e-12 * largest)
    here = stream.state
    away = connected(here.derivatives, path.goal, 12.0)
    after = solve(rig, away, 0.0, begin=here)
    at = solve(rig, stream.reference, stream.time, begin=stream.begin)
    assert_allclose(after.inputs, at.inputs, rtol=0, atol=1e-12 * largest)
    assert_allclose(after.positions, at.positions, rtol=0, atol=1e-12)


def test_stream_carries_the_turns_of_a_frame():
    """More than once around the tower."""
    rig = models.rotary_crane()
    stream = Stream(rig, (5.0, 0.0, -5.0), rate=10.0, lag=0.5)
    samples = []
    for _ in range(450):
        x, y, _ = stream.outputs
        inwards = 0.3 * (5.0 - np.hypot(x, y))
        ahead = np.array([-y, x]) + inwards * np.array([x, y])
        samples.append(stream.tick((*(ahead / np.hypot(x, y)), 0.0)))
    angles = np.array([sample.drive_positions[0] for sample in samples])
    assert angles[-1] > 2.1 * np.pi
    assert np.abs(np.diff(angles)).max() < 0.1
    assert_allclose(stream.state.angles["bridge.angle"], angles[-1], atol=0.1)
    agree(stream, samples[-1:])


def test_governor_keeps_within_all_bounds_and_stops():
    rig = models.rotary_crane()
    stream = Stream(rig, (5.0, 0.0, -5.0), rate=50.0, share=0.9, margin=10.0)
    wild = commands(rig, 150, speed=3.0, hold=50)
    samples = driven(stream, wild)
    let = np.abs([sample.velocity for sample in samples]).sum(axis=0)
    assert (let < 0.95 * np.abs(wild).sum(axis=0)).any()
    assert (let > 0.3 * np.abs(wild).sum(axis=0)).all()
    while not stream.resting:
        samples.append(stream.stop())
    assert stream.time < 15.0
    reference = stream.reference
    fine = solve(rig, reference, np.arange(0.0, stream.time, 0.005), begin=stream.begin)
    limits = np.array([drive.limit for drive in rig.drives])
    assert not fine.slack
    assert (np.abs(fine.inputs) / limits).max() < 0.905
    assert fine.tensions.min() > 9.0
    assert_allclose(stream.outputs, reference.goal, atol=1e-8)


def test_load_is_kept_on_this_side_of_what_cannot_be_passed():
    """Driven at the tower's axis, its rail's end and its trolley, for good."""
    rig = models.rotary_crane()
    for velocity in ((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)):
        stream = Stream(rig, (5.0, 0.0, -5.0), rate=10.0)
        for _ in range(150):
            stream.tick(velocity)
        trolley = stream.tick(velocity).positions[1]
        assert 0.5 < trolley < 8.0
        assert stream.outputs[2] < 0.0
        solve(rig, stream.reference, 15.0, begin=stream.begin)


def test_fast_ticks_hold_a_command_between_decisions():
    rig = models.overhead_crane()
    stream = Stream(rig, (0.0, -4.0), rate=1000.0)
    samples = [stream.tick((0.1 * k, 0.0)) for k in range(20)]
    assert_allclose([s.velocity[0] for s in samples], [0.0] * 10 + [1.0] * 10)
    assert_allclose([s.time for s in samples], np.arange(20) * 1e-3)
    agree(stream, samples)


def test_copies_go_their_own_ways():
    rig = models.overhead_crane()
    stream = Stream(rig, (0.0, -4.0))
    driven(stream, commands(rig, 10))
    other = stream.copy()
    ahead = driven(other, commands(rig, 30, seed=2))
    again = driven(stream, commands(rig, 30, seed=2))
    for one, two in zip(ahead, again, strict=True):
        assert np.array_equal(one.inputs, two.inputs)
    stream.tick((1.0, 0.0))
    assert other.time < stream.time
    assert len(other.reference.knots) < len(stream.reference.knots)


def test_stream_without_commands_rests():
    rig = models.navy_crane_3d()
    start = models.default_move(rig).start
    stream = Stream(rig, start)
    assert stream.resting
    sample = stream.stop()
    assert_allclose(sample.derivatives, [start, *np.zeros((analyse(rig).reference_order, 4))])
    assert_allclose(stream.reference.goal, start)


def test_pulley_without_mass_has_to_hang_aside():
    rig = models.navy_crane_2d(pulley_mass=0)
    move = models.default_move(rig)
    stream = Stream(rig, move.goal, rate=20.0)
    agree(stream, driven(stream, commands(rig, 20)))
    with pytest.raises(PathError, match="hangs straight below its winch at the start"):
        Stream(rig, move.start)


@pytest.mark.parametrize(
    ("wrong", "error", "line"),
    [
        ({"lag": 0.0}, OptionError, r"lag is 0\.0, it must be from 0\.001 to 100 s"),
        ({"rate": np.nan}, OptionError, "rate is nan, it must be from 1 to"),
        ({"share": 1.2}, OptionError, r"share is 1\.2, it must be from"),
        ({"margin": -1.0}, OptionError, r"margin is -1\.0, it must be from 0 to"),
        ({"start": (0.0, 0.0, 0.0)}, PathError, "3 columns"),
        ({"start": (0.0, np.inf)}, PathError, "must be one finite number"),
    ],
)
def test_wrong_options_are_refused(wrong, error, line):
    options = {"start": (0.0, -4.0), **wrong}
    with pytest.raises(error, match=line):
        Stream(models.overhead_crane(), options.pop("start"), **options)


def test_wrong_commands_are_refused_and_change_nothing():
    rig = models.overhead_crane()
    stream = Stream(rig, (0.0, -4.0))
    for velocity, line in (
        ((1.0,), r"shape \(1,\), rig overhead_crane needs 2 numbers: load.x, load.z"),
        ((1.0, np.nan), "velocity of load.z is nan, it must be finite"),
        ("fast", "velocity is 'fast'"),
    ):
        with pytest.raises(PathError, match=line):
            stream.tick(velocity)
    assert stream.time == 0.0
    with pytest.raises(RigError, match="of rig overhead_crane, not of rotary_crane"):
        Stream(models.rotary_crane(), stream.state)
