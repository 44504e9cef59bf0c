"""Hands on the command line: what is printed, written and refused, and K's figures 2.13 to 2.19."""

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from flatrig import models
from flatrig.feedforward.rolling import in_cones, joint_forces, plan_hand
from flatrig.models.mjcf import hand_state
from flatrig.training.cli import main
from flatrig.training.film.filming import Film
from flatrig.training.look_up import is_hand
from flatrig.training.options import Analyse
from flatrig.training.reproduce import figures_k2, figures_k2_grasp

pytest.importorskip("clarabel")


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def said(capsys: pytest.CaptureFixture[str], *argv: str, status: int = 0) -> str:
    """What a command prints, in one line with single spaces."""
    assert main(argv) == status
    return " ".join(capsys.readouterr().out.split())


def refused(capsys: pytest.CaptureFixture[str], *argv: str) -> str:
    """The one line that a wrong command gets."""
    assert main(argv) == 2
    err = capsys.readouterr().err
    assert err.startswith("flatrig: error: ")
    assert err.count("\n") == 1
    return err


def read(name: str) -> np.ndarray:
    return np.genfromtxt(name, delimiter=",", names=True, deletechars="")


def test_names_are_told_from_those_of_cranes() -> None:
    for name in models.HAND_CATALOGUE:
        assert is_hand(name)
        assert is_hand(name.replace("_hand", "").replace("_", "-"))
    for name in models.CATALOGUE:
        assert not is_hand(name)
        assert not is_hand(name.replace("_crane", "").replace("_", "-"))
    assert is_hand("three-fingre")
    assert not is_hand("ball_in_corner.toml")


def test_list_names_every_hand(capsys: pytest.CaptureFixture[str]) -> None:
    out = said(capsys, "list")
    for name in models.HAND_CATALOGUE:
        assert name in out
    assert "plate_y, plate_x, plate_z" in out


