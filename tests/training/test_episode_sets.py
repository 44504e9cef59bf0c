"""Sets of episodes: what is in them, how they are driven side by side, and what scores say."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flatrig import models
from flatrig.envs import PD, Feedforward, Scenario
from flatrig.models.errors import OptionError
from flatrig.training.cli import main
from flatrig.training.compare import episode_sets
from flatrig.training.compare.contenders import BASE, CONTENDERS, Contender
from flatrig.training.compare.crane_runner import EpisodeRunner
from flatrig.training.compare.episode_sets import OWN, SETS, Episode, gather
from flatrig.training.compare.metrics import Metrics, Record, measure, over_hold
from flatrig.training.compare.runs import Run
from flatrig.training.compare.scores import scores_of, worst_mean

RIG = models.overhead_crane()
MOVE = models.Move(start=(0.0, -4.0), goal=(1.0, -3.5), duration=2.0)
PERIOD = 0.02


def made(name: str, number: int) -> list[Episode]:
    return SETS[name].episodes(RIG, MOVE, number)


def test_sets_repeat_and_begin_alike_whatever_their_size() -> None:
    first = made("random", 8)
    episode_sets._drawn.cache_clear()
    again = made("random", 8)
    assert first == again
    fewer = made("random", 4)
    assert [(e.move, e.hold) for e in fewer] == [(e.move, e.hold) for e in first[:4]]
    others = [each.move for each in (*made("late", 10), *made("strong", 10))]
    assert set(others) <= {each.move for each in first}


def test_random_moves_are_as_stated() -> None:
    episodes = made("random", 8)
    assert len({each.move for each in episodes}) == 8
    resolutions = [each.scenario.encoder_resolution for each in episodes]
    assert resolutions == [0.0, 0.0, 1e-3, 1e-3] * 2
    assert all(4.0 <= each.hold <= 30.0 for each in episodes)
    assert [each.seed for each in episodes] == list(range(8))
    corners = np.array((MOVE.start, MOVE.goal)).T
    edges = [np.isin((each.move.start, each.move.goal), corners.ravel()).any() for each in episodes]
    assert not any(edges[::2])
    assert sum(edges[1::2]) >= 3  # all but 0.3^4 = 1 % of them


def test_other_sets_are_as_stated() -> None:
    back = made("reversed", 3)
    assert all((e.move.start, e.move.goal) == (MOVE.goal, MOVE.start) for e in back)
    assert [e.scenario for e in back] == [e.scenario for e in made(OWN, 3)]
    assert {e.scenario.delay for e in made("late", 20)} == {3}
    assert {e.hold for e in made("hold", 20)} == {60.0}
    nominal = made("nominal", 20)
    assert {e.scenario for e in nominal} == {Scenario()}
    assert nominal[0].move == MOVE
    masses = [e.scenario.load_mass for e in made("strong", 100)]
    assert min(masses) < 0.7
    assert max(masses) > 1.3
    assert 0.55 <= min(masses) <= max(masses) <= 1.45
    scenarios = [e.scenario for name in ("random", "hold", "strong") for e in made(name, 20)]
    assert len(set(scenarios)) == len(scenarios)


def test_a_set_that_cannot_be_is_left_out_unless_it_is_asked_for() -> None:
    still = models.Move(start=(0.0, -4.0), goal=(0.0, -4.0), duration=3.0)
    found, left_out = gather(RIG, still, 2, 8)
    assert set(found) == {OWN, "reversed", "hold"}
    assert "random: random moves keep to the box" in left_out[0]
    with pytest.raises(OptionError, match="random moves keep to the box"):
        gather(RIG, still, 2, 8, ["random"])
    with pytest.raises(OptionError, match=r"no set of episodes 'randon'.*did you mean random"):
        gather(RIG, MOVE, 2, 2, ["randon"])


def weak(env: Any) -> Any:
    """A controller whose load runs away from its path, where inputs are late."""
    return Feedforward(PD(env, stiffness=[4e3, 500.0], damping=[0.0, 0.0]))


@pytest.mark.parametrize("sensors", ["encoders", "sway"])
def test_episodes_side_by_side_are_what_they_are_alone(sensors: str) -> None:
    """Of any length, and with one that ends early, to the last bit."""
    disturbed = Scenario(load_mass=1.2, trolley_friction=20.0, encoder_resolution=1e-3)
    episodes = [
        Episode(MOVE, Scenario(load_mass=0.8, delay=12), hold=3.0, seed=5),
        Episode(MOVE, disturbed, hold=0.5, seed=2),
        Episode(MOVE, Scenario(wind=40.0), hold=1.0, seed=0),
    ]
    together = EpisodeRunner(RIG, episodes, sensors=sensors).drive(weak)
    assert together.lengths is not None
    assert together.lengths.tolist() == [250, 125, 150]
    for place, episode in enumerate(episodes):
        alone = EpisodeRunner(RIG, [episode], sensors=sensors).drive(weak)
        part = together.of(slice(place, place + 1))
        for name in ("times", "arrival", "load", "reference", "inputs", "tensions", "alive"):
            np.testing.assert_array_equal(getattr(alone, name), getattr(part, name), name)
        both = measure(alone), measure(part), measure(together)
        for name in Metrics.__annotations__:
            one, cut, of_all = (getattr(metrics, name) for metrics in both)
            np.testing.assert_allclose(cut, one, 1e-12, err_msg=name)  # sums in another order
            np.testing.assert_allclose(of_all[place], one[0], 1e-12, err_msg=name)
    found = measure(together)
    np.testing.assert_array_equal(found.failed, [1.0, 0.0, 0.0])
    end = int(together.alive[:, 0].sum())
    assert 0 < end < 250
    rest = together.load[end - 1, 0] - together.reference[-1, 0]
    assert together.distance[-1, 0] == pytest.approx(np.linalg.norm(rest), abs=1e-12)


def test_a_run_in_which_all_end_early_is_over() -> None:
    episodes = [Episode(MOVE, Scenario(load_mass=0.8, delay=12), hold=3.0) for _ in range(2)]
    record = EpisodeRunner(RIG, episodes).drive(weak)
    assert not record.alive[-1].any()
    assert np.isfinite(record.load).all()


def padded(offset: np.ndarray, lengths: list[int]) -> Record:
    """A load that is `offset` (T, N) to the side of its reference; arrival after 1 s."""
    steps, count = offset.shape
    load = np.stack((offset, np.zeros_like(offset)), axis=2)
    return Record(
        times=PERIOD * np.arange(1, steps + 1),
        arrival=np.ones(count),
        load=load,
        reference=np.zeros_like(load),
        inputs=np.full((steps, count, 1), 0.5),
        tensions=np.full((steps, count, 1), 9.0),
        alive=np.ones((steps, count), bool),
        lengths=np.array(lengths),
    )


def test_what_follows_an_episode_does_not_count() -> None:
    offset = np.full((200, 2), 0.04)
    offset[150:, 1] = 7.0
    record = padded(offset, [200, 150])
    record.inputs[150:, 1] = 1.0
    record.tensions[150:, 1] = -5.0
    found = measure(record)
    np.testing.assert_allclose(found.rmse, 0.04)
    np.testing.assert_allclose(found.largest, 0.04)
    np.testing.assert_allclose(found.swing, 0.0, atol=1e-15)
    np.testing.assert_allclose(found.effort, 0.5)
    np.testing.assert_allclose(found.tension, 9.0)
    np.testing.assert_array_equal(found.settled, 1.0)
    np.testing.assert_allclose(found.settling, 0.0, atol=1e-12)
    offset[140:150, 1] = 0.06  # away from its goal as it ends
    found = measure(padded(offset, [200, 150]))
    np.testing.assert_array_equal(found.settled, [1.0, 0.0])
    np.testing.assert_allclose(found.settling, [0.0, 2.0])
    assert found.rmse[1] == pytest.approx(np.sqrt((140 * 0.04**2 + 10 * 0.06**2) / 150))


def test_the_hold_is_told_part_by_part() -> None:
    """Arrival after 50 periods; then 150 in the one and 60 in the other episode."""
    offset = np.zeros((200, 2))
    offset[:50] = 9.0
    offset[50:200, 0] = np.repeat([1.0, 2.0, 3.0], 50)
    offset[50:110, 1] = np.repeat([4.0, 5.0, 6.0], 20)
    offset[110:, 1] = 8.0
    found = over_hold(padded(offset, [200, 110]), 3)
    np.testing.assert_allclose(found, [[1.0, 4.0], [2.0, 5.0], [3.0, 6.0]])


def run(name: str, errors: list[float], sensors: str = "encoders", learned: bool = False) -> Run:
    count = len(errors)
    rmse, none = np.array(errors), np.zeros(count)
    metrics = Metrics(rmse, rmse, none, none, none, none, none, none + 1.0 * (rmse > 3), none)
    contender = Contender(name, lambda env: env, sensors=sensors, learned=learned)
    return Run(contender, np.zeros(1), np.zeros((1, count)), metrics, np.array([rmse, 2 * rmse]))


def test_scores_are_against_the_best_classical_controller_that_sees_no_more() -> None:
    runs = [
        run("plain", [2.0, 2.0, 4.0]),
        run("good", [1.0, 2.0, 3.0]),
        run("seeing", [0.5, 0.5, 0.5], "full"),
        run("learned", [0.5, 3.0, 1.0], learned=True),
        run("learned and swaying", [0.1, 0.1, 0.1], "sway", learned=True),
        run("learned and seeing", [0.25, 0.75, 0.2], "full", learned=True),
    ]
    easy = [run(each.name, [9.0, 8.0], each.contender.sensors, each.contender.learned)
            for each in runs]  # fmt: skip
    scores = scores_of({"own": easy, "random": runs})
    assert {name: score.against for name, score in scores["own"].items()} == {
        "plain": "good", "good": "good", "seeing": "seeing", "learned": "good",
        "learned and swaying": "good", "learned and seeing": "seeing",
    }  # fmt: skip
    random = scores["random"]
    assert random["learned"].worse == pytest.approx(1 / 3)
    assert random["learned"].ratio is not None
    assert random["learned"].ratio.mean == pytest.approx(4.5 / 6.0)
    assert random["learned"].ratio.low <= 4.5 / 6.0 <= random["learned"].ratio.high
    assert random["good"].ratio is random["good"].worse is None
    assert random["plain"].rmse.mean == pytest.approx(8 / 3)
    assert random["plain"].median == 2.0
    assert random["plain"].early_ends == 1
    assert random["plain"].hold == pytest.approx((8 / 3, 16 / 3))
    assert random["plain"].drift.mean == pytest.approx(2.0)
    own = scores["own"]["learned"]
    assert own.worse == 0.0
    assert own.ratio is not None
    assert own.ratio.mean == 1.0


def test_the_worst_are_a_twentieth_and_one_at_least() -> None:
    assert worst_mean(np.arange(10.0)) == 9.0
    assert worst_mean(np.arange(40.0)) == 38.5


def test_a_comparison_on_several_sets(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    two = {name: CONTENDERS[name] for name in ("PD, moving", BASE)}
    monkeypatch.setattr("flatrig.training.compare.contenders.CONTENDERS", two)
    argv = ["compare", "overhead", "--goal", "1", "-3.5", "--duration", "2", "--scenarios", "2"]
    argv += ["--episodes", "1", "--sets", "reversed", "random", "--trajectories"]
    assert main([*argv, "-o", str(tmp_path)]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "random moves against the best classical controller" in out
    assert "reversed: the same move back, 1" in out
    facts = json.loads((tmp_path / "summary.json").read_text())
    assert [entry["name"] for entry in facts["sets"]] == [OWN, "reversed", "random"]
    with (tmp_path / "scenarios.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["set"] for row in rows] == [OWN] * 4 + ["reversed"] * 2 + ["random"] * 2
    for entry in facts["sets"]:
        name = entry["name"]
        for controller, score in entry["controllers"].items():
            assert score["against"] == BASE
            mine = [
                float(row["rmse"])
                for row in rows
                if (row["set"], row["controller"]) == (name, controller)
            ]
            assert score["rmse"]["mean"] == pytest.approx(np.mean(mine))
            assert len(mine) == entry["episodes"]
    with np.load(tmp_path / "trajectories/ff-pd.npz") as file:
        kept = dict(file)
    assert kept["set"].tolist() == [OWN, OWN, "reversed", "random"]
    own = np.isfinite(kept["load"][:, 0, 0])
    assert own.sum() * PERIOD == pytest.approx(2.0 + 4.0)
    squares = np.square(kept["load"] - kept["reference"]).sum(axis=2)[own, 0]
    mine = next(float(row["rmse"]) for row in rows if row["controller"] == BASE)
    assert np.sqrt(squares.mean()) == pytest.approx(mine, rel=1e-5)


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["--sets", "randm"], "there is no set of episodes 'randm'"),
        (["--episodes", "-1"], "--episodes is -1, it must be >= 0"),
    ],
)
def test_a_mistake_is_said_in_one_line(
    options: list[str], complaint: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["compare", "overhead", *options, "-o", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert complaint in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()
