"""Numbers of `flatrig regress`: by second roads, under noise, and with small faults planted."""

import math
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.feedforward import from_move
from flatrig.feedforward.rolling import plan_hand
from flatrig.models.hand.catalogue import default_hand_move
from flatrig.models.mjcf import rig_model, simulate
from flatrig.models.mjcf.hand_model import RECOMMENDED, compile_hand, resting_depth
from flatrig.training.regress import baseline, crane_rows, hand_rows, quantities
from flatrig.training.regress import regression as regress
from flatrig.training.regress.baseline import Stored
from flatrig.training.regress.row import Row
from flatrig.training.simulate import drift
from flatrig.training.simulate.hand_runs import Track
from flatrig.training.simulate.open_loop import prepare

CRANE = ("error", "arrival", "tension", "tension rms", "energy", "momentum")


def test_the_free_rotary_crane_has_the_energy_and_momentum_of_the_source():
    """Y 2.87 to 2.91 with table 2.1, the load turning with the bridge."""
    free = drift.free_motion("rotary_crane")
    model = rig_model.compile(free.rig, timestep=1e-2, visuals=False)
    start = rig_model.joint_state(free.rig, model, free.coordinates, free.rates)
    energy, momentum = drift._conserved(model, *start, drift.cyclic(model))
    inertia = 16.67 + 2.08 + 0.26 + (50 + 3 + 10) * 1.5**2
    assert_allclose(momentum, [inertia], rtol=1e-12)
    assert_allclose(energy, inertia / 2 - 10 * 9.81 * 5, rtol=1e-12)
    lost = drift.drift(model, free)
    assert lost.energy < 1e-7
    assert lost.momentum < 1e-9


@pytest.mark.parametrize(
    ("name", "joints"),
    [
        ("overhead_crane", ["trolley.position"]),
        ("rotary_crane", ["bridge.angle"]),
        ("gantry_crane", ["gantry.position", "trolley.position"]),
        ("navy_crane_2d", []),
    ],
)
def test_what_has_a_momentum_that_stays(name, joints):
    rig = models.make(name)
    model = rig_model.compile(rig, timestep=1e-3, visuals=False)
    assert [model.joint(int(i)).name for i in drift.cyclic(model)] == joints
    found = drift.drift(model, drift.Free(rig, {}, {}))
    assert found.energy < 1e-9
    assert math.isnan(found.momentum) if not joints else found.momentum < 1e-12


def test_mujoco_computes_what_is_stored():
    names = ["overhead_crane", "rotary_crane"]
    rows = [row for name in names for row in crane_rows.rows(name, 1e-2, repeat=False)]
    found = {key: row[name] for row in rows for name, key in row.keys().items()}
    assert len(found) == 2 * len(CRANE) * len(rig_model.INTEGRATORS)
    stored = {key: value for key, value in baseline.read()[0].items() if key[2] == 1e-2}
    assert baseline.departures(found, stored, names) == []


def rolled(name):
    """Numbers of a hand at 2 ms with the recommended integrator."""
    plan = plan_hand(
        models.make_hand(name), replace(default_hand_move(name), duration=hand_rows.MOTION)
    )
    tracks = Track.of(plan, 2e-3, hand_rows.ROLL), Track.still(plan, 2e-3, hand_rows.HOLD)
    return hand_rows.run(*tracks, "IMPLICITFAST", 2e-3, quantities.still)[0]


def test_a_hand_rolls_as_is_stored():
    hand, numbers = models.make_hand("ball_on_plate"), rolled("ball_on_plate")
    stored, _ = baseline.read()
    assert tuple(numbers) == hand_rows.ALL
    for name, value in numbers.items():
        assert stored[("ball_on_plate", "IMPLICITFAST", 2e-3, name)].holds(value), name
    model = compile_hand(hand, replace(RECOMMENDED, timestep=2e-3), visuals=False)
    depth = resting_depth(model, "plate", 9.81 * hand.held.mass)
    assert numbers["creep"] == pytest.approx(depth, rel=0.15)  # the ball sinks in, and stays


@pytest.fixture(scope="module")
def overhead():
    """The overhead crane's move at 10 ms, and its numbers with RK4."""
    rig = models.overhead_crane()
    prepared = prepare(rig, from_move(models.default_move(rig)), 1e-2)
    free = drift.free_motion("overhead_crane")
    numbers, _ = crane_rows.run(rig, prepared, free, "RK4", 1e-2, quantities.still)
    return rig, prepared, free, numbers


def test_tensions_are_those_of_newtons_law_at_the_load(overhead):
    """T = m |a - g| from MuJoCo's acceleration of the load, without the winch and its torque."""
    rig, prepared, _, numbers = overhead
    model = rig_model.compile(rig, timestep=1e-2, visuals=False)
    run = prepared.run(model)
    acceleration = simulate.accelerations(model, run.qpos, run.qvel, prepared.motion.inputs)
    load = acceleration[:, [1, 2]] + np.outer(acceleration[:, 0], [1.0, 0.0]) + [0.0, rig.gravity]
    tension = 100.0 * np.linalg.norm(load, axis=1)
    away = tension - prepared.motion.tensions[:, 0]
    assert_allclose(np.abs(away).max(), numbers["tension"], rtol=1e-6)
    assert_allclose(np.sqrt(np.mean(away**2)), numbers["tension rms"], rtol=1e-6)


