"""Training, end to end and small: adapter, export, result folder, checkpoints."""

import csv
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")
pytest.importorskip("torch")

import torch
from stable_baselines3.common.vec_env import VecEnv

from flatrig import feedforward, models
from flatrig.models.errors import OptionError
from flatrig.training import compare
from flatrig.training.cli import main
from flatrig.training.policy import Policy, Recall
from flatrig.training.sb3 import Adapter
from flatrig.training.teacher import Teacher
from flatrig.training.tutor import FAILURE, REWARD, Tutor

RIG = models.overhead_crane()
MOVE = models.Move(start=(0.0, -4.0), goal=(0.5, -3.5), duration=1.5)


@pytest.fixture(autouse=True, scope="module")
def _few_scenarios() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("flatrig.training.ppo.VALIDATION_SCENARIOS", 4)
        yield


SHORT = ["--goal", "0.5", "-3.5", "--duration", "1.5", "--envs", "4", "--evaluations", "1"]


def adapter(num: int = 3, hold: float = 0.1, episode: int = 10_000, every: int = 1) -> Adapter:
    names = compare.environment(RIG, MOVE, 1).observation_names
    env = compare.environment(RIG, MOVE, num, sensors="full", hold=hold)
    teacher = Teacher(env.task, feedforward.from_move(MOVE), 0.1)
    tutor = Tutor(compare.with_residual(env, 0.2), names, 0.1, teacher)
    recall = Recall(len(names), 2, 0.02, (0.2, 1.0), 0.5, every, (1.0, 1.0))
    made = Adapter(tutor, recall, episode)
    made.seed(11)
    return made


def test_episodes_restart_in_the_step_in_which_they_end() -> None:
    made = adapter()
    assert isinstance(made, VecEnv)
    first = made.reset()
    assert first.shape == (3, *made.observation_space.shape)
    assert first.dtype == np.float32
    action = np.full((3, 2), 0.2, dtype=np.float32)
    for step in range(1, 81):
        observation, reward, done, infos = made.step(action)
        assert made.observation_space.contains(observation[0])
        assert (reward <= REWARD).all()
        assert done.all() == (step == 80)
        assert step == 80 or infos == [{}] * 3
    final = np.array([info["terminal_observation"] for info in infos])
    assert all(info["TimeLimit.truncated"] for info in infos)
    assert [info["episode"]["l"] for info in infos] == [80] * 3
    np.testing.assert_array_equal(made.memory.action, 0.0)
    assert np.abs(observation - final).max() > 0.5
    start = np.abs(made.memory.slow[:, :, :-2] - made.memory.slow[:, :1, :-2]).max()
    assert start == 0.0  # filters begin at the first observation


def test_first_episodes_end_at_different_times_and_others_go_on() -> None:
    made = adapter(num=4, episode=80)
    made.reset()
    ended = []
    for step in range(1, 101):
        before = made.memory.slow.copy()
        _, _, done, _ = made.step(np.zeros((4, 2)))
        ended += [(step, int(i)) for i in np.flatnonzero(done)]
        assert np.abs(made.memory.slow - before)[~done].max(initial=0.0) < 1.0
    assert ended == [(20, 0), (40, 1), (60, 2), (80, 3), (100, 0)]


def test_several_periods_make_one_decision() -> None:
    fine, coarse = adapter(), adapter(every=4)
    fine.reset(), coarse.reset()
    action = np.full((3, 2), 0.4)
    rewards = [fine.step(action)[1] for _ in range(8)]
    sums = [coarse.step(action)[1] for _ in range(2)]
    np.testing.assert_allclose(np.sum(rewards, axis=0), np.sum(sums, axis=0), rtol=1e-5)
    np.testing.assert_array_equal(fine.memory.slow, coarse.memory.slow)
    assert len(coarse.lessons) == 2


def test_the_teacher_brings_the_load_to_its_path() -> None:
    runner = compare.Runner(RIG, MOVE, compare.scenarios_for(RIG, 8), sensors="full")
    teacher = Teacher(runner.task, feedforward.from_move(MOVE), 0.12)
    found = []
    for taught in (0.0, 1.0):
        env = compare.with_residual(runner.env, float(teacher.fractions.max()))
        env.reset(seed=0, options={"scenarios": runner.scenarios})
        teacher.reset()
        teacher.watch()
        errors = []
        for _ in range(runner.steps):
            advice = teacher.advice() * teacher.fractions / teacher.fractions.max()
            *_, info = env.step(taught * advice)
            teacher.watch()
            errors.append(np.linalg.norm(info["load"] - info["reference"], axis=1))
        found.append(np.sqrt(np.square(errors).mean()))
    assert found[1] < 0.5 * found[0]


def test_an_early_end_is_no_time_limit_and_costs() -> None:
    made = adapter(num=2, hold=4.0)
    made.env = Failing(made.env)
    made.reset()
    _, reward, done, infos = made.step(np.zeros((2, 2)))
    np.testing.assert_array_equal(done, [True, False])
    assert reward[0] == -FAILURE
    assert infos[0]["TimeLimit.truncated"] is False
    assert infos[1] == {}


