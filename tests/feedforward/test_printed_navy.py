"""Equations generated for the Navy cranes against the printed ones at random states.

A test states the printed coordinates, matrices and gradients of the constraints; a constant linear
map takes the printed coordinates to the generated ones.  The sources write M q'' = f + B u + sum
multiplier grad(Phi), so that a printed column of G or H is a gradient; here the sum has the other
sign, and a multiplier is a rope's tension over its length.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import null_space

from flatrig import models
from flatrig.feedforward import analyse, equations_of, redundant

STATES = 20


def relative(actual, desired):
    assert_allclose(actual, desired, rtol=1e-12, atol=1e-12 * np.abs(desired).max(initial=1e-300))


@pytest.fixture
def rng():
    return np.random.default_rng(6)


@pytest.fixture
def drawn(rng):
    """A function of a rig's function: the rig with random numbers, and those numbers."""

    def draw(build, *names):
        values = {name: float(rng.uniform(0.3, 1.3)) for name in (*names, "gravity")}
        return build(**values), tuple(values.values())

    return draw


def map_to(made, columns):
    """Matrix (n, columns) whose columns put a printed coordinate into a named one, by a factor."""
    matrix = np.zeros((len(made.names), len(columns)))
    for k, (name, factor) in enumerate(columns.items()):
        matrix[made.names.index(name), k] = factor
    return matrix


def same_terms(made, to_q, mass, force, inputs, state):
    """Mass matrix, gravity and inputs at one state of the printed coordinates."""
    relative(to_q.T @ made.mass @ to_q, mass)
    relative(to_q.T @ made.force, force)
    relative(to_q.T @ made.input_matrix(to_q @ state), inputs)


def same_constraints(made, to_q, state, printed, scale=None):
    """Values and gradients, `printed` by name; the generated one times `scale` is the printed."""
    values, slopes = made.constraint_values(to_q @ state), made.constraint_jacobian(to_q @ state)
    assert set(printed) == set(made.constraint_names)
    for k, name in enumerate(made.constraint_names):
        factor = (scale or {}).get(name, 1.0)
        value, gradient = printed[name]
        relative(factor * values[k], value)
        relative(factor * slopes[k] @ to_q, gradient)


def diagonal_of(*entries):
    return np.diag(np.array(entries, dtype=float))


def test_planar_navy_crane_without_pulley_mass_is_y_6_1_to_6_8(rng, drawn):
    """Also Y A.2."""

    def build(**values):
        return models.navy_crane_2d(pulley_mass=0, **values)

    names = ("load_mass", "winch_inertia", "drum_radius", "boom_angle", "tagline_distance")
    rig, (m, inertia, r, alpha, l, g) = drawn(build, *names)  # noqa: E741
    made = equations_of(rig)
    names = ("tagline.length", "hoist.length", "hoist.span1", "pulley.x", "pulley.z")
    to_q = map_to(made, dict.fromkeys((*names, "load.x", "load.z"), 1.0))
    mass = diagonal_of(inertia / r**2, inertia / r**2, 0, 0, 0, m, m)  # (6.6)
    force = [0, 0, 0, 0, 0, 0, -m * g]  # (6.7)
    inputs = np.eye(7)[:, :2] / r
    for state in rng.normal(size=(STATES, 7)):
        same_terms(made, to_q, mass, force, inputs, state)
        l1, l2, l0, x0, z0, x, z = state
        ax, az = x0 + l * np.sin(alpha), z0 + l * np.cos(alpha)
        printed = {  # (6.3), (6.4), (6.8)
            "tagline.1": (0.5 * (ax**2 + az**2 - l1**2), [-l1, 0, 0, ax, az, 0, 0]),
            "hoist.1": (0.5 * (x0**2 + z0**2 - l0**2), [0, 0, -l0, x0, z0, 0, 0]),
            "hoist.2": (
                0.5 * ((x - x0) ** 2 + (z - z0) ** 2 - (l2 - l0) ** 2),
                [0, l0 - l2, l2 - l0, x0 - x, z0 - z, x - x0, z - z0],
            ),
        }
        same_constraints(made, to_q, state, printed)


