"""Bases that move as given: closed forms, recordings, loads on deck, streams, refusals."""

import re
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from flatrig import feedforward, models
from flatrig.feedforward import at_sea, base_at, check, connected, dae, from_move, solve, stopped
from flatrig.models import (
    Drive,
    Frame,
    Load,
    Move,
    PathError,
    Rail,
    Record,
    Rig,
    RigError,
    Rope,
    Trolley,
    Wave,
)

SHIP, MOVE = models.ship_crane(), models.default_move("ship_crane")
PATH = from_move(MOVE)
SHORT = replace(MOVE, goal=(21.8, 0.2, 11.0, 0.0, 0.0, 0.0), duration=4.0, order=6)
TIMES = np.linspace(0.0, 40.0, 81)
SEA = [(w.amplitude, 2.0 * np.pi / w.period, w.phase) for w in MOVE.waves]


def heaving(wave):
    """A trolley with a hoist on a beam that heaves, in a plane."""
    rig = Rig(
        name="heaving",
        dimensions=2,
        frames=(Frame("heave", "sliding", given=True),),
        rails=(Rail("beam", (1.0, 0.0, 0.0), frame="heave"),),
        masses=(Trolley("trolley", 10.0, "beam"), Load("load", 80.0)),
        ropes=(Rope("hoist", ("trolley", "load"), 0.1, 0.1),),
        drives=(
            Drive("trolley", "trolley", 1e3),
            Drive("hoist", "hoist", 500.0),
            Drive("heave", "heave", 50.0),
        ),
        outputs=("load.x", "load.z", "heave.position"),
        home={"trolley": 0.0, "load": (0.0, 0.0, -5.0)},
    )
    return rig, Move((0.0, -5.0, 0.0), (0.0, -5.0, 0.0), duration=5.0, waves=(wave,))


def recording(tmp_path, duration=60.0, rate=10.0):
    """The default sea as a file: time, heave, roll, pitch."""
    times = np.arange(0.0, duration + 0.5 / rate, 1.0 / rate)
    columns = [size * np.sin(turn * times + phase) for size, turn, phase in SEA]
    file = tmp_path / "sea.csv"
    table = np.column_stack([times, *columns])
    np.savetxt(file, table, delimiter=",", header="t,heave,roll,pitch", comments="", fmt="%.17g")
    return file


def test_a_load_that_hangs_on_a_heaving_beam_pulls_with_m_g_plus_a():
    wave = Wave(2, 0.7, 6.0, 0.4)
    rig, move = heaving(wave)
    motion = solve(rig, from_move(replace(move, frame="heave"), rig), TIMES)
    turn = 2.0 * np.pi / wave.period
    rise = wave.amplitude * np.sin(turn * TIMES + wave.phase)
    assert_allclose(motion.tensions[:, 0], 80.0 * (9.81 - turn**2 * rise), rtol=1e-12)
    assert_allclose(motion.positions[:, motion.column("load.z")], rise - 5.0, rtol=0, atol=1e-13)
    assert_allclose(motion.positions[:, motion.column("hoist.length")], 5.0, rtol=1e-13)


def test_a_load_held_in_the_world_below_it_pulls_with_its_weight():
    wave = Wave(2, 0.7, 6.0, 0.4)
    rig, move = heaving(wave)
    motion = solve(rig, from_move(move), TIMES)
    rise = wave.amplitude * np.sin(2.0 * np.pi / wave.period * TIMES + wave.phase)
    assert_allclose(motion.tensions[:, 0], 80.0 * 9.81, rtol=1e-12)
    assert_allclose(motion.positions[:, motion.column("hoist.length")], 5.0 + rise, rtol=1e-13)
    # of the winch: what the rope pulls and what its drum takes to turn with it
    spin = (2.0 * np.pi / wave.period) ** 2 * rise / 0.1
    assert_allclose(motion.inputs[:, 1], -80.0 * 9.81 * 0.1 - 0.1 * spin, rtol=1e-9)


