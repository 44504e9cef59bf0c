"""Stored policies: the network against a hand calculation, the memory, the files."""

import itertools
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from flatrig import models
from flatrig.models.errors import OptionError
from flatrig.training.policy import SHIPPED, Card, Policy, shipped

NAMES = ("trolley.error", "winch.error", "left")
CARD = Card(
    rig="overhead_crane",
    observation_names=NAMES,
    action_names=("trolley", "winch"),
    fraction=0.2,
    rate=50.0,
    sensors="encoders",
    time_constants=(0.2, 1.0),
    smoothing=0.5,
    every=1,
    shares=(1.0, 0.5),
    training={"seed": 3},
)


def random_policy(seed: int = 0, card: Card = CARD) -> Policy:
    rng = np.random.default_rng(seed)
    widths = (15, 8, 6, 2)
    return Policy(
        card=card,
        weights=tuple(rng.normal(size=(b, a)) for a, b in itertools.pairwise(widths)),
        biases=tuple(rng.normal(size=b) for b in widths[1:]),
        mean=rng.normal(size=15),
        scale=rng.uniform(0.5, 2.0, 15),
    )


def test_the_network_is_what_its_numbers_say() -> None:
    policy = random_policy()
    x = np.random.default_rng(1).normal(size=15)
    hidden = (x - policy.mean) / policy.scale
    hidden = np.tanh(policy.weights[0] @ hidden + policy.biases[0])
    hidden = np.tanh(policy.weights[1] @ hidden + policy.biases[1])
    expected = policy.weights[2] @ hidden + policy.biases[2]
    np.testing.assert_allclose(policy.network(x[None])[0], expected, rtol=1e-13)


def test_memory_filters_towards_what_stays() -> None:
    recall = random_policy().recall
    memory = recall.start(1)
    first = recall.look(np.zeros((1, 3)), memory)
    assert first.shape == (1, recall.features)
    for step in range(1, 51):  # one second of a constant observation
        recall.act(memory)
        features = recall.look(np.ones((1, 3)), memory)
        slow = features[0, 5:].reshape(2, 5)[:, 0]
        np.testing.assert_allclose(slow, 1.0 - np.exp(-step * 0.02 / np.array([0.2, 1.0])))


def test_the_network_is_asked_every_few_periods() -> None:
    policy = random_policy(card=replace(CARD, every=4, smoothing=1.0))
    policy = replace(policy, weights=(*policy.weights[:-1], 0.1 * policy.weights[-1]))
    policy = replace(policy, biases=(*policy.biases[:-1], 0.1 * policy.biases[-1]))
    memory = policy.start(1)
    rng = np.random.default_rng(6)
    actions = np.array([policy(rng.normal(size=(1, 3)), memory)[0] for _ in range(12)])
    blocks = actions.reshape(3, 4, 2)
    np.testing.assert_array_equal(blocks, np.repeat(blocks[:, :1], 4, axis=1))
    assert np.abs(np.diff(blocks[:, 0], axis=0)).min() > 1e-6


def test_an_episode_forgets_the_one_before() -> None:
    policy = random_policy()
    rng = np.random.default_rng(2)
    observations = rng.normal(size=(20, 4, 3))
    memory = policy.start(4)
    before = [policy(observation, memory) for observation in observations]
    memory.reset(np.array([True, False, True, False]))
    after = [policy(observation, memory) for observation in observations]
    np.testing.assert_array_equal(np.array(before)[:, [0, 2]], np.array(after)[:, [0, 2]])
    assert np.abs(np.array(before) - np.array(after))[:, [1, 3]].max() > 1e-6


def test_actions_are_smooth_bounded_and_copies() -> None:
    policy = random_policy()
    policy = replace(policy, weights=tuple(50.0 * weight for weight in policy.weights))
    memory = policy.start(2)
    rng = np.random.default_rng(3)
    last = np.zeros((2, 2))
    for _ in range(30):
        action = policy(rng.normal(size=(2, 3)), memory)
        assert (np.abs(action) <= (1.0, 0.5)).all()
        assert np.abs(action - last).max() <= 0.5 * 2.0 + 1e-12
        last = action.copy()
        action[:] = np.nan
    assert np.isfinite(memory.action).all()


