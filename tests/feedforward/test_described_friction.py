"""Friction, drag and gears that are described: in equations, MuJoCo, programs, and the energy."""

import shutil
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import feedforward, models
from flatrig.feedforward import dae
from flatrig.feedforward.exact.branch import branch_of
from flatrig.feedforward.exact.problem import problem_of
from flatrig.feedforward.solving.inverse import interpreted
from flatrig.models.errors import ModelError
from flatrig.models.friction import Friction
from flatrig.models.mjcf import rig_model
from flatrig.models.mjcf.simulate import accelerations

VISCOUS = {"frame": (0.0, 20.0), "trolley": (0.0, 20.0), "rope": (0.0, 30.0), "drag": 5.0}
DRY = {"frame": (15.0, 20.0), "trolley": (15.0, 20.0), "rope": (20.0, 30.0), "drag": 0.0}
COMPILER = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)


def rubbing(name, laws, **drives):
    """A rig of the catalogue with friction, and with all its drives changed."""
    rig = models.make(name)
    law = {kind: Friction(*laws[kind]) for kind in ("frame", "trolley", "rope")}
    trolleys = (replace(part, friction=law["trolley"]) for part in rig.trolleys)
    loads = (replace(part, drag=laws["drag"] if part.mass else 0.0) for part in rig.loads)
    return replace(
        rig,
        frames=tuple(replace(part, friction=law["frame"]) for part in rig.frames),
        masses=(*trolleys, *loads, *rig.platforms),
        ropes=tuple(replace(part, friction=law["rope"]) for part in rig.ropes),
        drives=tuple(replace(part, **drives) for part in rig.drives),
    )


def path_of(name):
    return feedforward.from_move(models.default_move(models.make(name)))


STRAIGHT = "overhead_crane", "roped_overhead_crane", "gantry_crane"
TURNING = "rotary_crane", "luffing_crane", "double_pendulum_crane"


@pytest.mark.parametrize("name", [*STRAIGHT, *TURNING])
def test_accelerations_are_those_of_mujoco(name, random_states):
    rig = rubbing(name, VISCOUS, gear=3.0)
    qpos, qvel, inputs = random_states(rig)
    model, equations = rig_model.compile(rig), feedforward.equations_of(rig)
    values, rates = rig_model.coordinates(rig, model, rig_model.State(qpos, qvel))
    state = feedforward.redundant(equations, values, rates)
    expected, _ = equations.accelerations(*state, inputs)
    found = rig_model.points(rig, qpos, qvel, accelerations(model, qpos, qvel, inputs))
    for load in rig.loads:
        columns = [equations.names.index(f"{load.name}.{axis}") for axis in rig.axes]
        second = found[load.name][2][:, ["xyz".index(axis) for axis in rig.axes]]
        assert_allclose(second, expected[:, columns], atol=1e-9 * np.abs(expected).max())
    dampers = [model.tendon(i).name for i in range(model.ntendon)]
    assert any(name.endswith(".ahead") for name in dampers) == (name in TURNING)


@pytest.mark.parametrize(
    ("name", "laws", "distance"),
    [
        ("overhead_crane", VISCOUS, 2.8e-6),
        ("roped_overhead_crane", VISCOUS, 4e-6),  # its trolley has no drive of its own
        ("overhead_crane", DRY, 1e-3),
        ("rotary_crane", DRY, 1e-3),
        ("rotary_crane", VISCOUS, 1e-5),
    ],
)
def test_a_crane_that_rubs_arrives_open_loop(name, laws, distance):
    rig = rubbing(name, laws)
    path, step = path_of(name), 1e-3
    steps = round(path.duration / step)
    motion = feedforward.solve(rig, path, step * (np.arange(steps) + 0.5))
    model = models.compile(rig, visuals=False, timestep=step)
    data, start = mujoco.MjData(model), feedforward.solve(rig, path, 0.0)
    place = dict(zip(start.coordinate_names, start.positions[0], strict=True))
    data.qpos[:] = rig_model.joint_state(rig, model, place).qpos
    for inputs in motion.inputs:
        data.ctrl[:] = inputs
        mujoco.mj_step(model, data)
    end = rig_model.coordinates(rig, model, data)[0]
    missed = [end[name] - goal for name, goal in zip(rig.outputs, path.goal, strict=True)]
    assert np.abs(missed).max() < distance
    assert np.abs(motion.inputs - feedforward.solve(models.make(name), path, motion.times).inputs
                  ).max() > 1.0  # fmt: skip


@pytest.mark.parametrize("drag", [0.0, 4.0])
def test_tensions_of_links_know_what_rubs(drag):
    plain = rubbing("overhead_crane", {**VISCOUS, "drag": drag}, gear=2.0)
    hook = models.Load("hook", 20.0, drag=3.0)
    (hoist,) = plain.ropes
    rig = replace(
        plain,
        masses=(*plain.trolleys, hook, *plain.loads),
        ropes=(replace(hoist, path=("trolley", "hook")),),
        links=(models.Link("sling", ("hook", "load")),),
        home={**plain.home, "hook": (0.0, 0.0, -3.0)},
    )
    times = np.array([0.7, 2.4, 4.2])
    path = feedforward.rest_to_rest((0.0, -4.0), (5.0, -2.0), duration=5.0, order=6)
    motion, model = feedforward.solve(rig, path, times), models.compile(rig)
    values, rates = (
        dict(zip(motion.coordinate_names, part.T, strict=True))
        for part in (motion.positions, motion.velocities)
    )
    state = rig_model.joint_state(rig, model, values, rates)
    qacc = accelerations(model, *state, motion.inputs)
    found = rig_model.tensions(rig, *state, qacc, motion.inputs)
    assert_allclose(found, motion.tensions, rtol=1e-8)


