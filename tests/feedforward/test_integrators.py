"""Schemes for constrained systems: order, conserved quantities, conditioning, failures."""

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.feedforward import integrators, multibody
from flatrig.feedforward.integrators import (
    SCHEMES,
    EnergyMomentum,
    Failure,
    GeneralisedAlpha,
    ImplicitEuler,
    Midpoint,
    ReducedEnergyMomentum,
    Run,
    Scheme,
    Variational,
    integrate,
)
from flatrig.feedforward.integrators.iteration import linearised
from flatrig.feedforward.integrators.stage import OneStage
from flatrig.feedforward.multibody import (
    GROUND,
    Angle,
    Body,
    Effort,
    Mechanism,
    Point,
    Revolute,
    Spherical,
    Spring,
    Start,
    System,
)
from flatrig.models.errors import OptionError, RigError
from flatrig.models.types import Array


def named(scheme: Scheme) -> str:
    return scheme.name


def double_pendulum(effort: float = 2.0) -> tuple[System, Start]:
    """Two rods in the plane, a spring from the ground to the outer, a torque on the inner."""
    rods = (
        Body("inner", 2.0, (0.1, 0.1), (0.5, 0.0)),
        Body("outer", 1.0, (0.05, 0.05), (1.0, -0.4), multibody.planar(-0.5 * np.pi)),
    )
    mechanism = Mechanism(
        "double pendulum",
        rods,
        (
            Revolute("pin", Point(GROUND), Point("inner", (-0.5, 0.0))),
            Revolute("elbow", Point("inner", (0.5, 0.0)), Point("outer", (-0.4, 0.0))),
        ),
        (Angle("swing", GROUND, "inner"), Angle("bend", "inner", "outer")),
        (Spring("spring", Point(GROUND, (0.0, 1.0)), Point("outer"), 60.0, 1.2),),
        (Effort("swing", effort),),
        (0.0, -9.81),
    )
    return multibody.assemble(mechanism)


def top() -> tuple[System, Start]:
    """A heavy symmetric top, 6 cm from its tip to its centre, leaning and spinning."""
    lean, spin = 0.4, 120.0
    rotation = np.array(
        [[np.cos(lean), 0, np.sin(lean)], [0, 1, 0], [-np.sin(lean), 0, np.cos(lean)]]
    )
    axis, arm = rotation[:, 2], 0.06
    body = Body(
        "top",
        0.5,
        multibody.euler_of((4e-4, 4e-4, 5e-4)),
        tuple(arm * axis),
        tuple(map(tuple, rotation)),
        spin=tuple(spin * axis),
    )
    tip = Spherical("tip", Point(GROUND), Point("top", (0.0, 0.0, -arm)))
    return multibody.assemble(Mechanism("top", (body,), (tip,), gravity=(0.0, 0.0, -9.81)))


def energies(system: System, run: Run) -> Array:
    """Along a run, shape (N,)."""
    return np.array([system.energy(q, v) for q, v in zip(run.q, run.v, strict=True)])


def moments(system: System, run: Run) -> Array:
    """Angular momentum about the vertical along a run, shape (N,)."""
    pairs = zip(run.q, run.v, strict=True)
    return np.array([system.angular_momentum(q, v)[-1] for q, v in pairs])


def spread(values: Array) -> float:
    """Greatest change from the first value, relative to the greatest value."""
    return float(np.abs(values - values[0]).max() / np.abs(values).max())


@pytest.mark.parametrize("scheme", SCHEMES, ids=named)
def test_order_of_convergence(scheme: Scheme) -> None:
    system, start = double_pendulum()
    duration, counts = 0.4, (40, 80, 160)
    exact = integrators.integrate_index_one(system, start.q, start.v, [0.0, duration])
    runs = [integrate(scheme, system, start.q, start.v, duration=duration, steps=n) for n in counts]
    for found, reference in ((lambda run: run.q, exact.q), (lambda run: run.v, exact.v)):
        errors = [np.linalg.norm(found(run)[-1] - reference[-1]) for run in runs]
        orders = np.log2(np.divide(errors[:-1], errors[1:]))
        assert orders == pytest.approx(scheme.order, abs=0.15)
    assert [run.counters.steps for run in runs] == list(counts)
    for run in runs:
        assert np.abs([system.constraint_values(q) for q in run.q]).max() < 1e-13
        assert run.counters.iterations >= 2 * run.counters.steps
        assert run.counters.factorisations >= run.counters.iterations


