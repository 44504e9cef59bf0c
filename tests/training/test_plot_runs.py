"""Curves of training: which runs are one curve, and what its band holds."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from flatrig.models.errors import OptionError
from flatrig.training.cli import main
from flatrig.training.learn.plot_runs import read_run, together


def a_run(folder: Path, *, seed: int, errors: list[float], sensors: str = "sway") -> Path:
    """A result folder with two judgements after four iterations."""
    folder.mkdir()
    options = {"rig": "overhead", "sensors": sensors, "seed": seed, "output": str(folder)}
    (folder / "config.json").write_text(json.dumps({"options": options, "rig": "..."}))
    rows = "".join(f"{i},{0.5 / i}\n" for i in range(1, 5))
    (folder / "progress.csv").write_text("iteration,loss\n" + rows)
    rows = "".join(f"{2 * i + 2},{e},{2 * e},0.05\n" for i, e in enumerate(errors))
    (folder / "evaluation.csv").write_text("iteration,rmse,worst,rmse_base\n" + rows)
    return folder


def test_runs_that_differ_in_the_seed_alone_are_of_one_kind(tmp_path: Path) -> None:
    first = read_run(a_run(tmp_path / "a-seed0", seed=0, errors=[0.04, 0.02]))
    second = read_run(a_run(tmp_path / "a-seed1", seed=1, errors=[0.03, 0.01]))
    other = read_run(a_run(tmp_path / "b", seed=0, errors=[0.04, 0.02], sensors="encoders"))
    assert first.kind == second.kind != other.kind
    assert first.name == second.name == "a"
    np.testing.assert_array_equal(first.series("evaluation.csv", "rmse"), [[2, 4], [0.04, 0.02]])


def test_a_band_goes_from_the_least_to_the_most_where_all_seeds_are() -> None:
    short = (np.array([2.0, 4.0]), np.array([4.0, 2.0]))
    long = (np.array([3.0, 4.0, 6.0]), np.array([1.0, 1.0, 0.0]))
    steps, least, mean, most = together([short, long])
    np.testing.assert_allclose(steps, [3.0, 4.0])
    np.testing.assert_allclose([least, mean, most], [[1, 1], [2, 1.5], [3, 2]])


def test_the_figure_is_drawn(tmp_path: Path) -> None:
    runs = [
        a_run(tmp_path / f"a-seed{seed}", seed=seed, errors=[0.04 - 0.01 * seed, 0.02])
        for seed in range(2)
    ]
    picture = tmp_path / "curves.png"
    assert main(["plot", *map(str, runs), "-o", str(picture)]) == 0
    with Image.open(picture) as image:
        assert image.size == (1728, 544)  # three panels: error, worst and loss
        assert len(image.convert("RGB").getcolors(1 << 20) or []) > 50


def test_what_is_no_run_gets_one_line(tmp_path: Path) -> None:
    a_run(tmp_path / "overhead-seed0", seed=0, errors=[0.1, 0.1])
    with pytest.raises(OptionError, match=r"no config\.json; did you mean overhead-seed0"):
        read_run(tmp_path / "overhead-seed")
    assert main(["plot"]) == 2


@pytest.mark.parametrize("kind", ["svg", "pdf"])
def test_a_figure_is_the_same_file_each_time(kind: str, tmp_path: Path) -> None:
    run = a_run(tmp_path / "run", seed=0, errors=[0.1, 0.1])
    for name in ("a", "b"):
        assert main(["plot", str(run), "-o", str(tmp_path / f"{name}.{kind}")]) == 0
    assert (tmp_path / f"a.{kind}").read_bytes() == (tmp_path / f"b.{kind}").read_bytes()


def test_a_figure_is_a_picture(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    run = a_run(tmp_path / "run", seed=0, errors=[0.1, 0.1])
    assert main(["plot", str(run), "-o", "curves.jpg"]) == 2
    assert capsys.readouterr().err == (
        "flatrig: error: a figure is a .png, .svg or .pdf file, not 'curves.jpg'\n"
    )
