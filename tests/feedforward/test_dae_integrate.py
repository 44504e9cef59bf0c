"""Whole integrations: the sources' steps, results, failures."""

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.feedforward import dae, rest_to_rest
from flatrig.models.errors import OptionError, PathError

QUANTITIES = ("positions", "velocities", "inputs")


def default(name, **options):
    rig = getattr(models, name)(**options)
    return rig, feedforward.from_move(models.default_move(rig))


def errors(rig, reference, found):
    truth = feedforward.solve(rig, reference, found.motion.times)
    return [np.abs(getattr(found.motion, q) - getattr(truth, q)).max() for q in QUANTITIES]


@pytest.mark.parametrize(
    ("name", "steps"),
    [
        ("overhead_crane", (0.1, 0.01)),
        ("rotary_crane", (1.0, 0.1)),
        ("navy_crane_2d", (0.1, 0.01)),
    ],
)
def test_at_the_printed_steps(name, steps):
    """Implicit Euler, minimal extension: coordinates do not depend on the step, inputs do."""
    rig, path = default(name)
    coarse, fine = (
        errors(rig, path, feedforward.integrate(rig, path, step=step)) for step in steps
    )
    assert max(coarse[0], fine[0]) < 1e-11
    assert 5.0 < coarse[2] / fine[2] < 11.0
    assert 5.0 < coarse[1] / fine[1] < 11.0


def test_massless_pulley_leaves_its_singular_start():
    """Y 6.1.1: the coordinates of the planar crane do not depend on the step."""
    rig = models.navy_crane_2d(pulley_mass=0.0)
    path = feedforward.from_move(models.default_move(models.navy_crane_2d(pulley_mass=0)))
    for step in (0.1, 0.02):
        found = feedforward.integrate(rig, path, step=step)
        assert found.failure is None
        places, _, inputs = errors(rig, path, found)
        assert places < 1e-5
        assert inputs < 30 * step


@pytest.mark.parametrize("formulation", dae.FORMULATIONS)
@pytest.mark.parametrize("name", ["rotary_crane", "cable_manipulator"])
def test_result_is_a_motion_as_of_solve(name, formulation):
    rig, path = default(name)
    if dae.why_not(rig, formulation):
        pytest.skip("does not apply")
    found = feedforward.integrate(rig, path, step=0.1, formulation=formulation, scheme="BDF 2")
    truth = feedforward.solve(rig, path, found.motion.times)
    assert found.motion.coordinate_names == truth.coordinate_names
    for quantity in ("positions", "velocities", "accelerations", "tensions", "inputs"):
        one, other = getattr(found.motion, quantity), getattr(truth, quantity)
        assert one.shape == other.shape
        assert np.abs(one - other).max() < 0.1 * (1.0 + np.abs(other).max())
    assert found.motion.times[-1] == pytest.approx(path.duration)


def test_counts_what_it_cost():
    rig, path = default("overhead_crane")
    found = feedforward.integrate(rig, path, step=0.1)
    cost = found.counters
    assert cost.steps == len(found.motion.times) - 1 == 30
    assert cost.rejected == 0
    assert cost.evaluations == cost.iterations >= cost.steps
    assert 0 < cost.factorisations == cost.jacobians < cost.iterations
    stages = feedforward.integrate(rig, path, step=0.1, scheme="Radau IIA 3").counters
    assert stages.evaluations == 3 * stages.iterations


def test_last_step_ends_at_the_end_or_after_it():
    rig, path = default("overhead_crane")
    times = feedforward.integrate(rig, path, step=0.7).motion.times
    np.testing.assert_allclose(times, 0.7 * np.arange(6))


def test_tolerance_controls_the_error():
    rig, path = default("overhead_crane")
    found = [
        feedforward.integrate(rig, path, step=0.01, scheme="Radau IIA 3", tolerance=tolerance)
        for tolerance in (1e-3, 1e-5)
    ]
    assert [one.failure for one in found] == [None, None]
    coarse, fine = (errors(rig, path, one)[1] for one in found)
    assert fine < 0.15 * coarse
    assert found[0].counters.steps < found[1].counters.steps < 300
    steps = np.diff(found[1].motion.times)
    assert steps.max() > 3 * steps.min()
    assert found[1].motion.times[-1] == path.duration


