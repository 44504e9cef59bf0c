"""Three users, from the README to a result with nothing but documented commands."""

import csv
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from flatrig import feedforward, models

ROOT = Path(__file__).resolve().parents[1]
PATIENCE = 300.0
"""What each may take [s]."""


def played(user: str, folder: Path) -> str:
    """What the commands of a user print."""
    script = ROOT / "tests" / "users" / f"{user}.sh"
    here = Path(sys.executable).parent
    done = subprocess.run(
        ["bash", "-euo", "pipefail", str(script)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
        env=os.environ | {"PATH": f"{here}:{os.environ['PATH']}"},
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_commands_of_users_are_documented() -> None:
    texts = [path.read_text() for path in (ROOT / "README.md", *(ROOT / "docs").rglob("*.md"))]
    told = "\n".join(texts)
    for script in (ROOT / "tests" / "users").glob("*.sh"):
        for command in re.findall(r"^flatrig (\w+)", script.read_text(), flags=re.MULTILINE):
            assert f"flatrig {command}" in told


def test_an_engineer_with_a_crane_of_her_own(tmp_path: Path) -> None:
    played("engineer", tmp_path)
    rig, move = models.load(tmp_path / "crane.toml")
    assert move is not None
    found = json.loads((tmp_path / "analysis.json").read_text())
    assert found["feasible"]
    assert 0.0 < found["shortest"]["duration_s"] <= move.duration
    rows = rows_of(tmp_path / "inputs.csv")
    times = np.array([float(row["time"]) for row in rows])
    motion = feedforward.solve(rig, feedforward.from_move(move), times, hold=0.01)
    for name, values in zip(rig.input_names, motion.inputs.T, strict=True):
        np.testing.assert_allclose(
            [float(row[f"{name}.held"]) for row in rows], values, rtol=1e-9, atol=1e-6
        )
    assert "int main" in (tmp_path / "feedforward.c").read_text()
    errors = [
        abs(float(row["load.x"]) - float(row["load.x.planned"]))
        for row in rows_of(tmp_path / "run" / "run.csv")
    ]
    assert 0.0 < max(errors) < 1.0
    assert "load_mass 1.2" in (tmp_path / "report.html").read_text()


def test_a_teacher(tmp_path: Path) -> None:
    said = played("teacher", tmp_path)
    assert "luffing_crane" in said
    assert (tmp_path / "flatness.md").read_text().startswith("#")
    assert list((tmp_path / "figures").glob("K3.21*.png"))
    with Image.open(tmp_path / "stills.png") as picture:
        assert picture.width == 3 * 240  # start, middle, arrival; a row for each controller
    summary = json.loads((tmp_path / "compared" / "summary.json").read_text())
    assert "FF + PD" in json.dumps(summary)


def test_a_student_of_reinforcement_learning(tmp_path: Path) -> None:
    pytest.importorskip("stable_baselines3", reason="needs the extra train")
    played("student", tmp_path)
    assert "## Action" in (tmp_path / "environment.md").read_text()
    assert (tmp_path / "agent.zip").stat().st_size > 10_000
    found = json.loads((tmp_path / "run.json").read_text())
    assert found["ended_early"] is None
    assert found["error_rms_m"] < 0.1
    assert "residual, sway" in (tmp_path / "compared.json").read_text()
