"""Equations generated for the cranes with a roped trolley against the printed ones.

As in `test_printed_navy`: the sources' multipliers have the other sign, so a printed column of
multipliers' factors is a constraint's gradient.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.feedforward import equations_of, from_move, solve


def relative(actual, desired):
    assert_allclose(actual, desired, rtol=1e-12, atol=1e-12 * np.abs(desired).max(initial=1e-300))


@pytest.fixture
def rng():
    return np.random.default_rng(8)


def on_a_turning_beam(build, distance, share, rng):
    """The crane with its hoisting winch at a distance from the axis, the other one at a share of
    it, and different drums."""
    names = ("load_mass", "trolley_mass", "gravity")
    rig = build(**{name: float(rng.uniform(0.5, 2)) for name in names})
    places = {"inner": (distance, 0.0, 0.0), "outer": (share * distance, 0.0, 0.0)}
    radii = rng.uniform(0.1, 0.5, 2)
    return replace(
        rig,
        anchors=tuple(replace(anchor, position=places[anchor.name]) for anchor in rig.anchors),
        ropes=tuple(
            replace(rope, drum_radius=float(radius))
            for rope, radius in zip(rig.ropes, radii, strict=True)
        ),
    )


@pytest.mark.parametrize(
    ("build", "distance", "share"),
    [
        (models.cantilever_crane, 8.5, -0.2),
        (models.cantilever_crane, -1.5, 0.3),
        (models.extended_rotary_crane, -4.0, 0.5),  # Y's own numbers
        (models.extended_rotary_crane, -4.0, -2.0),
    ],
)
def test_roped_trolley_on_a_turning_beam_is_k_3_44_to_3_47_and_y_5_120_to_5_127(
    rng, build, distance, share
):
    """One crane in two theses; K has no sheave.  In K's numbering, with Y's constraints h1, h2,
    Phi, h3, h4, whose gradients Y prints with the other sign.

    Here the trolley's position s along the rail is a coordinate of its own, without mass or force.
    Two constraints, (x0, y0) = s (cos, sin), stand for the collinearity C5 = distance (y0 cos -
    x0 sin): s's own equation, mu_x cos + mu_y sin = 0, leaves their multipliers only the direction
    (-sin, cos), along which the two gradients add up to that of C5 / distance.

    Misprints: Y 5.127 has alpha_1 for alpha.  In Y 5.125 the sheave couples (L1 - L2)', equal to
    its speed (L0 - L2)' only while both winches stand on one side of the trolley (L1' = L0'); here
    it is (L0 - L2)' always.  K's T3 is the torque over distance^2 (3.47i, j: its virtual work is
    T3 (x21 d(x22) - x22 d(x21))), as its M is the inertia over distance^2.
    """
    rig = on_a_turning_beam(build, distance, share, rng)
    made = equations_of(rig)
    at = {name: k for k, name in enumerate(made.names)}
    m, m0, g = rig.loads[0].mass, rig.trolleys[0].mass, rig.gravity
    frame, (pull, hoist) = rig.frames[0], rig.ropes
    beam = frame.inertia / distance**2
    names = [f"{frame.name}.cos", f"{frame.name}.sin", "trolley.x", "trolley.y", "pull.length"]
    names += ["hoist.length", "hoist.span1", "load.x", "load.y", "load.z"]
    to_q = np.zeros((len(at), 10))
    for column, name in enumerate(names):
        to_q[at[name], column] = 1 / distance if column < 2 else 1.0
    mass = np.diag([beam, beam, m0, m0, pull.inertia_along, hoist.inertia_along, 0, m, m, m])
    for sheave in hoist.sheaves:
        mass[5:7, 5:7] += sheave.inertia / sheave.radius**2 * np.array([[1, -1], [-1, 1]])
    relative(to_q.T @ made.mass @ to_q, mass)  # K (3.46), Y (5.125)
    relative(to_q.T @ made.force, [0, 0, 0, 0, 0, 0, 0, 0, 0, -m * g])
    s_alone = at["trolley.position"]
    assert not made.mass[s_alone].any()
    for c, n, s, l1, l2, l0, x, y, z in rng.normal(size=(20, 9)):
        x2, y2, x0, y0 = distance * c, distance * n, s * c, s * n
        q = to_q @ [x2, y2, x0, y0, l1, l2, l0, x, y, z]
        q[s_alone] = s
        inputs = np.zeros((10, 3))
        inputs[4, 0], inputs[5, 1] = 1 / pull.drum_radius, 1 / hoist.drum_radius
        inputs[:2, 2] = -y2 / distance**2, x2 / distance**2
        relative(to_q.T @ made.input_matrix(q), inputs)  # Y (5.126)
        assert not made.input_matrix(q)[s_alone].any()
        ax, ay, px, py = x0 - share * x2, y0 - share * y2, x0 - x2, y0 - y2
        dx, dy, lower = x0 - x, y0 - y, l2 - l0
        values = dict(zip(made.constraint_names, made.constraint_values(q), strict=True))
        slopes = dict(zip(made.constraint_names, made.constraint_jacobian(q), strict=True))
        relative(values["pull.1"], 0.5 * (ax**2 + ay**2 - l1**2))  # K (3.44a), Y (5.122)
        relative(values["hoist.1"], 0.5 * (px**2 + py**2 - l0**2))
        relative(values["hoist.2"], 0.5 * (dx**2 + dy**2 + z**2 - lower**2))  # Y (5.123)
        unit = f"{frame.name}.unit"
        relative(values[unit] * distance**2, 0.5 * (x2**2 + y2**2 - distance**2))
        printed = {  # the columns of K (3.47) and, negative, of Y (5.127)
            "pull.1": [-share * ax, -share * ay, ax, ay, -l1, 0, 0, 0, 0, 0],
            "hoist.1": [-px, -py, px, py, 0, 0, -l0, 0, 0, 0],
            "hoist.2": [0, 0, dx, dy, 0, -lower, lower, -dx, -dy, z],
        }
        for name, gradient in printed.items():
            relative(slopes[name] @ to_q, gradient)
        relative(slopes[unit] @ to_q * distance**2, [x2, y2, 0, 0, 0, 0, 0, 0, 0, 0])
        along, across = slopes["trolley.rail_x"], slopes["trolley.rail_y"]
        assert_allclose([along[s_alone], across[s_alone]], [-c, -n], rtol=1e-15)
        collinear = distance * (-n * along + c * across)
        assert_allclose(collinear[s_alone], 0, atol=1e-14)
        relative(collinear @ to_q, [y0, -x0, -y2, x2, 0, 0, 0, 0, 0, 0])


def test_gantry_crane_is_k_3_48_to_3_51(rng):
    """With alpha_1 - 1 for the place of winch 1 and winch 2 at 0.

    Misprint: (3.51d) lacks lambda_3 (x01 - x1).  (3.48c) depends on x01, and the load pulls the
    trolley along the rail as it pulls load and gantry in (3.51a, e).
    """
    names = ("load_mass", "trolley_mass", "gantry_mass", "winch_inertia", "drum_radius", "gravity")
    m, m0, gantry, inertia, r, g = numbers = [float(v) for v in rng.uniform(0.5, 2, 6)]
    made = equations_of(models.gantry_crane(**dict(zip(names, numbers, strict=True))))
    names = ("load.x", "load.y", "load.z", "trolley.position", "gantry.position")
    names += ("hoist.span1", "pull.length", "hoist.length")
    order = [made.names.index(name) for name in names]
    assert sorted(order) == list(range(8))
    winch, place = inertia / r**2, 8.0
    relative(made.mass[np.ix_(order, order)], np.diag([m, m, m, m0, m0 + gantry, 0, winch, winch]))
    relative(made.force[order], [0, 0, -m * g, 0, 0, 0, 0, 0])
    inputs = np.zeros((8, 3))
    inputs[6, 0] = inputs[7, 1] = 1 / r  # K's T1, T2 are forces, the torques over the radius
    inputs[4, 2] = 1
    relative(made.input_constant[order], inputs)
    assert not made.input_linear.any()
    assert made.constraint_names == ("pull.1", "hoist.1", "hoist.2")
    for state in rng.normal(size=(20, 8)):
        x1, x2, x3, x01, x02, l0, l1, l2 = state
        q = np.zeros(8)
        q[order] = state
        dx, dy = x01 - x1, x02 - x2
        values = [(x01 - place) ** 2 - l1**2, x01**2 - l0**2]
        values.append(dx**2 + dy**2 + x3**2 - (l2 - l0) ** 2)
        relative(made.constraint_values(q), 0.5 * np.array(values))  # (3.48)
        gradients = [
            [0, 0, 0, x01 - place, 0, 0, -l1, 0],
            [0, 0, 0, x01, 0, -l0, 0, 0],
            [-dx, -dy, x3, dx, dy, l2 - l0, 0, -(l2 - l0)],
        ]
        relative(made.constraint_jacobian(q)[:, order], gradients)


@pytest.mark.parametrize("winch_1", [-2.0, 8.0])
def test_extended_rotary_crane_has_the_rotary_crane_s_inputs(winch_1):
    """Y 5.139, 5.140 (and the same with winch 1 beyond the trolley): bridge torque, trolley force
    and winch torque of the rotary crane from M_1, M_2; winches without inertia, J_w = 0.1."""
    extended = models.extended_rotary_crane(winch_1_position=winch_1, winch_inertia=1e-15)
    path, times = from_move(models.default_move("rotary_crane")), np.linspace(0, 20, 201)
    plain = solve(models.rotary_crane(), path, times)
    motion = solve(extended, path, times)
    one, two, bridge = motion.inputs.T / [[0.1], [0.1], [1.0]]
    toward = 1.0 if winch_1 < 0 else -1.0
    expected = np.array([bridge, toward * one + two, 0.1 * two]).T
    assert_allclose(plain.inputs, expected, rtol=0, atol=1e-9)
    assert {slack.rope for slack in motion.slack} == ({"pull"} if winch_1 < 0 else set())