class Failing:
    """Ends the first simulation's episode at once."""

    def __init__(self, env: Any) -> None:
        self.env, self.num_envs, self.unwrapped = env, env.num_envs, env.unwrapped
        self.reset, self.advice = env.reset, env.advice

    def step(self, actions: np.ndarray) -> Any:
        observation, reward, terminated, truncated, info = self.env.step(actions)
        terminated[0], reward[0] = True, -FAILURE
        return observation, reward, terminated, truncated, info


def test_the_critic_is_told_the_scenario_and_the_actor_is_not() -> None:
    made = adapter()
    made.reset()
    observation, _ = made.env.reset()
    heavy = np.array([scenario.load_mass for scenario in made.env.unwrapped.task.scenarios])
    public = made.recall.observations
    names = compare.environment(RIG, MOVE, 1).observation_names
    assert public == len(names)
    hints = observation[:, len(made.env.unwrapped.observation_names) :]
    np.testing.assert_allclose(hints[:, 0], 3.0 * (heavy - 1.0))


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "small"
    assert main(["train", "overhead", *SHORT, "--steps", "1000", "-o", str(folder)]) == 0
    return folder


def test_a_run_says_what_it_was(trained: Path) -> None:
    held = {path.name for path in trained.iterdir()}
    assert held >= {"config.json", "progress.csv", "evaluation.csv", "checkpoint.json"}
    assert held >= {"checkpoint.safetensors", "policy.json", "policy.safetensors"}
    config = json.loads((trained / "config.json").read_text())
    assert config["versions"]["torch"] == torch.__version__
    assert config["options"]["seed"] == 0
    assert models.loads(config["rig"])[0] == RIG
    with (trained / "evaluation.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert int(rows[-1]["steps"]) >= 1000
    assert float(rows[-1]["rmse"]) > 0
    policy = Policy.load(trained / "policy")
    assert policy.card.rig == "overhead_crane"
    assert policy.card.training["seed"] == 0


def test_numpy_and_torch_agree(trained: Path) -> None:
    from flatrig.training.console import console
    from flatrig.training.options import Train
    from flatrig.training.ppo import Training
    from flatrig.training.sb3 import export
    from flatrig.training.train import Settings

    command = Train("overhead", goal=(0.5, -3.5), duration=1.5, envs=4, resume=True)
    rig, move = command.target()
    training = Training(rig, move, command, Settings(), trained, console())
    network: Any = training.model.policy
    with torch.no_grad():
        torch.manual_seed(0)
        network.action_net.weight.normal_()
    policy = export(network, training.adapter, training.card)
    features = 3.0 * np.random.default_rng(0).normal(size=(200, policy.recall.features))
    normal = training.adapter.normaliser
    whole = np.concatenate((features, np.zeros((200, training.adapter.private))), axis=1)
    scaled = np.clip((whole - normal.mean) / training.adapter.scale, -10.0, 10.0)
    with torch.no_grad():
        theirs = network._predict(torch.as_tensor(scaled, dtype=torch.float32), deterministic=True)
    ours = policy.network(features)
    np.testing.assert_allclose(ours, theirs.numpy(), rtol=1e-5, atol=1e-5)
    assert training.steps >= 1000


def test_resuming_goes_on_where_it_stopped(trained: Path, tmp_path: Path) -> None:
    steps = json.loads((trained / "checkpoint.json").read_text())["steps"]
    argv = ["train", "overhead", *SHORT, "--steps", str(steps + 600), "-o", str(trained)]
    assert main([*argv, "--resume"]) == 0
    again = json.loads((trained / "checkpoint.json").read_text())
    assert steps + 600 <= again["steps"] < steps + 600 + 2 * 512


def test_a_run_is_not_overwritten_and_not_resumed_from_nothing(
    trained: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["train", "overhead", "-o", str(trained)]) == 2
    assert "holds a run already" in capsys.readouterr().err
    assert main(["train", "overhead", "-o", str(tmp_path / "none"), "--resume"]) == 2
    assert "no checkpoint" in capsys.readouterr().err


def test_a_damaged_checkpoint_is_refused(trained: Path, tmp_path: Path) -> None:
    from flatrig.training import checkpoint

    (tmp_path / "checkpoint.json").write_text("{}")
    (tmp_path / "checkpoint.safetensors").write_bytes(b"\x80\x04pickle")
    with pytest.raises(OptionError, match="does not fit"):
        checkpoint.read(tmp_path, None, None)  # type: ignore[arg-type]


def test_the_same_seed_trains_the_same_policy(tmp_path: Path) -> None:
    found = []
    for name in "ab":
        argv = ["train", "overhead", *SHORT, "--steps", "600", "--seed", "3"]
        assert main([*argv, "-o", str(tmp_path / name)]) == 0
        found.append((tmp_path / name / "policy.safetensors").read_bytes())
    assert found[0] == found[1]
