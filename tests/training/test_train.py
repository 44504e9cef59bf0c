"""Training, end to end and small: imitation, export, result folder, checkpoints."""

import csv
import io
import json
import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")
pytest.importorskip("torch")

import torch
from rich.console import Console

from flatrig import models
from flatrig.models.errors import OptionError
from flatrig.training.cli import main
from flatrig.training.learn.ppo import Training
from flatrig.training.learn.sb3 import export
from flatrig.training.learn.settings import Settings
from flatrig.training.lock import locked
from flatrig.training.options import Train
from flatrig.training.policy import Policy

RIG = models.overhead_crane()


@pytest.fixture(autouse=True, scope="module")
def _few_scenarios() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("flatrig.training.learn.ppo.VALIDATION_SCENARIOS", 4)
        yield


SHORT = ["--goal", "0.5", "-3.5", "--duration", "1.5", "--envs", "4", "--evaluations", "1"]


def training_in(folder: Path, settings: Settings | None = None, **more: Any) -> Training:
    command = Train("overhead", goal=(0.5, -3.5), duration=1.5, envs=4, evaluations=1, **more)
    out = Console(file=io.StringIO(), width=200)
    return Training(*command.target(), command, settings or Settings(), folder, out)


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Training:
    training = training_in(tmp_path_factory.mktemp("finished"), steps=600, seed=5)
    training.run()
    return training


def test_a_resumed_run_has_the_numbers_of_the_run_before(finished: Training) -> None:
    again = training_in(finished.folder, steps=600, seed=5, resume=True)
    assert (again.steps, again.spent, again.best) == (
        finished.steps,
        finished.spent,
        finished.best,
    )
    weights = finished.model.policy.state_dict()
    assert weights["action_net.weight"].abs().max() > 0
    for name, value in again.model.policy.state_dict().items():
        torch.testing.assert_close(value, weights[name], rtol=0, atol=0)
    moments = finished.model.policy.optimizer.state_dict()["state"]
    restored = again.model.policy.optimizer.state_dict()["state"]
    assert restored.keys() == moments.keys()
    assert len(moments) > 0
    for index, entries in moments.items():
        assert {"step", "exp_avg", "exp_avg_sq"} <= entries.keys() == restored[index].keys()
        for name, value in entries.items():
            torch.testing.assert_close(restored[index][name], value, rtol=0, atol=0)
    ours, theirs = again.adapter.normaliser, finished.adapter.normaliser
    np.testing.assert_array_equal(ours.mean, theirs.mean)
    np.testing.assert_array_equal(ours.var, theirs.var)
    assert ours.count == theirs.count


def test_a_resumed_run_does_not_meet_its_first_scenarios_again(finished: Training) -> None:
    found = []
    for resume in (False, False, True):
        training = training_in(finished.folder, steps=600, seed=5, resume=resume)
        training.adapter.reset()
        found.append(list(training.adapter.env.unwrapped.task.scenarios))
    assert found[0] == found[1]
    assert not set(map(repr, found[0])) & set(map(repr, found[2]))


def test_the_last_line_says_which_policy_is_best_and_where(finished: Training) -> None:
    file: Any = finished.out.file
    line = file.getvalue().splitlines()[-1]
    best = json.loads((finished.folder / "policy.json").read_text())["training"]["steps"]
    assert line.startswith(f"best policy, of decision {best}: ")
    assert "on the validation scenarios that it was selected on" in line


