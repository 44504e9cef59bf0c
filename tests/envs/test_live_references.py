"""References that are given while an episode runs: new goals, stops, an operator's velocities."""

import warnings
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.envs.crane.payloads import reloaded
from flatrig.envs.crane.plan import make_plan
from flatrig.envs.crane.tuning import gains_along
from flatrig.envs.plans import steps_ahead

NAMES = list(envs.ENVIRONMENTS)
OVERHEAD, ROTARY = "flatrig/OverheadCrane-v0", "flatrig/RotaryCrane-v0"
CABLEV = "flatrig/CableManipulator-v0"
WORKSHOP = Path(__file__).parents[2] / "docs/how-to/workshop_crane.toml"


def make(name=OVERHEAD, **options):
    return gym.make(name, **options)


def with_feedback(name=OVERHEAD, **options):
    return envs.Feedforward(envs.PD(make(name, **options)))


def goes_on(env, steps, action=None):
    """Step with zero action; the last info, and the largest error of the outputs."""
    action = np.zeros(env.action_space.shape) if action is None else action
    most = 0.0
    for _ in range(steps):
        _, _, terminated, truncated, info = env.step(action)
        assert not terminated, env.unwrapped.reasons[info["reason"]]
        most = max(most, float(np.abs(info["load"] - info["reference"]).max()))
        if truncated:
            break
    return info, most


@pytest.mark.parametrize("name", [OVERHEAD, ROTARY, CABLEV])
def test_gymnasium_finds_nothing_wrong_with_an_operator(name):
    env = make(name, reference="operator", disturbances="standard", sensors="full")
    rig = env.unwrapped.task.rig
    assert env.unwrapped.action_names == tuple(f"{output}.velocity" for output in rig.outputs)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped, skip_render_check=True)


@pytest.mark.parametrize("name", NAMES)
def test_an_operator_leads_the_load(name):
    """It goes where it is led; what is planned is the exact motion along what was let through."""
    env = make(name, reference="operator")
    task = env.unwrapped.task
    env.reset(seed=0)
    start = task.rows.parts["outputs"][0].copy()
    led = [task.rig.outputs.index(name.removesuffix(".velocity")) for name in task.action_names]
    move = models.default_move(task.rig)
    way = np.sign(np.subtract(move.goal, move.start))
    rows = []
    for _ in range(50):
        info, error = goes_on(env, 1, 0.3 * way[led])
        assert error < 1e-3
        rows.append({part: values[0].copy() for part, values in task.rows.parts.items()})
    gone = (info["load"] - start) * way
    assert np.linalg.norm(gone) > 1e-3
    assert (gone[way != 0] > 0).any()
    # The second road: the whole path that was commanded, solved at once from the rig's home.
    last = task.plans[0]
    times = task.period * np.arange(1, 51 + max(steps_ahead(task.period)))
    motion = feedforward.solve(task.rig, last.reference, times)
    drives = motion.drive_positions.shape[1]
    for k in (0, 17, 49):
        assert rows[k]["outputs"] == pytest.approx(motion.outputs[k], abs=1e-9)
        assert rows[k]["drives"][:drives] == pytest.approx(motion.drive_positions[k], abs=1e-9)
        assert rows[k]["drives"][drives:] == pytest.approx(motion.drive_velocities[k], abs=1e-8)
        assert rows[k]["left"] == pytest.approx(1.0 - (k + 1) / last.steps)
    # What is seen ahead of the last step is the stop that would follow.
    ahead = [motion.drive_positions[49 + step] for step in steps_ahead(task.period)]
    expected = np.concatenate(ahead) - np.tile(motion.drive_positions[49], len(ahead))
    assert rows[49]["preview"] == pytest.approx(expected, abs=1e-9)
    middle = feedforward.solve(task.rig, last.reference, times[49] + 0.5 * task.period)
    assert rows[49]["feedforward"] * task.limits == pytest.approx(
        middle.inputs[0], abs=1e-8 * np.abs(middle.inputs).max()
    )