def test_power_is_what_the_load_gains_and_friction_takes():
    rig = rubbing("overhead_crane", {**DRY, "drag": 3.0})
    path = path_of("overhead_crane")
    times = np.linspace(0.0, path.duration, 20001)
    motion = feedforward.solve(rig, path, times)
    speeds = motion.drive_velocities
    power = (motion.inputs * speeds / [1.0, 0.1]).sum(axis=1)  # the drum's radius is 0.1 m
    lost = 15.0 * np.abs(speeds[:, 0]) + 20.0 * speeds[:, 0] ** 2
    lost += 20.0 * np.abs(speeds[:, 1]) + 30.0 * speeds[:, 1] ** 2
    load = motion.velocities[:, [motion.column("load.x"), motion.column("load.z")]]
    lost += 3.0 * (load**2).sum(axis=1)
    lifted = rig.weight * (path.goal[1] - path.start[1])
    assert lost.min() >= 0.0
    assert np.trapezoid(power, times) == pytest.approx(lifted + np.trapezoid(lost, times), rel=1e-6)


def test_a_gear_loses_its_share_both_ways():
    plain = models.overhead_crane()
    crane = rubbing("overhead_crane", {**DRY, "frame": (0, 0), "trolley": (0, 0), "rope": (0, 0)},
                    gear=20.0, efficiency=0.8)  # fmt: skip
    path = feedforward.from_move(models.Move((0.0, -4.0), (0.0, -2.0), 4.0))
    back = feedforward.from_move(models.Move((0.0, -2.0), (0.0, -4.0), 4.0))
    times = np.linspace(0.4, 3.6, 50)
    up, down = (feedforward.solve(crane, way, times).inputs[:, 1] for way in (path, back))
    up_plain, down_plain = (
        feedforward.solve(plain, way, times).inputs[:, 1] for way in (path, back)
    )
    assert_allclose(up, up_plain / 20.0 / 0.8, rtol=1e-12)
    assert_allclose(down, down_plain / 20.0 * 0.8, rtol=1e-12)
    with pytest.raises(ModelError, match=r"efficiency is 0\.8, a motor of MuJoCo loses nothing"):
        models.compile(crane)


@pytest.mark.parametrize("name", ["overhead_crane", "roped_overhead_crane", "rotary_crane"])
def test_programs_say_what_the_expansion_says(name, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    dry = name != "roped_overhead_crane"
    rig = rubbing(name, {**DRY, "drag": 4.0} if dry else VISCOUS, gear=5.0, efficiency=0.9)
    path = path_of(name)
    times = np.linspace(0.0, path.duration, 41)
    truth = interpreted(branch_of(problem_of(rig), path), times)
    size = np.abs(truth.inputs).max()
    many, few = (
        np.concatenate([feedforward.solve(rig, path, part).inputs for part in parts])
        for parts in ((times,), np.split(times, [15, 30]))
    )
    assert_allclose(many, truth.inputs, atol=1e-11 * size)
    assert_allclose(few, truth.inputs, atol=1e-11 * size)
    for in_c in (False, True) if COMPILER else (False,):
        stepper = feedforward.Stepper(rig, path.start, in_c=in_c)
        derivatives = path.derivatives(times, stepper.order).swapaxes(0, 1)
        gaps = np.diff(times, prepend=0.0)
        inputs = [stepper.step(d, h).inputs for d, h in zip(derivatives, gaps, strict=True)]
        assert_allclose(inputs, truth.inputs, atol=1e-10 * size)
    assert "Friction beyond what is described" in feedforward.source(rig)


@pytest.mark.parametrize("formulation", ["minimal extension, twice", "projection, dependent"])
def test_integration_knows_what_rubs(formulation):
    rig, path = rubbing("roped_overhead_crane", VISCOUS), path_of("roped_overhead_crane")
    if dae.why_not(rig, formulation):
        pytest.skip("does not apply")
    errors = []
    for step in (0.04, 0.02):
        motion = feedforward.integrate(rig, path, step=step, formulation=formulation).motion
        exact = feedforward.solve(rig, path, motion.times)
        errors.append(np.abs(motion.inputs - exact.inputs).max())
    rubs = exact.inputs - feedforward.solve(models.make(rig.name), path, exact.times).inputs
    assert errors[1] < 0.5 * np.abs(rubs).max()
    if max(errors) > 1e-9:  # at index 1 nothing is left to integrate
        assert 1.6 < errors[0] / errors[1] < 2.4  # implicit Euler is of first order


@pytest.mark.parametrize("name", ["overhead_crane", "roped_overhead_crane", "rotary_crane"])
def test_motions_satisfy_their_equations(name):
    laws = {**(VISCOUS if name == "roped_overhead_crane" else DRY), "drag": 4.0}
    rig, path = rubbing(name, laws, gear=5.0, efficiency=0.9), path_of(name)
    motion = feedforward.solve(rig, path, np.linspace(0.1, path.duration - 0.1, 30))
    assert feedforward.residuals(motion, path).max() < 1e-10


def test_a_part_at_rest_is_asked_for_no_friction():
    rig = rubbing("overhead_crane", DRY)
    path = feedforward.from_move(models.Move((0.0, -4.0), (0.0, -2.0), 4.0))  # the trolley stays
    inputs = feedforward.solve(rig, path, np.linspace(0.0, 4.0, 201)).inputs
    assert np.abs(inputs[:, 0]).max() < 1e-9
    assert_allclose(inputs[[0, -1], 1], -0.1 * rig.weight, rtol=1e-12)
