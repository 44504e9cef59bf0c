"""Cranes that users described in files of their own: planned, simulated and run as environments."""

from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

from flatrig import envs, models
from flatrig.envs import CraneEnv
from flatrig.models.errors import FlatrigError, OptionError
from flatrig.training.compare.contenders import contenders_for

FOLDER = Path(__file__).resolve().parents[1] / "field"
FILES = sorted(FOLDER.glob("*.toml"))


def errors(env) -> np.ndarray:
    """Deviations of the outputs in an episode without actions, shape (steps, outputs)."""
    env.reset(seed=0)
    found, over = [], False
    while not over:
        _, _, terminated, truncated, info = env.step(np.zeros(env.action_space.shape))
        found.append(info["load"] - info["reference"])
        over = terminated or truncated
    assert not terminated
    return np.array(found)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_crane_from_a_file_follows_its_plan_in_mujoco(file):
    env = envs.Feedforward(envs.PD(gym.make("flatrig/Rig-v0", rig=str(file))))
    of_place = [not name.endswith(".tension") for name in models.load(file)[0].outputs]
    # Inputs held for 20 ms are all that stands between the plan and the plant: 4e-6 to 5e-5 m, rad.
    assert np.abs(errors(env)[:, of_place]).max() < 1e-4


def disturbed(file):
    """Feedforward and PD in the standard disturbances, with a sway sensor."""
    env = gym.make("flatrig/Rig-v0", rig=str(file), disturbances="standard", sensors="sway")
    return envs.Feedforward(envs.PD(envs.TautGuard(env)))


def test_the_regulator_holds_a_platform_whose_open_tensions_are_outputs():
    plain = disturbed(FOLDER / "redundant8.toml")
    regulated = envs.LQR(disturbed(FOLDER / "redundant8.toml"))
    off, left = (np.linalg.norm(errors(env)[:, :3]) for env in (plain, regulated))
    assert left < 0.5 * off


def test_a_load_on_more_ropes_than_freedoms_does_not_swing():
    with pytest.raises(OptionError, match="4 ropes hold load of redundant4_point"):
        envs.SwingDamping(disturbed(FOLDER / "redundant4_point.toml"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_every_classical_controller_drives_it_or_refuses(file):
    """As `flatrig compare` puts them around the environment; anything else is a traceback there."""
    rig, move = models.load(file)
    drove = []
    for entry in contenders_for("crane"):
        if entry.learned:
            continue
        env = CraneEnv(rig, reference=move, sensors=entry.sensors, disturbances="standard")
        try:
            env = entry.wrap(env)
            env.reset(seed=0)
            env.step(np.zeros(env.action_space.shape))
        except FlatrigError:
            continue
        drove.append(entry.name)
    assert {"FF + PD", "observer", "LQR, sway"} <= set(drove)