def test_places_on_deck_are_turned_and_lifted_with_the_ship():
    deck = from_move(replace(MOVE, frame="ship"), SHIP)
    plain = from_move(replace(MOVE, waves=()))
    heave, roll, pitch = (size * np.sin(turn * TIMES + phase) for size, turn, phase in SEA)
    turned = Rotation.from_euler("XY", np.column_stack([roll, pitch]))  # about the ship's own axes
    expected = turned.apply(plain(TIMES)[:, :3]) + np.outer(heave, (0.0, 0.0, 1.0))
    assert_allclose(deck(TIMES)[:, :3], expected, rtol=0, atol=1e-12)
    # each derivative is the slope of the one before
    step = 1e-4
    for order in range(1, 5):
        near = [deck.derivatives(TIMES[1:60] + s, order - 1)[-1] for s in (step, -step)]
        found = deck.derivatives(TIMES[1:60], order)[-1]
        assert_allclose((near[0] - near[1]) / (2.0 * step), found, rtol=0, atol=1e-6)
    # and from the world back
    values = deck.derivatives(TIMES, 4)
    back = deck.base.added(values, TIMES, back=True)
    assert_allclose(back, plain.derivatives(TIMES, 4), rtol=0, atol=1e-11)


def test_a_load_on_deck_moves_with_it_and_feels_it():
    lies = replace(MOVE, goal=MOVE.start, frame="ship")
    motion = solve(SHIP, from_move(lies, SHIP), TIMES)
    world = solve(SHIP, from_move(replace(lies, frame="")), TIMES)
    swing = [np.ptp(m.tensions[:, 0]) for m in (motion, world)]
    assert swing[0] > 1e3
    assert swing[1] < 1e-6
    length = motion.positions[:, motion.column("hoist.length")]
    assert np.ptp(length) < 0.05 * np.ptp(world.positions[:, world.column("hoist.length")])
    assert check(SHIP, from_move(lies, SHIP), rate=20.0).feasible


def test_a_recording_of_a_sea_is_as_good_as_its_sinusoids(tmp_path):
    move = replace(MOVE, waves=(), records=(Record(str(recording(tmp_path)), (3, 4, 5)),))
    path = from_move(move)
    times = TIMES[TIMES < 30.0]
    assert_allclose(path(times), PATH(times), rtol=0, atol=1e-11)
    found, exact = solve(SHIP, path, times), solve(SHIP, PATH, times)
    assert_allclose(found.inputs, exact.inputs, rtol=0, atol=1e-8 * np.abs(exact.inputs).max())
    # it repeats, and as smoothly as the crane needs
    (record,) = path.base.records
    for joint in (record.period, record.period + record.fade, 2.0 * record.period):
        before, after = (path.derivatives([joint + s], 4) for s in (-1e-9, 1e-9))
        assert_allclose(before, after, rtol=0, atol=1e-8)
    early, late = (path.derivatives([t], 4) for t in (12.0, 12.0 + record.period))
    assert_allclose(early[:, :, 3:], late[:, :, 3:], rtol=0, atol=1e-12)


def test_a_noisy_recording_is_smoothed_as_far_as_it_may_be(tmp_path):
    file = recording(tmp_path)
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    table[:, 1:] += (5e-3, 2e-4, 2e-4) * np.random.default_rng(0).normal(size=(len(table), 3))
    np.savetxt(file, table, delimiter=",")
    move = replace(MOVE, waves=(), records=(Record(str(file), (3, 4, 5)),))
    with pytest.raises(PathError, match=r"sea.csv: the points scatter by about .* pass tolerance"):
        from_move(move)
    path = from_move(replace(move, records=(replace(move.records[0], tolerance=0.03, start=5.0),)))
    times = TIMES[TIMES < 30.0]
    away = path.derivatives(times, 2) - PATH.derivatives(times + 5.0, 2)
    assert np.abs(away[2, :, 3]).max() < 0.1 * 9e-3 * 100.0  # a difference of samples: 9 m/s2
    assert np.abs(away[0, :, 3:]).max(axis=0) == pytest.approx(0.0, abs=0.03)


