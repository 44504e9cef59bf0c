"""What a comparison keeps comes back bit for bit, and nothing is driven twice."""

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from flatrig.training.cli import main
from flatrig.training.compare.contenders import BASE, CONTENDERS
from flatrig.training.compare.kept_runs import Driven, kept, restored
from flatrig.training.compare.metrics import Metrics
from flatrig.training.compare.runs import Run


def test_runs_come_back_with_all_their_bits() -> None:
    rng = np.random.default_rng(0)
    metrics = Metrics(*(rng.normal(size=3) for _ in fields(Metrics)))
    metrics.swing[1] = np.nan
    distance = np.asfortranarray(rng.normal(size=(5, 3)))
    run = Run(CONTENDERS[BASE], np.arange(5.0) / 3.0, distance, metrics)
    driven = restored(Metrics, kept(Driven({"own": run}, b"\0file")))
    back = driven.runs["own"]
    assert driven.trajectories == b"\0file"
    assert back.contender is CONTENDERS[BASE]
    assert back.hold is None
    assert run.distance.flags.c_contiguous  # as what comes back, so that sums round alike
    np.testing.assert_array_equal(back.distance, distance)
    for item in fields(Metrics):
        assert getattr(back.metrics, item.name).tobytes() == getattr(metrics, item.name).tobytes()


@pytest.mark.parametrize("name", ["overhead", "ball-on-plate"])
def test_a_comparison_that_goes_on_writes_the_same(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    two = {name: CONTENDERS[name] for name in ("feedforward", BASE)}
    monkeypatch.setattr("flatrig.training.compare.contenders.CONTENDERS", two)
    for module in ("compare_cranes", "compare_hands"):
        monkeypatch.setattr(f"flatrig.training.compare.{module}.draw", lambda *_: None)
    argv = ["compare", name, "--scenarios", "2", "--duration", "4", "--json", "-o", str(tmp_path)]
    argv += ["--sets", "own"] * (name == "overhead")
    assert main(argv) == 0
    first = capsys.readouterr().out
    files = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}

    def never(*_: object) -> None:
        raise AssertionError("it is kept already")

    monkeypatch.setattr("flatrig.training.compare.crane_entry.runner_of", never)
    monkeypatch.setattr("flatrig.training.compare.compare_hands.drive", never)
    assert main([*argv, "--resume"]) == 0
    assert capsys.readouterr().out == first
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == files
    assert set(files) == {"progress.jsonl", "scenarios.csv", "summary.json"}
