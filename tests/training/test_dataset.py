"""`flatrig dataset`: Minari reads what was recorded, and its actions repeat it to the bit."""

import gc
import importlib.util
import json

import gymnasium as gym
import numpy as np
import pytest

from flatrig import envs, models
from flatrig.training.cli import main

minari = pytest.importorskip("minari")
for package in ("h5py", "jax"):
    pytest.importorskip(package)

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")
SHORT = ["--duration", "0.9", "--goal", "0.2", "-4.1"]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "own"))
    yield tmp_path / "data"
    gc.collect()  # Minari leaves it to Python to remove its temporary folders, which warns


def load(folder, name, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(folder))
    return minari.load_dataset(name)


def replayed(data):
    """Of each episode what the environment of the dataset says to its actions."""
    env = data.recover_environment()
    for episode in data.iterate_episodes():
        (told,) = data.storage.get_episode_metadata([episode.id])
        seed = int(told["seed"])
        seen, info = env.reset(seed=seed)
        seen, infos, rewards = [seen], [info], []
        for action in episode.actions:
            now, reward, *ends, info = env.step(action)
            seen.append(now)
            infos.append(info)
            rewards.append(reward)
        yield episode, np.array(seen), infos, np.array(rewards), ends


def test_what_a_crane_did_is_read_and_repeated(folder, monkeypatch, capsys):
    command = ["dataset", "overhead", "--controller", "FF + PD", "--episodes", "2", "--seed", "5"]
    assert main([*command, *SHORT, "-o", str(folder)]) == 0
    assert f"wrote {folder / 'overhead_crane' / 'ff-pd-v0'}: 2 episodes" in capsys.readouterr().out
    data = load(folder, "overhead_crane/ff-pd-v0", monkeypatch)
    assert data.total_episodes == 2
    assert data.spec.env_spec.id == "flatrig/OverheadCrane-v0"
    assert (
        json.loads((folder / "overhead_crane/ff-pd-v0/data/metadata.json").read_text())[
            "algorithm_name"
        ]
        == "FF + PD"
    )
    for episode, seen, infos, rewards, ends in replayed(data):
        assert np.array_equal(seen, episode.observations)
        assert np.array_equal(rewards, episode.rewards)
        assert set(episode.infos) == set(infos[0])
        for name, values in episode.infos.items():
            assert np.array_equal(values, [info[name] for info in infos])
        assert ends == [episode.terminations[-1], episode.truncations[-1]]
        # The same controller in precision of its own goes the same way, but for rounding.
        move = models.Move(start=(0, -4), goal=(0.2, -4.1), duration=0.9)
        own = gym.make(data.spec.env_spec.id, reference=move, disturbances="standard")
        own = envs.Feedforward(envs.PD(own))
        own.reset(seed=5 + episode.id)
        for _ in episode.actions:
            last, *_ = own.step([0.0, 0.0])
        assert np.allclose(last, episode.observations[-1], rtol=0, atol=1e-4)


@pytest.mark.parametrize(
    ("plant", "controller", "options"),
    [
        ("ball-on-plate", "ff+pd", ["--duration", "0.5"]),
        ("overhead", "residual,sway", ["--nominal", *SHORT]),
        ("overhead", "observer", ["--set", "load_mass=80", "--moves", "random"]),
    ],
)
def test_hands_policies_and_changed_cranes(plant, controller, options, folder, monkeypatch):
    command = ["dataset", plant, "--controller", controller, "--episodes", "1", "-o", str(folder)]
    assert main([*command, *options, "--name", "trial/one-v3"]) == 0
    data = load(folder, "trial/one-v3", monkeypatch)
    for episode, seen, _, rewards, _ in replayed(data):
        assert np.array_equal(seen, episode.observations)
        assert np.array_equal(rewards, episode.rewards)
    if "--set" in options:
        env = data.recover_environment()
        assert env.unwrapped.task.rig == models.make("overhead", load_mass=80.0)


def test_a_dataset_is_replaced_only_where_told(folder, monkeypatch, capsys):
    command = ["dataset", "overhead", "--episodes", "1", "--nominal", *SHORT, "-o", str(folder)]
    assert main(command) == 0
    before = sorted(path.name for path in folder.iterdir())
    capsys.readouterr()
    assert main(command) == 2
    said = capsys.readouterr().err
    assert "already; say --replace, or take another --name" in said
    assert len(said.splitlines()) == 1
    assert main([*command, "--replace", "--episodes", "2"]) == 0
    assert load(folder, "overhead_crane/ff-pd-v0", monkeypatch).total_episodes == 2
    assert sorted(path.name for path in folder.iterdir()) == before


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["overhead", "--controller", "ff+pdd"], "did you mean ff+pd"),
        (["overhead", "--controller", "ff+pd+pose"], "no controller 'ff+pd+pose' for a crane"),
        (["overhead", "--episodes", "0"], "--episodes is 0, it must be >= 1"),
        (["overhead", "--name", "a b"], "--name is a b, it must be like overhead_crane/ff-pd-v0"),
        (["overhead", "--controller", "lqr,full", "--sensors", "encoders"], "sensors"),
        (["luffing", "--controller", "residual,sway"], "no policy is shipped for luffing_crane"),
        (["overhead", "--policy", "a.json"], "--policy is for controllers that are learned"),
    ],
)
def test_wrong_input_has_one_line_and_writes_nothing(arguments, line, folder, capsys):
    assert main(["dataset", *arguments, "-o", str(folder)]) == 2
    said = capsys.readouterr().err
    assert line in said
    assert len(said.splitlines()) == 1
    assert not folder.exists() or list(folder.iterdir()) == []


def test_a_missing_package_is_named(monkeypatch, capsys):
    find = importlib.util.find_spec
    monkeypatch.setattr(
        "importlib.util.find_spec", lambda name: None if name == "h5py" else find(name)
    )
    assert main(["dataset", "overhead"]) == 2
    said = capsys.readouterr().err
    assert "datasets need the package h5py: pip install 'flatrig[minari]'" in said
