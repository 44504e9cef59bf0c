"""Cranes whose base moves as given: the ship of docs/how-to/ship.md, and those of the catalogue."""

import re
from dataclasses import replace
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.feedforward.exact.branch import branch_of
from flatrig.feedforward.exact.problem import problem_of
from flatrig.feedforward.solving.inverse import interpreted
from flatrig.models import PathError, RigError, Wave
from flatrig.models.mjcf import rig_model
from flatrig.models.mjcf.simulate import accelerations
from flatrig.training.simulate.open_loop import open_loop

FILE = Path(__file__).resolve().parents[1] / "docs" / "how-to" / "ship_crane.toml"
RIG, MOVE = models.load(FILE)
assert MOVE is not None


def test_inputs_of_a_base_are_its_accelerations_and_the_load_stays_in_the_world():
    reference = feedforward.from_move(MOVE)
    report = feedforward.check(RIG, reference)
    assert report.problems == ()
    motion = feedforward.solve(RIG, reference, np.linspace(0.0, 60.0, 301))
    assert feedforward.residuals(motion, reference).max() < 1e-12
    waves = {wave.column: wave for wave in MOVE.waves}
    for column in (3, 4, 5):
        wave = waves[column]
        turn = 2.0 * np.pi / wave.period
        place = wave.amplitude * np.sin(turn * motion.times + wave.phase)
        assert motion.inputs[:, column] == pytest.approx(-(turn**2) * place, abs=1e-12)
    # at rest in the world after arrival, the load hangs straight below the trolley
    rest = motion.times > MOVE.duration
    assert motion.tensions[rest, 0] == pytest.approx(100.0 * 9.81, rel=1e-9)
    x, y = (motion.positions[rest, motion.column(f"trolley.{axis}")] for axis in "xy")
    assert np.hypot(x - 8.0, y - 6.0).max() < 1e-9


def test_programs_give_the_same():
    branch = branch_of(problem_of(RIG), feedforward.from_move(MOVE))
    times = np.linspace(0.0, 40.0, 9)
    found, oracle = feedforward.solve(RIG, branch.reference, times), interpreted(branch, times)
    for group in ("positions", "velocities", "accelerations", "inputs", "tensions"):
        size = np.abs(getattr(oracle, group)).max()
        assert np.abs(getattr(found, group) - getattr(oracle, group)).max() < 1e-11 * size


def test_it_lands_in_mujoco_open_loop():
    run = open_loop(RIG, feedforward.from_move(replace(MOVE, duration=10.0)))
    assert run.distance.max() < 1e-4


def test_accelerations_are_those_of_mujoco():
    random = np.random.default_rng(4)
    model = rig_model.compile(RIG, visuals=False)
    equations = feedforward.equations_of(RIG)
    homes = RIG.home_coordinates
    values = {name: home + 0.3 * random.normal(size=5) for name, home in homes.items()}
    rates = {name: 0.3 * random.normal(size=5) for name in homes}
    limits = np.array([drive.limit for drive in RIG.drives])
    inputs = limits * random.uniform(-1.0, 1.0, (5, len(limits)))
    joints = rig_model.joint_state(RIG, model, values, rates)
    turn = accelerations(model, *joints, inputs)
    world = rig_model.points(RIG, *joints, turn)["load"][2]
    expected, _ = equations.accelerations(*feedforward.redundant(equations, values, rates), inputs)
    columns = [equations.names.index(f"load.{axis}") for axis in "xyz"]
    assert world == pytest.approx(expected[:, columns], rel=0, abs=1e-9 * np.abs(expected).max())


