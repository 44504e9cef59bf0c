"""The schemes: orders of convergence, and how the unsuitable ones fail."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.feedforward import dae, rest_to_rest
from flatrig.feedforward.dae.multistep import Backward, advance
from flatrig.feedforward.dae.runge_kutta import radau
from flatrig.models.errors import OptionError
from flatrig.training.bench import trial_figures

# Smoother than the cranes need, so that no join disturbs the order.
PATHS = {
    "overhead_crane": rest_to_rest((0, -4), (5, -1), duration=6.0, order=10),
    "rotary_crane": rest_to_rest((5, 0, -5), (-2, 2, -2), duration=20.0, order=10),
}
STEPS = {"overhead_crane": 0.025, "rotary_crane": 0.05}
QUANTITIES = ("positions", "velocities", "inputs")


def errors(rig, reference, **options):
    found = feedforward.integrate(rig, reference, **options)
    assert found.failure is None
    truth = feedforward.solve(rig, reference, found.motion.times)
    return np.array(
        [np.abs(getattr(found.motion, q) - getattr(truth, q)).max() for q in QUANTITIES]
    )


def measured(name, formulation, scheme, step):
    rig, path = getattr(models, name)(), PATHS[name]
    options = {"formulation": formulation, "scheme": scheme}
    coarse, fine = (errors(rig, path, step=h, **options) for h in (step, step / 2))
    return np.log2(coarse / fine), coarse, fine


@pytest.mark.parametrize("scheme", dae.SCHEMES)
@pytest.mark.parametrize("name", PATHS)
def test_order_of_every_scheme(name, scheme):
    """Velocities and inputs have the scheme's order; positions are exact whatever the step, but
    not those of the midpoint rule, which has them in the middle of a step.
    """
    exact = scheme != "midpoint rule"
    step = STEPS[name] if exact else 3 * STEPS[name]  # it lets rounding errors grow
    order, coarse, fine = measured(name, "minimal extension", scheme, step)
    theory = dae.orders(dae.scheme(scheme), 3)
    assert math.isinf(theory.positions) == exact
    for i, expected in enumerate(theory):
        if math.isinf(expected):
            assert max(coarse[i], fine[i]) < 1e-10
        else:
            assert abs(order[i] - expected) < 0.15


@pytest.mark.parametrize("scheme", dae.SCHEMES)
@pytest.mark.parametrize("name", PATHS)
def test_order_of_coordinates_without_index_reduction(name, scheme):
    order, *_ = measured(name, "direct", scheme, 2 * STEPS[name])
    theory = dae.orders(dae.scheme(scheme), 5)
    assert abs(order[0] - theory.positions) < 0.15


@pytest.mark.parametrize(
    "formulation", [name for name in dae.FORMULATIONS if name.startswith(("proj", "min"))]
)
def test_every_formulation_of_index_3_has_the_same_order(formulation):
    if dae.why_not(models.overhead_crane(), formulation):
        pytest.skip("does not apply")
    order, _, fine = measured("overhead_crane", formulation, "BDF 2", 0.05)
    if dae.formulation(models.overhead_crane(), formulation).index == 1:
        assert fine.max() < 1e-9
    else:
        assert abs(order[2] - 2) < 0.15


def test_radau_does_not_converge_without_index_reduction():
    """Y 4.2: not even with three stages."""
    assert dae.orders(dae.scheme("Radau IIA 3"), 5).inputs == 0
    order, _, fine = measured("overhead_crane", "direct", "Radau IIA 3", 0.025)
    assert abs(order[2]) < 0.15
    assert fine[2] > 100


@pytest.mark.parametrize("scheme", ["trapezoidal rule", "midpoint rule"])
def test_midpoint_type_rules_oscillate(scheme):
    """Y 7: with the printed path the error of the inputs stays, whatever the step."""
    rig = models.overhead_crane()
    path = rest_to_rest((0, -4), (5, -1), duration=3.0, order=4)
    coarse, fine = (errors(rig, path, step=h, scheme=scheme)[2] for h in (0.05, 0.0125))
    assert 0.5 < fine / coarse < 2.0
    assert fine > 1000
    motion = feedforward.integrate(rig, path, step=0.0125, scheme=scheme).motion
    wrong = (motion.inputs - feedforward.solve(rig, path, motion.times).inputs)[-20:, 0]
    assert (np.sign(wrong[1:]) == -np.sign(wrong[:-1])).all()


@dataclass(frozen=True)
class Simple:
    """A scheme of one's own: implicit Euler that guesses the last state."""

    name: str = "my Euler"
    order: int = 1
    memory: int = 1
    nodes: tuple[float, ...] = (1.0,)
    estimates: bool = False

    def after(self, differentiations):
        return self.order if differentiations else math.inf

    def step(self, equations, newton, past, given, h):
        z, zd, _ = past[-1]
        return advance(equations, newton, z, given[:, 0], 1 / h, (-z / h, -zd / h))


def test_a_scheme_of_ones_own_is_added_in_one_line():
    """As CONTRIBUTING.md says."""
    dae.add_scheme(Simple())
    try:
        rig, path = models.overhead_crane(), PATHS["overhead_crane"]
        own, euler = (
            feedforward.integrate(rig, path, step=0.1, scheme=name).motion.inputs
            for name in ("my Euler", "implicit Euler")
        )
        assert np.abs(own - euler).max() < 1e-6
        with pytest.raises(OptionError, match="my Euler"):
            dae.scheme("my Eular")
        assert set(dae.SCHEMES) <= set(trial_figures.colours())
    finally:
        del dae.SCHEMES["my Euler"]


@pytest.mark.parametrize("order", range(1, 6))
def test_backward_differences_are_exact_for_polynomials(order):
    t = 2.0 - np.arange(order + 1)
    for degree in range(order + 1):
        slope = Backward(order).factors @ t**degree
        assert slope == pytest.approx(degree * 2.0 ** max(degree - 1, 0), abs=1e-12)
        past = 2.0 - np.arange(1, Backward(order).memory + 1)
        assert Backward(order).forward @ past**degree == pytest.approx(2.0**degree)


def test_radau_nodes_are_the_published_ones():
    """The stage weights A of Hairer and Wanner, table IV.5.5."""
    np.testing.assert_allclose(
        np.linalg.inv(radau(2).differences), [[5 / 12, -1 / 12], [3 / 4, 1 / 4]]
    )
    weights = np.linalg.inv(radau(3).differences)[-1]
    np.testing.assert_allclose(weights, [(16 - 6**0.5) / 36, (16 + 6**0.5) / 36, 1 / 9])
