"""Disturbances: what they do to the plant, and that they are the same for every controller."""

from dataclasses import asdict, replace

import gymnasium as gym
import mujoco
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import models
from flatrig.envs.crane.disturbances import DIMENSIONS
from flatrig.envs.crane.plant import Plant
from flatrig.envs.formulas import Formulas
from flatrig.models.friction import Friction

OVERHEAD, ROPED, ROTARY, *_ = envs.ENVIRONMENTS
NAVY, CABLEV = "flatrig/NavyCrane2D-v0", "flatrig/CableManipulator-v0"
FRICTION = envs.Disturbances(winch_friction=(0, 50), trolley_friction=(0, 50))


def make(name=OVERHEAD, **options):
    return gym.make(name, **options)


def start(scenario, name=OVERHEAD, **options):
    env = make(name, **options)
    env.reset(seed=0, options={"scenario": scenario})
    return env


def follow(env, steps, action=(0.02, -0.49)):
    """Loads after each of some steps under a constant action."""
    return np.array([env.step(np.array(action))[4]["load"] for _ in range(steps)])


def test_a_design_is_the_same_for_the_same_seed_and_covers_its_ranges():
    disturbances = envs.Disturbances.standard(models.overhead_crane())
    scenarios = envs.design(disturbances, 50, seed=3)
    assert scenarios == envs.design(disturbances, 50, seed=3)
    assert scenarios != envs.design(disturbances, 50, seed=4)
    masses = np.sort([scenario.load_mass for scenario in scenarios])
    strata = 0.7 + 0.6 * np.arange(51) / 50
    assert ((masses >= strata[:-1]) & (masses <= strata[1:])).all()  # one in each of 50 parts
    delays = [scenario.delay for scenario in scenarios]
    assert set(delays) == {0, 1, 2}
    assert min(delays.count(delay) for delay in range(3)) >= 16


def test_every_controller_meets_the_same_scenario():
    scenario, other = envs.design(envs.Disturbances.standard(models.overhead_crane()), 2, seed=0)
    plants = []
    for build in (envs.PD, envs.Feedforward, lambda env: envs.PD(env, track="set point")):
        env = build(make(disturbances="standard"))
        env.reset(options={"scenario": other})
        before = in_plant(env)
        _, info = env.reset(options={"scenario": scenario})
        assert info["scenario"].tolist() == list(vars(scenario).values())
        assert env.unwrapped.task.scenarios == [scenario]
        plants.append(in_plant(env))
        assert all(
            not np.array_equal(one, two) for one, two in zip(before, plants[-1], strict=True)
        )
    for plant in plants[1:]:
        assert all(np.array_equal(one, two) for one, two in zip(plants[0], plant, strict=True))


def in_plant(env):
    """What a scenario has changed in the only simulation: masses, friction, wind, delay."""
    task = env.unwrapped.task
    plant, wind = task.plant, task.plant._wind
    return (
        plant._masses[0].copy(),
        plant._friction._on_tendon[0].copy(),
        plant._friction._on_joint[0].copy(),
        np.array((wind._steady[0], wind._gust[0], wind._rate[0], wind._phase[0])),
        task._commands._periods.copy(),
    )


def test_the_same_scenario_is_the_same_episode_single_or_vector():
    scenarios = envs.design(envs.Disturbances.standard(models.overhead_crane()), 4, seed=0)
    vector = gym.make_vec(OVERHEAD, num_envs=4, disturbances="standard")
    vector.reset(seed=0, options={"scenarios": scenarios})
    actions = np.tile([0.02, -0.49], (4, 1))
    together = np.array([vector.step(actions)[4]["load"] for _ in range(20)])
    for index, scenario in enumerate(scenarios):
        env = start(scenario, disturbances="standard")
        assert np.array_equal(follow(env, 20), together[:, index])


def drawn_by(env, **how):
    env.reset(**how)
    return env.unwrapped.task.scenarios[0]