def test_failure_is_a_value():
    """With Radau and the index left at 5 no step is short enough: that ends the motion."""
    rig, path = default("overhead_crane")
    found = feedforward.integrate(
        rig, path, step=0.01, formulation="direct", scheme="Radau IIA 3", tolerance=1e-5
    )
    assert found.failure is not None
    assert found.failure.time == found.motion.times[-1] < path.duration
    assert str(found.failure).startswith("no step of ")
    assert found.counters.rejected > 5
    assert np.isfinite(found.motion.inputs).all()


def test_singular_equations_are_a_failure():
    """A massless pulley straight below its winch: minimal coordinates find no way from there."""
    rig = models.navy_crane_2d(pulley_mass=0.0)
    path = feedforward.from_move(models.default_move(models.navy_crane_2d(pulley_mass=0)))
    found = feedforward.integrate(
        rig, path, step=0.1, formulation="projection, minimal", scheme="implicit Euler"
    )
    assert found.failure is not None
    assert "singular" in found.failure.reason
    assert found.motion.times.tolist() == [0.0]


@pytest.mark.parametrize("formulation", dae.FORMULATIONS)
def test_no_rope_passes_through_its_winch(formulation):
    """The equations would go on with a rope of negative length."""
    rig = models.overhead_crane()
    if dae.why_not(rig, formulation):
        pytest.skip("does not apply")
    path = rest_to_rest((0, -4), (0, 4), duration=3.0, order=4)  # through the trolley at 1.5 s
    found = feedforward.integrate(rig, path, step=0.07, formulation=formulation)
    assert "hoist would pass through its own winch at trolley" in found.failure.reason
    assert found.failure.time == found.motion.times[-1] == pytest.approx(1.47)
    assert found.counters.steps == len(found.motion.times) - 1


def test_no_trolley_leaves_its_rail():
    rig = models.overhead_crane()
    path = rest_to_rest((0, -4), (20, -1), duration=6.0, order=4)
    found = feedforward.integrate(rig, path, step=0.1)
    assert "trolley is at 8.172 m, rail beam goes from -2 m to 8 m" in found.failure.reason
    trolley = found.motion.positions[:, found.motion.column("trolley.position")]
    assert 7.0 < trolley[-1] == trolley.max() < 8.0


def test_start_is_the_equilibrium():
    rig, path = default("navy_crane_2d")
    for formulation in ("direct", "minimal extension, minimal", "minimal extension, twice"):
        found = feedforward.integrate(rig, path, step=1.0, formulation=formulation)
        np.testing.assert_allclose(found.motion.inputs[0], [-49.05, -98.1, -129.77], atol=5e-3)
        assert not found.motion.velocities[0].any()


def test_mistakes_get_one_line():
    rig, path = default("overhead_crane")
    with pytest.raises(OptionError, match="did you mean implicit Euler"):
        feedforward.integrate(rig, path, step=0.1, scheme="implicit euler")
    with pytest.raises(OptionError, match="did you mean minimal extension"):
        feedforward.integrate(rig, path, step=0.1, formulation="minimal extention")
    for step in (0.0, -1.0, float("nan"), float("inf"), 1e-12, "0.1", None, True):
        with pytest.raises(OptionError, match="step is"):
            feedforward.integrate(rig, path, step=step)
    for value in (2.0, "1e-3", float("nan")):
        with pytest.raises(OptionError, match=r"tolerance is .*between 0 and 1"):
            feedforward.integrate(rig, path, step=0.1, scheme="Radau IIA 3", tolerance=value)
    for name in (None, 3, ["BDF 2"]):
        with pytest.raises(OptionError, match="there is no scheme"):
            feedforward.integrate(rig, path, step=0.1, scheme=name)
        with pytest.raises(OptionError, match="there is no formulation"):
            feedforward.integrate(rig, path, step=0.1, formulation=name)
    with pytest.raises(PathError, match="is a Move, it must be a path"):
        feedforward.integrate(rig, models.default_move(rig), step=0.1)
    with pytest.raises(OptionError, match=r"no error estimate.*Radau IIA 3"):
        feedforward.integrate(rig, path, step=0.1, scheme="BDF 3", tolerance=1e-3)
    with pytest.raises(PathError, match="3 columns"):
        feedforward.integrate(rig, rest_to_rest((0, 0, -4), (1, 0, -4), 3.0), step=0.1)
