"""Generated equations against the printed ones, term by term at random states."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.feedforward import equations_of, redundant
from flatrig.models import Load, Rail, Rope, Sheave, Trolley


def relative(actual, desired):
    assert_allclose(actual, desired, rtol=1e-12, atol=1e-12 * np.abs(desired).max(initial=1e-300))


@pytest.fixture
def rng():
    return np.random.default_rng(5)


def test_overhead_crane_is_y_5_41_to_5_47(rng):
    m, m_t, inertia, r, g = 70.0, 12.0, 0.3, 0.2, 9.7
    rig = models.overhead_crane(
        load_mass=m, trolley_mass=m_t, winch_inertia=inertia, drum_radius=r, gravity=g
    )
    made = equations_of(rig)
    assert made.names == ("trolley.position", "hoist.length", "load.x", "load.z")
    relative(made.mass, np.diag([m_t, inertia / r**2, m, m]))  # (5.44)
    relative(made.force, [0, 0, 0, -m * g])  # (5.45)
    relative(made.input_constant, [[1, 0], [0, 1 / r], [0, 0], [0, 0]])  # (5.45)
    assert not made.input_linear.any()
    for s, length, x, z in rng.normal(size=(20, 4)):
        state = np.array([s, length, x, z])
        phi = 0.5 * ((x - s) ** 2 + z**2 - length**2)  # (5.42)
        relative(made.constraint_values(state), [phi])
        gradient = [[-(x - s), -length, x - s, z]]  # (5.43)
        relative(made.constraint_jacobian(state), gradient)


@pytest.mark.parametrize("build", [models.rotary_crane, models.rotary_crane_small])
def test_rotary_crane_reduces_to_y_5_71_to_5_77(rng, build):
    """The map (phi, s, l, x, y, z) -> q must turn the generated equations into the printed ones,
    with the signs of (5.137) for the Coriolis terms."""
    rig = build()
    m, m_t = rig.loads[0].mass, rig.trolleys[0].mass
    bridge, winch, r = rig.frames[0].inertia, rig.ropes[0].inertia_along, rig.ropes[0].drum_radius
    made = equations_of(rig)
    place = {name: i for i, name in enumerate(made.names)}
    span = made.constraint_names.index("hoist.1")
    for phi, s, length, x, y, z in rng.normal(size=(20, 6)):
        rate, speed = rng.normal(size=2)
        c, n = np.cos(phi), np.sin(phi)
        q = np.zeros(len(made.names))
        tangent = np.zeros((len(made.names), 6))
        bend = np.zeros(len(made.names))  # second derivative of the map along the rates
        for name, value, row, second in [
            ("bridge.cos", c, [-n, 0], -c * rate**2),
            ("bridge.sin", n, [c, 0], -n * rate**2),
            ("trolley.x", s * c, [-s * n, c], -s * c * rate**2 - 2 * n * rate * speed),
            ("trolley.y", s * n, [s * c, n], -s * n * rate**2 + 2 * c * rate * speed),
            ("trolley.position", s, [0, 1], 0),
        ]:
            q[place[name]], tangent[place[name], :2], bend[place[name]] = value, row, second
        for column, (name, value) in enumerate(
            [("hoist.length", length), ("load.x", x), ("load.y", y), ("load.z", z)], start=2
        ):
            q[place[name]], tangent[place[name], column] = value, 1.0
        values, slopes = made.constraint_values(q), made.constraint_jacobian(q)
        others = [k for k in range(len(values)) if k != span]
        assert_allclose(values[others], 0, atol=1e-14)  # the map solves all constraints but one
        assert_allclose(slopes[others] @ tangent, 0, atol=1e-13)
        mass = np.diag([bridge + m_t * s**2, m_t, winch, m, m, m])  # (5.74)
        relative(tangent.T @ made.mass @ tangent, mass)
        coriolis = [-2 * m_t * s * speed * rate, m_t * s * rate**2, 0]  # (5.137)
        force = tangent.T @ (made.force - made.mass @ bend)
        relative(force, [*coriolis, 0, 0, -m * rig.gravity])  # (5.75) corrected
        inputs = np.zeros((6, 3))
        inputs[:3] = np.diag([1, 1, 1 / r])  # (5.75)
        relative(tangent.T @ made.input_matrix(q), inputs)
        phi_value = 0.5 * ((x - s * c) ** 2 + (y - s * n) ** 2 + z**2 - length**2)
        relative(values[span], phi_value)  # (5.72)
        gradient = [(x * n - y * c) * s, s - x * c - y * n, -length, x - s * c, y - s * n, z]
        relative(slopes[span] @ tangent, gradient)  # (5.73)


def test_redundant_coordinates_satisfy_the_constraints_and_their_rates(rng):
    for rig in (models.make(name) for name in models.CATALOGUE):
        made = equations_of(rig)
        names = [name for name in rig.coordinate_names if not name.endswith(".length")]
        values = {name: rng.uniform(1, 2, size=7) for name in names}
        rates = {name: rng.normal(size=7) for name in names}
        q, v = redundant(made, values, rates)
        rounding = 1e-13 + 1e-15 * np.abs(q).max() ** 2
        # Where ends are drawn at random, a link has another length than its own.
        links = [link.name for link in rig.links]
        kept = [row for row, name in enumerate(made.constraint_names) if name not in links]
        assert_allclose(made.constraint_values(q)[:, kept], 0, atol=rounding)
        speed = np.einsum("nki,ni->nk", made.constraint_jacobian(q)[:, kept], v)
        assert_allclose(speed, 0, atol=rounding)


def test_redundant_coordinates_need_every_name():
    made = equations_of(models.overhead_crane())
    values = {"trolley.position": np.zeros(1), "load.x": np.zeros(1), "load.z": -np.ones(1)}
    with pytest.raises(models.RigError, match=r"coordinate load\.z is missing"):
        redundant(made, {name: values[name] for name in list(values)[:2]}, values)
    with pytest.raises(models.RigError, match=r"no coordinate 'load.y'; did you mean"):
        redundant(made, values, values | {"load.y": np.zeros(1)})


def test_a_sheave_is_never_the_winch():
    """A rope from the trolley around a pulley back to a sheave on the trolley, then to the load."""
    rig = models.Rig(
        name="around",
        dimensions=2,
        rails=(Rail("beam", (1.0, 0.0, 0.0)),),
        masses=(Trolley("trolley", 10.0, "beam"), Load("pulley", 5.0), Load("load", 20.0)),
        ropes=(
            Rope(
                "hoist",
                ("trolley", "pulley", "trolley", "load"),
                drum_radius=0.1,
                winch_inertia=0.1,
                sheaves=(Sheave("trolley", inertia=0.2, radius=0.1),),
            ),
        ),
        drives=(),
        outputs=(),
        home={"pulley": (1.0, 0.0, -2.0), "load": (0.0, 0.0, -4.0)},
    )
    made = equations_of(rig)
    place = {name: i for i, name in enumerate(made.names)}
    spans = [place["hoist.span1"], place["hoist.span2"]]
    # 1/2 J/r^2 (L - span1 - span2)'^2 couples the two spans.
    relative(made.mass[np.ix_(spans, spans)], np.full((2, 2), 20.0))


def test_accelerations_satisfy_the_equations_and_the_hidden_constraints(rng):
    rig = models.rotary_crane()
    made = equations_of(rig)
    names = [name for name in rig.coordinate_names if not name.endswith(".length")]
    values = {name: rng.uniform(1, 2, size=5) for name in names}
    q, v = redundant(made, values, {name: rng.normal(size=5) for name in names})
    inputs = rng.normal(size=(5, 3)) * 100
    acceleration, multipliers = made.accelerations(q, v, inputs)
    jacobian = made.constraint_jacobian(q)
    motion = acceleration @ made.mass - made.force
    motion += np.einsum("nki,nk->ni", jacobian, multipliers)
    motion -= np.einsum("nia,na->ni", made.input_matrix(q), inputs)
    assert_allclose(motion, 0, atol=1e-9)
    hidden = np.einsum("nki,ni->nk", jacobian, acceleration) + made.constraint_curvature(v)
    assert_allclose(hidden, 0, atol=1e-10)
