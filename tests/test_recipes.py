"""The recipes of CONTRIBUTING.md work as they stand, for a newcomer's crane everywhere."""

import re
from collections.abc import Iterator
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

from flatrig import envs, feedforward, models
from flatrig.models import CATALOGUE
from flatrig.training.cli import main
from flatrig.training.commands import COMMANDS
from flatrig.training.compare.contenders import CONTENDERS
from flatrig.training.compare.episode_sets import SETS
from flatrig.training.regress import baseline
from flatrig.training.reproduce import entry

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
RECIPES = {
    title: "\n".join(re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL))
    for title, text in re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", PAGE, flags=re.DOTALL | re.M)
}


def follow(title: str) -> dict[str, object]:
    """Run the Python code of a recipe."""
    names: dict[str, object] = {"__name__": "recipe"}
    exec(compile(RECIPES[title], "CONTRIBUTING.md", "exec"), names)
    return names


@pytest.fixture
def wall_crane(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[str]:
    """A crane that is registered for one test, which runs in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    follow("Add a crane")
    yield "wall_crane"
    del CATALOGUE._entries["wall_crane"]


@pytest.mark.parametrize(
    "argv",
    [
        ("list",),
        ("analyse", "wall"),
        ("analyse", "wall-crane", "--set", "load_mass=40"),
        ("solve", "wall", "--rate", "100", "-o", "torques.csv"),
        ("compare", "wall", "--scenarios", "2", "--sets", "reversed", "-o", "out"),
        ("render", "wall", "-o", "still.png"),
        ("scenes", "-o", "scenes"),
        ("lean",),
    ],
    ids=lambda argv: argv[0],
)
def test_commands_know_a_new_crane(
    argv: tuple[str, ...], wall_crane: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(argv) == 0
    said = capsys.readouterr().out
    assert wall_crane in said or list(Path().iterdir())


def test_a_new_crane_is_solved_simulated_and_trained_with(wall_crane: str) -> None:
    rig = models.make("wall", load_mass=60.0)
    path = feedforward.from_move(models.default_move(rig))
    motion = feedforward.solve(rig, path, np.linspace(0, path.duration, 101))
    assert not motion.slack
    assert models.compile(rig).nu == 3
    env = envs.Feedforward(envs.PD(gym.make("flatrig/Rig-v0", rig=wall_crane)))
    env.reset(seed=0)
    for _ in range(100):
        _, _, terminated, _, info = env.step(np.zeros(3))
        assert not terminated
    assert np.linalg.norm(info["load"] - info["reference"]) < 1e-3


def test_what_a_new_crane_lacks_names_the_command_that_makes_it(
    wall_crane: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["regress", "wall", "-o", "regress"]) == 0
    assert "numbers of wall_crane have no stored ones; --update stores them" in " ".join(
        capsys.readouterr().out.split()
    )
    assert wall_crane not in {key[0] for key in baseline.read()[0]}


def test_a_controller_drives_and_is_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    names = follow("Add a controller")
    try:
        assert CONTENDERS["FF + PD + damping"].wrap is names["with_damping"]
    finally:
        del CONTENDERS["FF + PD + damping"]
    damped = names["damped"]
    assert callable(damped)
    for make in (gym.make, gym.make_vec):
        env = damped(envs.Feedforward(make("flatrig/OverheadCrane-v0")), share=0.2)
        env.reset(seed=0)
        env.step(env.action_space.sample())


def test_a_set_of_episodes_is_registered() -> None:
    follow("Add a set of episodes")
    rig = models.make("overhead")
    episodes = SETS.pop("slow").episodes(rig, models.default_move(rig), 8)
    assert [episode.move.duration for episode in episodes] == [6.0, 6.0]


def test_a_command_is_registered() -> None:
    options = follow("Add a command")["Weigh"]
    assert isinstance(options, type)
    assert COMMANDS.pop(options).main == ".bench.weigh:main"


def test_a_figure_is_registered(tmp_path: Path) -> None:
    follow("Add a figure")
    try:
        _, files = entry.entries()["K9.9"].run(tmp_path)
        assert [path.name for path in files] == ["K9.9.png", "K9.9.csv"]
    finally:
        del entry._REGISTERED["K9.9"]


@pytest.mark.parametrize(
    "path", re.findall(r"`((?:models|feedforward|envs|training|tests)/[^`]*)`", PAGE)
)
def test_what_recipes_name_is_there(path: str) -> None:
    assert path == "models/wall_crane.xml" or (ROOT / path).exists()


def test_every_recipe_names_its_test() -> None:
    for title, text in re.findall(r"^## (Add .*?)\n(.*?)(?=^## |\Z)", PAGE, flags=re.DOTALL | re.M):
        assert re.search(r"Followed\s+by\s+`tests/", text), title


def test_the_readme_lists_every_crane() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    missing = [name for name in CATALOGUE if f"`{name}`" not in readme]
    assert not missing, "README's table of cranes wants a line for each"
