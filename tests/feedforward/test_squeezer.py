"""Andrews' squeezing mechanism: our equations and integrators against the published solution."""

from functools import cache

import numpy as np
import pytest

from flatrig.feedforward import multibody
from flatrig.feedforward.integrators import (
    EnergyMomentum,
    GeneralisedAlpha,
    Midpoint,
    ReducedEnergyMomentum,
    Run,
    Scheme,
    Variational,
    measured,
)
from flatrig.models.squeezer import closing as squeezer_run
from flatrig.models.squeezer import mechanism as data
from flatrig.models.types import Array

AGREEMENT = 1e-10
"""Of our converged methods in beta [rad]."""
SCHEMES = (Midpoint(), EnergyMomentum(), Variational())


@cache
def explicit() -> Run:
    """The index-1 form by an explicit method of order eight."""
    return measured.squeezer_explicit(1e-13)


def final_angles(run: Run) -> Array:
    assert run.failure is None
    return multibody.angles_of_squeezer(run.q)[-1]


def test_it_has_43_coordinates_and_one_freedom() -> None:
    system, start = multibody.assemble(multibody.squeezer())
    assert (len(system.names), len(system.constraint_names)) == (43, 42)
    angles = multibody.angles_of_squeezer(start.q[None])[0]
    assert angles == pytest.approx(data.START, abs=1e-14)
    assert start.q[system.index("beta")] == pytest.approx(data.START[0], abs=1e-14)


def test_the_start_fits_the_printed_tables() -> None:
    mechanism = multibody.squeezer()
    _, start = multibody.assemble(mechanism)
    # Y table 3.2, with the signs of K1's y and K3's x mended, and hinge P of table 3.1.
    centres = [
        (9.182e-4, -5.7e-5),
        (-4.491e-3, 2.788e-4),
        (-1.874e-2, 2.048e-2),
        (-3.022e-2, 1.207e-2),
        (-5.324e-2, 1.663e-2),
        (-2.854e-2, -1.072e-2),
        (-5.926e-2, -1.060e-2),
    ]
    for body, centre in zip(mechanism.bodies, centres, strict=True):
        assert body.position == pytest.approx(centre, abs=6e-6)
    hinge = multibody.hinge_of_squeezer(start.q[None])[0]
    assert hinge == pytest.approx((-0.02096, 0.0013), abs=6e-6)


def test_accelerations_are_those_of_the_test_sets_equations() -> None:
    system, _ = multibody.assemble(multibody.squeezer())
    run = explicit()
    angles = multibody.angles_of_squeezer(run.q)
    for k in range(0, 101, 10):
        q, v = run.q[k], run.v[k]
        found = rates(q, system.accelerations(q, v)[0])
        expected = published_accelerations(angles[k], rates(q, v))
        assert found == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())
    # The first is printed in the test set.
    assert rates(run.q[0], system.accelerations(run.q[0], run.v[0])[0])[0] == pytest.approx(
        14222.4439199541138, rel=1e-12
    )


def rates(q: Array, v: Array) -> Array:
    """First or second derivatives of the seven angles from those of the directors.

    With d and d' (or d'') of a unit director, d x d' is the rate (or the rate's rate).
    """
    absolute = [q[6 * i + 2] * v[6 * i + 3] - q[6 * i + 3] * v[6 * i + 2] for i in range(7)]
    parents = [link.parent for link in data.LINKS]
    return np.array(
        [
            rate - (0.0 if parent is None else absolute[parent])
            for rate, parent in zip(absolute, parents, strict=True)
        ]
    )


