"""Losses that a rig is described with, in environments: gears, and what controllers know."""

from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import envs, feedforward, models
from flatrig.envs.crane import input_shaper, linear_plans, linearisation
from flatrig.models import Move
from flatrig.models.friction import Friction


def lossy(name, efficiency, gear=20.0):
    rig = models.make(name)
    drives = tuple(replace(part, gear=gear, efficiency=efficiency) for part in rig.drives)
    return replace(rig, drives=drives)


def driven(rig, wrap, steps=None, **options):
    """Errors, inputs and tensions of an episode, (steps, ...), and whether it ended early."""
    env = wrap(gym.make(envs.OWN, rig=rig, **options))
    env.reset(seed=0)
    rows, over = [], False
    while not over and len(rows) != steps:
        *_, ended, late, info = env.step(np.zeros(len(rig.drives)))
        error = np.linalg.norm(info["load"] - info["reference"])
        rows.append((error, info["load"], info["input"], info["tension"]))
        over = ended or late
    error, load, inputs, tension = (np.array(part) for part in zip(*rows, strict=True))
    return error, load, inputs, tension, ended


def open_loop(env):
    return envs.Feedforward(env)


def regulated(env):
    return envs.LQR(envs.Feedforward(envs.PD(env)))


def test_gears_lose_what_the_feedforward_adds():
    """Under exact inputs alone, held for 20 ms, a crane with such gears moves as without."""
    error, *_, ended = driven(lossy("rotary_crane", 0.6), open_loop, steps=400)
    assert not ended
    assert error.max() < 1e-4


def test_inputs_for_ideal_gears_do_not_do():
    rig, ideal = lossy("rotary_crane", 0.8), lossy("rotary_crane", 1.0)
    path = feedforward.from_move(models.default_move(models.rotary_crane()))
    env = gym.make(envs.OWN, rig=rig)
    env.reset(seed=0)
    worst, scale = 0.0, np.array([drive.largest for drive in rig.drives])
    for inputs in feedforward.solve(ideal, path, 0.02 * np.arange(150) + 0.01).inputs:
        *_, info = env.step(inputs / scale)
        worst = max(worst, np.linalg.norm(info["load"] - info["reference"]))
    assert worst > 0.1


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_winch_hoists_and_lowers_by_its_efficiency(sign):
    """Torque times turns times e is tension times radius where it hoists, over e otherwise."""
    rig = lossy("overhead_crane", 0.8)
    path = feedforward.from_move(Move((0.0, -4.0), (0.0, -4.0 + sign), 4.0))
    _, _, inputs, tension, _ = driven(rig, open_loop, reference=path)
    moving = slice(60, 140)
    torque, pull = -inputs[moving, 1] * 20.0, tension[moving, 0] * 0.1
    inertia = rig.ropes[0].winch_inertia / 0.1
    times = 0.02 * (np.arange(len(inputs)) + 1.0)[moving]
    second = path.derivatives(times, 2)[2][:, 1]
    assert_allclose(torque * 0.8**sign, pull + inertia * second, rtol=2e-3)


def test_at_rest_a_gear_helps_to_hold():
    rig = lossy("overhead_crane", 0.8)
    env = gym.make(envs.OWN, rig=rig, reference=feedforward.hold((0.0, -4.0)))
    env.reset(seed=0)
    held = feedforward.solve(rig, feedforward.hold((0.0, -4.0)), [0.0]).inputs[0]
    scale = np.array([drive.largest for drive in rig.drives])
    for share in (0.9, 1.1):
        for _ in range(25):
            *_, info = env.step(share * held / scale)
        assert abs(info["load"][1] + 4.0) < 1e-4
    for _ in range(25):
        *_, info = env.step(0.7 * held / scale)
    assert info["load"][1] < -4.01


def dragged(drag):
    rig = models.overhead_crane()
    return replace(rig, masses=(*rig.trolleys, replace(rig.loads[0], drag=drag)))


def set_point(env):
    return envs.Shaper(envs.PD(env, track="set point"))


def test_a_shaper_knows_drag(monkeypatch):
    """A load that the air damps swings less at the goal than for a shaper that does not know."""
    rig = dragged(60.0)
    env = set_point(gym.make(envs.OWN, rig=rig))
    task = envs.task_of(env)
    plan, gains = task.plans[0], np.full(4, 1e3)  # drives that hold still
    mode = input_shaper.swing_mode(task.plant, plan, gains)
    at_goal = feedforward.hold(models.default_move(models.overhead_crane()).goal)
    length = feedforward.solve(rig, at_goal, [0.0]).rope_lengths[0, 0]
    assert mode.frequency == pytest.approx(np.sqrt(rig.gravity / length), rel=1e-3)
    assert mode.damping == pytest.approx(60.0 / (2.0 * 100.0 * mode.frequency), rel=1e-2)

    def swing():
        load = driven(rig, set_point)[1][-150:, 0]
        return np.abs(load - load[-1]).max()

    knowing = swing()
    monkeypatch.setattr(input_shaper, "_rubbing", lambda model, joints: np.zeros((model.nv,) * 2))
    assert knowing < 0.2 * swing()


def test_a_regulator_is_that_of_a_crane_without_dry_friction(monkeypatch):
    """Near rest no small push moves what sticks: a linear model of that regulates nothing."""
    rig = models.overhead_crane()
    rig = replace(
        rig,
        masses=(replace(rig.trolleys[0], friction=Friction(40.0, 20.0)), rig.loads[0]),
        ropes=(replace(rig.ropes[0], friction=Friction(20.0, 30.0)),),
    )
    error, *_, ended = driven(rig, regulated, steps=200, sensors="full")
    assert not ended
    assert error.max() < 1e-4
    monkeypatch.setattr(linearisation, "without_jumps", lambda rig: rig)
    linear_plans._KNOWN.clear()
    error, *_, ended = driven(rig, regulated, sensors="full")
    linear_plans._KNOWN.clear()
    assert ended