def test_without_options_every_episode_draws_its_own():
    env = make(disturbances="standard")
    drawn = [drawn_by(env, seed=1), drawn_by(env)]
    assert drawn[0] != drawn[1]
    assert drawn_by(env, seed=1) == drawn[0]
    assert drawn_by(make(), seed=1) == envs.Scenario()


@pytest.mark.parametrize("factor", [0.7, 1.3])
def test_the_load_mass_is_that_of_a_model_compiled_with_it(factor):
    disturbed = follow(start(envs.Scenario(load_mass=factor)), 30)
    rig = models.overhead_crane(load_mass=100.0 * factor)
    rig = replace(rig, drives=models.overhead_crane().drives)  # actions mean the same inputs
    own = envs.CraneTask(rig)
    own.reset(own.all, [np.random.default_rng(0)])
    own.plant.ctrl[...] = 0.0
    loads = []
    for _ in range(30):
        own.step([[0.02, -0.49]])
        loads.append(own.plant.outputs[0].copy())
    assert np.allclose(disturbed, loads, atol=1e-12)
    assert np.abs(disturbed - follow(start(envs.Scenario()), 30)).max() > 0.01


def test_masses_of_one_simulation_leave_the_others_alone():
    vector = gym.make_vec(OVERHEAD, num_envs=2)
    vector.reset(options={"scenarios": [envs.Scenario(load_mass=1.3), envs.Scenario()]})
    actions = np.tile([0.02, -0.49], (2, 1))
    loads = np.array([vector.step(actions)[4]["load"][1] for _ in range(10)])
    assert np.allclose(loads, follow(start(envs.Scenario()), 10), rtol=0, atol=1e-14)


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_a_delay_is_exactly_that_many_steps(delay):
    env = start(envs.Scenario(delay=delay))
    inputs = []
    for step in range(6):
        *_, info = env.step(np.array([0.01 * (step + 1), -0.49]))
        inputs.append(info["input"].tolist())
    limits = env.unwrapped.task.limits
    sent = np.array([[0.01 * (step + 1), -0.49] for step in range(6)]) * limits
    expected = [(0.0, -98.1)] * delay + sent[: 6 - delay].tolist()
    assert np.allclose(inputs, expected)


def test_encoders_read_multiples_of_their_resolution_and_count():
    step = 0.01
    env = start(envs.Scenario(encoder_resolution=step))
    encoders, period = env.unwrapped.task.encoders, env.unwrapped.task.period
    plant = env.unwrapped.task.plant
    before = encoders.positions.copy()
    coarse = False
    for _ in range(20):
        env.step(np.array([0.1, -0.45]))
        assert np.allclose(encoders.positions / step, np.round(encoders.positions / step))
        assert np.abs(encoders.positions - plant.drive_positions).max() <= 0.5 * step + 1e-12
        assert np.allclose(encoders.rates, (encoders.positions - before) / period)
        coarse |= not np.allclose(encoders.rates, plant.drive_rates, atol=1e-3)
        before = encoders.positions.copy()
    assert coarse


def test_encoders_without_resolution_read_the_truth_beside_others_that_do_not():
    vector = gym.make_vec(OVERHEAD, num_envs=2)
    scenarios = [envs.Scenario(encoder_resolution=0.01), envs.Scenario()]
    vector.reset(options={"scenarios": scenarios})
    single = start(envs.Scenario())
    for _ in range(10):
        observations = vector.step(np.tile([0.1, -0.45], (2, 1)))[0]
        assert np.array_equal(observations[1], single.step(np.array([0.1, -0.45]))[0])


def test_swing_starts_at_rest_at_its_angle():
    for name, rope in ((OVERHEAD, 4.0), (ROPED, 4.0), (ROTARY, 5.0)):
        env = start(envs.Scenario(swing=0.1, swing_direction=0.5), name)
        still, swung = start(envs.Scenario(), name), env.unwrapped.task.plant
        shift = swung.outputs[0] - still.unwrapped.task.plant.outputs[0]
        assert np.isclose(np.linalg.norm(shift[:-1]), rope * np.sin(0.1))
        assert np.isclose(shift[-1], rope * (1 - np.cos(0.1)))
        assert np.allclose(swung.drive_positions, still.unwrapped.task.plant.drive_positions)
        assert (swung.qvel == 0).all()


