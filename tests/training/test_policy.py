"""Stored policies: the network against a hand calculation, memory, gate and files."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flatrig import envs, models
from flatrig.models import fingerprint
from flatrig.models.errors import OptionError
from flatrig.training.features import Features, Signal
from flatrig.training.gate import Gate
from flatrig.training.learned import LearnedLaw, LearnedResidual, base_controller, features_of
from flatrig.training.network import CLIP, Network
from flatrig.training.policy import Card, Policy

RIG = models.overhead_crane()
MOVE = models.default_move(RIG)


def feature_names() -> tuple[str, ...]:
    env = base_controller(envs.CraneEnv(RIG))
    mass = next(law for law in envs.laws.laws_of(env) if law.name == "MassEstimate")
    return features_of(env.unwrapped.task, mass, np.ones(2), (0.2, 1.0)).names  # type: ignore[arg-type]


LIMITS = np.array([drive.limit for drive in RIG.drives])
GAINS = tuple(np.concatenate([g / LIMITS for g in envs.CraneTask(RIG).gains()[:2]]).tolist())

CARD = Card(
    plant=RIG.name, fingerprint=fingerprint(RIG), sensors="encoders", rate=50.0,
    feature_names=feature_names(), action_names=("trolley", "winch"), time_constants=(0.2, 1.0),
    gains=GAINS, units=(0.05, 0.02), reach=2.0, usual=(0.02, 0.01), gate=(0.1, 0.5, 10.0),
    speeds=(5.0, 5.0),
    box=((-1.0, -5.0), (6.0, -1.0)), heads=("mass", "wind"), training={"seed": 3},
)  # fmt: skip


def random_network(seed: int = 0, features: int = len(CARD.feature_names)) -> Network:
    rng = np.random.default_rng(seed)
    shapes = {
        "first": (7, features), "second": (6, 7), "heads": (2, 6), "mixed": (5, 8),
        "action": (2, 5), "skip": (2, features),
    }  # fmt: skip

    def single(numbers: np.ndarray) -> np.ndarray:
        """Numbers as they are stored, in single precision."""
        return numbers.astype(np.float32).astype(float)

    return Network(
        {name: single(rng.normal(size=shape)) for name, shape in shapes.items()},
        {name: single(rng.normal(size=shape[0])) for name, shape in shapes.items()},
        single(rng.normal(size=features)),
        single(rng.uniform(0.5, 2.0, features)),
    )


def random_policy(seed: int = 0, **changes: Any) -> Policy:
    return Policy(replace(CARD, **changes), random_network(seed))


def test_the_network_is_what_its_numbers_say() -> None:
    net = random_network()
    x = 20.0 * np.random.default_rng(1).normal(size=len(net.mean))
    w, b = net.weights, net.biases

    def silu(v: np.ndarray) -> np.ndarray:
        return v / (1.0 + np.exp(-v))

    z = np.clip((x - net.mean) / net.scale, -CLIP, CLIP)
    hidden = silu(w["second"] @ silu(w["first"] @ z + b["first"]) + b["second"])
    heads = w["heads"] @ hidden + b["heads"]
    mixed = silu(w["mixed"] @ np.append(hidden, heads) + b["mixed"])
    expected = w["action"] @ mixed + b["action"] + w["skip"] @ z + b["skip"]
    action, told = net(x[None])
    np.testing.assert_allclose(action[0], expected, rtol=1e-12)
    np.testing.assert_allclose(told[0], heads, rtol=1e-12)


def test_torch_has_the_same_network() -> None:
    torch = pytest.importorskip("torch")
    from flatrig.training.learn.student import Student, normalised

    torch.manual_seed(4)
    student = Student(9, 2, 3, 16)
    for layer in student.parameters():
        torch.nn.init.normal_(layer, std=0.5)
    mean, scale = np.arange(9.0), np.full(9, 2.0)
    x = np.random.default_rng(0).normal(3.0, 5.0, (20, 9))
    ours, heads = student.export(mean, scale)(x)
    theirs, told = student(torch.from_numpy(normalised(x, mean, scale)))
    np.testing.assert_allclose(ours, theirs.detach().numpy(), rtol=1e-4, atol=1e-5)
    np.testing.assert_allclose(heads, told.detach().numpy(), rtol=1e-4, atol=1e-5)


def test_filters_go_to_what_stays_and_forget_with_the_episode() -> None:
    now = np.zeros((2, 1))
    signals = [Signal(["a"], lambda: now.copy(), True), Signal(["b"], lambda: now + 7.0)]
    features = Features(signals, 0.02, (0.2, 1.0))
    assert features.names == ("a", "b", "a ~0.2 s", "a ~1 s")
    fresh, old = np.array([True, True]), np.array([False, False])
    features.look(fresh)
    now[...] = 1.0
    for step in range(1, 51):  # one second of a constant signal
        seen = features.look(old)
        slow = 1.0 - np.exp(-step * 0.02 / np.array([0.2, 1.0]))
        np.testing.assert_allclose(seen, [[1.0, 8.0, *slow]] * 2)
    now[...] = 3.0
    seen = features.look(np.array([False, True]))
    np.testing.assert_array_equal(seen[1], [3.0, 10.0, 3.0, 3.0])
    assert (seen[0, 2:] < 1.2).all()


def test_a_gate_opens_with_evidence_stays_open_for_a_while_and_shuts() -> None:
    gate = Gate(np.array([0.02, 0.01]), low=0.1, high=0.5, forget=2.0, period=0.02)
    fresh, old = np.array([True, True]), np.array([False, False])
    quiet = np.zeros((2, 2))
    np.testing.assert_array_equal(gate.open(quiet + 1e-3, fresh), 0.0)
    found = np.array([[0.006, 0.0], [0.0, -0.01]])
    for _ in range(200):  # the low-pass filter has settled
        share = gate.open(found, old)
    evidence = np.array([0.3, 1.0]) / np.sqrt(2.0)
    np.testing.assert_allclose(share[:, 0], np.clip((evidence - 0.1) / 0.4, 0.0, 1.0), rtol=1e-6)
    for _ in range(round(2.0 / 0.02)):  # one time constant
        share = gate.open(quiet, old)
    kept = np.clip((evidence * np.exp(-1.0) - 0.1) / 0.4, 0.0, 1.0)
    np.testing.assert_allclose(share[:, 0], kept, atol=1e-9)
    assert kept[1] > 0.3
    np.testing.assert_array_equal(gate.open(quiet, fresh), 0.0)


def test_an_undisturbed_plant_is_left_to_its_controller() -> None:
    """However wild the network, the gate stays shut, and the load goes as without."""
    ends = []
    for learned in (False, True):
        env = base_controller(envs.CraneEnv(RIG))
        env = LearnedResidual(env, random_policy()) if learned else env
        env.reset(seed=0)
        over = False
        while not over:
            _, _, terminated, truncated, info = env.step(np.zeros(2))
            over = terminated or truncated
        assert not terminated
        ends.append(info["load"])
    np.testing.assert_array_equal(ends[0], ends[1])


def test_a_residual_is_bounded_and_that_of_a_single_simulation() -> None:
    policy = random_policy()
    scenarios = [envs.Scenario(load_mass=1.2, wind=20.0), envs.Scenario(load_mass=0.9, delay=2)]

    def roll(num: int, first: int) -> np.ndarray:
        env = base_controller(envs.CraneVectorEnv(RIG, num_envs=num, disturbances="standard"))
        mass = next(law for law in envs.laws.laws_of(env) if law.name == "MassEstimate")
        law = LearnedLaw(env.unwrapped.task, policy, mass)  # type: ignore[arg-type]
        env.reset(seed=0, options={"scenarios": scenarios[first : first + num]})
        said = []
        for _ in range(60):
            said.append(law.residual())
            env.step(said[-1])
        return np.array(said)

    both = roll(2, 0)
    for index in (0, 1):
        np.testing.assert_allclose(both[:, index], roll(1, index)[:, 0], rtol=1e-9, atol=1e-12)
    assert np.abs(both).max() > 0.01
    assert (np.abs(both) <= 2.0 * np.array(CARD.units)).all()


@pytest.mark.parametrize(
    ("far", "share"), [(0.0, 1.0), (0.15, 0.5), (0.4, 0.0)], ids=["inside", "near", "far"]
)
def test_a_residual_fades_where_it_was_not_trained(far: float, share: float) -> None:
    goal = CARD.box[1][0] + far * (CARD.box[1][0] - CARD.box[0][0])
    rig = replace(RIG, rails=(replace(RIG.rails[0], end=20.0),))
    policy = random_policy(fingerprint=fingerprint(rig), speeds=(50.0, 50.0))
    move = models.Move(start=(0.0, -4.0), goal=(goal, -3.5), duration=8.0)
    env = LearnedResidual(base_controller(envs.CraneEnv(rig, reference=move)), policy)
    env.reset(seed=0)
    if share == 1.0:
        env.step(np.zeros(2))
    else:
        with pytest.warns(UserWarning, match=f"its residual counts {100 * share:.0f} %"):
            env.step(np.zeros(2))
    np.testing.assert_allclose(env.law._trust, share, atol=1e-9)


def test_saving_and_loading_keeps_every_bit(tmp_path: Path) -> None:
    policy = random_policy()
    policy.save(tmp_path / "policy")
    loaded = Policy.load(tmp_path / "policy.json")
    assert loaded.card == policy.card
    for name, array in policy.network.tensors().items():
        np.testing.assert_array_equal(array, loaded.network.tensors()[name])
    assert {path.name for path in tmp_path.iterdir()} == {"policy.json", "policy.safetensors"}


def test_weights_of_a_large_network_are_stored_in_half_precision(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    policy = random_policy()
    policy.save(tmp_path / "single")
    monkeypatch.setattr("flatrig.training.policy.SINGLE", 100)
    policy.save(tmp_path / "half")
    sizes = [(tmp_path / f"{name}.safetensors").stat().st_size for name in ("half", "single")]
    assert sizes[0] < 0.85 * sizes[1]
    loaded = Policy.load(tmp_path / "half").network
    np.testing.assert_array_equal(loaded.mean, policy.network.mean)
    np.testing.assert_allclose(loaded.weights["first"], policy.network.weights["first"], atol=2e-3)
    assert np.abs(loaded.weights["first"] - policy.network.weights["first"]).max() > 0.0


def test_what_is_not_a_policy_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OptionError, match="cannot read policy"):
        Policy.load(tmp_path / "nowhere")
    policy = random_policy()
    policy.save(tmp_path / "policy")
    card = json.loads((tmp_path / "policy.json").read_text())
    for changes in (
        {"format": 1}, {"units": [0.2]}, {"action_names": ["trolley"]}, {"gate": [0.1, 0.5]},
        {"feature_names": ["a"]}, {"heads": []}, {"box": [[0.0, 0.0], [1.0, "nan"]]},
        {"fingerprint": 5},
    ):  # fmt: skip
        (tmp_path / "policy.json").write_text(json.dumps(card | changes))
        with pytest.raises(OptionError, match="not a flatrig policy"):
            Policy.load(tmp_path / "policy")
    (tmp_path / "policy.json").write_text(json.dumps(card))
    (tmp_path / "policy.safetensors").write_bytes(b"cposix\nsystem\n")
    with pytest.raises(OptionError, match="not a flatrig policy"):
        Policy.load(tmp_path / "policy")


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("first.weight", np.nan, "not finite"),
        ("action.bias", -np.inf, "not finite"),
        ("mean", np.nan, "not finite"),
        ("scale", 0.0, "a feature's scale is 0, it must be > 0"),
        ("scale", -1.0, "a feature's scale is -1, it must be > 0"),
        ("skip.weight", 1e30, "larger than 1e"),
    ],
)
def test_numbers_that_make_no_finite_action_are_refused(
    tmp_path: Path, name: str, value: float, message: str
) -> None:
    policy = random_policy()
    policy.network.tensors()[name].flat[0] = value
    policy.save(tmp_path / "policy")
    with pytest.raises(OptionError, match=message):
        Policy.load(tmp_path / "policy")


@pytest.mark.parametrize(
    ("changes", "options", "message"),
    [
        ({"plant": "rotary_crane"}, {}, "the policy is for rotary_crane, the environment's is"),
        ({"fingerprint": "0"}, {}, "with other parts or numbers than the environment's"),
        ({}, {"rate": 25.0}, "acts at 50 Hz, the environment at 25 Hz"),
        ({"sensors": "full"}, {}, "needs sensors='full', the environment has 'encoders'"),
        ({"action_names": ("winch", "trolley")}, {}, "acts on winch, trolley, the environment on"),
        ({"time_constants": (0.2, 2.0)}, {}, "was trained with other features"),
    ],
)
def test_a_policy_for_something_else_is_refused(
    changes: dict[str, Any], options: dict[str, Any], message: str
) -> None:
    env = base_controller(envs.CraneEnv(RIG, **options))
    with pytest.raises(OptionError, match=message):
        LearnedResidual(env, random_policy(**changes))


def test_a_residual_wants_the_gains_that_it_was_trained_on() -> None:
    env = envs.CraneEnv(RIG)
    env = envs.MassEstimate(envs.Feedforward(envs.PD(envs.TautGuard(env), stiffness=[900.0, 50.0])))
    with pytest.raises(OptionError, match="was trained on a PD with other gains"):
        LearnedResidual(env, random_policy())


def test_a_residual_wants_the_controllers_that_it_was_trained_on() -> None:
    env = envs.Feedforward(envs.PD(envs.CraneEnv(RIG)))
    with pytest.raises(OptionError, match="there is no MassEstimate below it"):
        LearnedResidual(env, random_policy())
    other = base_controller(envs.CraneEnv(models.overhead_crane(load_mass=101)))
    with pytest.raises(OptionError, match="no policy is shipped for overhead_crane"):
        LearnedResidual(other)