def test_planar_navy_crane_is_y_6_13_to_6_20(rng, drawn):
    """Also Y A.3 and 6.21."""
    names = ("load_mass", "pulley_mass", "winch_inertia", "drum_radius", "boom_angle")
    names += ("tagline_distance", "suspension_distance")
    rig, (m, m0, inertia, r, alpha, l, s, g) = drawn(models.navy_crane_2d, *names)  # noqa: E741
    made = equations_of(rig)
    names = ("tagline.length", "hoist.length", "suspension.length", "hoist.span1", "pulley.x")
    to_q = map_to(made, dict.fromkeys((*names, "load.x", "load.z", "pulley.z"), 1.0))
    winch = inertia / r**2
    mass = diagonal_of(winch, winch, winch, 0, m0, m, m, m0)  # (6.17)
    force = [0, 0, 0, 0, 0, 0, -m * g, -m0 * g]  # (6.18)
    inputs = np.eye(8)[:, :3] / r
    for state in rng.normal(size=(STATES, 8)):
        same_terms(made, to_q, mass, force, inputs, state)
        l1, l2, l3, l0, x0, x, z, z0 = state
        ax, az = x0 + (l + s) * np.sin(alpha), z0 + (l + s) * np.cos(alpha)
        px, pz = x0 + s * np.sin(alpha), z0 + s * np.cos(alpha)
        printed = {  # (6.15), (6.19), (6.20)
            "tagline.1": (0.5 * (ax**2 + az**2 - l1**2), [-l1, 0, 0, 0, ax, 0, 0, az]),
            "hoist.1": (0.5 * (px**2 + pz**2 - l0**2), [0, 0, 0, -l0, px, 0, 0, pz]),
            "suspension.1": (0.5 * (x0**2 + z0**2 - l3**2), [0, 0, -l3, 0, x0, 0, 0, z0]),
            "hoist.2": (
                0.5 * ((x - x0) ** 2 + (z - z0) ** 2 - (l2 - l0) ** 2),
                [0, l0 - l2, 0, l2 - l0, x0 - x, x - x0, z - z0, z0 - z],
            ),
        }
        same_constraints(made, to_q, state, printed)


def test_navy_crane_without_pulley_mass_is_y_6_26_to_6_33(rng, drawn):
    """Also Y A.4."""

    def build(**values):
        return models.navy_crane_3d(pulley_mass=0, **values)

    names = ("load_mass", "platform_mass", "winch_inertia", "drum_radius", "boom_angle")
    names += ("tagline_distance", "hoist_distance")
    rig, (m, platform, inertia, drum, alpha, k, tip, g) = drawn(build, *names)
    made = equations_of(rig)
    r, z3, b1 = tip * np.sin(alpha), tip * np.cos(alpha), k / tip
    names = ("tagline.length", "hoist.length", "hoist.span1", "pulley.x", "pulley.y", "pulley.z")
    columns = dict.fromkeys(names, 1.0) | {"boom.cos": 1 / r, "boom.sin": 1 / r}
    to_q = map_to(made, columns | dict.fromkeys(("load.x", "load.y", "load.z"), 1.0))
    winch = inertia / drum**2
    mass = diagonal_of(winch, winch, 0, 0, 0, 0, platform, platform, m, m, m)
    force = np.zeros(11)
    force[10] = -m * g
    for state in rng.normal(size=(STATES, 11)):
        l1, l3, l0, x0, y0, z0, x3, y3, x, y, z = state
        inputs = np.zeros((11, 3))
        inputs[0, 0] = inputs[1, 1] = 1 / drum
        inputs[6:8, 2] = -y3 / r**2, x3 / r**2
        same_terms(made, to_q, mass, force, inputs, state)
        ax, ay, az = x0 - b1 * x3, y0 - b1 * y3, z0 - b1 * z3
        px, py, pz = x0 - x3, y0 - y3, z0 - z3
        cx, cy, cz = x - x0, y - y0, z - z0
        printed = {  # (6.28), (6.33), A.4
            "tagline.1": (
                0.5 * (ax**2 + ay**2 + az**2 - l1**2),
                [-l1, 0, 0, ax, ay, az, -b1 * ax, -b1 * ay, 0, 0, 0],
            ),
            "hoist.1": (
                0.5 * (px**2 + py**2 + pz**2 - l0**2),
                [0, 0, -l0, px, py, pz, -px, -py, 0, 0, 0],
            ),
            "boom.unit": (0.5 * (x3**2 + y3**2 - r**2), [0, 0, 0, 0, 0, 0, x3, y3, 0, 0, 0]),
            "hoist.2": (
                0.5 * (cx**2 + cy**2 + cz**2 - (l3 - l0) ** 2),
                [0, l0 - l3, l3 - l0, -cx, -cy, -cz, 0, 0, cx, cy, cz],
            ),
        }
        same_constraints(made, to_q, state, printed, {"boom.unit": r**2})