def test_what_a_recording_cannot_be(tmp_path):
    file = str(recording(tmp_path))
    for changed, message in (
        ({"columns": (3, 4)}, r"sea.csv has 4 columns, it needs a time and 2 outputs"),
        ({"columns": (0, 4, 5)}, r"a record is in load.x, which has to start in rest: records are"),
        ({"fade": 30.0}, r"lasts 60 s, a record must last longer than twice its fade of 30 s"),
        ({"samples": file + "x"}, "cannot read .*sea.csvx: No such file"),
    ):
        record = replace(Record(file, (3, 4, 5)), **changed)
        with pytest.raises(PathError, match=message):
            solve(SHIP, from_move(replace(MOVE, waves=(), records=(record,))), 0.0)
    for changed, message in (
        ({"columns": ()}, "columns is (), it must be one column or more, each once"),
        ({"fade": 0.0}, "fade is 0 s, it must be > 0"),
        ({"start": -1.0}, "start is -1 s, it must be >= 0"),
    ):
        with pytest.raises(PathError) as error:
            replace(Record(file, (3,)), **changed)
        assert message in str(error.value)


def test_files_keep_recordings_and_decks(tmp_path):
    (tmp_path / "data").mkdir()
    file = recording(tmp_path / "data")
    move = replace(MOVE, waves=(), records=(Record(str(file), (3, 4, 5), fade=4.0),), frame="ship")
    models.dump(tmp_path / "rig.toml", SHIP, move)
    text = (tmp_path / "rig.toml").read_text()
    assert 'samples = "data/sea.csv"' in text
    assert models.load(tmp_path / "rig.toml") == (SHIP, move)


def test_what_a_deck_cannot_be():
    navy, navy_move = models.navy_ship_crane(), models.default_move("navy_ship_crane")
    for rig, move, message in (
        (SHIP, replace(MOVE, frame="girder"), "whose motion is given; known are heave, roll, ship"),
        (SHIP, replace(MOVE, frame="shop"), "given; did you mean ship"),
        (navy, replace(navy_move, frame="ship"), "pulley.z is an output, all of pulley.x, pull"),
    ):
        with pytest.raises(PathError, match=message):
            from_move(move, rig)
    with pytest.raises(PathError, match=r"on frame ship, and only its rig knows .* from_move\(mov"):
        from_move(replace(MOVE, frame="ship"))


def test_a_stream_leads_the_load_while_the_ship_goes_on():
    for move in (MOVE, replace(MOVE, frame="ship")):
        base = base_at(from_move(move, SHIP), 0.0)
        stream = feedforward.Stream(SHIP, MOVE.start, base=base, rate=20.0)
        samples = [stream.tick((-0.3, 0.2, 0.1, 1.0, 1.0, 1.0)) for _ in range(10)]
        times = np.array([sample.time for sample in samples])
        motion = solve(SHIP, stream.reference, times, begin=stream.begin)
        positions = np.array([sample.positions for sample in samples])
        assert_allclose(positions, motion.positions, rtol=0, atol=1e-11)
        assert_allclose(motion.outputs[:, 3:], PATH(times)[:, 3:], rtol=0, atol=1e-12)
        # the velocity is of the load in the world, or on its deck
        state = stream.state
        back = base_at(stream.reference, stream.time).added(
            state.derivatives[:, None], np.zeros(1), back=True
        )
        assert np.linalg.norm(back[1, 0, :3]) > 0.005
        assert_allclose(back[:, 0], state.still, rtol=0, atol=1e-12)
        assert np.abs(state.still[1, 3:]).max() < 1e-12


def test_new_goals_and_stops_go_on_in_the_same_sea():
    state = solve(SHIP, PATH, 0.0).at(8.0)
    left = np.linspace(0.0, 25.0, 6)
    for path in (connected(state, MOVE.goal, 20.0), stopped(PATH, 8.0, 10.0)):
        motion = solve(SHIP, path, left, begin=state)
        assert_allclose(motion.outputs[:, 3:], PATH(8.0 + left)[:, 3:], rtol=0, atol=1e-12)
        assert_allclose(path.derivatives([25.0], 2)[1:, 0, :3], 0.0, atol=1e-12)


