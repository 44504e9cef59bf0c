"""Figures of Y chapters 2 and 3: two roads to the same motion, and what the schemes keep."""

import numpy as np
import pytest
from PIL import Image

from flatrig.feedforward.integrators import (
    EnergyMomentum,
    ImplicitEuler,
    Midpoint,
    Variational,
    integrate_index_one,
    measured,
)
from flatrig.feedforward.multibody import assemble, rotary_crane
from flatrig.models.errors import OptionError
from flatrig.models.squeezer import mechanism as data
from flatrig.training import cli
from flatrig.training.reproduce import (
    conserved,
    crane_by_angles,
    figures_y2,
    figures_y3,
    work_precision,
)


def test_angles_and_directors_describe_one_crane():
    """Energy, angular momentum and the load's way, by two derivations that share nothing."""
    system, start = assemble(rotary_crane(place=1.5))
    times = np.linspace(0.0, 0.4, 5)
    exact = integrate_index_one(system, start.q, start.v, times)
    goal = exact.q[-1, [system.index(f"load.{axis}") for axis in "xyz"]]
    errors = []
    for step in (4e-3, 2e-3):
        _, x, rates = crane_by_angles.run(1.5, step=step, duration=0.4)
        errors.append(np.abs(crane_by_angles.load(x)[-1] - goal).max())
    assert errors[1] < 1e-6
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
    energy, momentum = crane_by_angles.conserved(x[0], rates[0])
    assert energy == pytest.approx(system.energy(start.q, start.v), rel=1e-14)
    assert momentum == pytest.approx(system.angular_momentum(start.q, start.v)[2], rel=1e-14)


def mass_matrix(x):
    """From the load's place alone, by complex steps, and the other bodies' simple energies."""
    steps = 1e-200j * np.eye(5)
    slope = crane_by_angles.load(x + steps).imag / 1e-200
    turning = 16.67 + 2.08 + 0.26 + 53.0 * x[1] ** 2
    return 10.0 * slope @ slope.T + np.diag([turning, 53.0, 0.02 / 0.1**2, 0.0, 0.0])


def test_the_equations_by_angles_are_lagranges():
    """Mass matrix and force of a swinging crane against derivatives of its Lagrangian (Y 2.15)."""
    x, rates = np.array([0.4, 2.0, 5.0, 0.3, -0.5]), np.array([0.7, -0.3, 0.5, 0.9, -0.6])
    mass, force = crane_by_angles._equations(x, rates)
    assert mass == pytest.approx(mass_matrix(x), abs=1e-11)
    h = 1e-5
    slopes = np.array(
        [(mass_matrix(x + step) - mass_matrix(x - step)) / (2 * h) for step in h * np.eye(5)]
    )
    weight = 98.1 * crane_by_angles.load(x + 1e-200j * np.eye(5))[:, 2].imag / 1e-200
    expected = 0.5 * (slopes @ rates) @ rates - np.tensordot(rates, slopes, 1) @ rates - weight
    assert force == pytest.approx(expected, abs=1e-6)


def test_generalised_coordinates_keep_energy_only_up_to_the_step():
    coarse, fine = (
        np.ptp([crane_by_angles.conserved(*state) for state in zip(*run[1:], strict=True)], axis=0)
        for run in (crane_by_angles.run(step=step) for step in (2e-2, 1e-2))
    )
    assert coarse / fine == pytest.approx([4.0, 4.0], rel=0.1)


def test_a_step_too_long_for_the_iteration_is_one_line():
    with pytest.raises(OptionError, match="step of 1 s is too long"):
        crane_by_angles.run(place=1.5, step=1.0, spin=20.0)


@pytest.mark.parametrize("name", ["Y2.10", "Y2.11", "Y3.4", "Y3.5"])
def test_a_figure_comes_with_its_numbers(name, capsys, tmp_path):
    assert cli.main(["reproduce", name, "-o", str(tmp_path)]) == 0
    picture = tmp_path / f"{name}.png"
    assert picture.stat().st_size < 200_000
    with Image.open(picture) as image:
        assert image.size[0] > 500
    assert f"wrote {picture}" in capsys.readouterr().out


def test_energy_momentum_keeps_both_to_rounding_at_the_printed_step():
    let = figures_y2.by_directors()
    assert np.ptp(let.energy) < 1e-10 * np.abs(let.energy).max()
    assert np.ptp(let.momentum) < 1e-10 * let.momentum[0]


def test_only_energy_momentum_satisfies_the_balance():
    kept, lost = (
        np.abs(figures_y3.balances(measured.squeezer_run(scheme, 100))).max()
        for scheme in (EnergyMomentum(), Variational())
    )
    assert kept < 1e-12
    assert lost > 1e-3


def test_extrapolated_points_count_the_work_of_their_runs():
    counts = (100, 150, 200)
    made = [work_precision._run(Midpoint(), count) for count in counts]
    points = work_precision._extrapolations(made, counts)
    assert [point.setting for point in points] == ["up to 150 steps", "up to 200 steps"]
    assert points[-1].evaluations == sum(point.evaluations for point in made)
    away = [np.abs(point.angles - data.PUBLISHED).max() for point in (*made, *points)]
    assert away[-1] < 1e-4 < 1e-2 < away[-3]


def test_orders_of_the_schemes():
    runs = conserved.measure((20, 40), (ImplicitEuler(), EnergyMomentum()), duration=0.1)
    found = conserved.orders(runs)
    assert found["implicit Euler"] == pytest.approx(1.0, abs=0.02)
    assert found["energy-momentum"] == pytest.approx(2.0, abs=0.02)


def test_what_mujoco_keeps_of_the_free_crane():
    rows = {(run.method, run.step): run for run in conserved.in_mujoco((100,))}
    assert rows["MuJoCo RK4", 0.01].energy < 1e-7
    assert rows["MuJoCo RK4", 0.01].error < 1e-8
    assert rows["MuJoCo Euler", 0.01].energy > 1.0