def test_wind_pushes_the_load_where_it_blows():
    env = start(envs.Scenario(wind=20.0, wind_direction=np.pi / 2), ROTARY)
    *_, info = env.step(
        np.array(env.unwrapped.task.plant.model.key_ctrl[0]) / env.unwrapped.task.limits
    )
    shift = info["load"] - (5.0, 0.0, -5.0)
    assert np.isclose(shift[1], 0.5 * 20.0 / 100.0 * 0.02**2, rtol=1e-2)
    assert abs(shift[0]) < 1e-3 * shift[1]


def test_gusts_come_and_go():
    plant = Plant(models.overhead_crane(), 1, timestep=1e-3, substeps=10)
    scenario = envs.Scenario(gust=10.0, gust_frequency=0.5, gust_phase=0.0)
    ids = np.arange(1, dtype=np.int32)
    plant.reset(ids, plant.home[None], plant.model.key_ctrl[0], [scenario])
    forces = []
    for _ in range(100):
        plant.step()
        forces.append(plant.batch.bind("xfrc_applied")[0, 2, 0])
    expected = 10.0 * np.sin(2 * np.pi * 0.5 * 0.01 * np.arange(100))
    assert np.allclose(forces, expected, atol=1e-9)


def test_friction_stops_a_trolley_and_shows_in_the_tension():
    """Within what it can bear nothing creeps far; beyond, the rope's force is less by it."""
    slide = envs.Scenario(trolley_friction=30.0)
    moved = follow(start(slide, disturbances=FRICTION), 20, (20.0 / 1079.1, -0.5))[-1, 0]
    free = follow(start(envs.Scenario()), 20, (20.0 / 1079.1, -0.5))[-1, 0]
    assert abs(moved) < 0.05 * abs(free) or abs(moved) < 1e-3

    env = start(envs.Scenario(winch_friction=40.0), disturbances=FRICTION)
    for _ in range(20):
        *_, info = env.step(np.array([0.0, -0.6]))  # hauls in: friction helps to carry
    force = 100.0 * (9.81 + acceleration(env))
    assert np.isclose(info["tension"][0], force, rtol=1e-6)
    assert np.isclose(info["tension"][0] + 10.0 * acceleration(env), 0.6 * 1962.0 - 40.0, rtol=1e-3)


def acceleration(env):
    """Of the load upwards, with the trolley at rest below the rope [m/s2]."""
    plant = env.unwrapped.task.plant
    return float(plant.batch.bind("qacc")[0, 2])


def test_friction_of_two_drives_on_one_joint_is_shared():
    env = start(
        envs.Scenario(winch_friction=20.0, trolley_friction=10.0), ROPED, disturbances=FRICTION
    )
    hold = env.unwrapped.task.plant.model.key_ctrl[0] / env.unwrapped.task.limits
    for _ in range(20):
        env.step(1.1 * hold)
    step, along = Formulas(1), np.zeros((1, 2))
    step.keep(along, env.unwrapped.task.plant._friction.along(step))
    step.made()()
    force = along[0]
    assert 10.0 < abs(force[0]) <= 20.001  # nearly slipping; the trolley bears the rest


def test_friction_needs_an_environment_made_for_it():
    with pytest.raises(models.OptionError, match="made without"):
        start(envs.Scenario(winch_friction=1.0))


def test_standard_disturbances_scale_with_the_load():
    light = envs.Disturbances.standard(models.overhead_crane(load_mass=10.0))
    heavy = envs.Disturbances.standard(models.overhead_crane(load_mass=100.0))
    assert np.allclose(10 * np.array(light.wind), heavy.wind)
    assert heavy.load_mass == (0.7, 1.3)
    assert heavy.delay == (0, 2)