def test_a_sea_that_starts_with_a_jump_is_refused():
    wave = (Wave(0, 1.0, 8.0),)
    with pytest.raises(PathError, match=r"a wave is in load.x, which has to start in rest"):
        solve(SHIP, from_move(replace(MOVE, waves=wave)), 0.0)
    state = solve(SHIP, PATH, 0.0).at(8.0)
    solve(SHIP, connected(state.derivatives, MOVE.goal, 20.0), 0.0, begin=state)  # the ship stops
    other = at_sea(connected(state.still, MOVE.goal, 20.0), PATH.base)
    with pytest.raises(PathError, match=r"starts with roll.angle = 0\.0466"):
        solve(SHIP, other, 0.0, begin=state)


class Own:
    """A reference of one's own with a base that moves from the start, and one that jumps."""

    def __init__(self, late):
        self.late, self.order, self.size, self.duration = late, 4, 6, MOVE.duration

    @property
    def start(self):
        return self([0.0])[0]

    @property
    def goal(self):
        return self([self.duration])[0]

    def derivatives(self, times, order):
        values = PATH.derivatives(times, order)
        calm = from_move(replace(MOVE, waves=())).derivatives(times, order)
        return np.where((np.asarray(times) < self.late)[:, None], calm, values)

    def __call__(self, times):
        return self.derivatives(times, 0)[0]


def test_a_path_of_ones_own_may_move_its_base_and_must_not_let_it_jump():
    found, exact = (solve(SHIP, path, TIMES[:20]) for path in (Own(-9.0), PATH))
    assert_allclose(found.inputs, exact.inputs, rtol=0, atol=1e-9 * np.abs(exact.inputs).max())
    with pytest.raises(PathError, match=r"heave.position jumps from 0 to .* at 7\.3 s"):
        solve(SHIP, Own(7.3), 0.0)


@pytest.mark.parametrize("formulation", dae.FORMULATIONS)
def test_formulations_step_through_a_moving_base(formulation):
    """From motion, and not from rest: their start is no worse than the rest of the way."""
    if reason := dae.why_not(SHIP, formulation):
        assert re.search("has no dependent coordinates|its index is 5", reason)
        return
    path = from_move(replace(SHORT, duration=3.0))
    errors = []
    for step in (0.1, 0.05):
        run = feedforward.integrate(SHIP, path, step=step, formulation=formulation, scheme="BDF 3")
        assert run.failure is None
        exact = solve(SHIP, path, run.motion.times)
        if dae.formulation(SHIP, formulation).index <= 3:  # places follow without a difference
            assert_allclose(run.motion.positions, exact.positions, rtol=0, atol=1e-9)
        away = np.abs(run.motion.inputs - exact.inputs) / np.abs(exact.inputs).max(axis=0)
        errors.append(np.abs(away[run.motion.times < 1.5]).max())
    assert errors[1] < max(0.25 * errors[0], 1e-9)


def test_formulations_need_the_past_of_a_recording(tmp_path):
    record = Record(str(recording(tmp_path)), (3, 4, 5))
    path = from_move(replace(SHORT, waves=(), records=(record,)))
    with pytest.raises(PathError, match=r"a record must start 0\.4 s or later after its first sam"):
        feedforward.integrate(SHIP, path, step=0.1, scheme="BDF 4")
    late = from_move(replace(SHORT, waves=(), records=(replace(record, start=1.0),)))
    run = feedforward.integrate(SHIP, late, step=0.1, scheme="BDF 4")
    exact = solve(SHIP, late, run.motion.times)
    assert_allclose(run.motion.positions, exact.positions, rtol=0, atol=1e-9)


def test_what_does_not_hold_a_moving_base_says_so():
    with pytest.raises(RigError, match="given: its energy is not conserved"):
        feedforward.Regulator(SHIP, MOVE.start, (1.0,) * 6, (1.0,) * 6)
    with pytest.raises(PathError, match="another duration would change the sea's periods"):
        feedforward.shortest_duration(SHIP, PATH)