@pytest.mark.parametrize("name", [OVERHEAD, ROTARY])
def test_single_and_vector_agree_to_the_last_bit_with_an_operator(name):
    """Also where some episodes are over and begin anew, and one is redirected."""
    options = {"disturbances": "standard", "sensors": "sway", "reference": "operator"}
    count = 3
    vector = gym.make_vec(name, num_envs=count, nthread=2, **options)
    singles = [make(name, **options) for _ in range(count)]
    rng = np.random.default_rng(0)
    observations, _ = vector.reset(seed=5)
    for index, single in enumerate(singles):
        assert np.array_equal(single.reset(seed=5 + index)[0], observations[index])
    over = np.zeros(count, dtype=bool)
    for k in range(20):
        if k == 10:  # one simulation is lost, and its episode over
            for task, sim in ((vector.unwrapped.task, 1), (singles[1].unwrapped.task, 0)):
                task.plant.qvel[sim] = np.nan
        actions = rng.uniform(-1.0, 1.0, (count, singles[0].action_space.shape[0]))
        observations, rewards, terminated, truncated, _ = vector.step(actions)
        for index, single in enumerate(singles):
            if over[index]:
                observation, reward = single.reset()[0], 0.0
            else:
                observation, reward, *_ = single.step(actions[index])
            assert np.array_equal(observation, observations[index])
            assert reward == rewards[index]
        over = terminated | truncated
        assert over.any() == (k == 10)


def test_an_operator_is_leading_with_feedforward_and_feedback_below():
    options = {"disturbances": "standard", "sensors": "full"}
    operated = make(ROTARY, reference="operator", **options)
    move = models.default_move("rotary_crane")
    led = with_feedback(ROTARY, reference=feedforward.hold(move.start, 30.0), **options)
    assert np.array_equal(operated.reset(seed=2)[0], led.reset(seed=2)[0])
    rng = np.random.default_rng(0)
    for _ in range(30):
        velocity = rng.uniform(-1.5, 1.5, 3)
        led.unwrapped.lead(np.clip(velocity, -1.0, 1.0))
        one, other = operated.step(velocity), led.step(np.zeros(3))
        assert np.array_equal(one[0], other[0])
        assert one[1] == other[1]


def test_specs_with_an_operator_can_be_saved():
    env = make(reference="operator")
    again = gym.make(gym.envs.registration.EnvSpec.from_json(env.spec.to_json()))
    assert again.unwrapped.action_names == env.unwrapped.action_names


def test_an_operator_leads_a_rig_of_ones_own():
    env = make(envs.OWN, rig=str(WORKSHOP), reference="operator")
    env.reset(seed=0)
    info, error = goes_on(env, 80, np.array([0.2, 0.0, 0.1]))
    assert error < 1e-3
    assert info["load"][0] > env.unwrapped.task.plans[0].start["load.x"] + 0.02


def test_a_goal_can_change_on_the_way():
    env = with_feedback(hold=1.0)
    task = env.unwrapped.task
    env.reset(seed=0)
    goes_on(env, 70)
    before = {part: values[0].copy() for part, values in task.rows.parts.items()}
    goal = (1.0, -3.0)
    env.unwrapped.redirect(lambda state: feedforward.connected(state.derivatives, goal, 4.0))
    plan = task.plans[0]
    after = {part: values[0].copy() for part, values in task.rows.parts.items()}
    for part in ("drives", "outputs", "output_rates", "holding"):
        assert after[part] == pytest.approx(before[part], rel=1e-9, abs=1e-9)
    assert not np.allclose(after["preview"], before["preview"])
    assert plan.steps == 70 + round(5.0 / task.period)
    whole = feedforward.solve(task.rig, plan.reference, task.period * np.arange(70, 80))
    assert plan.rows[:10, :2] == pytest.approx(whole.drive_positions, abs=1e-9)
    info, error = goes_on(env, 10_000)
    assert task.steps[0] == plan.steps
    assert env.unwrapped.reasons[info["reason"]] == "time"
    assert error < 1e-3
    assert info["load"] == pytest.approx(goal, abs=1e-3)
    assert task.rows.parts["left"][0] == 0.0


