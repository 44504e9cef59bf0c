"""What stands between the crane environments and PPO: adapter, tutor and teacher."""

from typing import Any

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")
pytest.importorskip("torch")

from stable_baselines3.common.vec_env import VecEnv

from flatrig import feedforward, models
from flatrig.training.compare import compare_cranes as compare
from flatrig.training.compare.contenders import with_residual
from flatrig.training.learn.sb3 import Adapter
from flatrig.training.learn.teacher import Teacher
from flatrig.training.learn.tutor import FAILURE, REWARD, Tutor
from flatrig.training.recall import Recall

RIG = models.overhead_crane()
MOVE = models.Move(start=(0.0, -4.0), goal=(0.5, -3.5), duration=1.5)


def adapter(num: int = 3, hold: float = 0.1, episode: int = 10_000, every: int = 1) -> Adapter:
    names = compare.environment(RIG, MOVE, 1).observation_names
    env = compare.environment(RIG, MOVE, num, sensors="full", hold=hold)
    teacher = Teacher(env.task, feedforward.from_move(MOVE), 0.1)
    tutor = Tutor(with_residual(env, 0.2), names, 0.1, teacher)
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
        env = with_residual(runner.env, float(teacher.fractions.max()))
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


def test_public_entries_are_what_the_encoders_environment_shows() -> None:
    made = adapter()
    plain = with_residual(compare.environment(RIG, MOVE, 3, hold=0.1), 0.2)
    scenarios = compare.scenarios_for(RIG, 3)
    seen, _ = made.env.reset(seed=0, options={"scenarios": scenarios})
    expected, _ = plain.reset(seed=0, options={"scenarios": scenarios})
    for step in range(30):
        assert seen.shape[1] > expected.shape[1]
        np.testing.assert_array_equal(seen[:, : expected.shape[1]], expected)
        action = np.full((3, 2), np.sin(0.3 * step))
        seen, expected = made.env.step(action)[0], plain.step(action)[0]


def test_public_entries_come_in_the_order_asked_for() -> None:
    env = compare.environment(RIG, MOVE, 2, sensors="full", hold=0.1)
    names = env.observation_names
    teacher = Teacher(env.task, feedforward.from_move(MOVE), 0.1)
    tutor = Tutor(with_residual(env, 0.2), names[::-1], 0.1, teacher)
    told, _ = tutor.reset(seed=0)
    plain, _ = compare.environment(RIG, MOVE, 2, sensors="full", hold=0.1).reset(seed=0)
    assert np.abs(plain - plain[:, ::-1]).max() > 0
    np.testing.assert_array_equal(told[:, : len(names)], plain[:, ::-1])


def test_a_new_episode_leaves_the_teacher_of_the_others_alone() -> None:
    made = adapter()
    tutor: Any = made.env
    tutor.reset(seed=0)
    for _ in range(20):
        tutor.step(np.full((3, 2), 0.3))
    teacher = tutor._teacher
    before, told = (teacher._sum.copy(), teacher._step.copy()), tutor.advice()
    tutor.reset(options={"reset_mask": np.array([False, True, False])})
    for others in (0, 2):
        np.testing.assert_array_equal(teacher._sum[others], before[0][others])
        np.testing.assert_array_equal(tutor.advice()[others], told[others])
    np.testing.assert_array_equal(teacher._step, [before[1][0], 1, before[1][2]])
    assert np.abs(teacher._sum[1]).max() < np.abs(before[0][1]).max()
