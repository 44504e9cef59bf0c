"""Equations generated for CABLEV against the printed ones, Y 6.3 and A.6, at random states.

Y has twist coordinates (v, omega) and z down, here there are nine director components and z is up:
directors and positions are mirrored by diag(1, 1, -1), and the map from Y's rates to the generated
ones, d_i' = omega x d_i, is used with its tangent and the part of its second derivative that is
quadratic in the rates, omega x (omega x d_i).
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.feedforward import equations_of, redundant

MIRROR = np.array([1.0, 1.0, -1.0])
ROBOT = ("gantry.position", *(f"trolley_{i}.position" for i in (1, 2, 3)))
ROBOT += tuple(f"hoist_{i}.length" for i in (1, 2, 3))


def relative(actual, desired):
    assert_allclose(actual, desired, rtol=1e-12, atol=1e-12 * np.abs(desired).max(initial=1e-300))


def hat(vector):
    """(6.75): hat(a) b = a x b."""
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def rotation(phi):
    """R(phi) of Bryant angles, Rx Ry Rz, from body to inertial frame (Y 6.71)."""
    (c1, c2, c3), (s1, s2, s3) = np.cos(phi), np.sin(phi)
    about_x = np.array([[1, 0, 0], [0, c1, -s1], [0, s1, c1]])
    about_y = np.array([[c2, 0, s2], [0, 1, 0], [-s2, 0, c2]])
    about_z = np.array([[c3, -s3, 0], [s3, c3, 0], [0, 0, 1]])
    return about_x @ about_y @ about_z


def angle_rates(phi):
    """H_omega (6.63)."""
    (c1, c2, _), (s1, s2, _) = np.cos(phi), np.sin(phi)
    rows = [[c2, s1 * s2, -c1 * s2], [0, c1 * c2, s1 * c2], [0, -s1, c1]]
    return np.array(rows) / c2


@pytest.fixture
def rng():
    return np.random.default_rng(9)


@pytest.fixture
def rig(rng):
    moments = dict(zip("xyz", rng.uniform(0.7, 1.2, 3), strict=True))
    winches = dict(zip("123", rng.uniform(0.3, 1.2, 3), strict=True))
    others = ("platform_mass", "platform_side", "rail_distance", "drum_radius", "gravity")
    return models.cable_manipulator(
        gantry_mass=9.0,
        trolley_mass=2.5,
        **{f"platform_inertia_{axis}": float(value) for axis, value in moments.items()},
        **{f"winch_inertia_{i}": float(value) for i, value in winches.items()},
        **{name: float(rng.uniform(0.3, 1.2)) for name in others},
    )


class State:
    """A random state in Y's coordinates, and the generated ones with tangent and bend there."""

    def __init__(self, made, rng):
        self.p, self.r, self.phi = rng.normal(size=7), rng.normal(size=3), rng.uniform(-1, 1, 3)
        self.v, self.omega = rng.normal(size=(2, 3))
        self.R = rotation(self.phi)
        at = {name: k for k, name in enumerate(made.names)}
        self.q, self.bend = np.zeros((2, len(at)))
        self.tangent = np.zeros((len(at), 13))  # columns p', v, omega
        for column, name in enumerate(ROBOT):
            self.q[at[name]], self.tangent[at[name], column] = self.p[column], 1.0
        place = [at[f"platform.{axis}"] for axis in "xyz"]
        self.q[place], self.tangent[place, 7:10] = MIRROR * self.r, np.diag(MIRROR)
        for i in range(3):
            # Seen in the mirror the platform's own z axis turns over too.
            flip, director = MIRROR[i] * MIRROR, self.R[:, i]
            rows = [at[f"platform.d{i + 1}{axis}"] for axis in "xyz"]
            self.q[rows] = flip * director
            self.tangent[rows, 10:] = -flip[:, None] * hat(director)
            self.bend[rows] = flip * (hat(self.omega) @ hat(self.omega) @ director)
        self.directors = [k for name, k in at.items() if name.startswith("platform.d")]


@pytest.fixture
def states(rig, rng):
    made = equations_of(rig)
    return [State(made, rng) for _ in range(20)]


