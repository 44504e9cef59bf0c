"""Comparisons: same scenarios for all, what is written, what a zero residual changes."""

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flatrig import models
from flatrig.envs import Feedforward, Law, Scenario, wrap
from flatrig.models.errors import OptionError
from flatrig.training.cli import main
from flatrig.training.compare import compare_cranes as compare
from flatrig.training.compare.contenders import BASE, CONTENDERS, contender, contenders_for
from flatrig.training.compare.crane_runner import EpisodeRunner, carried
from flatrig.training.compare.episode_sets import HOLD, OWN, Episode, scenarios_for
from flatrig.training.compare.metrics import Metrics, between, measure
from flatrig.training.learned import base_controller
from flatrig.training.network import Network
from flatrig.training.policy import Policy

from .test_policy import CARD

RIG = models.overhead_crane()
MOVE = models.Move(start=(0.0, -4.0), goal=(1.0, -3.5), duration=2.0)
CLASSICAL = [entry for entry in contenders_for("crane") if not entry.learned]
CONTROLLERS = {entry.name: entry.wrap for entry in CLASSICAL if entry.sensors == "encoders"}
RESIDUAL = "residual, encoders"


def still_policy(action: float = 0.0) -> Policy:
    """A policy that always says the same: one unit of each drive is a tenth of its limit."""
    width = len(CARD.feature_names)
    shapes = {
        "first": (4, width), "second": (4, 4), "heads": (1, 4), "mixed": (4, 5), "action": (2, 4),
        "skip": (2, width),
    }  # fmt: skip
    biases = {name: np.zeros(shape[0]) for name, shape in shapes.items()}
    biases["action"] += action
    network = Network(
        {name: np.zeros(shape) for name, shape in shapes.items()}, biases,
        np.zeros(width), np.ones(width),
    )  # fmt: skip
    card = replace(CARD, units=(0.1, 0.1), usual=(1e-4, 1e-4), heads=("mass",))
    return Policy(card, network)


def runner_of(rig: models.Rig, move: models.Move, scenarios: list[Scenario]) -> EpisodeRunner:
    return EpisodeRunner(rig, [Episode(move, scenario) for scenario in scenarios])


@pytest.fixture(scope="module")
def runner() -> EpisodeRunner:
    return runner_of(RIG, MOVE, scenarios_for(RIG, 4))


def test_exact_feedforward_is_exact_without_disturbances() -> None:
    runner = runner_of(RIG, MOVE, [Scenario()])
    for name in ("feedforward", BASE):
        record = runner.drive(CONTROLLERS[name])
        assert record.distance.max() < 2e-3  # inputs are held for 20 ms
        assert record.alive.all()
        assert record.times[-1] == pytest.approx(2.0 + HOLD)
    slow = runner.drive(CONTROLLERS["PD, set point"])
    assert slow.distance.max() > 0.1


def test_a_run_does_not_depend_on_those_before_it(runner: EpisodeRunner) -> None:
    wrap = CONTROLLERS[BASE]
    first = runner.drive(wrap)
    runner.drive(CONTROLLERS["PD, moving"])
    second = runner.drive(wrap)
    np.testing.assert_array_equal(first.load, second.load)
    np.testing.assert_array_equal(first.tensions, second.tensions)


def test_a_zero_residual_changes_nothing(runner: EpisodeRunner) -> None:
    def driven(wrap: Any) -> Metrics:
        return measure(runner.drive(wrap))

    base, zero, pushed = (
        driven(wrap)
        for wrap in (
            base_controller,
            lambda env: CONTENDERS[RESIDUAL].wrap(env, still_policy()),
            lambda env: CONTENDERS[RESIDUAL].wrap(env, still_policy(0.3)),
        )
    )
    for name in Metrics.__annotations__:
        np.testing.assert_array_equal(getattr(base, name), getattr(zero, name))
    assert np.abs(pushed.rmse - base.rmse).max() > 1e-3


def test_a_policy_for_something_else_is_refused() -> None:
    episodes = {OWN: [Episode(models.default_move("rotary"), Scenario())]}
    with pytest.raises(OptionError, match="the policy is for overhead_crane"):
        compare.compare(models.make("rotary"), episodes, {"encoders": still_policy()})


def test_controllers_do_what_their_names_say(runner: EpisodeRunner) -> None:
    records = {name: runner.drive(wrap) for name, wrap in CONTROLLERS.items()}
    delayed = np.array([episode.scenario.delay for episode in runner.episodes])
    first = {
        name: made.inputs[delayed, np.arange(len(delayed)), 0] for name, made in records.items()
    }
    # A set point pulls the trolley at once, a moving reference as it moves.
    assert (first["PD, set point"] > 10 * np.abs(first["PD, moving"])).all()
    loads = [made.load[50, 0, 0] for made in records.values()]
    assert len({round(float(load), 9) for load in loads}) == len(loads)


def test_the_evaluation_uses_seeds_that_training_does_not() -> None:
    from flatrig.training.learn.settings import VALIDATION_SEED

    ours = scenarios_for(RIG, 5)
    assert ours == scenarios_for(RIG, 5)
    assert ours != scenarios_for(RIG, 5, VALIDATION_SEED)