def test_navy_crane_is_y_6_38_to_6_46_and_k_3_53_to_3_56(rng, drawn):
    """Also Y A.5, which has two misprints: the torque u4 is divided by r^2, r the tip's distance
    from the axis as in 6.44, not by r_2^2, a drum's radius; and a fourth servo constraint,
    z0 = gamma_4(t), is missing.  K's T4 is not a torque: its virtual work in 3.56k, l,
    T4 (x31 d(x32) - x32 d(x31)) = T4 r^2 d(angle), makes it the torque over r^2.  K writes
    alpha_1, alpha_2, x_3i for beta_1, beta_2, (x3, y3, z3), and numbers the multipliers otherwise.
    K 3.41b sums two coordinates only, which holds for winches at the pulley's height."""
    names = ("load_mass", "pulley_mass", "platform_mass", "winch_inertia", "drum_radius")
    names += ("boom_angle", "tagline_distance", "hoist_distance", "suspension_distance")
    rig, numbers = drawn(models.navy_crane_3d, *names)
    m, m0, platform, inertia, drum, alpha, k, tip, top, g = numbers
    made = equations_of(rig)
    r, z3, b1, b2 = tip * np.sin(alpha), tip * np.cos(alpha), k / tip, top / tip
    names = ("tagline.length", "suspension.length", "hoist.length", "hoist.span1")
    columns = dict.fromkeys((*names, "pulley.x", "pulley.y"), 1.0)
    columns |= {"boom.cos": 1 / r, "boom.sin": 1 / r}
    to_q = map_to(made, columns | dict.fromkeys(("load.x", "load.y", "load.z", "pulley.z"), 1.0))
    winch = inertia / drum**2
    mass = diagonal_of(winch, winch, winch, 0, m0, m0, platform, platform, m, m, m, m0)  # (6.43)
    force = np.zeros(12)
    force[10:] = -m * g, -m0 * g  # (6.44)
    for state in rng.normal(size=(STATES, 12)):
        l1, l2, l3, l0, x0, y0, x3, y3, x, y, z, z0 = state
        inputs = np.zeros((12, 4))
        inputs[:3, :3] = np.eye(3) / drum
        inputs[6:8, 3] = -y3 / r**2, x3 / r**2  # (6.44)
        same_terms(made, to_q, mass, force, inputs, state)
        ax, ay, az = x0 - b1 * x3, y0 - b1 * y3, z0 - b1 * z3
        sx, sy, sz = x0 - b2 * x3, y0 - b2 * y3, z0 - b2 * z3
        px, py, pz = x0 - x3, y0 - y3, z0 - z3
        cx, cy, cz = x - x0, y - y0, z - z0
        printed = {  # (6.40), (6.41), (6.45), (6.46); K (3.53)
            "tagline.1": (
                0.5 * (ax**2 + ay**2 + az**2 - l1**2),
                [-l1, 0, 0, 0, ax, ay, -b1 * ax, -b1 * ay, 0, 0, 0, az],
            ),
            "suspension.1": (
                0.5 * (sx**2 + sy**2 + sz**2 - l2**2),
                [0, -l2, 0, 0, sx, sy, -b2 * sx, -b2 * sy, 0, 0, 0, sz],
            ),
            "hoist.1": (
                0.5 * (px**2 + py**2 + pz**2 - l0**2),
                [0, 0, 0, -l0, px, py, -px, -py, 0, 0, 0, pz],
            ),
            "hoist.2": (
                0.5 * (cx**2 + cy**2 + cz**2 - (l3 - l0) ** 2),
                [0, 0, l0 - l3, l3 - l0, -cx, -cy, 0, 0, cx, cy, cz, -cz],
            ),
            "boom.unit": (0.5 * (x3**2 + y3**2 - r**2), [0, 0, 0, 0, 0, 0, x3, y3, 0, 0, 0, 0]),
        }
        same_constraints(made, to_q, state, printed, {"boom.unit": r**2})


@pytest.mark.parametrize(("build", "freedom"), [("navy_crane_2d", 3), ("navy_crane_3d", 5)])
def test_degrees_of_freedom_without_pulley_mass(rng, build, freedom):
    """Y counts n - m, 4 in 6.1.1 and 7 in 6.2.1.  But a massless pulley is in balance only where
    the tagline lies in the hoist rope's plane and halves its angle, and there it can move in one
    direction, in space in two, without any winch: these motions are algebraic (K remark 20)."""
    rig = models.make(build, pulley_mass=0)
    made = equations_of(rig)
    anchors = {anchor.name: np.array(anchor.position) for anchor in rig.anchors}
    axes = ["xyz".index(axis) for axis in rig.axes]
    for _ in range(STATES):
        pulley = np.zeros(3)
        pulley[axes] = rng.normal(size=len(axes))
        tagline, up = (
            (anchors[name] - pulley) / np.linalg.norm(anchors[name] - pulley) for name in "AP"
        )
        load = pulley + rng.uniform(1, 5) * (2 * (tagline @ up) * tagline - up)
        values = {f"pulley.{axis}": pulley["xyz".index(axis)] for axis in rig.axes}
        values |= {f"load.{axis}": load["xyz".index(axis)] for axis in rig.axes}
        values |= {frame.coordinate: 0.0 for frame in rig.frames}
        q, _ = redundant(made, values, dict.fromkeys(values, 0.0))
        moves = null_space(made.constraint_jacobian(q))
        assert moves.shape[1] == len(made.names) - len(made.constraint_names)
        assert np.linalg.matrix_rank(moves.T @ made.mass @ moves, tol=1e-9) == freedom


@pytest.mark.parametrize(
    ("build", "pulley_mass", "index", "order"),
    [
        ("navy_crane_2d", 0, 5, 4),
        ("navy_crane_2d", 150, 5, 4),
        ("navy_crane_3d", 0, 5, 4),
        ("navy_crane_3d", 5, 7, 6),
    ],
)
def test_index_and_derivatives(build, pulley_mass, index, order):
    """Y calls the last one index 5 too; its boom's angle needs the fourth derivative of the load's
    path and the boom's torque two more (K theorem 3)."""
    analysis = analyse(models.make(build, pulley_mass=pulley_mass))
    assert (analysis.index, analysis.reference_order) == (index, order)
    assert analysis.flat