def test_gains_follow_what_is_planned_now():
    env = with_feedback(ROTARY)
    task = env.unwrapped.task
    env.reset(seed=0)
    goes_on(env, 100)
    far = (4.0, 2.0, -4.0)
    env.unwrapped.redirect(lambda state: feedforward.connected(state.derivatives, far, 6.0))
    schedule = env.env.law.schedule
    for led in (False, True):
        for _ in range(20):
            if led:
                env.unwrapped.lead((0.2, 0.0, 0.0))
            goes_on(env, 1)
        step, path = int(task.steps[0]), task.plans[0].reference
        whole = make_plan(task.rig, path, task.period, 0.0)
        exact = gains_along(task.plant, whole)[[0, step, -1]]
        assert schedule.now()[0] == pytest.approx(exact[1], rel=1e-6, abs=1e-9)
        assert not np.allclose(exact[0], exact[1], rtol=1e-2)


def test_an_emergency_stop_stays_on_the_way():
    env = with_feedback(ROTARY, hold=0.5)
    task = env.unwrapped.task
    env.reset(seed=0)
    goes_on(env, 100)
    old = task.plans[0].reference
    env.unwrapped.redirect(lambda state: feedforward.stopped(old, state.time, 2.5))
    info, error = goes_on(env, 10_000)
    assert error < 1e-3
    assert info["load"] == pytest.approx(old([2.0 + 1.25])[0], abs=1e-3)


def test_goals_change_again_and_operators_come_and_go():
    """From a move to a velocity, to a new goal, and to a velocity again, without a jump."""
    slowly = feedforward.rest_to_rest((0.0, -4.0), (5.0, -1.0), 8.0)
    env = with_feedback(reference=slowly, hold=2.0)
    task = env.unwrapped.task
    env.reset(seed=0)
    goes_on(env, 50)
    length = task.plans[0].steps
    for _ in range(40):
        env.unwrapped.lead((0.3, 0.1))
        assert goes_on(env, 1)[1] < 1e-3
    assert task.plans[0].steps == length
    env.unwrapped.redirect(lambda state: feedforward.connected(state.derivatives, (2, -3), 5.0))
    assert goes_on(env, 30)[1] < 1e-3
    for _ in range(20):
        env.unwrapped.lead((-0.3, 0.1))
        assert goes_on(env, 1)[1] < 1e-3
    times = task.period * np.arange(1, 140)
    changes = np.diff(feedforward.solve(task.rig, task.plans[0].reference, times).inputs, axis=0)
    assert np.abs(changes).max() < 30.0  # a jump of the load's jerk would show
    _, error = goes_on(env, 10_000)  # and nobody leads any more
    assert error < 1e-3
    assert np.allclose(task.rows.parts["output_rates"], 0.0, atol=1e-4)


def test_a_simulation_that_is_not_led_stops():
    one, other = (with_feedback(reference="random") for _ in range(2))
    for env in (one, other):
        env.reset(seed=3)
        goes_on(env, 20)
        env.unwrapped.lead((0.5, 0.5))
    for _ in range(20):
        a = one.step(np.zeros(2))
        b = other.step(np.zeros(2))
        other.unwrapped.lead((0.0, 0.0))
        assert a[0][:10] == pytest.approx(b[0][:10], abs=1e-12)


def test_only_some_of_many_are_given_another_reference():
    options = {"sensors": "sway", "hold": 0.2}
    vector, untouched = (
        envs.Feedforward(envs.PD(gym.make_vec(OVERHEAD, num_envs=3, **options))) for _ in range(2)
    )
    actions = np.zeros((3, 2))
    for env in (vector, untouched):
        env.reset(seed=0)
        for _ in range(70):
            env.step(actions)
    ids = np.array([1], dtype=np.int32)

    def slower(state):
        return feedforward.connected(state.derivatives, (1.0, -3.0), 4.0)

    vector.unwrapped.redirect([slower], ids)
    lengths = vector.unwrapped.task.rows.length
    assert lengths[1] > lengths[0] == lengths[2] == untouched.unwrapped.task.rows.length[0]
    while not vector.unwrapped.over[0]:
        seen, other = vector.step(actions), untouched.step(actions)
        assert np.array_equal(seen[0][[0, 2]], other[0][[0, 2]])
    assert not vector.unwrapped.over[1]
    noise = vector.unwrapped.task.loads._noise[1]
    assert len(np.unique(noise[: lengths[1] + 1], axis=0)) == lengths[1] + 1


