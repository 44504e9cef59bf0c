"""Policies as ONNX: onnxruntime says what NumPy does, over whole episodes, without torch."""

import json
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

from flatrig import envs
from flatrig.envs.laws import laws_of
from flatrig.training.cli import main
from flatrig.training.features import Features, Signal
from flatrig.training.gate import Gate
from flatrig.training.learned import LearnedResidual, base_controller, features_of
from flatrig.training.policy import SHIPPED, Policy

onnx = pytest.importorskip("onnx")
runtime = pytest.importorskip("onnxruntime")

from flatrig.training.policy_graph import graph_of, memory_of, signals_of  # noqa: E402

NAMES = sorted(path.stem for path in SHIPPED.glob("*.json"))


class Runner:
    """A graph as a controller runs it: what comes out as memory goes in again."""

    def __init__(self, policy, num):
        model = graph_of(policy).SerializeToString()
        self.session = runtime.InferenceSession(model, providers=["CPUExecutionProvider"])
        self.names = [value.name for value in self.session.get_outputs()]
        self.memory = memory_of(policy.card, num)
        for values in self.memory.values():
            values[...] = 7.0  # does not matter in the first step

    def __call__(self, signals, fresh):
        inputs = {"signals": signals, "fresh": fresh[:, None], **self.memory}
        said = dict(zip(self.names, self.session.run(None, inputs), strict=True))
        self.memory = {name: said[f"next_{name}"] for name in self.memory}
        return said


@pytest.mark.parametrize("name", NAMES)
def test_it_is_filters_gate_and_network(name):
    policy = Policy.load(SHIPPED / name)
    card = policy.card
    now, kept = signals_of(card)
    rng, values = np.random.default_rng(0), np.zeros((3, len(now)))
    signals = [
        Signal([one], lambda k=k: values[:, k : k + 1], one in kept) for k, one in enumerate(now)
    ]
    features = Features(signals, 1.0 / card.rate, card.time_constants)
    assert features.names == card.feature_names
    gate = Gate(np.array(card.usual), *card.gate, 1.0 / card.rate)
    graph, moved = Runner(policy, 3), 0.0
    scale = policy.network.scale[: len(now)]
    for step in range(30):
        values[...] = policy.network.mean[: len(now)] + 2.0 * scale * rng.normal(size=values.shape)
        fresh = np.array([step == 0, step in (0, 7), step in (0, 20)])
        wanted, heads = policy.network(features.look(fresh))
        share = gate.open(values[:, : len(card.units)], fresh)
        asked = share * np.array(card.units) * np.clip(wanted, -card.reach, card.reach)
        said = graph(values, fresh)
        assert np.abs(said["action"] - asked).max() < 1e-12
        assert "heads" in said if card.heads else "heads" not in said
        assert np.allclose(said.get("heads", heads), heads, rtol=0, atol=1e-9)
        moved = max(moved, np.abs(asked / card.units).max())
    assert moved > 0.01


@pytest.mark.parametrize(
    ("name", "plant"),
    [("overhead_crane-sway", "flatrig/OverheadCrane-v0"), ("ball_on_plate-encoders", None)],
)
def test_an_episode_driven_by_it_is_that_of_the_policy(name, plant):
    policy = Policy.load(SHIPPED / name)
    options = {"sensors": policy.card.sensors, "disturbances": "standard", "hold": 0.5}

    def make():
        if plant is None:
            return base_controller(envs.HandEnv(policy.card.plant, **options))
        return base_controller(envs.CraneEnv(policy.card.plant, **options))

    own, other = LearnedResidual(make(), policy), make()
    task = other.unwrapped.task
    mass = next((law for law in laws_of(other) if law.name == "MassEstimate"), None)
    features = features_of(task, mass, np.array(policy.card.speeds), policy.card.time_constants)
    graph = Runner(policy, 1)
    residuals, own_residual = [], own.law.residual
    own.law.residual = lambda: residuals.append(own_residual()) or residuals[-1]
    own.reset(seed=3)
    other.reset(seed=3)
    still, over, largest = np.zeros(len(task.action_names)), False, 0.0
    while not over:
        seen, _, terminated, truncated, _ = own.step(still)
        signals = np.concatenate(features.now(task.steps == 0), axis=1)
        action = graph(signals, task.steps == 0)["action"]
        assert np.abs(action - residuals[-1]).max() < 1e-6
        same = other.step(action[0])
        largest = max(largest, np.abs(action).max())
        over = terminated or truncated
        assert over == (same[2] or same[3])
    assert not terminated
    assert largest > 1e-3
    assert np.allclose(seen, same[0], rtol=0, atol=1e-6)


def test_the_command_writes_it_without_torch(tmp_path):
    file = tmp_path / "crane.onnx"
    code = (
        "import sys; from flatrig.training.cli import main; "
        f"assert main(['export', 'overhead', '--sensors', 'sway', '--onnx', {str(file)!r}]) == 0; "
        "assert 'torch' not in sys.modules"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert f"wrote {file}: 40 signals in, 2 drives, 50 Hz" in said.stdout
    model = onnx.load(file)
    onnx.checker.check_model(model, full_check=True)
    card = json.loads(model.metadata_props[0].value)
    stored = asdict(Policy.load(SHIPPED / "overhead_crane-sway").card)
    assert card == json.loads(json.dumps(stored))


def test_a_hands_policy_and_one_of_a_file(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["export", "ball-on-plate", "--onnx", "hand.onnx"]) == 0
    own = ["--policy", str(SHIPPED / "overhead_crane-sway.json"), "--onnx", "own.onnx"]
    assert main(["export", "overhead", *own]) == 0
    assert Path("own.onnx").stat().st_size > Path("hand.onnx").stat().st_size
    capsys.readouterr()
    for arguments, line in (
        (["overhead", "--onnx", "a.onnx", "--sensors", "full"], "did you mean overhead_crane-sway"),
        (["luffing", "--onnx", "a.onnx"], "no policy luffing_crane-encoders is shipped"),
        (["overhead", "--set", "load_mass=80", "--onnx", "a.onnx"], "is for other numbers"),
        (["rotary", *own[:2], "--onnx", "a.onnx"], "is for overhead_crane with the fingerprint"),
        (["overhead", "--policy", "none.json", "--onnx", "a.onnx"], "cannot read policy none.json"),
        (["overhead", "--onnx", "a.txt"], "--onnx is a.txt, it must end in .onnx"),
        (["overhead", "--policy", "none.json", "--c", "a.c"], "--policy is for --onnx"),
    ):
        assert main(["export", *arguments]) == 2
        said = capsys.readouterr().err
        assert line in said
        assert len(said.splitlines()) == 1
    assert {path.name for path in tmp_path.iterdir()} == {"hand.onnx", "own.onnx"}
