"""Two roads to the motion: MuJoCo's model and the description's own equations."""

import json
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.feedforward import equations_of, from_move, redundant
from flatrig.models.mjcf import rig_model
from flatrig.models.mjcf.simulate import accelerations
from flatrig.models.rig.chain import apart
from flatrig.training.bench import accuracy
from flatrig.training.cli import main
from flatrig.training.simulate.open_loop import open_loop

ON_CHAINS = [name for name in models.CATALOGUE if not apart(models.make(name))]
RIGS = [*ON_CHAINS, "cantilever", "gantry", "planar navy", "navy", "four falls"]


@pytest.fixture
def rig(request, other_rigs):
    return other_rigs.get(request.param) or models.make(request.param)


def motion_of(model, data, site):
    """Acceleration, angular velocity and angular acceleration of a site's body, in the world."""
    moving, turning = (np.zeros((3, model.nv)) for _ in range(2))
    mujoco.mj_jacSite(model, data, moving, turning, site)
    spin = turning @ data.qvel
    drift, twist = (np.zeros((3, model.nv)) for _ in range(2))
    body = model.site_bodyid[site]
    mujoco.mj_jacDot(model, data, drift, twist, data.site_xpos[site], body)
    return (
        moving @ data.qacc + drift @ data.qvel,
        spin,
        turning @ data.qacc + twist @ data.qvel,
    )


def mujoco_accelerations(rig, model, data):
    """By the names of the equations' coordinates, from MuJoCo's own kinematics."""
    found = {}
    for frame in rig.frames:
        joint = data.joint(frame.coordinate)
        if frame.kind == "turning":
            angle, rate, turn = joint.qpos[0], joint.qvel[0], joint.qacc[0]
            found[f"{frame.name}.sin"] = np.cos(angle) * turn - np.sin(angle) * rate**2
        else:
            found[frame.coordinate] = joint.qacc[0]
    for part in (*rig.loads, *rig.platforms):
        site = model.site(part.name).id
        line, spin, turn = motion_of(model, data, site)
        found |= {f"{part.name}.{axis}": line["xyz".index(axis)] for axis in rig.axes}
        if part in rig.platforms:
            for k, director in enumerate(data.site_xmat[site].reshape(3, 3).T, start=1):
                second = np.cross(turn, director) + np.cross(spin, np.cross(spin, director))
                found |= dict(
                    zip((f"{part.name}.d{k}{axis}" for axis in "xyz"), second, strict=True)
                )
    return found


@pytest.mark.parametrize("rig", RIGS, indirect=True)
def test_accelerations_are_equal(rig, random_states):
    rig = replace(rig, held=())  # random states are not symmetric
    equations, model = equations_of(rig), rig_model.compile(rig)
    qpos, qvel, inputs = random_states(rig)
    values, rates = rig_model.coordinates(rig, model, rig_model.State(qpos, qvel))
    expected, _ = equations.accelerations(*redundant(equations, values, rates), inputs)
    data = mujoco.MjData(model)
    for i in range(len(qpos)):
        data.qpos, data.qvel, data.ctrl = qpos[i], qvel[i], inputs[i]
        mujoco.mj_forward(model, data)
        found = mujoco_accelerations(rig, model, data)
        columns = [equations.names.index(name) for name in found]
        size = np.abs(expected[i]).max()
        assert_allclose(list(found.values()), expected[i, columns], rtol=0, atol=1e-10 * size)


@pytest.mark.parametrize("rig", RIGS, indirect=True)
def test_tensions_are_equal(rig, random_states):
    rig = replace(rig, held=())  # random states are not symmetric
    equations, model = equations_of(rig), rig_model.compile(rig)
    qpos, qvel, inputs = random_states(rig)
    values, rates = rig_model.coordinates(rig, model, rig_model.State(qpos, qvel))
    state, speeds = redundant(equations, values, rates)
    _, multipliers = equations.accelerations(state, speeds, inputs)
    qacc = accelerations(model, qpos, qvel, inputs)
    found = rig_model.tensions(rig, qpos, qvel, qacc, inputs)
    expected = equations.tensions(state, multipliers)
    assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


CASES = {case.label: case for case in accuracy.cases()}


@pytest.mark.parametrize("label", CASES)
def test_every_crane_follows_its_path_open_loop(label):
    case = CASES[label]
    found = open_loop(case.rig, from_move(case.move))
    assert found.distance.max() < (case.largest or 1e-5)
    assert found.distance[-1] < (case.arrival or 1e-5)
    # the printed move pulls and pushes with 9 kN: there the held inputs alone leave 1.02e-3 N
    assert_allclose(found.tensions(), found.motion.tensions, rtol=1e-7, atol=case.tension)


@pytest.mark.parametrize("build", [models.navy_crane_2d, models.navy_crane_3d])
def test_the_error_falls_in_proportion_to_the_mass_that_stands_in_for_none(build):
    rig = build(pulley_mass=0.0)
    reference = from_move(models.default_move(rig))
    errors = [open_loop(rig, reference, massless=mass).distance.max() for mass in (1e-2, 1e-3)]
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.05)
    assert open_loop(rig, reference).distance.max() == errors[1]  # 1e-5 of the load's 100 kg


def test_the_error_of_held_inputs_falls_with_the_square_of_the_step():
    rig, reference = models.overhead_crane(), from_move(models.default_move("overhead_crane"))
    errors = [open_loop(rig, reference, step).distance[-1] for step in (4e-3, 2e-3, 1e-3)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert_allclose(orders, 2.0, atol=0.1)


def test_the_table_says_which_goals_are_missed(monkeypatch, capsys):
    rig = models.overhead_crane()
    move = models.default_move(rig)
    cases = (
        accuracy.Case("met", rig, move, largest=5e-6),
        accuracy.Case("too far", rig, move, largest=1e-9),
        accuracy.Case("too late", rig, move, arrival=1e-9),
    )
    monkeypatch.setattr(accuracy, "cases", lambda: cases)
    monkeypatch.setattr(accuracy, "massless", lambda: ())
    assert main(["accuracy"]) == 1
    out, err = capsys.readouterr()
    rows = [line for line in out.splitlines() if "e-0" in line]
    assert ["missed" in row for row in rows] == [False, True, True]
    assert err == "flatrig: a goal is missed: too far (and 1 more problem)\n"
    assert main(["accuracy", "--json"]) == 1
    found = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert [row["reached"] for row in found["moves"]] == [True, False, False]
    assert found["moves"][1]["largest_m"] > found["moves"][1]["largest_goal_m"] == 1e-9
    assert found["moves"][1]["arrival_goal_m"] is None
    monkeypatch.setattr(accuracy, "cases", lambda: cases[:1])
    assert main(["accuracy"]) == 0
