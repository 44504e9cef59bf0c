"""What a hand's residual can learn from encoders, what it cannot, and that it does."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flatrig.envs import PD, Feedforward, HandScenario, HandVectorEnv, hand_design
from flatrig.envs.controllers import PDLaw
from flatrig.envs.hand.goals import default_move
from flatrig.envs.laws import laws_of
from flatrig.models import OptionError, make_hand
from flatrig.training import policy as policies
from flatrig.training.cli import main
from flatrig.training.learn import train_hands
from flatrig.training.learn.hand_teacher import HandTeacher, visible
from flatrig.training.learn.hand_training import hand_disturbances
from flatrig.training.learned import LearnedResidual
from flatrig.training.policy import Policy, fingerprint_of, shipped
from flatrig.training.random_hand_moves import random_hand_move, random_hand_plan

HANDS = ("ball_on_plate", "ball_in_corner", "two_finger_hand", "three_finger_hand")


def driven(env, scenarios, law=None):
    """Run FF + PD, with a residual from a function of no arguments; returns the environment."""
    task = env.unwrapped.task
    env.reset(seed=0, options={"scenarios": scenarios})
    none = np.zeros((task.num, len(task.limits)))
    for _ in range(task.plans[0].steps - 1):  # the last step would begin the next episode
        env.step(none if law is None else law())
    return task


@pytest.mark.parametrize(
    ("hand", "scenario"),
    [
        ("two_finger_hand", HandScenario(turn=(0.0, 0.03, 0.0))),
        ("ball_on_plate", HandScenario(turn=(0.01, 0.02, 0.03))),
        ("ball_on_plate", HandScenario(shift=(0.001, -0.0005, 0.0))),
    ],
)
def test_encoders_do_not_tell_turns_nor_shifts_along_a_plate(
    hand: str, scenario: HandScenario
) -> None:
    move = replace(default_move(make_hand(hand)), duration=1.0)
    env = Feedforward(PD(HandVectorEnv(hand, num_envs=2, reference=move, hold=0.0)))
    task = driven(env, [HandScenario(), scenario])
    plain, disturbed = task.encoders.measured
    np.testing.assert_allclose(disturbed, plain, rtol=0, atol=1e-9)
    aside = np.subtract(*task.pose_errors())
    size = np.linalg.norm([*scenario.shift, *scenario.turn])
    np.testing.assert_allclose(np.linalg.norm(aside), size, rtol=0.02)


def test_directions_in_which_encoders_tell_the_place() -> None:
    told = {hand: visible(make_hand(hand)) for hand in HANDS}
    np.testing.assert_allclose(told["ball_on_plate"], np.diag([0, 0, 1]), atol=1e-12)
    np.testing.assert_allclose(told["ball_in_corner"], np.eye(3), atol=1e-12)
    np.testing.assert_allclose(told["two_finger_hand"], np.diag([1, 0, 1]), atol=1e-12)


@pytest.mark.parametrize("hand", ["ball_in_corner", "two_finger_hand"])
def test_the_teacher_takes_away_what_a_wrong_mass_does(hand: str) -> None:
    """Its push is that of a PD whose fingers are all misread by the object's error."""
    move = replace(default_move(make_hand(hand)), duration=1.0)
    env = Feedforward(PD(HandVectorEnv(hand, num_envs=1, reference=move, hold=0.1)))
    scenarios = [HandScenario(mass=1.2)]
    sag = np.linalg.norm(driven(env, scenarios).pose_errors()[0, :3])
    task = env.unwrapped.task
    servo = next(law for law in laws_of(env) if isinstance(law, PDLaw))
    teacher = HandTeacher(task, servo)

    place, drives = np.array([1e-4, 0.0, -3e-4]), len(task.limits)
    slides = np.vstack([finger.slides for finger in task.hand.fingers])
    misread = (slides @ -place) * servo.gains[:drives]
    np.testing.assert_allclose(teacher.carried(place[None])[0], misread, rtol=1e-12)

    def advice():
        wanted = teacher.advice()
        teacher.sent(wanted, task.steps == 0)
        return wanted

    left = np.linalg.norm(driven(env, scenarios, advice).pose_errors()[0, :3])
    assert sag > 2e-5
    assert left < 0.1 * sag


def test_random_moves_differ_and_can_be_planned() -> None:
    task = HandVectorEnv("ball_between_oblique_plates", num_envs=1, rate=50.0).task
    move = default_move(task.hand)
    first, again, other = (
        random_hand_plan(task, move, np.random.default_rng(seed)) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first.rows, again.rows)
    assert len(first.rows) != len(other.rows) or (first.rows != other.rows).any()
    turned = random_hand_move(task.hand, move, np.random.default_rng(3))
    assert turned.duration != move.duration


def test_training_writes_a_policy_that_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(train_hands, "JUDGED", 2)
    argv = ["train", "two-finger", "--duration", "0.5", "--episodes", "3", "--threads", "1"]
    argv += ["--iterations", "1"]
    assert main([*argv, "-o", str(tmp_path / "a")]) == 0
    assert "true encoders: place" in capsys.readouterr().out
    first = Policy.load(tmp_path / "a" / "policy")
    assert first.card.fingerprint == fingerprint_of(make_hand("two_finger_hand"))
    assert json.loads((tmp_path / "a" / "config.json").read_text())["episodes"] == 3
    assert main([*argv, "-o", str(tmp_path / "a")]) == 2
    with pytest.raises(OptionError, match="is for two_finger_hand, the environment's is ball_in_c"):
        LearnedResidual(Feedforward(PD(HandVectorEnv("ball_in_corner", num_envs=1))), first)
    other = HandVectorEnv(make_hand("two_finger_hand", mass=0.7), num_envs=1)
    with pytest.raises(OptionError, match="with other parts or numbers"):
        LearnedResidual(Feedforward(PD(other)), first)
    with pytest.raises(OptionError, match=r"on top of Feedforward\(PD\(env\)\)"):
        LearnedResidual(PD(HandVectorEnv("two_finger_hand", num_envs=1)), first)


@pytest.mark.parametrize("hand", ["two_finger_hand"])
def test_shipped_policies_halve_what_encoders_tell(hand: str) -> None:
    """On the catalogue's move, along which they were not trained, and on other plants."""
    described = make_hand(hand)
    drawn = hand_design(hand_disturbances(described), 3, seed=5)
    scenarios = [replace(scenario, offset=0.0) for scenario in drawn]
    base = HandVectorEnv(described, num_envs=3, hold=0.3)
    away = [
        np.linalg.norm(driven(env, scenarios).pose_errors()[:, :3], axis=1)
        for env in (Feedforward(PD(base)), LearnedResidual(Feedforward(PD(base))))
    ]
    assert away[1].mean() < 0.5 * away[0].mean()


def test_every_hand_has_a_small_policy() -> None:
    for hand in (*HANDS, "ball_between_plates", "ball_between_oblique_plates"):
        assert shipped(make_hand(hand)) is not None
        assert (policies.SHIPPED / f"{hand}-encoders.safetensors").stat().st_size < 300_000
