"""Several seeds: folders of their own, what fails, what is kept, what comes from elsewhere."""

import shutil
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from flatrig.models.errors import OptionError
from flatrig.training.learn.seeds import in_turn, seeds_of, train_seeds
from flatrig.training.options import Train

ASKED = Train(rig="overhead", seeds="3:6", iterations=1)


class Trainer:
    """Writes a policy that says its seed, and fails as scheduled."""

    __qualname__ = "Trainer"

    def __init__(self, *failing: int) -> None:
        self.failing, self.asked = set(failing), []

    def __call__(self, command: Train) -> int:
        folder = Path(command.output)
        self.asked.append((command.seed, command.resume))
        folder.mkdir(parents=True)
        (folder / "checkpoint.json").write_text("")
        if command.seed in self.failing:
            raise OptionError("no such luck")
        (folder / "policy.json").write_text(str(command.seed))
        print(f"trained {command.seed}")
        return 0


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def all_new(folder: Path) -> None:
    if folder.exists():
        raise OptionError(f"{folder} holds a run already")


def test_a_number_or_a_range_says_which_seeds() -> None:
    assert not in_turn(replace(ASKED, seeds="1"))
    assert in_turn(replace(ASKED, seeds="1", on="ray"))
    assert list(seeds_of(replace(ASKED, seeds="1", seed=4))) == [4]
    assert list(seeds_of(replace(ASKED, seeds="2", seed=4))) == [4, 5]
    assert list(seeds_of(replace(ASKED, seeds="0:10"))) == list(range(10))


def test_seeds_are_trained_each_in_its_folder_and_kept(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = list(sys.argv)
    trainer = Trainer(4)
    assert train_seeds(ASKED, "crane", trainer, all_new) == 1
    out, told = capsys.readouterr()
    assert out == "trained 3\ntrained 5\n"
    assert told == "seed 4: no such luck\n"
    assert trainer.asked == [(3, False), (4, False), (5, False)]
    with pytest.raises(OptionError, match="holds a run already"):
        train_seeds(ASKED, "crane", trainer, all_new)
    # What one has is another's: the files come back from what is kept, the checkpoint does not.
    for seed in (3, 4):
        shutil.rmtree(here / f"runs/crane-seed{seed}")
    trainer.failing = set()
    assert train_seeds(replace(ASKED, resume=True), "crane", trainer, all_new) == 0
    assert trainer.asked[3:] == [(4, False)]
    assert {path.parent.name: path.read_text() for path in here.glob("runs/*/policy.json")} == {
        f"crane-seed{seed}": str(seed) for seed in (3, 4, 5)
    }
    assert not (here / "runs/crane-seed3/checkpoint.json").exists()
    assert sys.argv == words


def test_a_run_whose_process_has_ended_goes_on_from_its_checkpoint(here: Path) -> None:
    folder = here / "runs/crane-seed3"
    folder.mkdir(parents=True)
    (folder / "checkpoint.json").write_text("")
    asked = []

    def go_on(command: Train) -> int:
        asked.append((command.seed, command.resume))
        return 0

    train_seeds(replace(ASKED, seeds="3:4", resume=True), "crane", go_on, all_new)
    assert asked == [(3, True)]