def test_equations_of_motion_are_y_6_85_to_6_91(rig, states):
    """Newton and Euler for the platform, J = R J^p R^T throughout.

    Misprints: (6.90) and A.6 write the gyroscopic torque omega x J omega by components that hold
    in the body's principal axes, beside omega and G_s in the inertial frame; and the first of them
    is (J_x - J_y) omega_y omega_z in A.6, where (6.90) has (J_z - J_y) rightly.  The directors have
    constant masses and need no such term: it is their M times omega x (omega x d).
    """
    made = equations_of(rig)
    platform, (gantry,), trolleys = rig.platforms[0], rig.frames, rig.trolleys
    moving = gantry.inertia + sum(trolley.mass for trolley in trolleys)
    robot = [moving, *(trolley.mass for trolley in trolleys)]
    robot += [rope.winch_inertia / rope.drum_radius**2 for rope in rig.ropes]
    for state in states:
        inertia = state.R @ np.diag(platform.inertia) @ state.R.T
        mass = np.zeros((13, 13))
        mass[:7, :7] = np.diag(robot)  # (6.86)
        mass[7:10, 7:10], mass[10:, 10:] = platform.mass * np.eye(3), inertia  # (6.89)
        relative(state.tangent.T @ made.mass @ state.tangent, mass)
        force = np.zeros(13)
        force[9] = platform.mass * rig.gravity  # (6.90), z down
        force[10:] = -np.cross(state.omega, inertia @ state.omega)  # (6.89)
        relative(state.tangent.T @ (made.force - made.mass @ state.bend), force)
        inputs = np.zeros((13, 7))
        inputs[:7] = np.diag([1, 1, 1, 1, *(1 / rope.drum_radius for rope in rig.ropes)])  # (6.86)
        relative(state.tangent.T @ made.input_matrix(state.q), inputs)


def test_cables_are_y_6_68_to_6_79(rig, states):
    """Misprint: (6.73) has hat(d_i) for the rate of d_i."""
    made = equations_of(rig)
    side = rig.anchors[1].position[1] * 2
    l2 = rig.rails[1].origin[1]
    corners = side * np.array(
        [[3**0.5 / 3, 0, 0], [-(3**0.5) / 6, 0.5, 0], [-(3**0.5) / 6, -0.5, 0]]
    )
    hoists = [made.constraint_names.index(f"hoist_{i}.1") for i in (1, 2, 3)]
    for state in states:
        slopes = made.constraint_jacobian(state.q)[hoists] @ state.tangent
        values = made.constraint_values(state.q)[hoists]
        for i, offset in enumerate((0, l2, -l2)):
            d = state.R @ corners[i]  # (6.70), (6.71)
            c = state.r + d - [state.p[1 + i], state.p[0] + offset, 0]  # (6.69)
            relative(values[i], 0.5 * (c @ c - state.p[4 + i] ** 2))  # (6.68)
            robot = np.zeros(7)
            robot[[0, 1 + i, 4 + i]] = -c[1], -c[0], -state.p[4 + i]  # (6.79)
            relative(slopes[i], [*robot, *c, *(-c @ hat(d))])  # (6.78)


def test_directors_satisfy_their_constraints_along_the_map(rig, states):
    """So that those six of the generated equations do not appear in the printed ones."""
    made = equations_of(rig)
    own = [k for k, name in enumerate(made.constraint_names) if name.startswith("platform.")]
    assert len(own) == 6
    assert len(made.constraint_names) == 9
    for state in states:
        slopes = made.constraint_jacobian(state.q)[own]
        assert_allclose(made.constraint_values(state.q)[own], 0, atol=1e-14)
        assert_allclose(slopes @ state.tangent, 0, atol=1e-14)
        rate = state.tangent[:, 10:] @ state.omega
        hidden = slopes @ state.bend + made.constraint_curvature(rate)[own]
        assert_allclose(hidden, 0, atol=1e-12)


def test_bryant_angles_and_their_rates_are_y_6_60_to_6_63(rig, states):
    """The mirror turns alpha, beta and z over."""
    made = equations_of(rig)
    angles, names = ("alpha", "beta", "gamma"), (*ROBOT[:4], *(f"platform.{a}" for a in "xyz"))
    names += tuple(f"platform.{angle}" for angle in angles)
    turned = np.array([-1.0, -1.0, 1.0])
    for state in states:
        values = [*state.p[:4], *(MIRROR * state.r), *(turned * state.phi)]
        turning = turned * (angle_rates(state.phi) @ state.omega)  # (6.62)
        rates = [*np.ones(4), *(MIRROR * state.v), *turning]
        q, v = redundant(
            made, dict(zip(names, values, strict=True)), dict(zip(names, rates, strict=True))
        )
        assert_allclose(q[state.directors], state.q[state.directors], atol=1e-14)
        moving = state.tangent[state.directors, 10:] @ state.omega
        assert_allclose(v[state.directors], moving, atol=1e-13)


def test_spread_is_y_6_81(rig):
    """At home it is b = sqrt(3) l2; Y's output is the difference, 0."""
    (spread,) = rig.combinations
    assert spread.of == ROBOT[1:4]
    assert spread.factors == (1, -0.5, -0.5)
    home = [rig.home[name.removesuffix(".position")] for name in spread.of]
    assert np.dot(spread.factors, home) == pytest.approx(3**0.5 * rig.rails[1].origin[1], rel=1e-12)