def test_compare_writes_tables_and_figure(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], runner: EpisodeRunner
) -> None:
    still_policy().save(tmp_path / "zero")
    argv = ["compare", "overhead", "--goal", "1", "-3.5", "--duration", "2", "--scenarios", "3"]
    argv += ["--sets", "own"]
    argv += ["--policy", str(tmp_path / "zero.json"), "-o", str(tmp_path / "out")]
    assert main(argv) == 0
    out = capsys.readouterr().out
    names = [*(entry.name for entry in CLASSICAL), RESIDUAL]
    for name in names:
        assert name in out
    assert f"{RESIDUAL}: tracking error" in out
    with (tmp_path / "out/scenarios.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["controller"] for row in rows] == [name for name in names for _ in range(3)]
    masses = [row["load_mass"] for row in rows]
    assert masses == masses[:3] * len(names)
    facts = json.loads((tmp_path / "out/summary.json").read_text())
    rmse = facts["controllers"][BASE]["rmse"]
    mine = [float(row["rmse"]) for row in rows if row["controller"] == BASE]
    assert rmse["mean"] == pytest.approx(np.mean(mine))
    assert rmse["low"] <= rmse["mean"] <= rmse["high"]
    assert (tmp_path / "out/figure.png").read_bytes().startswith(b"\x89PNG")


def test_nominal_needs_no_policy(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    argv = ["compare", "overhead", "--set", "load_mass=101", "--nominal", "-o", str(tmp_path)]
    assert main(argv) == 0
    out = capsys.readouterr().out
    assert "without a policy: residual, encoders and residual, sway" in " ".join(out.split())
    assert "undisturbed" in out


def test_intervals_are_of_the_same_resamples_for_all(runner: EpisodeRunner) -> None:
    comparison = compare.compare(RIG, {OWN: runner.episodes}, {})
    base = next(run for run in comparison.runs if run.name == BASE)
    other = replace(base, contender=replace(base.contender, name="other"))
    comparison = replace(comparison, runs=[base, other])
    means = comparison.means
    assert means[BASE]["rmse"] == means["other"]["rmse"]
    assert comparison.changes["other"].high == 0.0


def test_a_platform_is_judged_by_place_and_orientation(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rig = models.make("cable_manipulator")
    assert carried(rig) == ([0, 1, 2], [3, 4, 5])
    assert carried(models.make("navy_crane_2d")) == ([0, 1], [])
    start = models.default_move(rig).start
    goal = (*start[:3], 0.1, 0.0, 0.2, start[6])
    move = models.Move(start=start, goal=goal, duration=3.0)
    record = runner_of(rig, move, [Scenario()]).drive(CONTROLLERS["feedforward"])
    assert record.turn is not None
    assert record.turn.max() < 1e-3
    argv = ["compare", "cable-manipulator", "--goal", *map(str, goal), "--duration", "3"]
    argv += ["--profile", "polynomial", "--nominal", "-o", str(tmp_path)]
    assert main(argv) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "turned by" in out or "turned" in out
    assert "no policy is shipped for cable_manipulator" in out
    assert "left out: swing damping, sway: " in out
    facts = json.loads((tmp_path / "summary.json").read_text())
    assert facts["controllers"]["feedforward"]["turn"]["mean"] < 1e-3


def test_the_angle_between_orientations_is_of_one_rotation() -> None:
    assert between(np.zeros(3), np.array((0.0, 0.0, 1e-9))) == pytest.approx(1e-9)
    assert between(np.zeros(3), np.array((0.3, 0.0, 0.0))) == pytest.approx(0.3)
    assert between(np.array((0.2, 0.4, 1.0)), np.array((0.2, 0.4, 1.7))) == pytest.approx(0.7)
    quarter = np.array((np.pi / 2, 0.0, np.pi / 2))  # two quarter turns are a third about (1,1,1)
    assert between(np.zeros(3), quarter) == pytest.approx(2 * np.pi / 3)


HALF = 0.5
"""Share of the feedback's input that a made-up law takes away."""


class Halved(Law):
    """Half of what comes from above."""

    name = "Halved"

    def apply(self, actions: np.ndarray) -> np.ndarray:
        return HALF * actions


@pytest.mark.parametrize("rig", ["overhead", "ball-on-plate"])
def test_a_controller_is_registered_once(
    rig: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """How to add a controller to the comparison: a registered function of the environment."""
    name = "halved feedforward"
    monkeypatch.setitem(CONTENDERS, name, CONTENDERS[BASE])  # which takes it out again

    @contender(name)
    def halved(env: Any) -> Any:
        return Feedforward(wrap(env, Halved()))

    assert main(["compare", rig, "--nominal", "-o", str(tmp_path)]) == 0
    assert "halved feedforward" in " ".join(capsys.readouterr().out.split())
    with (tmp_path / "scenarios.csv").open(newline="") as file:
        rows = {row["controller"]: float(row["rmse"]) for row in csv.DictReader(file)}
    assert rows[name] > 2 * rows["feedforward"]
