"""Disturbances: what they do to the plant, and that they are the same for every controller."""

from dataclasses import asdict, replace

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import models
from flatrig.envs.disturbances import DIMENSIONS
from flatrig.envs.plant import Plant

OVERHEAD, ROPED, ROTARY = envs.ENVIRONMENTS
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
        assert info["scenario"] == scenario
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


def test_without_options_every_episode_draws_its_own():
    env = make(disturbances="standard")
    drawn = [env.reset(seed=1)[1]["scenario"], env.reset()[1]["scenario"]]
    assert drawn[0] != drawn[1]
    assert env.reset(seed=1)[1]["scenario"] == drawn[0]
    assert make().reset(seed=1)[1]["scenario"] == envs.Scenario()


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
    force = env.unwrapped.task.plant._friction.read()[0]
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