@pytest.mark.parametrize("scheme", [s for s in SCHEMES if isinstance(s, OneStage)], ids=named)
def test_newtons_matrix_is_the_residuals_derivative(scheme: OneStage) -> None:
    system, start = double_pendulum()
    state = scheme.begin(system, start.q, start.v + 1.0)
    stage = scheme.stage(system, state, 0.1)
    rng = np.random.default_rng(3)
    n, m = len(start.q), len(system.constraint_names)
    at = np.concatenate((start.q + 0.2 * rng.standard_normal(n), rng.standard_normal(m)))

    def residual(x: Array) -> Array:
        return linearised(system, stage, x[:n], x[n:])[1]

    matrix, _ = linearised(system, stage, at[:n], at[n:])
    steps = 1e-6 * np.eye(n + m)
    difference = np.stack([(residual(at + e) - residual(at - e)) / 2e-6 for e in steps], axis=1)
    assert matrix == pytest.approx(difference, abs=1e-7)


@pytest.mark.parametrize("place", [1.5, 2.5])
@pytest.mark.parametrize("scheme", [EnergyMomentum(), ReducedEnergyMomentum()], ids=named)
def test_the_free_crane_keeps_energy_and_momentum(scheme: Scheme, place: float) -> None:
    system, start = multibody.assemble(multibody.rotary_crane(place=place))
    run = integrate(scheme, system, start.q, start.v, duration=1.0, steps=100)
    assert run.failure is None
    assert run.times[-1] == pytest.approx(1.0)
    assert spread(energies(system, run)) < 1e-10
    assert spread(moments(system, run)) < 1e-10


def test_reduction_changes_the_unknowns_not_the_motion() -> None:
    system, start = multibody.assemble(multibody.rotary_crane())
    full, reduced = (
        integrate(scheme, system, start.q, start.v, duration=0.5, steps=50)
        for scheme in (EnergyMomentum(), ReducedEnergyMomentum())
    )
    assert reduced.q == pytest.approx(full.q, abs=1e-10)
    assert reduced.multipliers[1:] == pytest.approx(
        full.multipliers[1:], abs=1e-8 * np.abs(full.multipliers).max()
    )


def test_the_extrapolated_crane_moves_as_the_index_one_form_says() -> None:
    system, start = multibody.assemble(multibody.rotary_crane())
    counts = (100, 150, 200, 300, 400, 600)
    ends = [
        integrate(EnergyMomentum(), system, start.q, start.v, duration=0.5, steps=n).q[-1]
        for n in counts
    ]
    limit, unsure = integrators.extrapolated(ends, counts)
    exact = integrators.integrate_index_one(system, start.q, start.v, [0.0, 0.5]).q[-1]
    assert limit == pytest.approx(exact, abs=1e-9)
    assert np.abs(limit - exact).max() < max(unsure.max(), 1e-10)


@pytest.mark.parametrize(
    ("scheme", "h", "steps"),
    [
        (EnergyMomentum(), 1e-3, 5000),
        (EnergyMomentum(), 1e-2, 2000),
        (ReducedEnergyMomentum(), 4e-3, 1000),
    ],
)
def test_a_spinning_top_keeps_energy_and_momentum_for_long(
    scheme: Scheme, h: float, steps: int
) -> None:
    system, start = top()
    run = integrate(scheme, system, start.q, start.v, duration=steps * h, steps=steps)
    assert run.failure is None
    assert spread(energies(system, run)) < 1e-10
    assert spread(moments(system, run)) < 1e-10


def test_the_variational_scheme_keeps_momentum_and_its_energy_does_not_drift() -> None:
    system, start = top()
    run = integrate(Variational(), system, start.q, start.v, duration=3.0, steps=3000)
    assert spread(moments(system, run)) < 1e-10
    away = np.abs(energies(system, run) - system.energy(start.q, start.v))
    assert 1e-8 < away[1500:].max() < 1.05 * away[:1500].max()
    rates = [system.constraint_jacobian(q) @ v for q, v in zip(run.q, run.v, strict=True)]
    assert np.abs(rates).max() < 1e-10


def test_damping_schemes_lose_energy() -> None:
    system, start = double_pendulum(effort=0.0)

    def lost(scheme: Scheme) -> float:
        run = integrate(scheme, system, start.q, start.v, duration=3.0, steps=300)
        energy = energies(system, run)
        return float(energy[0] - energy[-1])

    assert lost(ImplicitEuler()) > 1.0
    assert 1e-2 < lost(GeneralisedAlpha(radius=0.2)) < 0.5 * lost(ImplicitEuler())
    assert abs(lost(EnergyMomentum())) < 1e-9