def test_a_scenario_from_the_middle_of_the_cube():
    disturbances = envs.Disturbances(load_mass=(0.5, 1.5), delay=(1, 3), encoder_resolution=0.1)
    scenario = disturbances.scenario(np.full(DIMENSIONS, 0.5))
    assert asdict(scenario)["load_mass"] == 1.0
    assert (scenario.delay, scenario.encoder_resolution) == (2, 0.1)
    assert scenario.wind == 0.0


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"load_mass": 0.0}, "load_mass is 0"),
        ({"wind": np.nan}, "wind is nan"),
        ({"winch_friction": -1.0}, "winch_friction is -1"),
        ({"wind": "a"}, "wind is 'a', it must be a finite number"),
        ({"gust": 5.0}, "a gust needs a frequency"),
        ({"encoder_resolution": (0.0, 0.1)}, "encoder_resolution is"),
        ({"delay": 1.5}, "whole number"),
        ({"delay": 99}, "at most 31"),
        ({"static_friction": 0.9}, "static_friction is 0.9, it must be a finite number >= 1"),
        ({"winch_viscous": -1.0}, "winch_viscous is -1"),
        ({"stribeck_velocity": 0.0}, "stribeck_velocity is 0"),
    ],
)
def test_wrong_scenarios_get_one_line(values, message):
    with pytest.raises(models.OptionError, match=message):
        envs.Scenario(**values)


def test_wrong_ranges_get_one_line():
    with pytest.raises(models.OptionError, match=r"must be \(low, high\)"):
        envs.Disturbances(wind=3.0)
    with pytest.raises(models.OptionError, match="wind is 'a'"):
        envs.Disturbances(wind=("a", "b"))
    with pytest.raises(models.OptionError, match="gusts need frequencies"):
        envs.Disturbances(gust=(0.0, 50.0))
    with pytest.raises(models.OptionError, match="number of scenarios is 0"):
        envs.design(envs.Disturbances(), 0, seed=0)
    with pytest.raises(models.OptionError, match="seed is -1"):
        envs.design(envs.Disturbances(), 1, seed=-1)


def test_directions_are_drawn_for_ranges_below_zero_too():
    scenarios = envs.design(envs.Disturbances(swing=(-0.2, 0.0)), 3, seed=0)
    assert all(scenario.swing_direction > 0 for scenario in scenarios)
    assert all(scenario.wind_direction == 0 for scenario in scenarios)


def test_more_kinds_of_friction_leave_the_other_draws_as_they_are():
    plain = envs.Disturbances.standard(models.overhead_crane())
    more = replace(plain, winch_viscous=(0.0, 5.0), static_friction=(1.0, 2.0))
    for one, other in zip(envs.design(plain, 5, 3), envs.design(more, 5, 3), strict=True):
        assert replace(other, winch_viscous=0.0, static_friction=1.0) == one
        assert other.winch_viscous > 0
    generator = np.random.default_rng(0)
    plain.draw(generator)
    untouched = np.random.default_rng(0)
    untouched.random(DIMENSIONS)
    assert generator.random() == untouched.random()


def test_viscous_friction_is_mujocos_damping_and_shows_in_the_tension():
    scenario = envs.Scenario(winch_viscous=80.0, trolley_viscous=30.0)
    env = start(scenario)
    model = models.compile(models.overhead_crane(), visuals=False, timestep=2e-3)
    model.tendon_damping[0], model.joint("trolley.position").damping = 80.0, 30.0
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.ctrl = np.array([0.02, -0.55]) * env.unwrapped.task.limits
    for _ in range(20):
        *_, info = env.step(np.array([0.02, -0.55]))
        mujoco.mj_step(model, data, 10)
    assert np.allclose(env.unwrapped.task.plant.qpos[0], data.qpos, rtol=0, atol=1e-12)
    load = env.unwrapped.task.plant.batch.bind("qacc")[0, 1:]
    rope = data.site("load").xpos - data.site("trolley").xpos
    pull = 100.0 * (9.81 + load[1]) / (-rope[2] / np.linalg.norm(rope))
    assert info["tension"][0] == pytest.approx(pull, rel=1e-9)


