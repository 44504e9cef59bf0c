"""TorchRL takes single and vector environments with all that their infos tell."""

import logging

import gymnasium as gym
import pytest

import flatrig.envs as envs

pytest.importorskip("torchrl")
pytestmark = pytest.mark.filterwarnings("ignore")

from torchrl.envs import GymWrapper  # noqa: E402
from torchrl.envs.utils import check_env_specs  # noqa: E402

OVERHEAD = "flatrig/OverheadCrane-v0"
TOLD = {"load", "tension", "reward_tracking", "scenario", "reason"}


@pytest.fixture(autouse=True)
def quiet():
    logging.getLogger("torchrl").setLevel(logging.ERROR)


def controlled(env):
    return envs.Feedforward(envs.PD(env))


def test_a_single_environment_with_its_info():
    env = GymWrapper(controlled(gym.make(OVERHEAD, disturbances="standard")))
    env = env.auto_register_info_dict()
    check_env_specs(env)
    assert set(env.rollout(3)["next"].keys()) >= TOLD


@pytest.mark.parametrize("mode", ["SameStep", "Disabled"])
def test_a_native_vector(mode):
    vector = gym.make_vec(OVERHEAD, num_envs=3, autoreset_mode=mode, hold=0.0)
    env = GymWrapper(controlled(vector))
    check_env_specs(env)
    data = env.rollout(155, break_when_any_done=False)  # the episode takes 150 steps
    assert data.shape == (3, 155)
    assert data["next", "done"][:, 149].all() or data["next", "terminated"].any()
    if mode == "Disabled":
        env = env.auto_register_info_dict()
        assert set(env.rollout(2)["next"].keys()) >= TOLD


def test_the_next_step_is_refused_as_by_gymnasiums_own():
    with pytest.raises(RuntimeError, match="auto-reset mode must be one of"):
        GymWrapper(controlled(gym.make_vec(OVERHEAD, num_envs=2)))