def test_a_batch_gives_what_its_members_give() -> None:
    policy = random_policy()
    observations = np.random.default_rng(4).normal(size=(10, 5, 3))
    memory, single = policy.start(5), policy.start(1)
    for observation in observations:
        together = policy(observation, memory)
        alone = policy(observation[2:3], single)
        np.testing.assert_allclose(together[2], alone[0], rtol=1e-12)


def test_saving_and_loading_keeps_every_bit(tmp_path: Path) -> None:
    policy = random_policy()
    policy.save(tmp_path / "policy")
    loaded = Policy.load(tmp_path / "policy.json")
    assert loaded.card == policy.card
    for one, other in zip(
        (*policy.weights, *policy.biases, policy.mean, policy.scale),
        (*loaded.weights, *loaded.biases, loaded.mean, loaded.scale),
        strict=True,
    ):
        np.testing.assert_array_equal(one, other)
    assert {path.name for path in tmp_path.iterdir()} == {"policy.json", "policy.safetensors"}


def test_what_is_not_a_policy_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OptionError, match="cannot read policy"):
        Policy.load(tmp_path / "nowhere")
    policy = random_policy()
    policy.save(tmp_path / "policy")
    card = json.loads((tmp_path / "policy.json").read_text())
    for changes in ({"format": 99}, {"time_constants": [0.2]}, {"action_names": ["trolley"]}):
        (tmp_path / "policy.json").write_text(json.dumps(card | changes))
        with pytest.raises(OptionError, match="not a flatrig policy"):
            Policy.load(tmp_path / "policy")
    (tmp_path / "policy.json").write_text(json.dumps(card))
    (tmp_path / "policy.safetensors").write_bytes(b"cposix\nsystem\n")
    with pytest.raises(OptionError, match="not a flatrig policy"):
        Policy.load(tmp_path / "policy")
    replace(policy, mean=np.full(15, np.nan)).save(tmp_path / "policy")
    with pytest.raises(OptionError, match="not finite"):
        Policy.load(tmp_path / "policy")


def task(policy: Policy, **changes: Any) -> Any:
    """What `check` looks at of a task that suits a policy, with some of it changed."""
    card = policy.card
    fitting = {
        "rig": SimpleNamespace(name=card.rig),
        "period": 1.0 / card.rate,
        "observation_names": card.observation_names,
        "action_names": card.action_names,
    }
    return SimpleNamespace(**fitting | changes)


def test_another_environment_is_refused() -> None:
    policy = random_policy()
    policy.check(task(policy))
    with pytest.raises(OptionError, match="other observations"):
        policy.check(task(policy, observation_names=(*NAMES, "load.x")))
    with pytest.raises(OptionError, match="order"):
        policy.check(task(policy, action_names=("winch", "trolley")))
    with pytest.raises(OptionError, match="is for rig"):
        policy.check(task(policy, rig=SimpleNamespace(name="another")))
    with pytest.raises(OptionError, match="the environment at 123 Hz"):
        policy.check(task(policy, period=1.0 / 123.0))


@pytest.mark.parametrize(
    "changes",
    [
        {"rate": 0},
        {"rate": float("inf")},
        {"time_constants": [0, 1]},
        {"every": 0},
        {"every": 1.5},
        {"smoothing": 2},
        {"shares": [9, 9]},
        {"shares": [1]},
        {"rig": 5},
        {"fraction": "a"},
    ],
)
def test_values_that_no_policy_can_have_are_refused(
    changes: dict[str, Any], tmp_path: Path
) -> None:
    random_policy().save(tmp_path / "policy")
    card = json.loads((tmp_path / "policy.json").read_text())
    (tmp_path / "policy.json").write_text(json.dumps(card | changes))
    with pytest.raises(OptionError, match="not a flatrig policy"):
        Policy.load(tmp_path / "policy")


@pytest.mark.parametrize("path", sorted(SHIPPED.glob("*.json")), ids=lambda path: path.stem)
def test_shipped_policies_are_small_and_say_where_they_come_from(path: Path) -> None:
    policy = shipped(path.stem)
    assert policy is not None
    assert policy.card.rig == path.stem
    assert str(policy.card.training["command"]).startswith("flatrig train ")
    assert path.with_suffix(".safetensors").stat().st_size + path.stat().st_size < 1e6
    first = policy(np.zeros((1, len(policy.card.observation_names))), policy.start())
    assert np.abs(first).max() <= 1.0


def test_a_rig_without_a_policy_has_none() -> None:
    assert shipped(models.navy_crane_3d()) is None