def test_static_friction_holds_what_coulomb_friction_lets_go():
    """Pushed with 1.2 times Coulomb friction, a trolley stays if 1.5 times hold it."""
    moved = []
    for static in (1.0, 1.5):
        scenario = envs.Scenario(trolley_friction=40.0, static_friction=static)
        env = start(scenario, disturbances=FRICTION)
        for _ in range(10):
            env.step(np.array([48.0, -98.1]) / env.unwrapped.task.limits)
        moved.append(abs(env.unwrapped.task.plant.drive_positions[0, 0]))
    assert moved[0] > 5e-3
    assert moved[1] < 0.1 * moved[0]  # MuJoCo's friction creeps


def test_bounds_of_static_friction_follow_its_law():
    scenario = envs.Scenario(winch_friction=20.0, static_friction=1.7, stribeck_velocity=0.05)
    env = start(scenario, disturbances=FRICTION)
    plant = env.unwrapped.task.plant
    env.step(np.array([0.0, -0.7]))
    law = Friction(20.0, static=34.0, stribeck_velocity=0.05)
    plant._friction.follow()
    speed = plant.batch.bind("ten_velocity")[0, 0]
    assert 0.01 < abs(speed) < 0.2
    assert plant._friction._on_tendon[0, 0] == pytest.approx(float(law.dry(speed)), rel=1e-12)


def test_a_frame_that_rubs_stays_where_it_is():
    moved = []
    for friction in (0.0, 50.0):
        env = start(
            envs.Scenario(frame_friction=friction), ROTARY, disturbances={"frame_friction": (0, 99)}
        )
        pushed = env.unwrapped.task.plant.model.key_ctrl[0] + np.array([40.0, 0.0, 0.0])
        for _ in range(20):
            env.step(pushed / env.unwrapped.task.limits)
        moved.append(abs(env.unwrapped.task.plant.drive_positions[0, 0]))
    assert moved[1] < 0.05 * moved[0]
    with pytest.raises(models.OptionError, match="frames have Coulomb friction in the scenario"):
        start(envs.Scenario(frame_friction=1.0), ROTARY, disturbances=FRICTION)


def test_a_scene_has_no_friction_that_nobody_asked_for():
    plant = start(envs.Scenario()).unwrapped.task.plant
    assert plant._friction is None
    assert plant._viscous is None
    assert not plant.model.dof_damping.any()
    assert plant.model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)


def test_the_load_mass_of_a_platform_scales_its_inertia_and_leaves_pulleys_alone():
    plant = start(envs.Scenario(load_mass=1.2), CABLEV).unwrapped.task.plant
    body = plant.model.body("platform").id
    assert plant.batch.expand("body_mass")[0, body] == pytest.approx(15.0)
    assert np.allclose(plant.batch.expand("body_inertia")[0, body], (0.9, 0.9, 1.8))
    plant = start(envs.Scenario(load_mass=1.2, wind=7.0), NAVY).unwrapped.task.plant
    bodies = [plant.model.body(name).id for name in ("pulley", "load")]
    assert plant.batch.expand("body_mass")[0, bodies].tolist() == [150.0, 120.0]
    assert plant.batch.bind("xfrc_applied")[0, bodies, 0].tolist() == [0.0, 7.0]


def test_a_platform_swings_without_turning_on_ropes_as_long():
    still, swung = (start(envs.Scenario(swing=angle), CABLEV) for angle in (0.0, 0.1))
    before, after = (env.unwrapped.task.plant for env in (still, swung))
    assert np.allclose(before.drive_positions, after.drive_positions, atol=1e-12)
    moved = after.outputs[0] - before.outputs[0]
    assert np.allclose(moved[:3], (3.0 * np.sin(0.1), 0.0, 3.0 - 3.0 * np.cos(0.1)), atol=1e-12)
    assert np.allclose(moved[3:], 0.0, atol=1e-12)
