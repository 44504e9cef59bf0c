"""Environments of rigs of one's own and of what the catalogue's other cranes need."""

from dataclasses import replace
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.envs.crane.outputs import levers
from flatrig.envs.crane.plant import Plant
from flatrig.models.mjcf.rig_state import coordinates, tensions

WORKSHOP = Path(__file__).parents[2] / "docs/how-to/workshop_crane.toml"
OVERHEAD = "flatrig/OverheadCrane-v0"
CABLEV = "flatrig/CableManipulator-v0"


def make(name=OVERHEAD, **options):
    return gym.make(name, **options)


def test_tension_where_spans_are_not_affine(other_rigs):
    """A rope from a fixed anchor to a turning rail takes the general formula."""
    rig = fixed_winch()
    plant = Plant(rig, 2, timestep=1e-3, substeps=1)
    assert not plant.geometry.affine
    scenarios = [envs.Scenario(), envs.Scenario(swing=0.1)]
    joints = np.tile(plant.home, (2, 1))
    plant.reset(np.arange(2, dtype=np.int32), joints, plant.model.key_ctrl[[0, 0]], scenarios)
    assert np.allclose(plant.tensions[0], 981.0)


def fixed_winch():
    """A rotary crane whose hoist winch stands on the ground at the tower, off its axis."""
    rig = models.rotary_crane()
    rope = models.Rope("hoist", ("foot", "trolley", "load"), 0.1, 0.1)
    return replace(rig, anchors=(models.Anchor("foot", (0.5, 0.5, 0.0)),), ropes=(rope,))


@pytest.mark.parametrize(
    ("kind", "goal", "duration"),
    [
        ("cantilever", (4.0, 1.5, -4.0), 6.0),
        ("gantry", (4.0, 1.5, -4.0), 6.0),
    ],
)
def test_rigs_outside_the_catalogue(other_rigs, kind, goal, duration):
    rig = other_rigs[kind]
    rig = replace(rig, drives=tuple(replace(drive, limit=2e3) for drive in rig.drives))
    path = feedforward.rest_to_rest((5.0, 0.0, -5.0), goal, duration)
    env = envs.Feedforward(envs.PD(make(rig=rig, reference=path, hold=0.0, sensors="full")))
    env.reset(seed=0, options={"scenario": envs.Scenario()})
    truncated = False
    while not truncated:
        *_, terminated, truncated, info = env.step(np.zeros(len(rig.drives)))
        assert not terminated
    assert np.linalg.norm(info["load"] - goal) < 1e-3


def test_an_environment_of_ones_own_rig_needs_one(tmp_path):
    with pytest.raises(models.OptionError, match="an environment needs a rig") as caught:
        make(envs.OWN)
    assert "\n" not in str(caught.value)
    text = WORKSHOP.read_text()
    file = tmp_path / "crane.toml"
    file.write_text(text[: text.index("[move]")])
    with pytest.raises(models.OptionError, match="give `reference`"):
        make(envs.OWN, rig=str(file))
    for rig in (str(WORKSHOP), WORKSHOP):
        env = envs.Feedforward(make(envs.OWN, rig=rig, rate=100.0, hold=0.0))
        error, info = furthest(env)
        assert error < 1e-3
        assert np.allclose(info["reference"], (5.0, 3.0, -2.0))


def furthest(env):
    """Largest error of the outputs in an episode with zero actions, and the last info."""
    env.reset(seed=0)
    over, most = False, 0.0
    while not over:
        *_, terminated, over, info = env.step(np.zeros(len(env.unwrapped.action_names)))
        assert not terminated, env.unwrapped.reasons[info["reason"]]
        most = max(most, float(np.abs(info["load"] - info["reference"]).max()))
    return most, info


def shaken(rig, **options):
    """The plant of a rig after some random inputs."""
    task = envs.CraneTask(rig, **options)
    task.reset(task.all, [np.random.default_rng(0)])
    rng = np.random.default_rng(0)
    hold = task.plant.model.key_ctrl[0] / task.limits
    for _ in range(25):
        task.step((hold + 0.1 * rng.normal(size=len(hold)))[None])
    return task.plant


def test_outputs_of_a_platform_are_coordinates_and_their_combination():
    plant = shaken("cable_manipulator", sensors="full")
    rig = plant.rig
    values, rates = coordinates(rig, plant.model, plant.batch)
    for row, name in enumerate(rig.outputs[:6]):
        assert plant.outputs[0, row] == pytest.approx(values[name][0], abs=1e-12)
        assert plant.output_rates[0, row] == pytest.approx(rates[name][0], abs=1e-12)
    one, two, three = (rates[f"trolley_{n}.position"][0] for n in "123")
    assert plant.output_rates[0, 6] == pytest.approx(one - 0.5 * (two + three), abs=1e-12)
    assert np.abs(plant.output_rates).min() > 1e-6


def test_spans_to_a_platform_and_a_reeved_rope_give_the_general_tension():
    crane = models.overhead_crane()
    reeved = replace(crane.ropes[0], falls=4)
    for rig in ("cable_manipulator", replace(crane, ropes=(reeved,))):
        move = None if isinstance(rig, str) else models.default_move("overhead_crane")
        plant = shaken(rig, reference=move)
        assert plant.geometry.affine
        state = (plant.qpos, plant.qvel, plant.batch.bind("qacc"), plant.ctrl)
        assert np.allclose(plant.tensions, tensions(plant.rig, *state), rtol=0, atol=1e-9)


def test_angles_count_times_the_distance_of_the_farthest_corner():
    task = envs.CraneTask("cable_manipulator")
    corner = 1.2 / np.sqrt(3.0)
    expected = [1.0] * 3 + [corner] * 3 + [1.0]
    assert np.allclose(levers(task.rig, task.scales), expected)
    assert task.scales.length == pytest.approx(3.0)
    assert task.scales.weight == pytest.approx(12.5 * 9.81)


def test_a_load_above_its_pulley_and_a_platform_that_tips_end_the_episode():
    env = make("flatrig/NavyCrane2D-v0")
    env.reset(seed=0)
    env.unwrapped.task.plant.qvel[0, 3] = 600.0
    info = env.step([-0.3, -0.5, -0.5])[4]
    assert env.unwrapped.reasons[info["reason"]] == "load above pulley"
    plant = make(CABLEV).unwrapped.task.plant
    reasons = []
    for lean in (1.2, 1.4):
        plant.qpos[0, plant.model.joint("platform.beta").qposadr[0]] = lean
        plant.batch.forward()
        plant._read()
        reasons.append(np.array(plant.reasons)[plant.margins[0] <= 0])
    assert "platform tipped over" not in reasons[0]
    assert "platform tipped over" in reasons[1]


def test_a_massless_pulley_needs_a_mass_that_stands_in():
    rig = models.navy_crane_2d(pulley_mass=0.0)
    with pytest.raises(models.FlatrigError, match="mass is 0 kg"):
        make(envs.OWN, rig=rig)
    env = make(envs.OWN, rig=rig, massless=1e-2, rate=100.0, timestep=1e-3, hold=0.0)
    assert np.allclose(env.unwrapped.task.planner.fixed.goal, [env_length(rig, n) for n in (0, 1)])
    assert furthest(envs.Feedforward(env))[0] < 0.05


def env_length(rig, rope):
    """Rope lengths at the goal of the massless planar move, by solving once more."""
    motion = feedforward.solve(rig, feedforward.from_move(models.default_move(rig)), [99.0])
    return motion.rope_lengths[0, rope]