def test_the_midpoint_rule_is_the_energy_momentum_scheme_of_quadratics() -> None:
    system, start = top()
    runs = [
        integrate(scheme, system, start.q, start.v, duration=0.1, steps=50)
        for scheme in (Midpoint(), EnergyMomentum())
    ]
    assert runs[0].q == pytest.approx(runs[1].q, abs=1e-12)
    system, start = double_pendulum()
    runs = [
        integrate(scheme, system, start.q, start.v, duration=1.0, steps=50)
        for scheme in (Midpoint(), EnergyMomentum())
    ]
    assert spread(energies(system, runs[0])) > 1e-6
    assert spread(energies(system, runs[1])) < 1e-12


def test_conditioning_as_the_step_shrinks() -> None:
    system, start = multibody.assemble(multibody.rotary_crane())
    rows = integrators.table(system, start.q, start.v, steps=(1e-2, 1e-3, 1e-4))
    for scheme in SCHEMES:
        mine = [row for row in rows if row.scheme == scheme.name]
        printed = np.array([row.printed for row in mine])
        scaled = np.array([row.scaled for row in mine])
        growth = 1.0 if scheme.name.startswith("reduced") else 1e3
        assert printed[1:] / printed[:-1] == pytest.approx(growth, rel=0.05)
        assert scaled[1:] / scaled[:-1] == pytest.approx(1.0, rel=0.05)
        assert mine[0].unknowns == (5 if growth == 1 else 79)


def test_a_rig_moves_freely_and_keeps_its_energy() -> None:
    rig = models.overhead_crane()
    equations = feedforward.equations_of(rig)
    system = multibody.of_equations(equations)
    values = {"trolley.position": 0.0, "load.x": 1.0, "load.z": -4.0}
    q, v = feedforward.redundant(equations, values, dict.fromkeys(values, 0.0))
    run = integrate(EnergyMomentum(), system, q, v, duration=1.0, steps=50)
    assert spread(energies(system, run)) < 1e-11
    exact = integrators.integrate_index_one(system, q, v, [0.0, 1.0])
    assert run.q[-1] == pytest.approx(exact.q[-1], abs=2e-2)


@pytest.mark.parametrize("scheme", SCHEMES, ids=named)
def test_a_failed_step_is_a_value(scheme: Scheme) -> None:
    system, start = top()
    far = integrate(scheme, system, start.q, 1e9 * start.v, duration=10.0, steps=10)
    assert isinstance(far.failure, Failure)
    assert far.failure.reason in ("not converged", "singular", "not finite")
    assert "\n" not in far.failure.detail
    assert len(far.times) == len(far.q) == len(far.v) == len(far.multipliers) < 11
    assert far.failure.time == far.times[-1]
    assert np.isfinite(far.q).all()
    assert np.isfinite(far.v).all()


def test_extrapolation_removes_the_even_powers() -> None:
    counts = (10, 15, 20)
    results = [[1 + 3 / n**2 - 7 / n**4, 2 + 1 / n**2] for n in counts]
    limit, unsure = integrators.extrapolated(results, counts)
    assert limit == pytest.approx([1, 2], abs=1e-14)
    # With two runs the first power alone is removed: what is left is 7 / (10^2 15^2).
    assert unsure == pytest.approx([7 / (10**2 * 15**2), 0], abs=1e-14)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"duration": 0.0}, "above 0"),
        ({"steps": 0}, "above 0"),
        ({"duration": np.nan}, "above 0"),
        ({"duration": "1"}, "above 0"),
        ({"steps": 1.5}, "above 0, the latter whole"),
        ({"q": [0.0]}, "q must be 12 finite numbers"),
        ({"v": [np.nan] * 12}, "v must be 12 finite numbers"),
        ({"v": "fast"}, "v must be numbers"),
        ({"v": [1.0] * 12}, "v is not consistent with constraint"),
        ({"q": [9.0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]}, "q is not consistent with constraint"),
    ],
)
def test_a_mistake_is_said_in_one_line(change: dict[str, object], message: str) -> None:
    system, start = top()
    given = {"q": start.q, "v": start.v, "duration": 1.0, "steps": 1} | change
    with pytest.raises(OptionError, match=message):
        integrate(Midpoint(), system, **given)
    with pytest.raises(OptionError, match="between 0 and 1"):
        GeneralisedAlpha(radius=1.5)
    with pytest.raises(OptionError, match="increasing numbers"):
        integrators.integrate_index_one(system, start.q, start.v, [0.0, 0.0])
    for option, text in (({"method": "RK4"}, "did you mean RK45"), ({"rtol": 0.0}, "rtol must")):
        with pytest.raises(OptionError, match=text):
            integrators.integrate_index_one(system, start.q, start.v, [0.0, 1.0], **option)


def test_a_singular_start_is_said_in_one_line() -> None:
    system, start = top()
    with pytest.raises(RigError, match="singular at the start"):
        integrate(Midpoint(), system, 0 * start.q, start.v, duration=1.0, steps=1)
