"""Environments of hands: Gymnasium's rules, determinism, endings, controllers, and closed loop."""

import json
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils.env_checker import check_env
from scipy.spatial.transform import Rotation

from flatrig.envs import (
    HAND_ENVIRONMENTS,
    OWN_HAND,
    PD,
    Feedforward,
    FrictionCompensation,
    HandDisturbances,
    HandEnv,
    HandScenario,
    HandVectorEnv,
    PoseFeedback,
    RandomGoals,
    Residual,
    hand_design,
)
from flatrig.envs.hand.goals import default_move
from flatrig.envs.hand.observation import pose_error
from flatrig.envs.hand.plan import drive_motion, gripped, hand_layout, make_hand_plan
from flatrig.envs.hand.rolling_feedback import twists
from flatrig.feedforward.rolling import grasp_matrix, joint_forces, plan_hand, wrench
from flatrig.models import HandMove, default_hand_move, dump_hand, dumps_hand, make_hand
from flatrig.models.errors import FlatrigError, OptionError, PathError
from flatrig.training.cli import main

HANDS = list(HAND_ENVIRONMENTS.values())
SHORT: dict[str, Any] = {"hold": 0.2, "rate": 250.0}


def run(env: Any, actions: Any, **reset: Any) -> tuple[Any, list[Any]]:
    """Observations and rewards of some steps, and the last info."""
    seen, _ = env.reset(**reset)
    found = [seen]
    for action in actions:
        seen, reward, _, _, info = env.step(action)
        found += [seen, np.asarray(reward)]
    return info, found


@pytest.mark.parametrize("name", HAND_ENVIRONMENTS)
def test_environments_obey_gymnasium(name: str) -> None:
    env = gym.make(name, disturbances="standard", sensors="full")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped, skip_render_check=True)
    names = env.unwrapped.observation_names
    assert len(set(names)) == len(names) == env.observation_space.shape[0]
    assert len(env.unwrapped.action_names) == env.action_space.shape[0]
    first, _ = env.reset(seed=1)
    second, _ = env.reset(seed=2)
    assert (first != second).any()


@pytest.mark.parametrize("hand", HANDS)
def test_a_vector_is_single_environments_side_by_side(hand: str) -> None:
    options = SHORT | {"disturbances": "standard", "sensors": "full"}
    actions = 0.05 * np.random.default_rng(3).uniform(-1, 1, (8, 2, 15))
    vector = HandVectorEnv(hand, num_envs=2, nthread=2, **options)
    width = vector.single_action_space.shape[0]
    driven = [PoseFeedback(Feedforward(PD(env))) for env in (vector, HandEnv(hand, **options))]
    _, together = run(driven[0], actions[..., :width], seed=5)
    _, again = run(driven[0], actions[..., :width], seed=5)
    for i in range(2):
        _, alone = run(driven[1], actions[:, i, :width], seed=5 + i)
        for one, other, same in zip(together, alone, again, strict=True):
            np.testing.assert_array_equal(one[i], other)
            np.testing.assert_array_equal(one, same)


