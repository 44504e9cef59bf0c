"""`flatrig bench cranebench`: the crane, the regulator, the adapter and the files.

Few of these need cranebench itself; the rest has a planar crane of its own, written down by hand.
"""

import csv
import importlib.util
import json
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm, solve_discrete_are

from flatrig import feedforward
from flatrig.models.errors import OptionError
from flatrig.training import options
from flatrig.training.bench import crane_of_cranebench as crane
from flatrig.training.bench import cranebench_report, cranebench_runs
from flatrig.training.bench import swing_regulator as swing
from flatrig.training.bench.cranebench_runs import ENTRANTS, Manoeuvre, Run, Unit
from flatrig.training.bench.speed import main
from flatrig.training.cli import main as cli

LENGTHS = np.array([9.0, 15.0])


@dataclass(frozen=True)
class Crane:
    """The numbers of cranebench's planar crane, by its names."""

    m_trolley: float = 1500.0
    m_payload: float = 4000.0
    m_winch: float = 300.0
    b_x: float = 250.0
    b_l: float = 120.0
    l0: float = 12.0
    u_max: tuple[float, float] = (40e3, 80e3)


def lagrange(numbers: Crane, states: np.ndarray, forces: np.ndarray, wind: float) -> np.ndarray:
    """d/dt of (x, l, theta and their rates), (n, 6), from Lagrange's equations by hand."""
    _, length, angle, dx, dl, turning = states.T
    sin, cos, one = np.sin(angle), np.cos(angle), np.ones(len(states))
    m = numbers.m_payload
    mass = np.moveaxis(np.array([
        [(numbers.m_trolley + m) * one, m * sin, m * length * cos],
        [m * sin, (numbers.m_winch + m) * one, 0 * one],
        [m * length * cos, 0 * one, m * length**2],
    ]), 2, 0)  # fmt: skip
    right = np.array([
        forces[:, 0] - numbers.b_x * dx + wind - m * (2 * dl * turning * cos
                                                      - length * turning**2 * sin),
        forces[:, 1] - numbers.b_l * dl + wind * sin + m * (length * turning**2
                                                            + crane.GRAVITY * cos),
        wind * length * cos - m * length * (2 * dl * turning + crane.GRAVITY * sin),
    ]).T  # fmt: skip
    return np.hstack((states[:, 3:], np.linalg.solve(mass, right[..., None])[..., 0]))


def hoisting() -> feedforward.Motion:
    rig = crane.crane_rig(Crane(), 20.0)
    path = feedforward.rest_to_rest((0.0, -12.0), (20.0, -5.0), 9.0)
    return feedforward.solve(rig, path, np.linspace(0.0, 9.0, 40))


def test_rig_has_the_equations_of_the_planar_crane():
    motion, smooth = hoisting(), replace(Crane(), b_x=0.0, b_l=0.0)
    states = crane.states_of(motion)
    found = lagrange(smooth, states, crane.forces_of(motion), 0.0)
    assert np.abs(found[:, 3:] - crane.accelerations_of(motion)).max() < 1e-12
    assert np.abs(states[:, 5]).max() > 0.1


def test_rig_has_cranebenchs_equations():
    plants = pytest.importorskip("cranebench.plants")
    numbers = plants.PlanarParams(b_x=0.0, b_l=0.0, c_theta=0.0)
    assert (numbers.m_trolley, numbers.m_payload) == (Crane().m_trolley, Crane().m_payload)
    motion, plant = hoisting(), plants.PlanarCrane(numbers)
    forces = crane.forces_of(motion)
    found = [
        plant.dynamics(0.0, state, force, np.zeros(3))[3:]
        for state, force in zip(crane.states_of(motion), forces, strict=True)
    ]
    assert np.abs(np.array(found) - crane.accelerations_of(motion)).max() < 1e-9


