"""Hands as TOML files: what is written is read again, and what is wrong gets one line."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flatrig import models
from flatrig.models import Finger, Hand, HandMove, HeldObject, Plate, RigError, Tip
from flatrig.models.hand.hand import unit
from flatrig.training.cli import main

PINCH = """
name = "pinch"
planar = true
friction = 0.8
position = [0.0, 0.0, 0.2]

[held]
shape = "disc"
radius = 0.05
mass = 0.5

[[fingers]]
name = "left"
tip = {radius = 0.02}
contact = [-1.0, 0.0, 0.0]
slides = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
masses = [0.2, 0.4]

[[fingers]]
name = "right"
tip = {radius = 0.02}
contact = [1.0, 0.0, 0.0]
slides = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
masses = [0.2, 0.4]

[move]
goal = [0.3]
duration = 2.0
turning = "axis"
"""


@pytest.fixture
def pinch(tmp_path: Path) -> Path:
    path = tmp_path / "pinch.toml"
    path.write_text(PINCH)
    return path


def test_a_file_says_what_python_says(pinch: Path) -> None:
    hand, move = models.load_hand(pinch)
    assert hand == replace(models.two_finger_hand(friction=0.8), name="pinch")
    assert move == HandMove(goal=(0.3,), duration=2.0, turning="axis")


@pytest.mark.parametrize("name", models.HAND_CATALOGUE)
def test_hands_of_the_catalogue_are_written_and_read_again(name: str, tmp_path: Path) -> None:
    hand, move = models.make_hand(name), models.default_hand_move(name)
    models.dump_hand(tmp_path / "hand.toml", hand, move)
    assert models.load_hand(tmp_path / "hand.toml") == (hand, move)
    assert models.loads_hand(f'hand = "{name}"\nfriction = 0.7\n') == (
        models.make_hand(name, friction=0.7),
        move,
    )


def test_directions_and_inertias_are_read_again_to_the_last_bit() -> None:
    generator = np.random.default_rng(0)
    for _ in range(100):
        normal, contact = generator.normal(size=(2, 3)).tolist()
        fingers = (
            Finger("plate", Plate(normal, 0.1), slides=(normal,)),
            Finger("tip", Tip(0.01, axes=((1, 2, 0), (2, -1, 0))), contact),
        )
        held = HeldObject("sphere", generator.uniform(), 0.1, generator.choice([0.0, 0.01]))
        hand = Hand("drawn", held, fingers, gravity=(0.0, 0.0, 0.0))
        assert models.loads_hand(models.dumps_hand(hand)) == (hand, None)
        assert unit("normal", unit("normal", normal)) == unit("normal", normal)


def test_commands_take_files_of_hands(pinch: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyse", str(pinch), "--set", "left.force_limit=9", "held.mass=0.4"]) == 0
    said = capsys.readouterr().out
    assert "pinch: structure" in said
    assert "±9" in said
    assert main(["solve", str(pinch), "--goal", "0.2", "--set", "friction=0.9"]) == 0
    assert main(["analyse", "two-finger", "--move", str(pinch)]) == 0
    assert "rad in 2 s, axis" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--set", "left.mass=9"), "no number 'mass'; known are force_limit, radius, inertia"),
        (("--set", "lft.radius=9"), "no part 'lft'; did you mean left?"),
        (("--set", "mass=9"), "no number 'mass'"),
        (("--move", "printed"), "hand pinch has no printed move"),
        (("--profile", "polynomial"), "--profile is for cranes"),
    ],
)
def test_wrong_options_get_one_line(
    words: tuple[str, ...], message: str, pinch: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["analyse", str(pinch), *words]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert said.count("\n") == 1


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('shape = "disc"', 'shape = "disk"', "did you mean disc"),
        ("radius = 0.05", 'radius = "wide"', "object: radius is 'wide', it must be a number"),
        ("tip = {radius = 0.02}", "", "finger left ends in none, it must be plate = {normal"),
        ("tip = {radius = 0.02}", "tip = 3", "finger left: tip is 3, it must be a table"),
        ("tip = {radius = 0.02}", "tip = {}", "finger left: tip: the entry 'radius' is missing"),
        ("friction", "fricton", "unknown entry 'fricton'; did you mean friction?"),
        ('name = "pinch"', "", "the entry 'name' is missing"),
        ("planar = true", "goal = [0.3]", "'goal' belongs to the move, below a line [move]"),
        ("goal = [0.3]", 'goal = ["far"]', "move: goal is 'far'"),
        ("goal = [0.3]", "gaol = [0.3]", "move: unknown entry 'gaol'; did you mean goal?"),
        ('name = "pinch"', 'rig = "overhead"', "this describes a rig, which models.load reads"),
        ('name = "pinch"', 'hand = "two_finger"', "'planar' cannot stand beside hand = 'two_f"),
    ],
)
def test_wrong_files_get_one_line(old: str, new: str, message: str) -> None:
    with pytest.raises(RigError) as error:
        models.loads_hand(PINCH.replace(old, new, 1))
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_hands_and_rigs_are_told_apart(pinch: Path, tmp_path: Path) -> None:
    with pytest.raises(RigError, match=r"this describes a hand, which models\.load_hand reads"):
        models.load(pinch)
    models.dump(tmp_path / "rig.toml", models.overhead_crane())
    with pytest.raises(RigError, match=r"this describes a rig, which models\.load reads"):
        models.load_hand(tmp_path / "rig.toml")
    with pytest.raises(RigError, match=r"rig\.toml has no \[move\]"):
        models.load_hand_move(tmp_path / "rig.toml")
    for wrong in (3, models.overhead_crane()):
        with pytest.raises(RigError, match="it must be a Hand"):
            models.dumps_hand(wrong)  # type: ignore[arg-type]
    with pytest.raises(RigError, match="it must be TOML text"):
        models.loads_hand(3)  # type: ignore[arg-type]
