"""The formulations: one set of equations, whatever coordinates and index."""

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.feedforward import dae
from flatrig.feedforward.dae.coordinates import coordinates_of
from flatrig.feedforward.dae.extension import Extension
from flatrig.feedforward.dae.formulation import prescribed
from flatrig.feedforward.dae.repeated import Repeated
from flatrig.feedforward.exact.problem import problem_of
from flatrig.models.errors import OptionError, RigError

RIGS = (
    "overhead_crane",
    "roped_overhead_crane",
    "rotary_crane",
    "navy_crane_2d",
    "navy_crane_3d",
    "cable_manipulator",
    "ship_crane",
)
PAIRS = [
    (name, formulation)
    for name in RIGS
    for formulation in dae.FORMULATIONS
    if not dae.why_not(getattr(models, name)(), formulation)
]


def default(name):
    rig = getattr(models, name)()
    return rig, feedforward.from_move(models.default_move(rig))


def exact_state(rig, reference, kind, time):
    """Unknowns of the direct formulation and two derivatives from the exact solution."""
    c = coordinates_of(problem_of(rig), kind)
    motion = feedforward.solve(rig, reference, [time])
    columns = dict(zip(motion.coordinate_names, range(100), strict=False))
    values, rates = (
        {name: table[0, columns[name]] for name in rig.coordinate_names}
        for table in (motion.positions, motion.velocities)
    )
    q, v = feedforward.redundant(c.equations, values, rates)
    a, _ = c.equations.accelerations(q[None], v[None], motion.inputs)
    forces = (motion.multipliers[0, list(c.multipliers)], motion.inputs[0])
    if kind == "redundant":
        x, xd, xdd = q, v, a[0]
    else:
        x, xd, xdd = (
            table[0, [columns[name] for name in c.names]]
            for table in (motion.positions, motion.velocities, motion.accelerations)
        )
    still = np.zeros(len(np.concatenate(forces)))
    return np.concatenate((x, *forces)), np.append(xd, still), np.append(xdd, still)


def test_a_formulation_of_ones_own_is_added_in_one_line():
    dae.FORMULATIONS["mine"] = lambda problem: Extension.of(problem, "minimal")
    try:
        rig, path = default("overhead_crane")
        own, known = (
            feedforward.integrate(rig, path, step=0.1, formulation=name).motion.inputs
            for name in ("mine", "minimal extension, minimal")
        )
        np.testing.assert_array_equal(own, known)
        with pytest.raises(OptionError, match="mine"):
            dae.formulation(rig, "mein")
    finally:
        del dae.FORMULATIONS["mine"]


@pytest.mark.parametrize(("name", "formulation"), PAIRS)
def test_jacobians_are_the_derivatives(name, formulation):
    rig, reference = default(name)
    equations = dae.formulation(rig, formulation)
    generator = np.random.default_rng(3)
    start = dae.start.at_rest(equations, reference)
    size, outputs = len(start), len(equations.mechanics.coordinates.servo)
    assert len(equations.names) == size
    state = [start, np.zeros(size), np.zeros(size)]
    state = [part + 0.1 * generator.normal(size=size) for part in state]
    given = generator.normal(size=(equations.derivatives + 1, outputs))
    _, jacobian = equations.evaluate(given, *state, True)
    for part in range(3):
        way = generator.normal(size=size)
        ahead, behind = list(state), list(state)
        ahead[part], behind[part] = state[part] + 1e-6 * way, state[part] - 1e-6 * way
        difference = (
            equations.evaluate(given, *ahead, False).residual
            - equations.evaluate(given, *behind, False).residual
        ) / 2e-6
        scale = 1.0 + np.abs(jacobian[part]).sum(axis=1)
        assert np.abs((difference - jacobian[part] @ way) / scale).max() < 1e-6


@pytest.mark.parametrize(
    ("name", "formulation"), [pair for pair in PAIRS if not pair[1].endswith(("twice", "times"))]
)
def test_exact_motion_satisfies_the_equations(name, formulation):
    rig, reference = default(name)
    equations = dae.formulation(rig, formulation)
    c = equations.mechanics.coordinates
    time = 0.37 * reference.duration
    z, zd, zdd = exact_state(rig, reference, c.kind, time)
    extra = len(equations.names) - len(z)
    if extra:
        hats = np.concatenate((zd[equations.replaced], zdd[equations.replaced]))
        z, zd, zdd = np.append(z, hats), *(np.append(part, 0.0 * hats) for part in (zd, zdd))
    given = prescribed(c, reference, [time], equations.derivatives)[:, 0]
    residual, jacobian = equations.evaluate(given, z, zd, zdd, True)
    scale = 1.0 + np.abs(jacobian[0]) @ np.abs(z)
    assert np.abs(residual / scale).max() < 1e-9