def published_accelerations(p: Array, v: Array) -> Array:
    """Accelerations by the seven-angle equations of the IVP test set (Mazzia, Magherini 2008).

    With its own names and numbers, typed from there and not from
    `flatrig.models.squeezer.mechanism`.
    """
    m = [0.0, 0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498]
    i = [0.0, 2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5]
    xb, yb, xc, yc = -0.03635, 0.03273, 0.014, 0.072
    c0, l0, mom, d, da, e, ea = 4530.0, 0.07785, 0.033, 0.028, 0.0115, 0.02, 0.01421
    rr, ra, ss, sa, sb, sc, sd = 0.007, 0.00092, 0.035, 0.01874, 0.01043, 0.018, 0.02
    ta, tb, u, ua, ub, zf, zt, fa = 0.02308, 0.00916, 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421
    beta, theta, gamma, phi, delta, omega, epsilon = p
    bep, thp, _, php, dep, omp, epp = v
    mass = np.zeros((7, 7))
    mass[0, 0] = m[1] * ra**2 + m[2] * (rr**2 - 2 * da * rr * np.cos(theta) + da**2) + i[1] + i[2]
    mass[1, 0] = m[2] * (da**2 - da * rr * np.cos(theta)) + i[2]
    mass[1, 1] = m[2] * da**2 + i[2]
    mass[2, 2] = m[3] * (sa**2 + sb**2) + i[3]
    mass[3, 3] = m[4] * (e - ea) ** 2 + i[4]
    mass[4, 3] = m[4] * ((e - ea) ** 2 + zt * (e - ea) * np.sin(phi)) + i[4]
    mass[4, 4] = m[4] * (zt**2 + 2 * zt * (e - ea) * np.sin(phi) + (e - ea) ** 2)
    mass[4, 4] += m[5] * (ta**2 + tb**2) + i[4] + i[5]
    mass[5, 5] = m[6] * (zf - fa) ** 2 + i[6]
    mass[6, 5] = m[6] * ((zf - fa) ** 2 - u * (zf - fa) * np.sin(omega)) + i[6]
    mass[6, 6] = m[6] * ((zf - fa) ** 2 - 2 * u * (zf - fa) * np.sin(omega) + u**2)
    mass[6, 6] += m[7] * (ua**2 + ub**2) + i[6] + i[7]
    mass += np.tril(mass, -1).T
    xd = sd * np.cos(gamma) + sc * np.sin(gamma) + xb
    yd = sd * np.sin(gamma) - sc * np.cos(gamma) + yb
    length = np.hypot(xd - xc, yd - yc)
    fx, fy = -c0 * (length - l0) / length * np.array([xd - xc, yd - yc])
    force = np.array(
        [
            mom - m[2] * da * rr * thp * (thp + 2 * bep) * np.sin(theta),
            m[2] * da * rr * bep**2 * np.sin(theta),
            fx * (sc * np.cos(gamma) - sd * np.sin(gamma))
            + fy * (sd * np.cos(gamma) + sc * np.sin(gamma)),
            m[4] * zt * (e - ea) * dep**2 * np.cos(phi),
            -m[4] * zt * (e - ea) * php * (php + 2 * dep) * np.cos(phi),
            -m[6] * u * (zf - fa) * epp**2 * np.cos(omega),
            m[6] * u * (zf - fa) * omp * (omp + 2 * epp) * np.cos(omega),
        ]
    )

    def hinge(p: Array) -> Array:
        """The loops: the crank's end less the three other ways to hinge P."""
        beta, theta, gamma, phi, delta, omega, epsilon = p
        x = rr * np.cos(beta) - d * np.cos(beta + theta)
        y = rr * np.sin(beta) - d * np.sin(beta + theta)
        return np.array(
            [
                x - ss * np.sin(gamma),
                y + ss * np.cos(gamma),
                x - e * np.sin(phi + delta) - zt * np.cos(delta),
                y + e * np.cos(phi + delta) - zt * np.sin(delta),
                x - zf * np.cos(omega + epsilon) - u * np.sin(epsilon),
                y - zf * np.sin(omega + epsilon) + u * np.cos(epsilon),
            ]
        )

    # All are sines of sums: Jacobian by complex steps, v^T Hessian v from the angles' rates.
    jacobian = np.stack([hinge(p + 1e-200j * unit).imag / 1e-200 for unit in np.eye(7)], axis=1)
    w, t = bep + thp, beta + theta
    bx = -rr * np.cos(beta) * bep**2 + d * np.cos(t) * w**2
    by = -rr * np.sin(beta) * bep**2 + d * np.sin(t) * w**2
    gap, a, b = v[2], phi + delta, omega + epsilon
    curvature = np.array(
        [
            bx + ss * np.sin(gamma) * gap**2,
            by - ss * np.cos(gamma) * gap**2,
            bx + e * np.sin(a) * (php + dep) ** 2 + zt * np.cos(delta) * dep**2,
            by - e * np.cos(a) * (php + dep) ** 2 + zt * np.sin(delta) * dep**2,
            bx + zf * np.cos(b) * (omp + epp) ** 2 + u * np.sin(epsilon) * epp**2,
            by + zf * np.sin(b) * (omp + epp) ** 2 - u * np.cos(epsilon) * epp**2,
        ]
    )
    matrix = np.block([[mass, jacobian.T], [jacobian, np.zeros((6, 6))]])
    return np.linalg.solve(matrix, np.concatenate((force, -curvature)))[:7]