def test_bands_follow_from_runs_with_noise():
    numbers = {"error": 1e-3, "arrival": 5.0, "energy": 1e-14, "momentum": math.inf, "slip": 1.0}
    repeated = [
        numbers | {"error": 1e-3 + shift, "slip": slip}
        for shift, slip in ((2e-9, 1.0), (-3e-9, math.inf))
    ]
    found = quantities.bands(numbers, repeated)
    expected = {"error": 3e-8, "arrival": 5e-8, "energy": 1e-10, "momentum": 0, "slip": math.inf}
    assert_allclose(list(found.values()), list(expected.values()), rtol=1e-6)
    assert list(found) == list(expected)


def test_noise_is_as_large_as_it_is_said_to_be_and_another_for_each_seed():
    values = np.column_stack([np.linspace(-3, 1, 5000), np.zeros(5000)])
    away = [quantities.shake(seed)(values) - values for seed in range(2)]
    assert_allclose(away[0][:, 0].std(), 3 * quantities.NOISE, rtol=0.05)
    assert not away[0][:, 1].any()
    assert not np.array_equal(*away)


def test_numbers_under_other_noise_stay_in_the_band(overhead):
    rig, prepared, free, numbers = overhead
    found = Row.of(
        ("overhead_crane", "RK4", 1e-2),
        lambda shake: crane_rows.run(rig, prepared, free, "RK4", 1e-2, shake),
        repeat=True,
    )
    assert found.numbers == numbers
    for seed in range(20, 24):
        other, _ = crane_rows.run(rig, prepared, free, "RK4", 1e-2, quantities.shake(seed))
        for name, value in other.items():
            assert Stored(numbers[name], found.bands[name]).holds(value), name


def damped(rig, model):
    model.tendon_damping[:] = 1e-3


def lighter_winch(rig, model):
    model.tendon_armature[:] *= 0.99


def larger_drum(rig, model):
    of_tendon = model.actuator_trntype == mujoco.mjtTrn.mjTRN_TENDON
    model.actuator_gear[of_tendon] /= 1.001


def without_armature(rig, model):
    model.dof_armature[:] *= 0.99


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("overhead_crane", lighter_winch),
        ("overhead_crane", larger_drum),
        ("overhead_crane", damped),
        ("rotary_crane", without_armature),
    ],
)
def test_small_faults_leave_the_stored_bands(name, fault, monkeypatch):
    compiled = rig_model.compile

    def faulty(rig, **options):
        model = compiled(rig, **options)
        fault(rig, model)
        return model

    monkeypatch.setattr(crane_rows.mjcf, "compile", faulty)
    stored, _ = baseline.read()
    rig = models.make(name)
    prepared = prepare(rig, from_move(models.default_move(rig)), 1e-2)
    numbers, _ = crane_rows.run(
        rig, prepared, drift.free_motion(name), "RK4", 1e-2, quantities.still
    )
    for quantity in ("error", "tension", "tension rms"):
        assert not stored[(name, "RK4", 1e-2, quantity)].holds(numbers[quantity]), quantity


def test_a_weaker_contact_leaves_the_stored_bands(monkeypatch):
    monkeypatch.setattr(hand_rows, "RECOMMENDED", replace(RECOMMENDED, impratio=99.9))
    stored, _ = baseline.read()
    numbers = rolled("ball_in_corner")
    for name in ("slip", "away", "turned"):
        number = numbers[name]
        assert not stored[("ball_in_corner", "IMPLICITFAST", 2e-3, name)].holds(number), name


def test_a_run_that_breaks_down_is_infinite(overhead, tmp_path):
    rig, prepared, free, _ = overhead
    wild = replace(prepared, inputs=1e12 * prepared.inputs)
    numbers, cost = crane_rows.run(rig, wild, free, "RK4", 1e-2, quantities.still)
    assert [numbers[name] for name in crane_rows.MOVE] == [math.inf] * 4
    assert np.isfinite(numbers["energy"])
    assert math.isnan(cost)
    assert tuple(numbers) == CRANE
    lost = Row("overhead_crane", "RK4", 1e-2, cost, numbers)
    regress.write_rows(tmp_path / "rows.csv", [lost], {})
    lines = (tmp_path / "rows.csv").read_text().splitlines()
    assert lines[1] == "overhead_crane,RK4,0.01,error,m,inf,,,"
    assert lines[-1] == "overhead_crane,RK4,0.01,cost,ms/s,,,,"


def test_a_hand_that_loses_its_object_is_infinite():
    plan = plan_hand(models.make_hand("ball_on_plate"), default_hand_move("ball_on_plate"))
    still = Track.still(plan, 2e-3, 0.1)
    fallen = replace(still, inputs=still.inputs * [1.0, 1.0, -40.0])
    numbers, _ = hand_rows.run(fallen, still, "IMPLICITFAST", 2e-3, quantities.still)
    assert numbers == dict.fromkeys(hand_rows.ALL, math.inf)