def test_swing_goes_on_as_its_differential_equation():
    period, gravity = 0.05, 9.8
    transition, pushed, blown = swing.swinging(LENGTHS, gravity, period)
    for i, length in enumerate(LENGTHS):
        whole = np.zeros((4, 4))
        whole[0, 1], whole[1] = 1.0, (-gravity / length, 0.0, -1.0, gravity / length)
        exact = expm(period * whole)[:2]
        found = np.hstack((transition[i], pushed[i], blown[i]))
        np.testing.assert_allclose(found, exact, rtol=1e-10, atol=1e-13)


def test_gains_solve_the_riccati_equation():
    period = 0.01
    hanging, pushed, blown = swing.swinging(LENGTHS, crane.GRAVITY, period)
    gains = swing.regulator_gains(LENGTHS, crane.GRAVITY, period)
    observer = swing.SwingObserver(LENGTHS, crane.GRAVITY, period)
    for i in range(len(LENGTHS)):
        step = np.zeros((4, 4))
        step[:2, :2], step[2:, 2:] = ((1.0, period), (0.0, 1.0)), hanging[i]
        push = np.vstack(((0.5 * period**2,), (period,), pushed[i]))
        cost, effort = np.diag((swing.PLACE**2, 0.0, 1.0, 0.0)), np.diag((swing.EFFORT**2,))
        value = solve_discrete_are(step, push, cost, effort)
        exact = np.linalg.solve(effort + push.T @ value @ push, push.T @ value @ step)[0]
        np.testing.assert_allclose(gains[i], exact, rtol=1e-6)
        walk = np.block([[hanging[i], blown[i]], [np.zeros((1, 2)), np.ones((1, 1))]])
        look, noise = np.eye(3)[:, :1], np.diag((0.0, 0.0, swing.GUSTS**2 * period))
        spread = solve_discrete_are(walk.T, look, noise, np.diag((swing.NOISE**2,)))
        exact = spread[:, 0] / (spread[0, 0] + swing.NOISE**2)
        np.testing.assert_allclose(observer._gain[i], exact, rtol=1e-6)


@pytest.mark.parametrize("name", ["FF + PD", "FF + observer", "FF + LQR"])
def test_on_the_plant_that_they_know_controllers_keep_to_the_plan(name: str):
    states, task = drive(name, Crane(), wind=0.0)
    aside = task.rows.parts["outputs"][:, 0] - task.rows.parts["drives"][:, 0]
    assert np.abs(aside).max() < 1e-9
    assert np.abs(np.degrees(states[:, 2])).max() < 1e-3
    assert np.abs(states[:, 0] - 5.0).max() < 1e-4


@pytest.mark.parametrize("name", ["FF + observer", "FF + LQR"])
def test_regulators_calm_what_wind_and_another_load_excite(name: str):
    real, wind = replace(Crane(), m_payload=4600.0, b_x=325.0), 700.0
    held = np.arctan2(wind, real.m_payload * crane.GRAVITY)

    def left(entrant: str) -> float:
        states, _ = drive(entrant, real, wind)
        energy = (states[:, 2] - held) ** 2 + LENGTHS / crane.GRAVITY * states[:, 5] ** 2
        return float(np.degrees(np.sqrt(energy)).max())

    assert left("FF + PD") > 0.5
    assert left(name) < 0.02


@cache
def drive(name: str, real: Crane, wind: float) -> tuple[np.ndarray, crane.Task]:
    """The states (n, 6) 12 s after a move of 5 m in 8 s, of cranes on ropes of `LENGTHS`."""
    entrant, period = ENTRANTS[name], 0.01
    rigs = [crane.crane_rig(replace(Crane(), l0=length), 5.0) for length in LENGTHS.tolist()]
    plans = [crane.plan_for(rig, 8.0, 12.0, period) for rig in rigs]
    task = crane.Task(
        crane.crane_rig(Crane(), 5.0), plans, period, loads=entrant.sensors != "encoders"
    )
    assert entrant.laws is not None
    laws = entrant.laws(task, Crane())
    states = np.zeros((len(LENGTHS), 6))
    states[:, 1] = LENGTHS
    for step in range(2000):
        task.read(step, states)
        task.commands = np.clip(crane.actions_of(laws, task), -1.0, 1.0)
        forces = task.commands * Crane().u_max

        def rate(now: np.ndarray, forces: np.ndarray = forces) -> np.ndarray:
            return lagrange(real, now, forces, wind)

        first = rate(states)
        second = rate(states + 0.5 * period * first)
        third = rate(states + 0.5 * period * second)
        last = rate(states + period * third)
        states = states + period / 6.0 * (first + 2.0 * (second + third) + last)
    return states, task


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    campaigns = {
        "calm": Manoeuvre("none", 8.0, 13.5, distance=5.0),
        "wind": Manoeuvre("kaimal", 8.0, 9.0, distance=5.0),
    }
    monkeypatch.setattr(cranebench_runs, "CAMPAIGNS", campaigns)