def test_controllers_are_made_again_from_a_spec() -> None:
    env = gym.make("flatrig/TwoFingerHand-v0", sensors="full", **SHORT)
    env = PoseFeedback(Feedforward(PD(env)))
    _, first = run(env, np.zeros((5, 4)), seed=0)
    _, second = run(gym.make(env.spec), np.zeros((5, 4)), seed=0)
    for one, other in zip(first, second, strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_hand_of_ones_own_comes_as_a_description_a_file_or_text(tmp_path: Path) -> None:
    hand, move = make_hand("two_finger_hand", mass=0.3), HandMove(goal=(0.2,), duration=1.0)
    hand = replace(hand, name="mine")
    path = tmp_path / "mine.toml"
    dump_hand(path, hand, move)
    given = [
        {"hand": hand, "reference": move},
        {"hand": path},
        {"hand": str(path)},
        {"hand": dumps_hand(hand, move)},
    ]
    for options in given:
        env = gym.make(OWN_HAND, disturbances="standard", **options)
        assert env.unwrapped.task.hand == hand  # type: ignore[attr-defined]
        again = gym.make(EnvSpec.from_json(env.spec.to_json()))  # type: ignore[union-attr]
        found = [one.reset(seed=3)[0] for one in (env, again)]
        expected = gym.make(OWN_HAND, disturbances="standard", **given[0]).reset(seed=3)[0]
        np.testing.assert_array_equal(found, [expected] * 2)
    short = gym.make(OWN_HAND, hand='hand = "two_finger_hand"\nmass = 0.3')
    assert short.unwrapped.task.planner.fixed.steps == 1500  # type: ignore[attr-defined]
    for wrong, message in (
        (None, "an environment needs a hand"),
        (3, "hand is 3, it must be a Hand, a name of the catalogue or the path"),
        ("nowhere/mine.toml", "cannot read nowhere/mine.toml"),
        (hand, "hand mine is not in the catalogue and brings no move; give `reference`"),
    ):
        with pytest.raises(FlatrigError, match=message):
            gym.make(OWN_HAND, hand=wrong)


def test_random_goals_are_drawn_again_and_differ() -> None:
    env = HandEnv("two_finger_hand", reference="random", **SHORT)
    env.reset(seed=1)
    first = env.task.plans[0].goal.copy()
    env.reset()
    assert (env.task.plans[0].goal != first).any()
    env.reset(seed=1)
    np.testing.assert_array_equal(env.task.plans[0].goal, first)


@pytest.mark.parametrize("hand", HANDS)
def test_random_goals_can_mostly_be_reached(hand: str) -> None:
    described = make_hand(hand)
    draw, generator = RandomGoals(described, default_move(described)), np.random.default_rng(0)
    good = 0
    for _ in range(4):
        try:
            make_hand_plan(described, draw(generator), 0.05, 0.0)
            good += 1
        except PathError:
            pass
    assert good >= 1


@pytest.mark.parametrize("hand", HANDS)
def test_random_actions_never_raise_and_endings_have_names(hand: str) -> None:
    env = HandVectorEnv(hand, num_envs=3, disturbances="standard", **SHORT)
    generator, reasons = np.random.default_rng(0), set()
    env.reset(seed=0)
    for _ in range(120):
        seen, reward, over, _, info = env.step(generator.uniform(-2, 2, env.action_space.shape))
        assert np.isfinite(seen).all()
        assert ((reward >= 0) & (reward <= 1)).all()
        assert (reward[over] == 0).all()
        assert (info["reason"] > 0).tolist() == over.tolist()
        reasons |= {env.reasons[why] for why in info["reason"]}
    assert {""} < reasons <= {"", "dropped", "contact lost", "not finite"}


def test_opening_one_finger_loses_its_contact_and_time_runs_out() -> None:
    env = HandEnv("ball_between_plates", **SHORT)
    env.reset(seed=0)
    over, lifting = False, np.array([0.0, 0.0, 3.0 / 50, -0.5])  # the upper slide points down
    while not over:
        _, _, over, late, info = env.step(lifting)
        assert not late
    assert env.reasons[info["reason"]] == "contact lost"
    assert info["touching"].tolist() == [True, False]
    held = Feedforward(PD(env))
    held.reset(seed=0)
    for _ in range(env.task.planner.fixed.steps):
        _, reward, over, late, info = held.step(np.zeros(4))
    assert (late, over, env.reasons[info["reason"]]) == (True, False, "time")
    assert reward == pytest.approx(info["reward_tracking"] * info["reward_smoothness"])


def test_nothing_is_shared_with_the_simulation() -> None:
    env = HandEnv("two_finger_hand", sensors="full", **SHORT)
    seen, info = env.reset(seed=0)
    kept = {name: np.copy(value) for name, value in info.items() if isinstance(value, np.ndarray)}
    before = seen.copy()
    for _ in range(5):
        env.step(np.full(4, 0.3))
    np.testing.assert_array_equal(seen, before)
    for name, value in kept.items():
        np.testing.assert_array_equal(info[name], value)


@pytest.mark.parametrize("hand", ["ball_in_corner", "three_finger_hand"])
def test_a_zero_residual_changes_nothing(hand: str) -> None:
    env = HandEnv(hand, disturbances="standard", sensors="full", **SHORT)
    zeros = np.zeros((20, *env.action_space.shape))
    for wrap in (lambda e: Feedforward(PD(e)), lambda e: PoseFeedback(Feedforward(PD(e)))):
        _, plain = run(wrap(env), zeros, seed=4)
        _, residual = run(Residual(wrap(env)), zeros, seed=4)
        for one, other in zip(plain, residual, strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("hand", HANDS)
def test_the_closed_loop_ends_in_the_planned_pose(hand: str) -> None:
    """Goal: 1 mm and 0.5 degrees, undisturbed, and disturbed with the object misplaced."""
    described = make_hand(hand)
    scenarios = [HandScenario(), *hand_design(HandDisturbances.standard(described), 2, seed=7)]
    base = HandVectorEnv(described, num_envs=3, sensors="full", hold=0.5)
    env, ends = PoseFeedback(Feedforward(PD(base))), []
    for wrapped in (env, Feedforward(PD(base))):
        wrapped.reset(seed=0, options={"scenarios": scenarios})
        for _ in range(base.task.planner.fixed.steps):
            _, _, over, _, info = wrapped.step(np.zeros(base.action_space.shape))
            assert not over.any()
        ends.append((1e3 * info["distance"], np.degrees(info["turned"])))
    (away, turned), (_, open_turned) = ends
    assert away.max() < 1.0
    assert turned.max() < 0.5
    assert max(away[0], turned[0]) < 0.02
    assert (turned[1:] < 0.5 * open_turned[1:]).all()


@pytest.mark.parametrize("hand", HANDS)
def test_planned_forces_make_the_motion_inside_the_cones(hand: str) -> None:
    described = make_hand(hand)
    motion = plan_hand(described, default_hand_move(hand))(np.linspace(0, 1, 41))
    forces, squeeze = gripped(motion)
    given = np.einsum("nij,nj->ni", grasp_matrix(motion), forces.values.reshape(41, -1))
    np.testing.assert_allclose(given, wrench(motion), atol=1e-9)
    assert squeeze > 0
    assert forces.outside is None


@pytest.mark.parametrize("hand", HANDS)
def test_rows_after_arrival_are_those_of_the_whole_motion(hand: str) -> None:
    """A plan computes them once; here all instants are."""
    made, move, period = (
        make_hand(hand),
        replace(default_move(make_hand(hand)), duration=2.003),
        0.01,
    )
    plan = make_hand_plan(made, move, period, hold=0.2)
    motion = plan_hand(made, move)(period * np.arange(plan.steps + 2))
    forces = joint_forces(motion, gripped(motion)[0])
    columns = hand_layout(made).columns
    found = {name: plan.rows[:, own] for name, own in columns.items()}
    np.testing.assert_array_equal(found["drives"], np.hstack(drive_motion(motion))[:-1])
    middles = 0.5 * (forces.values[:-1] + forces.values[1:]) / forces.limits
    np.testing.assert_array_equal(found["feedforward"], middles)
    np.testing.assert_array_equal(found["outputs"][:, :3], motion.position[:-1])
    np.testing.assert_array_equal(plan.motion.times, motion.times[:-1])


def test_twists_that_fingers_can_give() -> None:
    """All six of a ball in a corner, three in the plane; plates roll a ball along two axes."""
    ways = {}
    for hand in HANDS:
        plan = plan_hand(make_hand(hand), default_hand_move(hand))
        ways[hand] = twists(plan([0.0]))
    assert [ways[hand].shape[1] for hand in HANDS] == [3, 3, 6, 3, 6]
    # On one plate p' = J / (m R) z x w, under one that stays p' = R z x w.
    for hand, factor in (("ball_on_plate", 0.4), ("ball_between_plates", 1.0)):
        velocity, turning = ways[hand][:3], ways[hand][3:]
        rolled = factor * np.cross((0.0, 0.0, 1.0), turning.T).T
        np.testing.assert_allclose(velocity[:2], rolled[:2], atol=1e-12)
        np.testing.assert_allclose(turning[2], 0.0, atol=1e-12)


def test_pose_errors_are_small_turns_in_space() -> None:
    generator = np.random.default_rng(0)
    turn, planned = 0.1 * generator.standard_normal((4, 3)), Rotation.random(4, rng=generator)
    turn[3] = 0.0
    place = generator.standard_normal((2, 4, 3))
    now = Rotation.from_rotvec(turn) * planned
    off = pose_error(
        np.hstack((place[0], now.as_matrix().reshape(4, 9))),
        np.hstack((place[1], planned.as_matrix().reshape(4, 9))),
    )
    np.testing.assert_allclose(off, np.hstack((place[0] - place[1], turn)), atol=1e-12)


def test_wrong_use_gets_one_line() -> None:
    env = HandEnv("two_finger_hand", **SHORT)
    full = HandEnv("two_finger_hand", sensors="full", **SHORT)
    with pytest.raises(OptionError, match='sensors="full"'):
        PoseFeedback(PD(env))
    for below in (full, PD(full, track="set point")):
        with pytest.raises(OptionError, match="put PD below"):
            PoseFeedback(below)
    with pytest.raises(OptionError, match="is for drives of cranes"):
        FrictionCompensation(env)
    with pytest.raises(OptionError, match="must be a HandScenario"):
        env.reset(options={"scenario": 3})
    with pytest.raises(OptionError, match="shift is 1, it must be three numbers"):
        HandScenario(shift=1)  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="turn is 'a', it must be a finite number"):
        HandScenario(turn=(0, "a", 0))  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="mass is 0, it must be"):
        HandScenario(mass=0)
    with pytest.raises(OptionError, match=r"there is no disturbance 'masss'.*mass"):
        HandEnv("two_finger_hand", disturbances={"masss": (1, 2)})
    with pytest.raises(PathError, match="of its friction at the best squeeze"):
        env.reset(options={"reference": HandMove(goal=(0.3,), duration=0.02, turning="axis")})
    hand = make_hand("two_finger_hand")
    weak = tuple(replace(finger, force_limit=5.0) for finger in hand.fingers)
    with pytest.raises(PathError, match=r"motor \w+.slide\d would have to give"):
        HandEnv(replace(hand, fingers=weak), **SHORT)


def test_compare_prints_a_row_for_each_controller(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    argv = ["compare", "two-finger-hand", "--scenarios", "2", "--duration", "1"]
    assert main([*argv, "-o", str(tmp_path)]) == 0
    assert "residual: flatrig train two-finger" in capsys.readouterr().out
    facts = json.loads((tmp_path / "summary.json").read_text())["controllers"]
    assert facts["residual, encoders"]["ended"] == 0
    assert facts["FF + PD + pose"]["reached"] == 2
    assert facts["feedforward"]["ended"] == 2
    assert main([*argv, "--policy", "x.json"]) == 2
    assert "cannot read policy" in capsys.readouterr().err
