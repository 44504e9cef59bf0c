"""What cranes measure of their loads: noise, delay, rates, and that nothing else moves for it."""

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.envs.crane.load_sensors import DEFLECTION, FADING, FORCE

NAMES = list(envs.ENVIRONMENTS)
OVERHEAD, CABLEV = NAMES[0], "flatrig/CableManipulator-v0"
GENTLE = feedforward.rest_to_rest((0, -4), (1, -3), 2.5)


def controlled(env):
    return envs.Feedforward(envs.PD(env))


def readings(name, steps, **options):
    """What is read and what is true over some steps: errors, rates, tensions, (steps, n, ...)."""
    env = controlled(gym.make_vec(name, sensors="sway", timestep=4e-3, hold=60.0, **options))
    env.reset(seed=20)
    task = env.unwrapped.task
    read, true = [], []
    for _ in range(steps):
        env.step(np.zeros(env.action_space.shape))
        loads, plant, planned = task.loads, task.plant, task.rows.parts["outputs"]
        read.append([part.copy() for part in (loads.errors, loads.rate_errors, loads.tensions)])
        true.append([(planned - plant.outputs).copy(), None, plant.tensions.copy()])
    return task, list(zip(*read, strict=True)), list(zip(*true, strict=True))


@pytest.mark.parametrize("name", [OVERHEAD, CABLEV])
def test_noise_is_as_large_as_stated_and_white_and_readings_are_a_period_late(name):
    task, (errors, _, forces), (true, _, tensions) = readings(name, 250, num_envs=8)
    noise = np.array(errors)[1:] - np.array(true)[:-1]
    rig = task.rig
    arm = (
        max(float(np.linalg.norm(a.position)) for a in rig.anchors if a.frame == "platform")
        if rig.platforms
        else 1.0
    )
    turns = [output.split(".")[-1] in ("alpha", "beta", "gamma") for output in rig.outputs]
    expected = np.where(turns, DEFLECTION / arm, DEFLECTION)
    assert noise.std(axis=(0, 1)) == pytest.approx(expected, rel=0.05)
    assert abs(np.mean(noise[1:] * noise[:-1]) / np.mean(noise**2)) < 0.05
    weight = rig.gravity * sum(part.mass for part in (*rig.loads, *rig.platforms))
    spread = (np.array(forces) - np.array(tensions)).std(axis=(0, 1))
    assert spread == pytest.approx(FORCE * weight, rel=0.05)


def test_without_noise_the_readings_are_those_of_a_period_ago(monkeypatch):
    monkeypatch.setattr("flatrig.envs.crane.load_sensors.DEFLECTION", 0.0)
    monkeypatch.setattr("flatrig.envs.crane.load_sensors.FORCE", 0.0)
    options = {"reference": GENTLE, "disturbances": "standard", "num_envs": 3}
    _, (errors, rates, forces), (true, _, tensions) = readings(OVERHEAD, 100, **options)
    assert np.array_equal(errors[1:], true[:-1])
    assert np.array_equal(forces, tensions)
    # Two poles at f answer a ramp with its slope: over time, rates add up to what errors went.
    gone = np.array(errors)[-1] - np.array(errors)[0]
    late = 2.0 * FADING / (1.0 - FADING) * 0.02 * np.array(rates)[-1]
    assert 0.02 * np.sum(rates, axis=0) == pytest.approx(gone - late, abs=0.01)


def test_rates_have_the_noise_of_the_filter():
    """Variance of a g-h filter's rate (Brookner 1.2.7) with g = 1 - f^2, h = (1 - f)^2."""
    _, (_, rates, _), _ = readings(OVERHEAD, 400, num_envs=8)
    g, h = 1.0 - FADING**2, (1.0 - FADING) ** 2
    expected = DEFLECTION / 0.02 * np.sqrt(2.0 * h**2 / (g * (4.0 - 2.0 * g - h)))
    assert np.array(rates)[50:].std() == pytest.approx(expected, rel=0.08)


def test_seeded_episodes_repeat_and_scenarios_are_those_of_other_sensors():
    seen = []
    for sensors in ("sway", "sway", "encoders", "full"):
        env = gym.make(OVERHEAD, sensors=sensors, disturbances="standard", reference="random")
        observations = [env.reset(seed=4)[0], env.step(np.zeros(2))[0]]
        again, info = env.reset()
        seen.append((np.array([*observations, again]), info["scenario"].tolist()))
    assert np.array_equal(seen[0][0], seen[1][0])
    assert seen[0][1] == seen[2][1] == seen[3][1]
    width = seen[2][0].shape[1]
    assert np.array_equal(seen[0][0][:, :width], seen[2][0])
    assert seen[0][0].shape == seen[3][0].shape
    noise = seen[0][0][:, width:]
    assert len(np.unique(noise[:, 0])) == 3


def test_single_and_vector_agree_to_the_last_bit_also_where_episodes_end_apart():
    options = {"sensors": "sway", "disturbances": "standard", "hold": 0.0, "timestep": 4e-3}
    vector = controlled(gym.make_vec(OVERHEAD, num_envs=2, **options))
    seen = [vector.reset(seed=1, options={"references": [GENTLE, None]})[0]]
    seen += [vector.step(np.zeros((2, 2)))[0] for _ in range(140)]
    single = controlled(gym.make(OVERHEAD, **options))
    alone = [single.reset(seed=2)[0]]
    alone += [single.step(np.zeros(2))[0] for _ in range(140)]
    assert np.array_equal(np.array(seen)[:, 1], alone)


@pytest.mark.parametrize("name", NAMES)
def test_every_rig_has_them(name):
    env = gym.make(name, sensors="sway", disturbances="standard")
    rig = env.unwrapped.task.rig
    names = [f"{output}.error" for output in rig.outputs]
    names += [f"{output}.rate_error" for output in rig.outputs]
    names += [f"{name}.tension" for name in rig.tension_names]
    assert env.unwrapped.observation_names[-len(names) :] == tuple(names)
    observation, _ = env.reset(seed=0)
    assert env.observation_space.contains(observation)


def test_hands_have_none():
    with pytest.raises(models.OptionError, match="must be one of encoders, full"):
        gym.make("flatrig/TwoFingerHand-v0", sensors="sway")