@pytest.mark.usefixtures("short")
def test_runs_in_cranebench_are_cranebenchs():
    batch = pytest.importorskip("cranebench.batch")
    runner = pytest.importorskip("cranebench.runner")
    from cranebench import lhs_design
    from cranebench.reference import Manoeuvre as Path

    before = dict(batch.BATCH_OF)
    run = Unit("wind", "PD", 3).run()
    campaign = runner.Campaign(wind="kaimal", manoeuvre=Path(5.0, 8.0, 9.0), dt=0.01)
    design = lhs_design(3, cranebench_runs.SEED)
    plain = batch.run_campaign_batch(campaign, design, progress=False)["PD"]
    for metric, values in plain.items():
        assert run.metrics[metric] == values.tolist()
    assert all(value > 0.0 for value in run.metrics["held_swing"])
    exact = Unit("calm", "FF + LQR", 3).run()
    assert max(exact.metrics["residual_swing"]) < 0.01
    assert exact.metrics["free_swing"] == pytest.approx(exact.metrics["residual_swing"])
    assert before == batch.BATCH_OF


def made_up(campaign: str, controller: str) -> Run:
    rng = np.random.default_rng(len(controller))
    names = [*cranebench_report.UNITS, "rms_yaw"]
    metrics = {name: rng.uniform(0.1, 2.0, 4).tolist() for name in names}
    metrics["load_settle"][0] = float("inf")
    return Run(campaign, controller, metrics, [0.0, 1.0, 2.0], [0.1, 0.2, 0.1])


def test_files_hold_every_sample_and_paired_differences(tmp_path: Path):
    runs = [made_up(name, entrant) for name in cranebench_runs.CAMPAIGNS for entrant in ENTRANTS]
    cranebench_report.write(runs, tmp_path)
    rows = list(csv.DictReader((tmp_path / "samples.csv").read_text().splitlines()))
    assert len(rows) == 4 * len(runs)
    assert rows[0]["load_settle"] == ""
    swings = {
        name: np.array([
            float(row["residual_swing"])
            for row in rows
            if (row["campaign"], row["controller"]) == ("wind", name)
        ])
        for name in ("FF + LQR", "ZVD")
    }  # fmt: skip
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["samples"] == 4
    found = summary["campaigns"]["wind"]["FF + LQR"]["residual_swing against"]["ZVD"]
    assert found["mean"] == pytest.approx(np.mean(swings["FF + LQR"] - swings["ZVD"]))
    assert found["low"] < found["mean"] < found["high"]
    assert (tmp_path / "swing.png").stat().st_size > 10_000
    assert cranebench_report.of_campaign("wind", runs).row_count == len(ENTRANTS)


def test_wrong_options_are_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.chdir(tmp_path)
    for wrong, message in (
        ({"samples": 7}, "--samples is for `flatrig bench cranebench`"),
        ({"topic": "feedforward", "json": True}, "--json is for `flatrig bench cranebench`"),
        ({"topic": "cranebench", "rig": ("rotary",)}, "--rig is for `flatrig bench feedforward`"),
        ({"topic": "cranebench", "samples": 1}, "--samples is 1, it must be >= 2"),
    ):
        with pytest.raises(OptionError, match=message):
            main(options.Bench(**wrong))


def test_without_cranebench_one_line_says_so(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert cli(["bench", "cranebench"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line == "flatrig: error: cranebench is not installed; pip install 'flatrig[peers]'"
    assert not list(tmp_path.iterdir())
