"""The command `flatrig`: what it prints, what it writes, and how it refuses."""

import csv
import os
import re
import shlex
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.models.files import replacing
from flatrig.training.cli import main
from flatrig.training.commands import COMMANDS, command
from flatrig.training.rig_options import RigOptions

MY_CRANE = """
rig = "overhead"
load_mass = 90.0

[move]
start = [0.0, -4.0]
goal = [4.0, -2.0]
duration = 3.0
"""


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def read(path: Path) -> tuple[list[str], np.ndarray]:
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    return rows[0], np.array(rows[1:], dtype=float)


def refuse(capsys: pytest.CaptureFixture[str], *argv: str) -> str:
    """The one line that a wrong command gets."""
    try:
        status = main(argv)
    except SystemExit as leave:
        status = int(leave.code or 0)
    out, err = capsys.readouterr()
    assert status == 2, out
    assert err.count("\n") == 1, err
    assert err.startswith("flatrig: error: ")
    assert "Traceback" not in out + err
    return err


def test_list_names_every_rig(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list"]) == 0
    out = capsys.readouterr().out
    for name in models.CATALOGUE:
        assert name in out
    assert "load.x, load.z" in out


def test_analyse_tells_structure_and_feasibility(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyse", "overhead", "--equations"]) == 0
    out = capsys.readouterr().out
    assert re.search(r"index +5", out)
    assert re.search(r"derivatives the path needs +4", out)
    assert re.search(r"degrees of freedom left +0 \(flat\)", out)
    assert "servo constraint load.x" in out
    assert "What the drives need, without friction" in out
    assert "The move is feasible without friction." in out


def test_analyse_names_a_drive_that_is_too_weak(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyse", "overhead", "--duration", "2"]) == 1
    out = capsys.readouterr().out
    assert "beyond its limit" in out
    assert "The move is not feasible." in out


def test_solve_writes_the_exact_inputs(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["solve", "overhead", "--rate", "100", "-o", "out/torques.csv"]) == 0
    assert "301 samples" in capsys.readouterr().out
    names, table = read(tmp_path / "out/torques.csv")
    rig = models.overhead_crane()
    reference = feedforward.from_move(models.default_move("overhead"))
    motion = feedforward.solve(rig, reference, np.arange(301) / 100)
    assert names[:4] == ["time", "trolley", "winch", "hoist.tension"]
    np.testing.assert_array_equal(table[:, 0], motion.times)
    np.testing.assert_allclose(table[:, 1:3], motion.inputs, rtol=1e-12, atol=1e-12)


def test_solve_takes_rig_and_move_from_toml(tmp_path: Path) -> None:
    (tmp_path / "my_crane.toml").write_text(MY_CRANE)
    assert main(["solve", "my_crane.toml", "--rate", "10", "-o", "a.csv"]) == 0
    named = ["solve", "overhead", "--set", "load_mass=90", "--goal", "4", "-2"]
    assert main([*named, "--rate", "10", "-o", "b.csv"]) == 0
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_solve_changes_numbers_of_parts_and_of_the_move(tmp_path: Path) -> None:
    (tmp_path / "my_crane.toml").write_text(MY_CRANE)
    changes = [
        "--set",
        "load.mass=50",
        "hoist.winch_inertia=0.2",
        "--duration",
        "4",
        "--order",
        "5",
    ]
    assert main(["solve", "my_crane.toml", *changes, "--rate", "7", "-o", "a.csv"]) == 0
    names, table = read(tmp_path / "a.csv")
    assert table[-1, 0] == 4.0
    assert table[0, names.index("winch")] == pytest.approx(-50 * 9.81 * 0.1)


def test_nothing_is_left_of_a_file_that_could_not_be_finished(tmp_path: Path) -> None:
    (tmp_path / "old.csv").write_text("old")

    def fail(path: Path) -> None:
        with replacing(path) as beside:
            beside.write_text("half")
            assert beside.parent == path.parent
            raise ZeroDivisionError

    for name in ("old.csv", "new.csv"):
        with pytest.raises(ZeroDivisionError):
            fail(tmp_path / name)
    assert [path.name for path in tmp_path.iterdir()] == ["old.csv"]
    assert (tmp_path / "old.csv").read_text() == "old"


def test_a_table_goes_to_stdout_and_what_is_told_about_it_to_stderr(
    capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["solve", "overhead", "--rate", "10", "-o", "a.csv"]) == 0
    capfd.readouterr()
    assert main(["solve", "overhead", "--rate", "10", "-o", "-"]) == 0
    out, err = capfd.readouterr()
    assert out == (tmp_path / "a.csv").read_text()
    assert "wrote -: 31 samples" in err
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]
    for folder in (["compare", "overhead"], ["scenes"], ["regress"], ["reproduce", "K3.21"]):
        assert main([*folder, "-o", "-"]) == 2
        out, err = capfd.readouterr()
        assert out == ""
        assert err.startswith("flatrig: error: cannot write a folder to standard output")
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]


def test_what_the_system_refuses_gets_one_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(command: object) -> None:
        raise OSError(28, "No space left on device", "a.csv")

    monkeypatch.setattr("flatrig.training.describe.describe_cranes.write_solution", full)
    assert "a.csv: No space left on device" in refuse(capsys, "solve", "overhead")


WRONG = {
    "missing file": (["solve", "nowhere.toml"], "nowhere.toml"),
    "negative mass": (["solve", "overhead", "--set", "load_mass=-3"], "-3 kg"),
    "NaN": (["solve", "overhead", "--set", "load_mass=nan"], "nan"),
    "NaN in the move": (["solve", "overhead", "--goal", "nan", "-1"], "nan"),
    "unknown rig": (["solve", "overheat"], "did you mean overhead"),
    "unknown parameter": (["solve", "overhead", "--set", "loadmass=3"], "did you mean load_mass"),
    "unknown part": (["solve", "overhead", "--set", "lode.mass=3"], "did you mean load"),
    "unknown field": (["solve", "overhead", "--set", "load.mas=3"], "did you mean mass"),
    "no assignment": (["solve", "overhead", "--set", "load_mass"], "load_mass=80"),
    "zero duration": (["analyse", "overhead", "--duration", "0"], "duration is 0 s"),
    "zero rate": (["solve", "overhead", "--rate", "0"], "--rate is 0 Hz"),
    "absurd rate": (["solve", "overhead", "--rate", "1e12"], "samples"),
    "too few coordinates": (["solve", "overhead", "--goal", "5"], "goal 1"),
    "no rig": (["solve"], "Missing"),
    "unknown command": (["solv", "overhead"], "solv"),
    "unknown option": (["solve", "overhead", "--rat", "3"], "--rat"),
    "not a number": (["solve", "overhead", "--rate", "fast"], "fast"),
    "no scenarios": (["compare", "overhead", "--scenarios", "0"], "--scenarios is 0"),
    "no policy there": (["compare", "overhead", "--policy", "nix.json"], "nix.json"),
    "no time": (["train", "overhead", "--minutes", "0"], "--minutes is 0"),
    "no iterations": (["train", "overhead", "--iterations", "-5"], "--iterations is -5"),
    "negative seed": (["train", "overhead", "--seed", "-1"], "--seed is -1"),
    "huge seed": (["train", "overhead", "--seed", "4294967296"], "4294967295"),
    "strange film": (["render", "overhead", "-o", "film.avi"], ".gif, .mp4 or .png"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_mistake_gets_one_line(case: str, capsys: pytest.CaptureFixture[str]) -> None:
    argv, expected = WRONG[case]
    assert expected in refuse(capsys, *argv)


@pytest.mark.parametrize(
    "argv",
    [
        ["solve", "overhead", "-o", "blocked/torques.csv"],
        ["compare", "overhead", "--scenarios", "2", "-o", "blocked/results"],
        ["scenes", "-o", "blocked/scenes"],
    ],
    ids=lambda argv: argv[0],
)
def test_a_folder_that_cannot_be_made(
    argv: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "blocked").write_text("a file where a folder should be")
    assert "cannot write blocked" in refuse(capsys, *argv)


@pytest.mark.skipif(os.geteuid() == 0, reason="everything is writable for root")
def test_a_folder_that_is_read_only(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "locked").mkdir(mode=0o500)
    assert "Permission denied" in refuse(capsys, "solve", "overhead", "-o", "locked/torques.csv")


def test_scenes_are_written(tmp_path: Path) -> None:
    assert main(["scenes", "-o", "scenes"]) == 0
    machines = (*models.CATALOGUE, *models.HAND_CATALOGUE)
    names = {name + kind for name in machines for kind in ("", "_scene")}
    assert {path.stem for path in (tmp_path / "scenes").glob("*.xml")} == names


def test_training_without_its_packages_names_the_extra(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert "pip install 'flatrig[train]'" in refuse(capsys, "train", "overhead")


def test_help_is_quick_and_complete() -> None:
    done = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "flatrig.training.cli", "--help"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    for name in ("list", "analyse", "solve", "compare", "train", "bench", "render"):
        assert name in done.stdout
    loaded = {
        line.rpartition("|")[2].strip().partition(".")[0] for line in done.stderr.splitlines()
    }
    assert not loaded & {"mujoco", "gymnasium", "matplotlib", "torch", "scipy"}


def test_the_version_is_that_of_the_package(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"flatrig {metadata.version('flatrig')}\n"


def test_a_mistyped_command_gets_a_suggestion(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyze", "overhead"]) == 2
    assert capsys.readouterr().err == (
        "flatrig: error: there is no command 'analyze'; did you mean analyse?\n"
    )


def test_quiet_leaves_what_was_asked_for(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    table = tmp_path / "inputs.csv"
    assert main(["solve", "overhead", "--rate", "10", "-o", str(table), "--quiet"]) == 0
    assert table.exists()
    assert main(["solve", "overhead", "--rate", "10", "-o", "-", "--quiet"]) == 0
    assert capsys.readouterr() == (table.read_text(), "")
    assert main(["list"]) == 0  # and the next command speaks again
    assert "overhead_crane" in capsys.readouterr().out


def test_help_tells_no_default_that_tells_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["train", "--help"])
    told = re.findall(r"\(default:\s*([^)]*)\)", capsys.readouterr().out)
    assert told
    assert not {"", "''", "None", "False"} & set(told)


def test_an_output_is_a_file_if_it_ends_as_one_and_else_a_folder(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["solve", "overhead", "--rate", "10", "-o", str(tmp_path / "tables")]) == 0
    assert [path.name for path in (tmp_path / "tables").iterdir()] == ["overhead_crane.csv"]
    for words in (["compare", "overhead"], ["stress"], ["train", "overhead"], ["scenes"]):
        assert "several files are written, name a folder" in refuse(
            capsys, *words, "-o", str(tmp_path / "all.csv")
        )
    assert not (tmp_path / "all.csv").exists()


GREET = """
def crane(options):
    print(f"{options.times} x {options.target()[0].name}")

def hand(options):
    print(f"{options.times} x {options.hand_target()[0].name}")
"""


@pytest.mark.parametrize("words", ["bench --help", "list --json"])
def test_a_reader_that_has_enough_is_no_mistake(words: str) -> None:
    command = f"{shlex.quote(sys.executable)} -m flatrig.training.cli {words} | true"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr) == ("", "")


def test_a_command_is_its_options_and_a_function(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """How to add a command: a registered class in `options`, and what it names in a file."""
    (tmp_path / "greetings.py").write_text(GREET)
    monkeypatch.syspath_prepend(tmp_path)

    @command(crane="greetings:crane", hand="greetings:hand")
    class Greet(RigOptions):
        """Greet a rig."""

        times: int = 1
        """How often."""

    with monkeypatch.context() as patch:
        patch.setitem(COMMANDS, Greet, COMMANDS.pop(Greet))
        assert main(["--help"]) == 0
        assert re.search(r"greet +Greet a rig\.", capsys.readouterr().out)
        assert "greetings" not in sys.modules  # loaded only when it runs
        assert main(["greet", "overhead", "--times", "3"]) == 0
        assert main(["greet", "two-finger"]) == 0
        assert capsys.readouterr().out == "3 x overhead_crane\n1 x two_finger_hand\n"
