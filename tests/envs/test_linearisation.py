"""Linear models against the environment's steps, regulators against SciPy's; guard, teacher."""

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from flatrig import models
from flatrig.envs import CraneTask, Disturbances, Scenario, design
from flatrig.envs.controllers import PDLaw
from flatrig.envs.crane.courses import planned
from flatrig.envs.crane.linearisation import Lineariser
from flatrig.envs.crane.optimal_feedback import Weights, output_weights, regulator
from flatrig.envs.crane.plan import feedforward_with, make_plan
from flatrig.envs.crane.riccati import Ahead, Stage, recursion, stationary
from flatrig.envs.crane.taut_guard import LEAST, MOST, TautBand, pulls_of
from flatrig.feedforward import from_move, solve
from flatrig.training.learn.crane_teacher import CraneTeacher

PERIOD = 0.02


def plan_of(name, hold=1.0):
    rig = models.make(name)
    return rig, make_plan(rig, from_move(models.default_move(rig)), PERIOD, hold)


def differences(rig, state, inputs, scenario):
    """Central differences of a control period of the environment, by states and inputs."""
    joints, drives = len(state) // 2, len(inputs)
    steps = np.repeat((1e-5, 1e-4), (2 * joints, drives))
    task = CraneTask(rig, num=2 * len(steps), disturbances="standard", timestep=2e-3, nthread=1)
    generators = [np.random.default_rng(0)] * task.num
    task.reset(task.all, generators, [scenario] * task.num)
    aside = np.vstack((np.diag(steps), -np.diag(steps)))
    task.plant.qpos[...] = state[:joints] + aside[:, :joints]
    task.plant.qvel[...] = state[joints:] + aside[:, joints : 2 * joints]
    task.plant.ctrl[...] = (inputs + aside[:, 2 * joints :]) * task.limits
    task.plant.step()
    after = np.hstack((task.plant.qpos, task.plant.qvel))
    ahead, behind = np.split(after, 2)
    return ((ahead - behind) / (2.0 * steps[:, None])).T, task


@pytest.mark.parametrize(
    "name", ["overhead_crane", "cantilever_crane", "navy_crane_2d", "cable_manipulator"]
)
def test_a_linear_model_is_the_derivative_of_the_environments_step(name):
    rig, plan = plan_of(name)
    lineariser = Lineariser(rig, PERIOD, room=64)
    course = planned(rig, lineariser.model, plan, 1.2)
    model = lineariser.along([course])
    knot = model.knots.shape[1] // 3
    step = int(model.knots[0, knot])
    scenario = Scenario(load_mass=1.2)
    truth, _ = differences(rig, course.states[step], course.inputs[step], scenario)
    found = model.transition[0, knot, :, : truth.shape[1]]
    assert found == pytest.approx(truth, rel=1e-4, abs=1e-4 * np.abs(truth).max(axis=0).min())


