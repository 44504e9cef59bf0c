"""The load's mass from encoders: that it is found, on every rig, and what it is good for."""

from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.envs.crane.plan import feedforward_with, layout_of, make_plan
from flatrig.models.errors import OptionError

NAMES = list(envs.ENVIRONMENTS)
OVERHEAD = NAMES[0]
DOUBLE = "double_pendulum_crane"
SHORT = feedforward.rest_to_rest((0, -4), (1, -3), 2.5)


def make(name=OVERHEAD, **options):
    return gym.make(name, **options)


def run(env, seed):
    """The observations of an episode of the overhead crane."""
    observations, over = [env.reset(seed=seed)[0]], False
    while not over:
        observation, _, terminated, truncated, _ = env.step(np.zeros(2))
        observations.append(observation)
        over = terminated or truncated
    return np.array(observations)


def base(env):
    return envs.Feedforward(envs.PD(env))


def half_way(name):
    """A calm move to the middle of the catalogue's."""
    move = models.default_move(envs.ENVIRONMENTS[name])
    middle = tuple(0.5 * (first + last) for first, last in zip(move.start, move.goal, strict=True))
    return replace(move, goal=middle)


def estimating(name, masses, seconds, **options):
    """Estimates over so many seconds, (steps, n)."""
    scenarios = [envs.Scenario(load_mass=mass) for mass in masses]
    env = gym.make_vec(name, num_envs=len(masses), timestep=1e-2, hold=12.0, **options)
    env = envs.MassEstimate(base(env))
    env.reset(seed=0, options={"scenarios": scenarios})
    history = []
    for _ in range(round(50 * seconds)):
        _, _, terminated, _, _ = env.step(np.zeros(env.action_space.shape))
        assert not terminated.any()
        history.append(env.law.estimate.copy())
    return np.array(history)


@pytest.mark.parametrize("name", NAMES)
def test_the_estimate_ends_at_the_true_mass_on_every_rig(name):
    masses = (0.8, 1.25)
    history = estimating(name, masses, 9.0, reference=half_way(name))
    assert history[-1] == pytest.approx(masses, abs=0.01)


@pytest.mark.parametrize("rate", [0.5, 1.0])
def test_at_rest_the_error_of_the_estimate_decays_at_the_rate(rate):
    home = models.make("overhead_crane").home["load"]
    there = feedforward.rest_to_rest((home[0], home[2]), (home[0], home[2] + 1e-6), 1.0)
    env = gym.make_vec(OVERHEAD, num_envs=1, reference=there, hold=12.0)
    env = envs.MassEstimate(base(env), rate=rate)
    env.reset(seed=0, options={"scenarios": [envs.Scenario(load_mass=1.2)]})
    errors = [env.step(np.zeros((1, 2))) and 1.2 - env.law.estimate[0] for _ in range(300)]
    # Feedback settles first, so the slope counts: by the law's promise it is the rate.
    slope = np.log(errors[150] / errors[250]) / 2.0
    assert slope == pytest.approx(rate, rel=0.1)


def test_the_sensitivity_is_that_of_a_crane_built_with_another_load():
    move = models.default_move("overhead_crane")
    env = envs.MassEstimate(base(make()))
    env.reset(seed=0)
    heavy = models.make("overhead_crane", load_mass=120.0)
    limits = np.array([drive.limit for drive in models.make("overhead_crane").drives])
    reference = feedforward.from_move(move)
    for step in range(3):
        instant = 0.02 * (step + 0.5)
        light = feedforward.solve(models.make("overhead_crane"), reference, instant).inputs[0]
        more = feedforward.solve(heavy, reference, instant).inputs[0] - light
        assert env.law.sensitivity[0] == pytest.approx(more / 0.2 / limits, rel=1e-9, abs=1e-12)
        env.step(np.zeros(2))


def bend(rig, path, duration):
    """What the feedforward is off a straight line in the load's mass, (N, drives)."""
    plan = make_plan(rig, path, duration / 40, 0.0)
    light, own, heavy = (feedforward_with(rig, plan, mass) for mass in (0.5, 1.0, 1.5))
    return light - 2.0 * own + heavy


PULLEY = "navy_crane_3d", "navy_ship_crane"
"""Rigs whose free pulley bends the way of the force in space."""