def test_sizes_are_the_printed_ones():
    """Y 5.37, remark 7: f + 3 a minimally extended and f + a projected equations, f = n - m."""
    for name, free, inputs in (("overhead_crane", 3, 2), ("rotary_crane", 5, 3)):
        rig = getattr(models, name)()
        assert len(dae.formulation(rig, "minimal extension, minimal").names) == free + 3 * inputs
        assert len(dae.formulation(rig, "projection, minimal").names) == free + inputs
    rotary = coordinates_of(problem_of(models.rotary_crane()), "dependent")
    assert rotary.names == (
        *("bridge.angle", "trolley.position", "hoist.length"),
        *("load.x", "load.y", "load.z"),
    )  # Y 4.98
    assert len(rotary.constraints) == 1


@pytest.mark.parametrize("name", ["overhead_crane", "rotary_crane", "navy_crane_2d"])
def test_extension_and_reduction_of_coordinates_commute(name):
    """Figure Y 5.1: extend and then reduce, or reduce and then extend."""
    rig, reference = default(name)
    redundant = Extension.of(problem_of(rig), "redundant")
    minimal = Extension.of(problem_of(rig), "minimal")
    generator = np.random.default_rng(5)
    k, _, b = minimal.mechanics.sizes
    z = dae.start.at_rest(minimal, reference)
    z, zd, zdd = (part + 0.2 * generator.normal(size=len(z)) for part in (z, 0.0 * z, 0.0 * z))
    given = np.zeros((3, len(minimal.replaced)))
    reduced_first = minimal.evaluate(given, z, zd, zdd, False).residual
    # The other road: Y 5.27, 5.30, 5.31 put into the extended redundant equations.
    rate, acceleration = minimal.rates(z, zd, zdd)

    def along(time):
        x = z[:k] + time * rate + 0.5 * time**2 * acceleration
        return minimal.mechanics.coordinates.place(x).q

    h = 1e-3
    values = [along(i * h) for i in (-2, -1, 0, 1, 2)]
    q, v = values[2], np.array([1, -8, 0, 8, -1]) @ values / (12 * h)
    a = np.array([-1, 16, -30, 16, -1]) @ values / (12 * h**2)
    multipliers = generator.normal(size=redundant.mechanics.sizes[1])
    dummies = redundant.replaced
    w = np.concatenate((q, multipliers, z[k : k + b], v[dummies], a[dummies]))
    wd, wdd = (np.append(part, np.zeros(len(w) - len(q))) for part in (v, a))
    extended_first = redundant.evaluate(given, w, wd, wdd, False).residual
    slope = minimal.mechanics.coordinates.place(z[:k]).slope
    outputs = len(reduced_first) - k
    expected = np.concatenate((slope.T @ extended_first[: len(q)], extended_first[-outputs:]))
    np.testing.assert_allclose(reduced_first, expected, rtol=1e-6, atol=1e-5)
    # And the map satisfies the constraints: no multiplier counts.
    middle = extended_first[len(q) : -outputs]
    np.testing.assert_allclose(middle, 0.0, atol=1e-9)


@pytest.mark.parametrize("name", ["overhead_crane", "navy_crane_2d", "navy_crane_3d"])
def test_applied_once_by_offsets_is_minimal_extension(name):
    rig, _ = default(name)
    once, extension = Repeated.of(problem_of(rig), 1), None
    extension = dae.formulation(rig, "minimal extension")
    generator = np.random.default_rng(7)
    size = len(extension.names)
    state = generator.normal(size=(3, size))
    marks = {"hat": "'", "tilde": "''"}
    names = [
        old if old in once.names else old.split()[0] + marks[old.split()[1]]
        for old in extension.names
    ]
    order = [names.index(new) for new in once.names]
    given = generator.normal(size=(3, len(extension.replaced)))
    one = once.evaluate(given, *state[:, order], False).residual
    other = extension.evaluate(given, *state, False).residual
    np.testing.assert_allclose(np.sort(one), np.sort(other), rtol=1e-12, atol=1e-12)


def test_extended_to_the_end_nothing_is_left_to_integrate():
    for name, formulation in (
        ("rotary_crane", "minimal extension, twice"),
        ("navy_crane_3d", "minimal extension, three times"),
    ):
        rig, _ = default(name)
        equations = dae.formulation(rig, formulation)
        assert equations.index == 1
        size = len(equations.names)
        given = np.zeros((equations.derivatives + 1, len(equations.mechanics.coordinates.servo)))
        _, jacobian = equations.evaluate(given, *np.ones((3, size)), True)
        assert not jacobian[1:].any()


def test_what_does_not_apply_is_refused_with_the_reason():
    manipulator = models.cable_manipulator()
    reason = dae.why_not(manipulator, "projection")
    assert "mass matrix is singular (no inertia along platform.d3z)" in reason
    with pytest.raises(RigError, match="mass matrix is singular"):
        dae.formulation(manipulator, "projection")
    navy = models.navy_crane_2d()
    assert "4 constraints contain its 3 outputs" in dae.why_not(navy, "projection, dependent")
    assert "its index is 5" in dae.why_not(navy, "minimal extension, three times")
    assert not dae.why_not(navy, "minimal extension")
    with pytest.raises(OptionError, match="did you mean projection"):
        dae.formulation(navy, "projektion")
