"""`flatrig bench feedforward`: what it measures, keeps, writes and refuses."""

import csv
import functools
import math
from pathlib import Path

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.models.errors import OptionError, RigError
from flatrig.training import options
from flatrig.training.bench import error_against_time as bench_feedforward
from flatrig.training.bench import speed as bench
from flatrig.training.bench import trial_tables as bench_tables
from flatrig.training.bench import trials as bench_runs
from flatrig.training.bench.exact_roads import COMPILED, roads
from flatrig.training.bench.peers import PEERS, IndexOneProblem, Peer, PeerError
from flatrig.training.bench.smooth_moves import cases
from flatrig.training.bench.trials import EXACT, Run, Unit
from flatrig.training.cli import main

ALGEBRAIC = "minimal extension, twice"
OVERHEAD = cases()["overhead_crane"]


@pytest.fixture(autouse=True)
def _small(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(bench_runs, "COUNTS", (40, 80, 160))
    monkeypatch.setattr(bench_runs, "TOLERANCES", (1e-3,))
    monkeypatch.setattr(bench_runs, "PEER_TOLERANCES", (1e-4, 1e-7))
    monkeypatch.setattr(bench_runs, "LONGEST", 60.0)


def test_order_is_the_slope_where_it_has_settled():
    counts = [40, 80, 160, 320, 640]
    steps = 1.0 / np.array(counts)
    order = bench_tables.measured_order
    assert order(counts, 7.0 * steps**3) == pytest.approx(3.0)
    assert order(counts, 1e-3 * steps**2 + 1e-20 * steps**-4) == pytest.approx(2.0, abs=0.05)
    assert order(counts, np.full(5, 0.2)) == 0.0
    assert math.isnan(order(counts, 1e-16 * steps**-2))
    assert math.isnan(order(counts, [1.0, 1e-1, 1e-4, 1e-5, 1e-9]))
    assert math.isnan(order(counts[:2], steps[:2]))


def test_inputs_count_over_their_largest_value():
    times = np.linspace(0.0, OVERHEAD.reference.duration, 11)
    truth = feedforward.solve(OVERHEAD.rig, OVERHEAD.reference, times)
    size = np.abs(truth.inputs).max(axis=0)
    off = truth.inputs + np.outer(times == times[4], (0.01, -0.03) * size)
    wrong = type(truth)(**{**vars(truth), "inputs": off})
    assert bench_runs.errors(wrong, truth) == (0.0, pytest.approx(0.03))


def test_paths_are_smooth_and_feasible():
    """With kinks in the inputs every scheme would be of order 1, and slack ropes mean nothing."""
    assert set(models.CATALOGUE) < set(cases())
    for case in cases().values():
        assert case.move.order >= feedforward.analyse(case.rig).reference_order + 4
    assert feedforward.check(OVERHEAD.rig, OVERHEAD.reference).feasible


def test_ladder_of_steps_shows_the_order():
    runs = Unit("overhead_crane", "minimal extension", ("BDF 2",)).runs()
    assert [run.count for run in runs] == [run.steps for run in runs] == [40, 80, 160]
    assert all(run.coordinates < 1e-10 and not run.failure for run in runs)
    (row,) = bench_tables.orders(runs)
    assert row["inputs"] == pytest.approx(2.0, abs=0.15)
    assert row["inputs in theory"] == 2
    assert math.isinf(row["coordinates in theory"])
    assert math.isnan(row["coordinates"])


def test_exact_solution_agrees_with_a_second_road():
    runs = Unit("overhead_crane", EXACT, ()).runs()
    assert {run.scheme for run in runs} == set(roads())
    for name in roads():
        assert [run.steps for run in runs if run.scheme == name] == [40, 80, 160]
    assert max(run.inputs for run in runs) < 1e-10


def test_a_path_that_compiled_steps_cannot_start_on_is_a_failure():
    runs = Unit("navy_crane_2d, massless", EXACT, ()).runs()
    for run in runs:
        assert ("refused" in run.failure or "cannot go on" in run.failure) == (
            run.scheme == COMPILED
        )


def test_failures_are_kept_with_their_reason():
    runs = Unit("navy_crane_2d, massless", "projection, minimal", ("implicit Euler",)).runs()
    assert len(runs) == 3
    for run in runs:
        assert "singular" in run.failure
        assert math.isnan(run.inputs)


def test_step_across_half_the_path_is_no_exception():
    """Newton's cautious iteration ends at a zero by a correction of exactly zero here."""
    trial = bench_runs.Trial("roped_overhead_crane", "projection, minimal", "BDF 4", 4)
    assert bench_runs.integrate(trial).motion.times[0] == 0.0


def test_what_does_not_apply_says_why():
    (run,) = Unit("overhead_crane", "minimal extension, three times", ("BDF 2",)).runs()
    assert "its index is 5" in run.failure
    assert not run.scheme


def test_runs_that_would_take_too_long_are_left_out(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(bench_runs, "LONGEST", 0.0)
    first, *others = Unit("overhead_crane", ALGEBRAIC, ("implicit Euler",)).runs()
    assert not first.failure
    assert [run.failure[:7] for run in others] == ["not run"] * 2


def test_run_that_does_not_end_is_stopped(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(bench_runs, "STOPPED", 0.01)
    monkeypatch.setattr(bench_runs, "COUNTS", (20_000,))
    (run,) = Unit("overhead_crane", "direct", ("implicit Euler",)).runs()
    assert run.failure == "stopped after 0.01 s"
    assert math.isnan(run.inputs)


@pytest.mark.parametrize("peer", PEERS, ids=lambda peer: peer.name)
@pytest.mark.parametrize("name", ["overhead_crane", "rotary_crane"])
def test_peers_solve_the_same_problem(name: str, peer: Peer):
    pytest.importorskip(peer.package)
    coarse, fine = Unit(name, peer.name, ()).runs()
    assert not fine.failure
    assert fine.inputs < 1e-4
    assert fine.inputs < 0.1 * coarse.inputs
    assert fine.of_peer


def test_peers_get_equations_that_the_exact_solution_satisfies():
    problem = IndexOneProblem(OVERHEAD.rig, OVERHEAD.reference)
    span = (0.0, OVERHEAD.reference.duration)
    found = bench_runs.BY_NAME["scipy DOP853"].prepare(problem, 1e-9)()
    assert (found.times[0], found.times[-1]) == span
    for t, z in zip(found.times, found.unknowns, strict=True):
        assert np.abs(problem.residual(problem.targets(t)[:, 0], z)).max() < 1e-4


def test_peer_that_gives_up_is_a_failure():
    def prepare(problem: IndexOneProblem, tolerance: float):
        raise PeerError("too stiff")

    bench = Unit("overhead_crane", "lazy", ())
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(bench_runs.BY_NAME, "lazy", Peer("lazy", "scipy", "ODE", prepare))
        assert [run.failure for run in bench.runs()] == ["too stiff"] * 2


def test_absent_peer_is_named(monkeypatch: pytest.MonkeyPatch):
    gone = Peer("Gone", "no_such_package", "ODE", PEERS[-1].prepare)
    monkeypatch.setattr(bench_feedforward, "PEERS", (gone, PEERS[-1]))
    units = [Unit("overhead_crane", name, ()) for name in ("Gone", PEERS[-1].name)]
    assert bench_feedforward.absent(units) == ["Gone"]


def test_units_are_cut_to_what_is_asked_for():
    def names(**chosen: tuple[str, ...]) -> set[str]:
        return {unit.name for unit in bench_feedforward.units(options.Bench(**chosen))}

    every = bench_feedforward.units(options.Bench())
    assert {unit.case for unit in every} == set(cases())
    assert names() == {EXACT, *feedforward.dae.FORMULATIONS, *bench_runs.BY_NAME}
    assert names(formulation=("direct",)) == {EXACT, "direct"}
    assert names(scheme=("scipy Radau",)) == {EXACT, "scipy Radau"}
    navy = bench_feedforward.units(options.Bench(rig=("navy-2d",), formulation=("direct",)))
    assert {unit.case for unit in navy} == {"navy_crane_2d", "navy_crane_2d, massless"}


def test_names_that_mean_nothing_are_refused():
    for wrong, error in (
        ({"rig": ("rotory",)}, RigError),
        ({"scheme": ("BDF3",)}, OptionError),
        ({"formulation": ("minimal",)}, OptionError),
    ):
        with pytest.raises(error, match="there is no"):
            bench_feedforward.units(options.Bench(**wrong))
    with pytest.raises(OptionError, match="--rig is for"):
        bench.main(options.Bench(rig=("rotary",)))


def test_command_writes_tables_and_figure_and_resumes(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    argv = ["bench", "feedforward", "--rig", "overhead", "--formulation", "minimal extension"]
    argv += [ALGEBRAIC, "--scheme", "BDF 3", "scipy DOP853", "--processes", "1", "-o", "out"]
    assert main(argv) == 0
    told = capsys.readouterr().out
    assert "times" in told
    assert "compiled C" in told
    assert "minimal extension" in told
    with Path("out/runs.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 3 * len(roads()) + 3 + 3 + 2
    assert {row["scheme"] for row in rows} == {*roads(), "BDF 3", "scipy DOP853"}
    with Path("out/orders.csv").open(newline="") as file:
        (order,) = [row for row in csv.DictReader(file) if row["formulation"] != ALGEBRAIC]
    assert float(order["inputs in theory"]) == 3
    assert Path("out/overhead_crane.png").stat().st_size > 10_000

    @functools.wraps(Unit.runs)
    def not_again(unit: Unit) -> list[Run]:
        raise AssertionError(unit)

    monkeypatch.setattr(Unit, "runs", not_again)
    assert main([*argv, "--resume"]) == 0
    with Path("out/runs.csv").open(newline="") as file:
        assert list(csv.DictReader(file)) == rows


def test_one_figure():
    argv = ["bench", "feedforward", "--rig", "overhead", "--scheme", "BDF 3", "scipy DOP853"]
    assert main([*argv, "--processes", "1", "-o", "one.png"]) == 0
    assert [path.name for path in Path().iterdir()] == ["one.png"]


def test_printed_steps_are_tabulated(monkeypatch: pytest.MonkeyPatch):
    few = (("overhead_crane", {}, (0.1, 0.05)), ("navy_crane_2d", {"pulley_mass": 0.0}, (0.1,)))
    monkeypatch.setattr(bench_tables, "PRINTED_STEPS", few)
    shown = bench_tables.at_printed_steps()
    rigs, steps, places = (list(shown.columns[i].cells) for i in range(3))
    assert rigs == ["overhead_crane"] * 2 + ["navy_crane_2d, massless"]
    assert steps == ["0.1", "0.05", "0.1"]
    assert max(float(place) for place in places[:2]) < 1e-11
