"""Two roads to the motion: MuJoCo's model and the description's own equations."""

import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.feedforward import equations_of, from_move, redundant, solve
from flatrig.models import mjcf
from flatrig.models.run import run

RIGS = [*models.CATALOGUE, "cantilever", "gantry", "planar navy", "navy"]


@pytest.fixture
def rig(request, other_rigs):
    return other_rigs.get(request.param) or models.make(request.param)


@pytest.mark.parametrize("rig", RIGS, indirect=True)
def test_accelerations_are_equal(rig, random_states):
    equations, model = equations_of(rig), mjcf.compile(rig)
    qpos, qvel, inputs = random_states(rig)
    values, rates = mjcf.coordinates(rig, model, mjcf.State(qpos, qvel))
    expected, _ = equations.accelerations(*redundant(equations, values, rates), inputs)
    data = mujoco.MjData(model)
    jacobian, drift = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    for i in range(len(qpos)):
        data.qpos, data.qvel, data.ctrl = qpos[i], qvel[i], inputs[i]
        mujoco.mj_forward(model, data)
        size = np.abs(expected[i]).max()
        for frame in rig.frames:
            if frame.kind == "turning":
                turn = data.joint(frame.coordinate).qacc[0]
                angle, rate = values[frame.coordinate][i], rates[frame.coordinate][i]
                column = equations.names.index(f"{frame.name}.sin")
                second = np.cos(angle) * turn - np.sin(angle) * rate**2
                assert_allclose(second, expected[i, column], rtol=0, atol=1e-10 * size)
            else:
                column = equations.names.index(frame.coordinate)
                slide = data.joint(frame.coordinate).qacc[0]
                assert_allclose(slide, expected[i, column], rtol=0, atol=1e-10 * size)
        for load in rig.loads:
            body = data.site(load.name)
            mujoco.mj_jacSite(model, data, jacobian, None, body.id)
            mujoco.mj_jacDot(model, data, drift, None, body.xpos, model.site_bodyid[body.id])
            world = jacobian @ data.qacc + drift @ data.qvel
            for axis in rig.axes:
                column = equations.names.index(f"{load.name}.{axis}")
                component = world["xyz".index(axis)]
                assert_allclose(component, expected[i, column], rtol=0, atol=1e-10 * size)


def open_loop(name, timestep):
    """Distance of the load from its reference at each step, (N,), driven by feedforward alone."""
    rig, reference = models.make(name), from_move(models.default_move(name))
    model = mjcf.compile(rig, timestep=timestep, visuals=False)
    steps = round(reference.duration / timestep)
    times = timestep * np.arange(steps + 1)
    motion = solve(rig, reference, times)
    start = dict(zip(motion.coordinate_names, motion.positions[0], strict=True))
    controls = solve(rig, reference, times[:-1] + 0.5 * timestep).inputs
    state = run(model, *mjcf.joint_state(rig, model, start), controls)
    found, _ = mjcf.coordinates(rig, model, state)
    path = np.array([found[name] for name in rig.outputs]).T
    return np.linalg.norm(path - motion.outputs, axis=1)


def test_overhead_crane_lands_open_loop():
    assert open_loop("overhead_crane", 1e-3)[-1] < 5e-6


def test_roped_overhead_crane_lands_open_loop():
    assert open_loop("roped_overhead_crane", 1e-3)[-1] < 1e-5


def test_rotary_crane_follows_its_path_open_loop():
    assert open_loop("rotary_crane", 1e-3).max() < 1e-6


def test_the_error_of_held_inputs_falls_with_the_square_of_the_step():
    errors = [open_loop("overhead_crane", step)[-1] for step in (4e-3, 2e-3, 1e-3)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert_allclose(orders, 2.0, atol=0.1)