@pytest.mark.parametrize("name", models.HAND_CATALOGUE)
def test_every_hand_is_analysed_and_its_move_is_feasible(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    out = said(capsys, "analyse", name)
    assert "holonomic" in out
    assert "Liouvillian yes" in out
    assert "driftless system integrated again" in out
    assert out.endswith("The move is feasible.")


def test_analysis_follows_the_excluded_spin(capsys: pytest.CaptureFixture[str]) -> None:
    """K proposition 6: without spin not flat."""
    assert "derived flag 2, 0" in said(capsys, "analyse", "ball-on-plate")
    out = said(capsys, "analyse", "ball-on-plate", "--set", "spin=0")
    assert "derived flag 3, 2, 0" in out
    assert "flat no two inputs" in out


def test_printed_move_is_shown_to_be_impossible(capsys: pytest.CaptureFixture[str]) -> None:
    out = said(capsys, "analyse", "three-finger", "--move", "printed", status=1)
    assert "finger1 -0.7407" in out  # pulls
    assert "problem: hand three_finger_hand cannot make the motion from t = 0.535 s on" in out
    assert out.endswith("The move is not feasible.")


def test_a_plan_that_is_refused_is_a_problem(capsys: pytest.CaptureFixture[str]) -> None:
    out = said(capsys, "analyse", "ball-in-corner", "--set", "plate_radius=0.005", status=1)
    assert "structure" in out
    assert "problem: hand ball_in_corner cannot make the move: from t =" in out
    assert out.endswith("The move is not feasible.")


def test_solution_is_the_plan_with_its_forces(capsys: pytest.CaptureFixture[str]) -> None:
    argv = ("--goal", "0.3", "--duration", "1", "--rate", "50", "-o", "motion.csv")
    assert "wrote motion.csv: 51 samples" in said(capsys, "solve", "two-finger", *argv)
    columns = read("motion.csv")
    hand = models.two_finger_hand()
    move = models.HandMove(goal=(0.3,), shift=(0.1, 0.0, 0.1), order=2, turning="axis")
    motion = plan_hand(hand, move)(np.linspace(0.0, 1.0, 51))
    forces = in_cones(motion)
    np.testing.assert_allclose(columns["left.position.z"], motion.finger_positions[:, 0, 2])
    np.testing.assert_allclose(columns["right.force.x"], forces.values[:, 1, 0], rtol=1e-6)
    wanted = joint_forces(motion, forces).values[:, 3]
    np.testing.assert_allclose(columns["right.slide2"], wanted, rtol=1e-6)


def test_solution_without_forces_is_the_motion(capsys: pytest.CaptureFixture[str]) -> None:
    argv = ("solve", "three-finger", "--move", "printed", "--rate", "20", "-o", "motion.csv")
    assert said(capsys, *argv, status=1).endswith("The move is not feasible.")
    assert not Path("motion.csv").exists()
    out = said(capsys, *argv, "--force")
    assert "The move is not feasible. wrote motion.csv: 21 samples" in out
    names = read("motion.csv").dtype.names
    assert "finger1.tip_turn.x" in names
    assert "finger1.force.x" not in names


def test_a_hand_is_filmed(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Joints are those of MuJoCo, from the plan's start to where it ends."""
    seen: list[np.ndarray] = []

    def blank(film: Film) -> np.ndarray:
        seen.append(film.shot.takes[0].qpos)
        return np.zeros((48, 192, 3), dtype=np.uint8)

    monkeypatch.setattr("flatrig.models.looks.render.backend", lambda: "")
    monkeypatch.setattr("flatrig.training.film.filming.Film.strip", blank)
    move = ("--goal", "0.2", "--duration", "0.5", "-o", "film.png")
    assert "wrote film.png: 3 pictures" in said(capsys, "render", "two-finger", *move)
    hand = models.two_finger_hand()
    poses = hand_state.object_poses(hand, seen[0])
    np.testing.assert_allclose(poses[0][-1] - poses[0][0], (0.1, 0.0, 0.1), atol=1e-3)
    turned = np.arctan2(poses[1][-1, 2, 0], poses[1][-1, 0, 0])
    assert turned == pytest.approx(0.2, abs=1e-2)
    assert "--force is for cranes" in refused(capsys, "render", "two-finger", "--force")
    printed = ("render", "three-finger", "--move", "printed", "-o", "printed.png")
    assert main(printed) == 1
    assert "the move is not feasible" in capsys.readouterr().err
    assert not Path("printed.png").exists()


REFUSALS = {
    ("train", "ball-on-plate", "--sensors", "full"): "a hand's residual is for encoders",
    ("train", "ball-on-plate", "--resume"): "--resume is for cranes",
    ("train", "ball-on-plate", "--profile", "polynomial"): "--profile is for cranes",
    ("train", "ball-on-plate", "--episodes", "0"): "--episodes is 0, it must be > 0",
    ("fingerprint", "ball-on-plate"): "ball-on-plate is a hand; this command is for cranes only",
    ("analyse", "ball-on-plat"): "there is no hand 'ball-on-plat'; did you mean ball_on_plate",
    ("analyse", "overhead", "--turning", "axis"): "--turning axis is for hands, overhead is none",
    ("analyse", "two-finger", "--shortest"): "--shortest is for cranes, two-finger is a hand",
    ("analyse", "two-finger", "--set", "size=1"): "two_finger_hand has no parameter 'size'",
    ("analyse", "two-finger", "--move", "printed"): "has no printed move that it cannot make",
    ("analyse", "two-finger", "--move", "x.toml"): "cannot read x.toml: No such file",
    ("solve", "two-finger", "--rate", "1e9"): "it must be <= 50000 Hz",
    ("solve", "two-finger", "--goal", "1", "2"): "move: goal has 2 angles",
}


@pytest.mark.parametrize(("argv", "message"), REFUSALS.items())
def test_refusals_are_one_line(
    argv: tuple[str, ...], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert message in refused(capsys, *argv)
    assert not list(Path().iterdir())


def test_without_a_solver_the_motion_is_still_written(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "clarabel", None)
    out = said(capsys, "solve", "two-finger", "--rate", "20", "-o", "motion.csv")
    assert "need clarabel: pip install 'flatrig[hands]'" in out
    assert "feasible" not in out
    assert len(read("motion.csv")) == 41


@pytest.mark.parametrize("number", [13, 14, 15, 17, 18, 19])
def test_figures_come_with_their_numbers(number: int, capsys: pytest.CaptureFixture[str]) -> None:
    assert f"wrote figs/K2.{number}.png" in said(capsys, "reproduce", f"k2.{number}", "-o", "figs")
    picture = Path(f"figs/K2.{number}.png")
    assert picture.stat().st_size < 200_000
    with Image.open(picture) as image:
        assert image.size[0] > 500
    columns = read(f"figs/K2.{number}.csv")
    assert all(np.isfinite(columns[name]).all() for name in columns.dtype.names)


def test_kiss_figure_needs_arms_in_the_objects_axes() -> None:
    """K 2.19 has every cosine < 0; in space a finger pulls, and later no forces do."""
    forces = figures_k2_grasp._three_fingers()
    assert forces["Least norm as K has it"].cosines.max() == pytest.approx(-0.1788, abs=1e-4)
    assert forces["Least norm with arms in space"].cosines.max() > 0.7
    early = forces["In the cones while they can be"]
    assert early.motion.times[-1] == pytest.approx(0.5375)
    assert early.outside is None
    misread = figures_k2_grasp._misread().values()
    assert all(each.cosines.max() > 0.9 for each in misread)


def test_table_has_rows_of_kisss(capsys: pytest.CaptureFixture[str]) -> None:
    """Ranks answer what K leaves open, and differ where K's row means a ball that may spin."""
    out = said(capsys, "reproduce", "K2.table")
    assert "two_finger_hand 2D, > 1 yes yes yes 0" in out
    assert "ball_on_plate without spin 3D, 1 no no (yes) yes 3, 2, 0" in out
    assert "ball_between_plates 3D, > 1 no yes (?) yes 2, 0" in out
    assert not list(Path().iterdir())


def test_a_hand_takes_the_options_that_it_can() -> None:
    command = Analyse("ball-on-plate", set=("spin=0", "radius=0.1"), turning="axis", duration=3.0)
    hand, move = command.hand_target()
    assert (hand.spin, hand.held.radius) == (False, 0.1)
    assert (move.turning, move.duration) == ("axis", 3.0)
    assert move.goal == figures_k2.default_hand_move(hand).goal


def test_examples_of_the_page_run(capsys: pytest.CaptureFixture[str]) -> None:
    root = Path(__file__).resolve().parents[2]
    page = (root / "docs" / "explanation" / "hands.md").read_text(encoding="utf-8")
    Path("docs").symlink_to(root / "docs")  # for files that the page names
    blocks = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    assert len(blocks) == 3
    for block in blocks:
        exec(compile(block, "hands.md", "exec"), {})
    out = capsys.readouterr().out
    assert "leaves its friction cone" in out
    assert Path("motion.csv").exists()
