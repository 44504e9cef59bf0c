"""The energy function of PD on encoders, against the source's and against what it must obey."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.feedforward import Regulator, equations_of, redundant
from flatrig.feedforward.stability.rivals import rivals
from flatrig.models.errors import OptionError
from flatrig.models.friction import Friction
from flatrig.training.reproduce import kiss_crane

G = 9.81
GAINS = {
    "overhead_crane": (5.0, -4.0),
    "rotary_crane": (2.0, 4.0, -5.0),
    "cantilever_crane": (2.0, 4.0, -5.0),
    "gantry_crane": (4.0, 2.0, -5.0),
    "navy_crane_2d": (-7.0, -17.5, -10.5),
}


def regulator_of(name):
    rig = models.make(name)
    drives = np.arange(1, len(rig.drives) + 1)
    set_point = GAINS.get(name, models.default_move(name).start)
    return Regulator(rig, set_point, tuple(100.0 * drives), tuple(50.0 * drives))


def random_states(regulator, count=20):
    draw = np.random.default_rng(3)
    rest = regulator.rest_values
    values = {name: at + draw.uniform(-0.5, 0.5, count) for name, at in rest.items()}
    return values, {name: draw.uniform(-1, 1, count) for name in rest}


def planar_places(gamma, tagline, hoist):
    """Pulley and load of the planar Navy crane from P (K 3.59 to 3.64)."""
    alpha, boom = kiss_crane.ANGLE, kiss_crane.BOOM
    beta = np.arcsin(tagline * np.sin(gamma) / boom)
    upper = boom * np.sin(gamma - beta) / np.sin(gamma)
    theta = np.pi - 2 * gamma - alpha + beta
    pulley = -upper * np.sin(alpha - beta), -upper * np.cos(alpha - beta)
    load = pulley[0] + (hoist - upper) * np.sin(theta), pulley[1] - (hoist - upper) * np.cos(theta)
    return [*pulley, *load]


def test_planar_navy_crane_has_the_energy_of_kiss():
    """K 3.64, in K's coordinates gamma, L1 and R, with the equilibrium of K 3.60."""
    regulator = kiss_crane.planar_regulator()
    (k1, k2), m = regulator.stiffness, 0.2
    x, z = kiss_crane.PLANAR_TARGET
    beta, gamma = kiss_crane.planar_angles(x)
    t1, t2 = 2 * m * G * np.cos(gamma), m * G
    l1 = kiss_crane.BOOM * np.sin(beta) / np.sin(gamma)
    upper = kiss_crane.BOOM * np.sin(gamma - beta) / np.sin(gamma)
    r = upper * (1 - np.cos(kiss_crane.ANGLE - beta)) - z
    assert_allclose(regulator.rest.tensions[0], [t1, t2], rtol=1e-9)

    draw = np.random.default_rng(0)
    q = np.array([gamma, l1, r])[:, None] + draw.uniform(-0.05, 0.05, (3, 20))
    v = draw.uniform(-0.3, 0.3, (3, 20))
    step = np.array(planar_places(*(q + 1e-30j * v)))  # exact derivatives
    names = ("pulley.x", "pulley.z", "load.x", "load.z")
    values = dict(zip(names, step.real, strict=True))
    rates = dict(zip(names, step.imag / 1e-30, strict=True))
    kinetic = m * (rates["load.x"] ** 2 + rates["load.z"] ** 2)
    kinetic = 0.5 * (kinetic + kiss_crane.ALONG * (v[1] ** 2 + v[2] ** 2))
    control = 0.5 * k1 * (q[1] - l1) ** 2 + t1 * q[1] + 0.5 * k2 * (q[2] - r) ** 2 + t2 * q[2]
    zero = m * G * z + t1 * l1 + t2 * r
    expected = kinetic + m * G * values["load.z"] + control - zero
    assert_allclose(regulator.energy(values, rates), expected, rtol=0, atol=1e-12)
    dissipation = 20.0 * v[1] ** 2 + 10.0 * v[2] ** 2  # K lemma 3
    assert_allclose(regulator.dissipation(values, rates), dissipation, rtol=1e-9)


def test_gantry_crane_has_the_energy_of_kiss():
    """K 3.79 with 3.50: winches at x = 0 (hoist) and x = 8 (pull)."""
    regulator = regulator_of("gantry_crane")
    values, rates = random_states(regulator)
    x, y, z = (values[f"load.{axis}"] for axis in "xyz")
    vx, vy, vz = (rates[f"load.{axis}"] for axis in "xyz")
    s, vs = values["trolley.position"], rates["trolley.position"]
    p, vp = values["gantry.position"], rates["gantry.position"]
    lower = np.sqrt((x - s) ** 2 + (y - p) ** 2 + z**2)
    lengths = np.array([8 - s, s + lower])
    lower_rate = ((x - s) * (vx - vs) + (y - p) * (vy - vp) + z * vz) / lower
    speeds = np.array([-vs, vs + lower_rate])
    kinetic = 100 * (vx**2 + vy**2 + vz**2) + 10 * (vs**2 + vp**2) + 100 * vp**2
    kinetic = 0.5 * (kinetic + 10 * (speeds**2).sum(axis=0))
    away = lengths - np.array([[4.0], [9.0]])
    control = 0.5 * (100 * away[0] ** 2 + 200 * away[1] ** 2 + 300 * (p - 2) ** 2)
    control += 981 * away.sum(axis=0)
    expected = kinetic + 981 * (z + 5) + control
    assert_allclose(regulator.energy(values, rates), expected, rtol=1e-12)


