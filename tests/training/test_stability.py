"""PD on encoders in MuJoCo: energy balance, convergence, tracking, friction."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import simpson

from flatrig import models
from flatrig.feedforward import Regulator, solve
from flatrig.models.errors import ModelError
from flatrig.models.friction import Friction
from flatrig.training.reproduce import convergence as stability
from flatrig.training.reproduce import kiss_crane
from flatrig.training.reproduce.rubbing import Winches
from flatrig.training.simulate.closed_loop import closed_loop

CASES = [name for name, case in stability.CASES.items() if case.massless is None]


@pytest.mark.parametrize("name", CASES)
def test_energy_lost_is_what_the_dampers_took(name):
    """Lemmas 7, 12, 17 of K: integrated by MuJoCo here, by quadrature there."""
    case = stability.CASES[name]
    regulator = case.regulator()
    values, rates = stability.initial_states(case, regulator, np.inf, runs=3, seed=1)
    course = closed_loop(regulator, values, rates, 1.0, timestep=5e-4)
    energy = regulator.energy(course.values, course.rates)
    power = regulator.dissipation(course.values, course.rates)
    assert_allclose(energy[0], regulator.energy(values, rates), rtol=1e-12)
    lost = simpson(power, x=course.times, axis=0)
    assert_allclose(energy[0] - energy[-1], lost, rtol=1e-5)
    assert (np.diff(energy, axis=0) <= 1e-12 * energy[0]).all()


def test_encoders_and_inputs_are_those_of_the_theory():
    regulator = stability.CASES["cantilever"].regulator()
    case = stability.CASES["cantilever"]
    values, rates = stability.initial_states(case, regulator, np.inf, runs=4, seed=2)
    course = closed_loop(regulator, values, rates, 0.05, every=5)
    assert course.times.tolist() == pytest.approx([0.005 * k for k in range(11)])
    wanted = regulator.inputs(course.values, course.rates)
    assert_allclose(course.inputs, wanted, rtol=1e-8, atol=1e-8)


def test_random_initial_states_converge():
    case = stability.CASES["overhead"]
    outcome = stability.study(case, runs=8)
    assert outcome.converged == 8
    assert outcome.taut.all()
    assert outcome.rise < 1e-12
    assert outcome.rival == pytest.approx(981 * (8 - 2 * 981 / 520))


def test_undamped_runs_do_not_converge():
    case = stability.CASES["overhead"]
    loose = replace(case.regulator(), damping=(0.0, 0.0))
    outcome = stability.study(replace(case, regulator=lambda: loose), runs=4)
    assert outcome.converged == 0
    assert abs(outcome.rise) < 1e-3  # the energy is kept


def test_initial_states_of_the_massless_pulley_balance_it():
    case = stability.CASES["planar Navy, massless"]
    regulator = case.regulator()
    values, _ = stability.initial_states(case, regulator, np.inf, runs=5, seed=0)
    place = {part: np.array([values[f"{part}.{i}"] for i in "xz"]) for part in ("pulley", "load")}
    home = regulator.rig.home_point
    sides = [np.array(home(name))[[0, 2], None] - place["pulley"] for name in ("A", "P")]
    sides.append(place["load"] - place["pulley"])
    tagline, upper, lower = (side / np.linalg.norm(side, axis=0) for side in sides)
    assert_allclose((tagline * upper).sum(axis=0), (tagline * lower).sum(axis=0), atol=1e-9)
    across = tagline[0] * (upper + lower)[1] - tagline[1] * (upper + lower)[0]
    assert_allclose(across, 0.0, atol=1e-9)


def test_tracking_from_the_right_place_follows_the_path():
    regulator, path = kiss_crane.spatial_regulator(), kiss_crane.move(1.0)
    middles = (np.arange(1000) + 0.5) * 1e-3
    start = solve(regulator.rig, path, 0.0)
    values = {name: start.positions[:, start.column(name)] for name in regulator.rest_values}
    reference = solve(regulator.rig, path, middles)
    course = closed_loop(regulator, values, {}, 1.0, every=10, reference=reference)
    wanted = solve(regulator.rig, path, course.times)
    assert_allclose(course.outputs[:, 0], wanted.outputs, rtol=0, atol=1e-5)
    # inputs belong to the middle of a step, half a millisecond before the sample
    assert_allclose(course.tensions[:, 0], wanted.tensions, rtol=0, atol=3e-2)


def test_dry_friction_holds_a_winch_and_dither_frees_it():
    """The spring of 20 N/m is 4 mm off: 0.08 N, less than the friction."""
    regulator = kiss_crane.planar_regulator()
    values = {name: np.atleast_1d(at) for name, at in regulator.rest_values.items()}
    values = values | {"load.z": values["load.z"] + 0.004}
    friction = Friction(coulomb=0.1)

    def moved(winches):
        course = closed_loop(
            regulator, values, {}, 1.5, timestep=5e-4, massless=1e-4, each_step=winches
        )
        return course.outputs[-1, 0, 1] - course.outputs[0, 0, 1]

    assert abs(moved(Winches(regulator, friction))) < 1e-5
    shaken = Winches(regulator, friction, known=friction, dither=0.1)
    assert moved(shaken) == pytest.approx(-0.004, abs=8e-4)


def test_a_step_too_long_for_the_gains_is_told():
    rig = models.overhead_crane()
    regulator = Regulator(rig, (5.0, -4.0), (1e8, 1e8), (1.0, 1.0))
    values = {name: np.array([at + 0.1]) for name, at in regulator.rest_values.items()}
    with pytest.raises(ModelError, match="the simulation breaks down"):
        closed_loop(regulator, values, {}, 5.0, timestep=1e-2)