def test_an_evaluation_tells_of_early_ends(
    finished: Training, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    judge, whole = finished.judge, finished.judge.residual
    monkeypatch.setattr(finished, "folder", tmp_path)
    assert "ended" not in finished.evaluate()
    failed = np.array([1.0, 0.0, 1.0, 1.0])
    monkeypatch.setattr(judge, "residual", lambda *given: replace(whole(*given), failed=failed))
    assert finished.evaluate().endswith("%), 3 ended early")


def test_the_actor_ignores_what_only_the_critic_may_see(finished: Training) -> None:
    network: Any = finished.model.policy
    public = finished.recall.features
    told = torch.rand(20, public + finished.adapter.private)
    other = told.clone()
    other[:, public:] += 1.0
    with torch.no_grad():
        actions = [network._predict(x, deterministic=True) for x in (told, other)]
        values = [network.predict_values(x) for x in (told, other)]
        changed = network._predict(told + 1.0, deterministic=True)
    torch.testing.assert_close(actions[0], actions[1], rtol=0, atol=0)
    assert (values[0] - values[1]).abs().min() > 0
    assert (actions[0] - changed).abs().min() > 0


def test_imitation_comes_close_to_the_teacher(tmp_path: Path) -> None:
    training = training_in(tmp_path, Settings(imitation=1.0), steps=800)
    training.run()
    parts: Any = training.model.policy.mlp_extractor
    head: Any = training.model.policy.action_net
    places, said = (torch.cat(column) for column in zip(*training.model.lessons, strict=True))
    with torch.no_grad():
        left = (head(parts.forward_actor(places)) - said).square().mean()
    assert left < 0.5 * said.square().mean()  # the actor starts at 0


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
    training = training_in(trained, resume=True)
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


def test_resuming_goes_on_where_it_stopped(trained: Path) -> None:
    steps = json.loads((trained / "checkpoint.json").read_text())["steps"]
    assert main(["train", "overhead", "-o", str(trained), "--resume"]) == 0
    same = json.loads((trained / "checkpoint.json").read_text())["steps"]
    assert same <= steps + 4  # the budget is the run's own, and spent
    more = ["--steps", str(same + 600), "-o", str(trained)]
    assert main(["train", "overhead_crane", *SHORT, *more, "--resume"]) == 0
    again = json.loads((trained / "checkpoint.json").read_text())
    assert same + 600 <= again["steps"] < same + 600 + 2 * 512
    config = json.loads((trained / "config.json").read_text())
    assert config["options"]["steps"] == 1000
    assert [later["steps"] for later in config["resumed"]] == [1000, same + 600]
    assert [later["from"] for later in config["resumed"]] == [steps, same]


def test_what_was_noted_after_the_checkpoint_is_not_there_twice(
    trained: Path, tmp_path: Path
) -> None:
    """A run killed between two checkpoints has rows that the resumed one writes again."""
    folder = tmp_path / "run"
    shutil.copytree(trained, folder)
    steps = json.loads((folder / "checkpoint.json").read_text())["steps"]
    kept = {}
    for name in ("progress.csv", "evaluation.csv"):
        kept[name] = (folder / name).read_text()
        header, *_, last = kept[name].splitlines()
        row = dict(zip(header.split(","), last.split(","), strict=True))
        later = ",".join((row | {"steps": str(steps + 64)}).values())
        with (folder / name).open("a") as file:
            file.write(f"{later}\n{later[: len(later) // 2]}")
    assert main(["train", "overhead", "-o", str(folder), "--resume"]) == 0
    for name, text in kept.items():
        assert (folder / name).read_text().startswith(text)
        with (folder / name).open(newline="") as file:
            reached = [int(row["steps"]) for row in csv.DictReader(file)]
        assert steps + 64 not in reached[: len(text.splitlines())]
        assert reached == sorted(reached)
    (folder / "progress.csv").write_text("no,table\n")
    assert main(["train", "overhead", "-o", str(folder), "--resume"]) == 2


def test_two_runs_in_one_folder_keep_apart(
    trained: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = {path.name: path.read_bytes() for path in trained.iterdir()}
    with locked(trained):
        assert main(["train", "overhead", "-o", str(trained), "--resume"]) == 2
    assert f"process {os.getpid()} on" in capsys.readouterr().err
    assert {path.name: path.read_bytes() for path in trained.iterdir()} == before
    with locked(trained.parent / "begun"):
        argv = ["train", "overhead", *SHORT, "--steps", "100", "-o", str(trained.parent / "begun")]
        assert main(argv) == 2
        assert [path.name for path in (trained.parent / "begun").iterdir()] == [".lock"]


@pytest.mark.parametrize(
    ("argv", "expected"),
    [
        (["overhead", "--envs", "8"], "--envs is 8, but the run in"),
        (["overhead", "--seed", "7"], "begun with 0"),
        (["overhead", "--goal", "0.6", "-3.5"], "begun with 0.5 -3.5"),
        (["overhead", "--set", "load_mass=80"], "begun with none"),
        (["rotary"], "rotary is not the rig"),
    ],
    ids=["envs", "seed", "goal", "set", "rig"],
)
def test_another_run_is_not_resumed(
    argv: list[str], expected: str, trained: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = {path.name: path.read_bytes() for path in trained.iterdir()}
    assert main(["train", *argv, "-o", str(trained), "--resume"]) == 2
    assert expected in capsys.readouterr().err
    assert {path.name: path.read_bytes() for path in trained.iterdir()} == before


def test_a_run_is_not_overwritten_and_not_resumed_from_nothing(
    trained: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["train", "overhead", "-o", str(trained)]) == 2
    assert "holds a run already" in capsys.readouterr().err
    assert main(["train", "overhead", "-o", str(tmp_path / "none"), "--resume"]) == 2
    assert "no checkpoint" in capsys.readouterr().err


def test_a_run_that_cannot_begin_leaves_nothing(tmp_path: Path) -> None:
    argv = ["train", "overhead", "--goal", "9", "-1", "-o", str(tmp_path / "run")]
    assert main(argv) == 1
    assert not (tmp_path / "run").exists()


def test_a_run_without_a_checkpoint_is_begun_anew(tmp_path: Path) -> None:
    for name in ("config.json", "progress.csv", "evaluation.csv"):
        (tmp_path / name).write_text("of the run before\n")
    assert main(["train", "overhead", *SHORT, "--steps", "100", "-o", str(tmp_path)]) == 0
    assert "checkpoint.json" in {path.name for path in tmp_path.iterdir()}
    assert "of the run before" not in (tmp_path / "evaluation.csv").read_text()


def test_a_folder_where_a_table_should_be(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from flatrig.models.files import OutputError
    from flatrig.training.tables import append_csv

    (tmp_path / "evaluation.csv").mkdir()
    assert main(["train", "overhead", *SHORT, "--steps", "100", "-o", str(tmp_path)]) == 2
    assert "evaluation.csv: it is there already" in capsys.readouterr().err
    with pytest.raises(OutputError, match="Is a directory"):
        append_csv(tmp_path / "evaluation.csv", {"steps": 1})


def test_a_damaged_checkpoint_is_refused(trained: Path, tmp_path: Path) -> None:
    from flatrig.training.learn import checkpoint

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
