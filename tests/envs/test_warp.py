"""Worlds of mujoco_warp, on Warp's processor device, against MuJoCo in C."""

import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import models
from flatrig.envs.crane.moving_base import given_drives
from flatrig.models.errors import OptionError

torch = pytest.importorskip("torch")
pytest.importorskip("mujoco_warp")
pytestmark = pytest.mark.filterwarnings("ignore")

from flatrig.envs.warp import Worlds  # noqa: E402

CRANES = [name for name in models.CATALOGUE if not given_drives(models.make(name))]
COARSE = {
    "cantilever_crane", "gantry_crane", "navy_crane_3d", "cable_manipulator", "luffing_crane",
    "knuckle_crane", "container_crane",
}  # fmt: skip
"""Cranes that single precision keeps from 1e-5 m: what rounding of the state makes in C, too."""
SOLVED = {"tandem_lift": 4e-5}
"""Cranes whose ropes are constraints, which are solved in single precision [m]."""
SHORT = models.Move(start=(0, -4), goal=(0.3, -4.2), duration=1.0)


@pytest.fixture(autouse=True)
def one_thread():
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


def controlled(name, **options):
    return envs.Feedforward(envs.PD(envs.CraneVectorEnv(name, timestep=5e-3, **options)))


def rounding(env):
    """Let the simulations below round their states to single precision in every time step."""
    plant = env.unwrapped.task.plant

    def step(ids=None):
        for _ in range(plant.substeps):
            plant.qpos[...] = plant.qpos.astype(np.float32)
            plant.qvel[...] = plant.qvel.astype(np.float32)
            plant.batch.step(ids, 1, plant.stage)
        plant._read()

    plant.step = step
    return env


@pytest.mark.slow
@pytest.mark.parametrize("name", CRANES)
def test_a_crane_makes_its_move_as_in_c(name):
    """Outputs stay within 1e-5 m, or within twice of what rounding alone does in C."""
    worlds = Worlds(name, 2, hold=0.1, device="cpu")
    exact, rounded = (controlled(name, hold=0.1) for _ in range(2))
    if name in COARSE:
        rounding(rounded)
    for env in (exact, rounded):
        env.reset(seed=0)
    still = np.zeros((1, len(worlds.action_names)))
    outputs = exact.unwrapped.task.plant.outputs
    most = by_rounding = 0.0
    for _ in range(worlds.length):
        *_, terminated, truncated = worlds.step(worlds.base())
        exact.step(still)
        most = max(most, np.abs(worlds.outputs.numpy() - outputs).max())
        if name in COARSE:
            rounded.step(still)
            off = np.abs(rounded.unwrapped.task.plant.outputs - outputs).max()
            by_rounding = max(by_rounding, off)
    assert not terminated.any()
    assert truncated.all()
    assert most < (2.0 * by_rounding if name in COARSE else SOLVED.get(name, 1e-5))
    assert most < 5e-4


def test_observations_rewards_and_actions_are_those_of_the_vector():
    options = {"reference": SHORT, "hold": 0.1}
    worlds = Worlds("overhead", 3, device="cpu", **options)
    env = controlled("overhead", num_envs=3, **options)
    task = env.unwrapped.task
    assert worlds.observation_names == task.observation_names
    assert worlds.action_names == task.action_names
    seen, _ = env.reset(seed=0)
    assert np.allclose(worlds.observation(), seen, atol=1e-6)
    rng, low = np.random.default_rng(0), 1.0
    while True:
        more = rng.uniform(-0.05, 0.05, (3, 2))
        came = worlds.step(worlds.base() + torch.as_tensor(more, dtype=torch.float32))
        seen, reward, terminated, truncated, info = env.step(more)
        assert np.allclose(came.observation, seen, rtol=0, atol=2e-4)
        assert np.allclose(came.reward, reward, rtol=0, atol=1e-5)
        assert np.allclose(worlds.outputs, info["load"], rtol=0, atol=1e-5)
        assert np.allclose(worlds.reference, info["reference"], rtol=0, atol=1e-5)
        assert came.terminated.tolist() == terminated.tolist()
        assert came.truncated.tolist() == truncated.tolist()
        low = min(low, reward.min())
        if truncated.any():
            break
    assert low < 0.95  # the actions did something


def test_worlds_begin_anew_one_by_one_and_are_pushed_one_by_one():
    worlds = Worlds("overhead", 3, SHORT, device="cpu")
    env = controlled("overhead", num_envs=1, reference=SHORT)
    seen, _ = env.reset(seed=0)
    begun = worlds.observation().clone()
    load = worlds.physics.model.body("load").id
    worlds.forces[1, load, 0] = 30.0
    for _ in range(10):
        worlds.step(worlds.base())
    worlds.forces[1] = 0.0
    assert np.allclose(worlds.observation()[0], worlds.observation()[2], atol=0)
    assert not np.allclose(worlds.outputs[0], worlds.outputs[1], atol=1e-3)
    after = worlds.reset(torch.tensor([True, True, False]))
    assert np.allclose(after[:2], begun[:2], atol=1e-7)
    assert worlds.steps.tolist() == [0, 0, 10]
    for _ in range(10):
        came = worlds.step(worlds.base())
        seen, *_ = env.step(np.zeros((1, 2)))
    assert np.allclose(came.observation[0], seen[0], rtol=0, atol=2e-4)
    assert np.allclose(came.observation[1], seen[0], rtol=0, atol=2e-4)
    assert not np.allclose(came.observation[2], seen[0], atol=0.1)


def test_a_rope_that_gets_slack_ends_an_episode():
    worlds = Worlds("overhead", 2, SHORT, device="cpu")
    env = envs.CraneVectorEnv("overhead", num_envs=1, reference=SHORT, timestep=5e-3)
    env.reset(seed=0)
    actions = worlds.base()
    actions[0] = torch.tensor([0.0, 1.0])  # pays out with all its torque
    came = worlds.step(actions)
    assert came.terminated.tolist() == [True, False]
    assert came.reward[0] == 0.0 < came.reward[1]
    assert env.step([[0.0, 1.0]])[2].tolist() == [True]
    worlds.reset()
    worlds.qvel[1, 0] = torch.nan
    assert worlds.step(worlds.base()).terminated.tolist() == [False, True]
    assert worlds.reset(torch.tensor([False, True])).isfinite().all()


@pytest.mark.parametrize(
    ("rig", "options", "line"),
    [
        ("overhead", {"num": 0}, "number of worlds is 0"),
        ("overhead", {"device": "tpu"}, "there is no device 'tpu', only cpu"),
        ("overhead", {"reference": "random"}, "worlds follow one reference"),
        ("ship", {}, "ship_crane has a base that moves as given"),
    ],
)
def test_what_worlds_cannot_do_is_said_in_one_line(rig, options, line):
    with pytest.raises(OptionError, match=line) as caught:
        Worlds(rig, **options)
    assert "\n" not in str(caught.value)