@pytest.mark.parametrize("name", GAINS)
def test_energy_falls_as_the_dampers_dissipate(name):
    """K lemmas 3, 7, 12, 17, with accelerations from the equations of motion."""
    regulator = regulator_of(name)
    equations = equations_of(regulator.rig)
    values, rates = random_states(regulator)
    q, v = redundant(equations, values, rates)
    inputs = regulator.inputs(values, rates)
    a, _ = equations.accelerations(q, v, inputs)
    # dW/dt = q'.(M q'' - f) + y'.(k (y - y*) - F), and k (y - y*) - F = -force - d y'
    power = np.einsum("nia,na,ni->n", equations.input_matrix(q), inputs, v)
    slope = np.einsum("ni,ij,nj->n", v, equations.mass, a) - v @ equations.force - power
    slope -= regulator.dissipation(values, rates)
    assert_allclose(slope, -regulator.dissipation(values, rates), rtol=1e-9)
    # and W itself has that slope: a small step along the motion
    h = 1e-5
    ahead, behind = (_energy_of(regulator, equations, q, v, a, side * h) for side in (1, -1))
    assert_allclose((ahead - behind) / (2 * h), slope, rtol=1e-5, atol=1e-3)


def _energy_of(regulator, equations, q, v, a, h):
    """W a time h later, from redundant coordinates."""
    place, speed = q + h * v + 0.5 * h**2 * a, v + h * a
    values, rates = {}, {}
    for name, cos, sin in equations.turning:
        values[name] = np.arctan2(place[:, sin], place[:, cos])
        rates[name] = place[:, cos] * speed[:, sin] - place[:, sin] * speed[:, cos]
    for name in regulator.rest_values:
        if name in equations.names:
            column = equations.names.index(name)
            values[name], rates[name] = place[:, column], speed[:, column]
    return regulator.energy(values, rates)


@pytest.mark.parametrize("name", [*GAINS, "cable_manipulator"])
def test_energy_is_least_at_the_set_point(name):
    regulator = regulator_of(name)
    still = dict.fromkeys(regulator.rest_values, np.zeros(1))
    rest = {key: np.atleast_1d(value) for key, value in regulator.rest_values.items()}
    assert_allclose(regulator.energy(rest, still), 0.0, atol=1e-9)
    assert_allclose(regulator.inputs(rest, still), regulator.rest.inputs, rtol=1e-9, atol=1e-9)
    values, _ = random_states(regulator)
    assert (regulator.energy(values, dict.fromkeys(rest, np.zeros(20))) > 0).all()


def test_the_set_point_by_other_angles_is_no_other_rest():
    """alpha + pi, pi - beta, gamma + pi turn a platform as alpha, beta, gamma do."""
    levels = rivals(regulator_of("cable_manipulator"), starts=6)
    assert (levels > 1.0).all()


def test_the_other_rest_is_the_load_standing_on_its_rope():
    """K lemmas 8 and 13: the load above, every tension reversed."""
    overhead = Regulator(models.overhead_crane(), (5.0, -4.0), (180.0, 520.0), (1.0, 1.0))
    height = 4.0 - 2 * 981 / 520
    assert_allclose(rivals(overhead), [981 * (4.0 + height)], rtol=1e-6)
    gantry = Regulator(models.gantry_crane(), (4.0, 2.0, -5.0), (1e3, 1.5e3, 130.0), (1.0,) * 3)
    height = (9.0 - 2 * 981 / 1.5e3) - (4.0 + 2 * 981 / 1e3)
    levels = rivals(gantry)
    assert np.isclose(levels, 981 * (5.0 + height), rtol=1e-6).any()


@pytest.mark.parametrize("gains", [(1.0,), (1.0, -1.0), (1.0, np.nan), ("stiff", 1.0)])
def test_wrong_gains_are_refused(gains):
    with pytest.raises(OptionError, match=r"stiffness is .* must be 2 numbers >= 0"):
        Regulator(models.overhead_crane(), (5.0, -4.0), gains, (1.0, 1.0))


def test_friction_has_its_three_parts():
    friction = Friction(coulomb=2.0, viscous=3.0, static=5.0, stribeck_velocity=0.1, width=1e-3)
    assert friction.force(0.0) == 0.0
    assert_allclose(friction.force(1.0), 2.0 + 3.0)  # far beyond the Stribeck velocity
    assert_allclose(friction.force([-1.0]), [-5.0])
    assert_allclose(friction.dry([0.0, 0.1]), [5.0, 2.0 + 3.0 / np.e])
    rising = friction.force([0.01, 0.1])
    assert rising[1] < rising[0]  # K: negative viscous friction


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"coulomb": -1.0}, "coulomb is -1.0, it must be >= 0"),
        ({"coulomb": 1.0, "width": 0.0}, "width is 0.0, it must be > 0"),
        ({"coulomb": 1.0, "static": 0.5}, "static is 0.5 N, it must be >= coulomb, 1 N"),
        ({"coulomb": np.nan}, "coulomb is nan"),
        ({"coulomb": "much"}, "coulomb is 'much', it must be >= 0"),
    ],
)
def test_wrong_friction_is_refused(given, said):
    with pytest.raises(OptionError, match=said):
        Friction(**given)