@pytest.mark.parametrize("name", [OVERHEAD, ROTARY])
def test_feedforward_of_another_load_along_what_an_operator_did(name):
    env = make(name, reference="operator")
    task = env.unwrapped.task
    env.reset(seed=0)
    goes_on(env, 25, np.full(len(task.rig.outputs), 0.4))
    goes_on(env, 10, np.full(len(task.rig.outputs), 0.2))
    plan = task.plans[0]
    now = task.period * 34
    for mass in (1.0, 1.3):
        rig = reloaded(task.rig, mass)
        exact = feedforward.solve(rig, plan.reference, now).inputs[0] / task.limits
        assert plan.inputs_with(task.rig, mass)[0] == pytest.approx(exact, abs=1e-9)


def test_what_cannot_be_is_refused_in_one_line():
    env = make()
    for call in (lambda: env.unwrapped.lead((0, 0)), lambda: env.unwrapped.redirect(None)):
        with pytest.raises(models.OptionError, match="no episode has begun"):
            call()
    env.reset(seed=0)
    task = env.unwrapped.task
    plan, seen = task.plans[0], task.observation()
    away = feedforward.rest_to_rest((3.0, -2.0), (4.0, -2.0), 3.0)
    with pytest.raises(models.PathError) as caught:
        env.unwrapped.redirect(away)
    assert "\n" not in str(caught.value)
    with pytest.raises(models.OptionError, match="it must be a Reference or a Move"):
        env.unwrapped.redirect(7)
    with pytest.raises(models.PathError, match="slack"):
        env.unwrapped.redirect(lambda s: feedforward.connected(s.derivatives, (0, -3), 0.6))
    assert task.plans[0] is plan
    assert np.array_equal(task.observation(), seen)
    with pytest.raises(models.PathError, match="velocity"):
        env.unwrapped.lead((np.nan, 0.0))
    env.unwrapped.lead((0.1, 0.0))
    with pytest.raises(models.OptionError, match="led in this step already"):
        env.unwrapped.lead((0.1, 0.0))
    for wrapper in (envs.PD, envs.Feedforward, envs.Residual):
        with pytest.raises(models.OptionError, match="velocities"):
            wrapper(make(reference="operator"))
    operated = make(reference="operator")
    operated.reset(seed=0)
    with pytest.raises(models.OptionError, match=r"load\.z\.velocity"):
        operated.step([0.0, np.nan])
    with pytest.raises(models.OptionError, match="shape"):
        operated.step([0.0])


@pytest.mark.parametrize("name", [OVERHEAD, CABLEV])
def test_the_plant_of_an_episode_that_runs_can_change(name):
    """Changed at once it is the plant that was made so; and others stay what they are."""
    other = envs.Scenario(load_mass=1.2, wind=30.0, trolley_viscous=5.0)
    made, changed = (
        envs.Feedforward(envs.PD(gym.make_vec(name, num_envs=2, sensors="full"))) for _ in range(2)
    )
    made.reset(seed=0, options={"scenarios": [envs.Scenario(), other]})
    changed.reset(seed=0, options={"scenarios": [envs.Scenario(), envs.Scenario()]})
    task = changed.unwrapped.task
    joints = task.plant.qpos.copy()
    task.disturb([other], np.array([1], dtype=np.int32))
    assert np.array_equal(task.plant.qpos, joints)
    assert task.scenarios == [envs.Scenario(), other]
    actions = np.zeros(made.action_space.shape)
    for _ in range(10):
        one, two = made.step(actions), changed.step(actions)
        assert np.array_equal(one[0][0], two[0][0])
        assert one[0][1] == pytest.approx(two[0][1], abs=1e-12)
    before = task.plant.tensions.sum(axis=1)
    task.disturb([other, envs.Scenario()])
    assert task.plant.tensions[0].sum() > before[0]
    assert task.plant.tensions[1].sum() < before[1]
    with pytest.raises(models.OptionError, match="friction"):
        task.disturb([envs.Scenario(winch_friction=5.0)] * 2)
    assert task.scenarios == [other, envs.Scenario()]