@pytest.mark.parametrize("name", sorted({*models.CATALOGUE} - {*PULLEY, DOUBLE}))
def test_the_feedforward_is_affine_in_the_mass(name):
    """No part between load and drives bends the way of the force."""
    rig, move = models.make(name), models.default_move(name)
    assert np.abs(bend(rig, feedforward.from_move(move), move.duration)).max() < 1e-13


def test_a_hook_that_keeps_its_mass_bends_the_way_of_the_force_as_much_as_by_hand():
    """To first order the rope leans by (h a'' + m a) / ((h + m) g), h and m the masses of hook and
    load, a the load's acceleration and l a''/g that of the hook beside it: what is above moves by
    h/(h + m) times rope and sling times a''/g2, whatever is straight in m aside."""
    rig, move = models.make(DOUBLE), models.default_move(DOUBLE)
    path = feedforward.from_move(move)
    trolley, hook, load = (part.mass for part in rig.masses)
    share = [hook / (hook + mass * load) for mass in (0.5, 1.0, 1.5)]
    times = np.linspace(0.0, move.duration, 801)
    sixth = path.derivatives(times, 6)[6, :, :2].T
    rope = feedforward.solve(rig, path, times)
    rope = rope.positions[:, rope.column("hoist.length")]
    sway = np.abs(rope * rig.link_length(rig.links[0]) * sixth / rig.gravity**2).max(axis=1)
    moved = np.array([trolley, trolley + rig.frames[0].inertia])  # along x, and along y
    by_hand = (share[0] - 2.0 * share[1] + share[2]) * moved * sway
    limits = [drive.limit for drive in rig.drives]
    found = np.abs(bend(rig, path, move.duration)).max(axis=0) * limits
    assert found[[1, 0]] == pytest.approx(by_hand, rel=0.06)


@pytest.mark.parametrize("name", PULLEY)
def test_a_pulley_bends_the_way_of_the_force_as_much_as_it_weighs(name):
    move = models.default_move(name)
    path = feedforward.from_move(move)
    heavy, light = (
        np.abs(bend(models.make(name, pulley_mass=mass), path, move.duration)).max()
        for mass in (5.0, 0.05)
    )
    assert 0.01 * heavy == pytest.approx(light, rel=0.2)
    assert heavy < 5e-5


@pytest.mark.parametrize("name", models.CATALOGUE)
def test_with_the_rigs_own_mass_it_is_the_plans_feedforward(name):
    rig, move = models.make(name), models.default_move(name)
    plan = make_plan(rig, feedforward.from_move(move), move.duration / 40, 1.0)
    planned = plan.rows[:, layout_of(rig).columns["feedforward"]]
    assert feedforward_with(rig, plan, 1.0) == pytest.approx(planned, rel=1e-9, abs=1e-12)


def test_single_and_vector_agree_to_the_last_bit_and_every_episode_starts_anew():
    options = {"disturbances": "standard", "reference": SHORT, "hold": 0.2}
    vector = envs.MassEstimate(base(gym.make_vec(OVERHEAD, num_envs=2, **options)))
    single = envs.MassEstimate(base(make(**options)))
    alone = [run(single, seed) for seed in (3, 4)]
    seen = [vector.reset(seed=3)[0]]
    for _ in range(len(alone[0]) - 1):
        seen.append(vector.step(np.zeros((2, 2)))[0])
    assert np.array_equal(np.array(seen)[:, 0], alone[0])
    assert np.array_equal(np.array(seen)[:, 1], alone[1])
    again = run(single, 3)
    assert np.array_equal(again, alone[0])


def test_where_it_cannot_work_one_line_says_why():
    with pytest.raises(OptionError, match="needs feedforward and PD towards the moving"):
        envs.MassEstimate(envs.PD(make()))
    with pytest.raises(OptionError, match="needs feedforward and PD towards the moving"):
        envs.MassEstimate(envs.Feedforward(envs.PD(make(), track="set point")))
    with pytest.raises(OptionError, match="stiffness is > 0"):
        envs.MassEstimate(envs.Feedforward(envs.PD(make(), stiffness=[0.0, 1.0])))
    with pytest.raises(OptionError, match="rate"):
        envs.MassEstimate(base(make()), rate=0.0)
    with pytest.raises(OptionError, match="no crane"):
        envs.MassEstimate(base(gym.make("flatrig/TwoFingerHand-v0")))
    with pytest.raises(OptionError, match="below already"):
        envs.MassEstimate(envs.MassEstimate(base(make())))
