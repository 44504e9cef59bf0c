"""Training, end to end and small: lessons, export, result folder, checkpoints."""

import csv
import json
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("torch")

import torch

from flatrig import models
from flatrig.envs import Disturbances, Scenario
from flatrig.training.cli import main
from flatrig.training.learn import checkpoint
from flatrig.training.learn.crane_teacher import CraneTeacher
from flatrig.training.learn.dagger import Training
from flatrig.training.learn.rollout import Classroom, draw_episodes
from flatrig.training.learn.settings import Settings
from flatrig.training.learn.student import Lessons, School, Student
from flatrig.training.lock import locked
from flatrig.training.policy import Policy

RIG = models.overhead_crane()
MOVE = models.default_move(RIG)
SHORT = ["--episodes", "4", "--iterations", "1", "--threads", "1"]


@pytest.fixture(autouse=True, scope="module")
def _few_lessons() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("flatrig.training.learn.loop.VALIDATION_EPISODES", 4)
        patch.setattr("flatrig.training.learn.loop.VALIDATION_HOLDS", (1.0, 1.0))
        patch.setattr(Settings, "__init__", _fewer(Settings.__init__))
        yield


FEW = {"updates": 20, "last_updates": 20, "width": 16, "holds": (0.5, 1.0)}


def _fewer(init: Any) -> Any:
    def made(self: Settings, **values: Any) -> None:
        init(self, **(FEW | values))

    return made


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished run."""
    folder = tmp_path_factory.mktemp("train") / "run"
    assert main(["train", "overhead", "--seed", "5", *SHORT, "-o", str(folder)]) == 0
    return folder


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_run_leaves_a_policy_with_what_one_needs_to_make_it_again(folder: Path) -> None:
    policy = Policy.load(folder / "policy")
    card = policy.card
    assert (card.plant, card.sensors) == ("overhead_crane", "encoders")
    assert card.fingerprint == models.fingerprint(RIG)
    made = card.training
    assert made["seed"] == 5
    assert made["disturbances"]["load_mass"] == [0.7, 1.3]
    assert made["command"].startswith("flatrig")
    assert made["versions"]["torch"].startswith("2.")
    low, high = card.box
    assert low <= tuple(np.minimum(MOVE.start, MOVE.goal))
    assert high >= tuple(np.maximum(MOVE.start, MOVE.goal))
    evaluation = rows_of(folder / "evaluation.csv")
    assert [row["iteration"] for row in evaluation] == ["1"]
    assert float(evaluation[0]["rmse"]) == pytest.approx(made["rmse"])
    assert len(rows_of(folder / "progress.csv")) == 1
    config = json.loads((folder / "config.json").read_text())
    assert models.loads(config["rig"])[0] == RIG


def test_the_same_seed_trains_the_same_policy(folder: Path, tmp_path: Path) -> None:
    again = tmp_path / "again"
    assert main(["train", "overhead", "--seed", "5", *SHORT, "-o", str(again)]) == 0
    first, second = (Policy.load(path / "policy").network.tensors() for path in (folder, again))
    for name, array in first.items():
        np.testing.assert_array_equal(array, second[name])
    assert np.abs(first["action.weight"]).max() > 0


def test_a_resumed_run_has_the_network_of_the_run_before(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder, tmp_path / "run")
    settings = Settings(episodes=4)
    one, other = (Training(RIG, MOVE, seed=seed, settings=settings, nthread=1) for seed in (5, 5))
    state = checkpoint.read(folder, one)
    checkpoint.write(tmp_path, one, state)
    assert checkpoint.read(tmp_path, other) == state
    assert one.iteration == other.iteration == 1
    for name, value in one.student.state_dict().items():
        torch.testing.assert_close(other.student.state_dict()[name], value, rtol=0, atol=0)
    moments, restored = (t.school.optimiser.state_dict()["state"] for t in (one, other))
    assert moments.keys() == restored.keys()
    assert len(moments) > 0
    np.testing.assert_array_equal(one.units, other.units)
    assert (
        main(["train", "overhead", "--resume", "--iterations", "2", "-o", str(tmp_path / "run")])
        == 0
    )
    assert [row["iteration"] for row in rows_of(tmp_path / "run/progress.csv")] == ["1", "2"]
    config = json.loads((tmp_path / "run/config.json").read_text())
    assert config["resumed"][0]["from"] == 1


@pytest.mark.parametrize(
    "spoil", ["checkpoint.safetensors", "checkpoint.json"], ids=["numbers", "words"]
)
def test_a_damaged_checkpoint_is_refused_in_one_line(
    folder: Path, tmp_path: Path, spoil: str, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(folder, tmp_path / "run")
    path = tmp_path / "run" / spoil
    path.write_bytes(path.read_bytes()[:100])
    assert main(["train", "overhead", "--resume", "-o", str(tmp_path / "run")]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--minutes", "0"], "--minutes is 0"),
        (["--iterations", "-1"], "--iterations is -1"),
        (["--episodes", "0"], "--episodes is 0"),
        (["--seed", "-1"], "--seed is -1"),
        (["--seeds", "2", "-o", "x"], "--seeds names its own folders"),
        (["--seeds", "two"], "--seeds is 'two', it must be a number of runs, or seeds as in 0:10"),
        (["--seeds", "0"], "--seeds is 0, it must be > 0"),
        (["--seeds", "3:3"], "--seeds is 3:3, it must end after it begins"),
        (["--seeds", "0:2", "--seed", "1"], "--seeds 0:2 says where to begin: no --seed"),
        (
            ["--seeds", "0:2", "--on", "rai"],
            "--on is 'rai', which is no back end; did you mean ray?",
        ),
        (["--resume", "-o", "nowhere"], "there is no checkpoint in nowhere"),
    ],
)
def test_what_no_run_can_have_is_refused(
    words: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    assert main(["train", "overhead", *words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert len(error.splitlines()) == 1
    assert not os.listdir(tmp_path)


def test_a_folder_with_a_run_is_not_begun_again(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (folder / "policy.json").read_bytes()
    assert main(["train", "overhead", *SHORT, "-o", str(folder)]) == 2
    assert "holds a run already; add --resume" in capsys.readouterr().err
    assert main(["train", "rotary", "--resume", "-o", str(folder)]) == 2
    assert "is not the rig with the move" in capsys.readouterr().err
    with locked(folder):
        assert main(["train", "overhead", "--resume", "-o", str(folder)]) == 2
    assert (folder / "policy.json").read_bytes() == before


def test_lessons_are_what_the_teacher_adds_to_the_base() -> None:
    """Where the teacher drives, base and lesson make its command, to the estimate's last step."""
    rng = np.random.default_rng(1)
    dis = Disturbances.standard(RIG)
    room = Classroom(RIG, MOVE, 3, sensors="encoders", disturbances=dis, nthread=1)
    episodes = draw_episodes(
        RIG, MOVE, 3, rng, disturbances=dis, period=room.task.period, holds=(0.5, 0.5)
    )
    plans, scenarios = zip(*episodes, strict=True)
    teacher = CraneTeacher(room.task, plans, scenarios)
    advised, sent = [], []
    advice, note = teacher.advice, teacher.sent
    teacher.advice = lambda: advised.append(advice()) or advised[-1]  # type: ignore[method-assign, func-returns-value]
    teacher.sent = lambda u: sent.append(u.copy()) or note(u)  # type: ignore[method-assign, func-returns-value]
    seen = room.run(
        episodes, lambda fresh: (np.zeros((3, 1)), np.zeros((3, 2))), teacher, seed=0, taught=1.0
    )
    apart = np.abs(np.array(sent) - np.array(advised))[seen.going]
    assert apart.max() < 0.02
    assert np.abs(seen.wanted[seen.going]).max() > 0.02
    assert not seen.early.any()
    plain = [
        e.scenario == Scenario(encoder_resolution=e.scenario.encoder_resolution) for e in episodes
    ]
    assert plain == [True, False, False]
    mass = seen.truth[0, :, room.heads.index("mass")] * 0.17 + 1.0
    np.testing.assert_allclose(mass, [s.load_mass for s in scenarios], rtol=1e-6)