def test_the_navy_crane_works_in_a_third_of_the_sea_and_no_more():
    rig, move = models.navy_ship_crane(), models.default_move("navy_ship_crane")
    rough = replace(move, waves=[replace(w, amplitude=3.0 * w.amplitude) for w in move.waves])
    assert feedforward.check(rig, feedforward.from_move(move), rate=20.0).feasible
    report = feedforward.check(rig, feedforward.from_move(rough), rate=20.0)
    line = r"rope suspension would have to push from \d+\.\d+ s to \d+\.\d+ s \(down to -15\d"
    assert re.match(line, report.problems[0])
    with pytest.raises(models.OptionError, match=r"suspension would have to push from .* s to"):
        gym.make("flatrig/NavyShipCrane-v0", reference=rough)


def test_episodes_start_in_motion_and_no_action_is_of_the_ship():
    env = envs.Feedforward(envs.PD(gym.make("flatrig/Rig-v0", rig=FILE, sensors="full")))
    _, info = env.reset(seed=0)
    task = env.unwrapped.task
    assert np.abs(info["load"] - info["reference"]).max() < 1e-12
    assert np.abs(task.plant.drive_rates[0, 3:]).min() > 1e-3
    for _ in range(200):
        *_, terminated, _, info = env.step(np.zeros(3))
        assert not terminated
    assert np.abs(info["load"] - info["reference"]).max() < 1e-3
    path = feedforward.from_move(MOVE)([200 * task.period])[0]
    assert task.plant.drive_positions[0, 3:] == pytest.approx(path[3:], abs=1e-5)
    assert {"heave.position", "pitch.rate"} < set(env.unwrapped.observation_names)
    assert env.unwrapped.action_names == ("girder", "trolley", "winch")
    with pytest.raises(models.OptionError, match=r"shape \(6,\), it must have shape \(3,\)"):
        env.step(np.zeros(6))
    led = gym.make("flatrig/Rig-v0", rig=FILE, reference="operator")
    assert led.unwrapped.action_names == tuple(f"load.{axis}.velocity" for axis in "xyz")


def test_one_ship_or_several_to_the_last_bit():
    options = {"rig": FILE, "sensors": "full", "disturbances": "standard", "reference": "random"}
    several = gym.make_vec("flatrig/Rig-v0", num_envs=2, nthread=1, **options)
    alone = [gym.make("flatrig/Rig-v0", **options) for _ in range(2)]
    seen, _ = several.reset(seed=5)
    random = np.random.default_rng(0)
    for number, env in enumerate(alone):
        assert np.array_equal(env.reset(seed=5 + number)[0], seen[number])
    for _ in range(20):
        actions = random.uniform(-0.05, 0.05, (2, 3))
        seen, rewards, *_ = several.step(actions)
        for number, env in enumerate(alone):
            observation, reward, *_ = env.step(actions[number])
            assert np.array_equal(observation, seen[number])
            assert reward == rewards[number]


def test_files_keep_waves():
    assert models.loads(models.dumps(RIG, MOVE)) == (RIG, MOVE)
    with pytest.raises(PathError, match="wave: period is 0 s, it must be > 0"):
        Wave(3, 1.0, 0.0)
    with pytest.raises(PathError, match="wave: column is 9, it must be 0 to 5"):
        replace(MOVE, waves=(Wave(9, 1.0, 1.0),))
    with pytest.raises(PathError, match="unknown entry 'height'"):
        models.loads(FILE.read_text().replace("amplitude = 1.0", "height = 1.0"))


def test_what_a_base_cannot_be():
    frames = RIG.frames
    for changed, message in (
        ((*frames[:2], replace(frames[2], given=False, inertia=9.0), frames[3]), None),
        ((replace(frames[0], given=False, inertia=9.0), *frames[1:]), "stands on heave, whose"),
    ):
        if message:
            with pytest.raises(RigError, match=message):
                replace(RIG, frames=changed)
        else:
            assert replace(RIG, frames=changed)
    with pytest.raises(RigError, match="roll, whose motion is given, has no drive"):
        replace(RIG, drives=(*RIG.drives[:4], RIG.drives[5]))
    with pytest.raises(RigError, match=r"needs heave\.position among the outputs"):
        replace(RIG, outputs=("load.x", "load.y", "load.z", "hoist.length", *RIG.outputs[4:]))