def test_disturbances_are_wind_and_friction_of_the_environment():
    rig, plan = plan_of("cantilever_crane")
    lineariser = Lineariser(rig, PERIOD, room=64)
    course = planned(rig, lineariser.model, plan)
    model = lineariser.along([course])
    step = int(model.knots[0, model.knots.shape[1] // 3])
    weight = rig.weight
    small = 1e-4 * weight
    kinds = (
        Scenario(),
        Scenario(wind=small),
        Scenario(wind=small, wind_direction=0.5 * np.pi),
        Scenario(winch_friction=small),
    )
    task = CraneTask(rig, num=len(kinds), disturbances="standard", timestep=1e-3, nthread=1)
    task.reset(task.all, [np.random.default_rng(0)] * task.num, list(kinds))
    joints = task.plant.model.nv
    task.plant.qpos[...] = course.states[step, :joints]
    task.plant.qvel[...] = course.states[step, joints:]
    task.plant.ctrl[...] = course.inputs[step] * task.limits
    task.plant.step()
    after = np.hstack((task.plant.qpos, task.plant.qvel))
    forces = model.at(step)[2][0]
    for column in range(3):
        change = (after[1 + column] - after[0]) / 1e-4
        # MuJoCo's dry friction is regularised: it gives in by a per cent of what it stops.
        near = 2e-2 if column == 2 else 1e-3
        assert forces[:, column] == pytest.approx(change, rel=near, abs=near * abs(change).max())


def test_outputs_follow_the_joints():
    rig, plan = plan_of("cable_manipulator")
    lineariser = Lineariser(rig, PERIOD, room=64)
    course = planned(rig, lineariser.model, plan)
    model = lineariser.along([course])
    step = 300
    rates = course.states[step, lineariser.model.nv :]
    outputs = model.at(step)[3][0] @ rates
    assert outputs == pytest.approx(plan.reference.derivatives([PERIOD * step], 1)[1][0], abs=2e-4)


def systems(seed=0):
    generator = np.random.default_rng(seed)
    forward = np.eye(4) + 0.3 * generator.normal(size=(3, 4, 4))
    push, wind = generator.normal(size=(3, 4, 2)), generator.normal(size=(3, 4, 1))
    root = generator.normal(size=(3, 4, 4))
    cost = np.broadcast_to(np.diag((1.0, 0.3)), (3, 2, 2))
    one = np.ones((3, 1, 1))
    return Stage(forward, push, wind, one, root @ root.swapaxes(1, 2), cost)


def test_a_lasting_stage_has_the_regulator_of_scipy():
    stage = systems()
    ahead = stationary(stage)
    gains = recursion(lambda step: stage, 2, ahead)
    for one in range(3):
        forward, push, _, _, cost, effort = (part[one] for part in stage)
        value = solve_discrete_are(forward, push, cost, effort)
        assert ahead.state[one] == pytest.approx(value, rel=1e-8)
        gain = np.linalg.solve(effort + push.T @ value @ push, push.T @ value @ forward)
        assert gains.state[0, one] == pytest.approx(gain, rel=1e-8)
        assert gains.weights[1, one] == pytest.approx(effort + push.T @ value @ push, rel=1e-8)


def test_gains_against_disturbances_are_those_of_a_system_that_holds_them():
    """The second road: w as states that nothing moves, and a long recursion instead of a limit."""
    stage = systems(1)
    ahead = stationary(stage)
    gains = recursion(lambda step: stage, 1, ahead)
    full = np.zeros((3, 5, 5))
    full[:, :4, :4], full[:, :4, 4:], full[:, 4, 4] = stage.transition, stage.disturbances, 1.0
    push = np.concatenate((stage.inputs, np.zeros((3, 1, 2))), axis=1)
    cost = np.zeros((3, 5, 5))
    cost[:, :4, :4] = stage.state_cost
    joined = Stage(full, push, np.zeros((3, 5, 0)), np.zeros((3, 0, 0)), cost, stage.input_cost)
    start = Ahead(cost, np.zeros((3, 5, 0)))
    long = recursion(lambda step: joined, 400, start).state[0]
    assert long[..., :4] == pytest.approx(gains.state[0], rel=1e-7)
    assert long[..., 4:] == pytest.approx(gains.disturbance[0], rel=1e-6)


def test_a_regulator_that_cannot_be_is_refused():
    stage = systems()
    stuck = stage._replace(inputs=np.zeros_like(stage.inputs))
    with pytest.raises(ArithmeticError, match="cannot be regulated"):
        stationary(stuck)


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_a_late_command_is_regulated_as_if_each_were_alone(delay):
    """Courses of different delays share one recursion; alone each has the same gains."""
    rig, plan = plan_of("overhead_crane")
    task = CraneTask(rig)
    lineariser = Lineariser(rig, PERIOD)
    course = planned(rig, lineariser.model, plan)
    weights = Weights()
    outputs = output_weights(rig, task.scales, weights)
    both = regulator(lineariser.along([course] * 2), np.array([delay, 3]), outputs, weights)
    alone = regulator(lineariser.along([course]), np.array([delay]), outputs, weights)
    size = alone.state.shape[-1]
    assert both.state[:, :1, :, :size] == pytest.approx(alone.state, rel=1e-6, abs=1e-9)
    assert both.state[:, :1, :, size:] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("name", ["roped_overhead_crane", "navy_crane_2d"])
def test_the_guard_leaves_shares_of_the_planned_pull(name):
    rig, plan = plan_of(name)
    task = CraneTask(rig)
    task.reset(task.all, [np.random.default_rng(0)])
    middles = PERIOD * (np.arange(plan.steps + 1) + 0.5)
    motion = solve(rig, plan.reference, middles)
    for column, drive in enumerate(rig.drives):
        rope = rig.driven(drive)
        pull = motion.tensions[:, rig.rope_names.index(rope.name)] * rope.drum_radius
        found = pulls_of(task, plan)[:, column] * drive.limit
        assert found[:-1] == pytest.approx(pull[:-1], rel=2e-3)
    guard, planned_now = TautBand(task), task.rows.parts["feedforward"]
    assert guard.keep(planned_now) == pytest.approx(planned_now)
    at_rest = plan.rows[0][: len(rig.drives)]
    assert np.isfinite(at_rest).all()
    lowest, highest = guard.band()
    pulls = pulls_of(task, plan)[:1]
    assert planned_now - lowest == pytest.approx((MOST - 1.0) * pulls)
    assert highest - planned_now == pytest.approx((1.0 - LEAST) * pulls)


def drive(task, plans, scenarios, act, sent=None):
    """Mean distance of the load over all periods, (n,)."""
    generators = [np.random.default_rng(i) for i in range(task.num)]
    task.reset(task.all, generators, scenarios, plans)
    squares = np.zeros(task.num)
    for _ in range(min(plan.steps for plan in plans)):
        actions = act()
        if sent is not None:
            sent(actions)
        assert not task.step(actions).terminated.any()
        squares += np.square(task.plant.outputs - task.rows.parts["outputs"]).sum(axis=1)
    return np.sqrt(squares / plans[0].steps)


def test_the_teacher_beats_feedforward_and_feedback_with_the_true_mass():
    rig, plan = plan_of("overhead_crane")
    scenarios = [Scenario(), *design(Disturbances.standard(rig), 7, 3)]
    plans = [plan] * len(scenarios)
    task = CraneTask(rig, num=len(plans), disturbances="standard", timestep=5e-3, nthread=1)
    teacher = CraneTeacher(task, plans, scenarios)
    feedback = PDLaw(task, task.gains(), moving=True, hold=False).feedback
    exact = np.array([feedforward_with(rig, plan, s.load_mass) for s in scenarios])

    def pd():
        return exact[np.arange(task.num), task.steps] + feedback()

    base = drive(task, plans, scenarios, pd)
    teacher.reset()
    taught = drive(task, plans, scenarios, teacher.advice, teacher.sent)
    assert taught[0] < 1e-3
    assert taught[1:].mean() < 0.2 * base[1:].mean()
    assert (taught[1:] < base[1:]).all()
    truth = teacher.truth()
    assert truth["mass"][:, 0] == pytest.approx([s.load_mass - 1.0 for s in scenarios])
    assert truth["offset"] == pytest.approx(task.plant.outputs - task.rows.parts["outputs"])