def test_a_student_learns_what_it_is_shown_and_weighs_errors() -> None:
    torch.manual_seed(0)
    rng = np.random.default_rng(0)
    x = rng.normal(size=(4000, 6))
    wanted = np.stack((np.tanh(x[:, 0] + x[:, 1]), np.tanh(x[:, 2] - x[:, 3])), axis=1)
    lessons = Lessons()
    lessons.add(x, wanted, x[:, :1], np.tile(np.diag([1.0, 0.1]), (4000, 1, 1)))
    school = School(Student(6, 2, 1, 32), batch=256)
    first, _ = school.fit(lessons, 20, 1.0, 1.0)
    last, _ = school.fit(lessons, 400, 1.0, 0.05)
    assert last < 0.5 * first
    with torch.no_grad():
        said, told = school.student(lessons.parts[0])
    rms = np.sqrt(np.square(said.numpy() - wanted).mean(axis=0))
    assert rms[0] < 0.2
    assert rms[0] < 0.7 * rms[1]  # whose errors weigh a tenth
    assert np.abs(told[:, 0].numpy() - x[:, 0]).mean() < 0.1


def test_lessons_beyond_the_most_replace_old_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("flatrig.training.learn.student.MOST", 100)
    lessons = Lessons()
    for value in (0.0, 1.0):
        lessons.add(*(np.full((80, 1), value) for _ in range(3)), np.full((80, 1, 1), value))
    assert len(lessons) == 100
    parts = [part.reshape(100, -1)[:, 0] for part in lessons.parts]
    assert all((part == parts[0]).all() for part in parts)
    assert 20 < parts[0].sum() <= 80