@cache
def converged(scheme: Scheme) -> Array:
    """The seven angles at 0.03 s, extrapolated to step zero."""
    limit, unsure = measured.squeezer_limit(scheme)
    assert unsure[0] < 1e-7
    return limit


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_the_schemes_converge_to_the_published_angles(scheme: Scheme) -> None:
    angles = converged(scheme)
    assert angles[0] == pytest.approx(data.PUBLISHED[0], abs=data.PUBLISHED_ACCURACY)
    assert angles == pytest.approx(data.PUBLISHED, abs=data.PUBLISHED_ACCURACY)
    assert angles[0] == pytest.approx(final_angles(explicit())[0], abs=AGREEMENT)


def test_all_converged_methods_agree() -> None:
    betas = [converged(scheme)[0] for scheme in SCHEMES] + [final_angles(explicit())[0]]
    assert np.ptp(betas) < AGREEMENT


def test_the_reduced_scheme_makes_the_same_steps() -> None:
    full, reduced = (
        final_angles(measured.squeezer_run(scheme, 400))
        for scheme in (EnergyMomentum(), ReducedEnergyMomentum())
    )
    assert reduced == pytest.approx(full, abs=AGREEMENT)


def test_the_explicit_method_finds_the_published_angles() -> None:
    run = explicit()
    assert final_angles(run) == pytest.approx(data.PUBLISHED, abs=data.PUBLISHED_ACCURACY)
    system, _ = multibody.assemble(multibody.squeezer())
    assert np.abs([system.constraint_values(q) for q in run.q]).max() < 1e-11


def test_generalised_alpha_converges_at_second_order() -> None:
    exact = final_angles(explicit())[0]
    errors = [
        final_angles(measured.squeezer_run(GeneralisedAlpha(), n))[0] - exact for n in (300, 600)
    ]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)


@pytest.mark.parametrize("steps", [100, 400])
def test_energy_balance(steps: int) -> None:
    """The motor's work is the gain of energy: exactly in one scheme, to h^2 in the others."""
    system, _ = multibody.assemble(multibody.squeezer())
    work = data.TORQUE * (data.PUBLISHED[0] - data.START[0])

    def away(scheme: Scheme) -> float:
        run = measured.squeezer_run(scheme, steps)
        # The motor's work is part of the potential, so the sum is constant.
        energy = [system.energy(q, v) for q, v in zip(run.q, run.v, strict=True)]
        return float(np.abs(np.array(energy) - energy[0]).max()) / work

    assert away(EnergyMomentum()) < 1e-11
    assert away(Variational()) > 1e-5
    assert away(GeneralisedAlpha()) > 1e-5


@pytest.mark.parametrize("timestep", [3e-5, 1e-5])
def test_mujoco_with_closed_loops_comes_close(timestep: float) -> None:
    angles = squeezer_run.final_angles(timestep)
    assert angles[0] == pytest.approx(data.PUBLISHED[0], abs=2e-6)
    assert angles == pytest.approx(data.PUBLISHED, abs=3e-6)
    assert 0 < squeezer_run.gap(angles) < 2e-7


def test_work_buys_precision() -> None:
    rows = measured.work_precision(
        converged(EnergyMomentum())[0], (100, 200), (1e-6, 1e-9), (Midpoint(), EnergyMomentum())
    )
    for coarse, fine in zip(rows[::2], rows[1::2], strict=True):
        assert coarse.method == fine.method
        assert coarse.error > 3 * fine.error > 0
        assert coarse.factorisations < fine.factorisations
