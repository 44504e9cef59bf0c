"""Equations of mechanisms by directors: against other formulations and their own derivatives."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from flatrig import feedforward, models
from flatrig.feedforward import integrators, multibody
from flatrig.feedforward.multibody import (
    GROUND,
    Angle,
    Body,
    Effort,
    Mechanism,
    Point,
    Prismatic,
    Revolute,
    Slide,
    Spring,
)
from flatrig.models.errors import RigError
from flatrig.models.rig.trolley_cranes import rotary_crane_small
from flatrig.models.types import Array


def pendulum(angle: float, effort: float = 0.0) -> Mechanism:
    """A rod of 2 kg and 0.3 kg m^2, pinned 0.5 m from its centre, in the plane."""
    arm = 0.5 * np.array([np.cos(angle), np.sin(angle)])
    rod = Body("rod", 2.0, (0.1, 0.2), tuple(arm), multibody.planar(angle))
    pin = Revolute("pin", Point(GROUND), Point("rod", (-0.5, 0.0)))
    return Mechanism(
        "pendulum",
        (rod,),
        (pin,),
        (Angle("swing", GROUND, "rod"),),
        efforts=(Effort("swing", effort),),
        gravity=(0.0, -9.81),
    )


def slope(function: Callable[[Array], Array], at: Array, step: float = 1e-6) -> Array:
    """Central differences, the derivative's index last."""
    moved = [(function(at + step * e), function(at - step * e)) for e in np.eye(len(at))]
    return np.stack([(up - down) / (2 * step) for up, down in moved], axis=-1)


@pytest.mark.parametrize("describe", [multibody.rotary_crane, multibody.squeezer])
def test_derivatives_and_discrete_gradients(describe: Callable[[], Mechanism]) -> None:
    system, start = multibody.assemble(describe())
    rng = np.random.default_rng(1)
    q0, q1 = start.q + 0.3 * rng.standard_normal((2, len(start.q)))
    weights = rng.standard_normal(len(system.constraint_names))
    pairs = [
        (system.constraint_jacobian(q1), slope(system.constraint_values, q1)),
        (
            system.constraint_hessian(q1, weights),
            slope(lambda q: weights @ system.constraint_jacobian(q), q1),
        ),
        (
            system.discrete_constraint_slope(q0, q1, weights),
            slope(lambda q: weights @ system.discrete_jacobian(q0, q), q1),
        ),
        (system.potential_gradient(q1), slope(lambda q: np.array(system.potential(q)), q1)),
        (system.potential_hessian(q1), slope(system.potential_gradient, q1)),
        (
            system.discrete_potential_slope(q0, q1),
            slope(lambda q: system.discrete_potential_gradient(q0, q), q1),
        ),
    ]
    for exact, difference in pairs:
        assert exact == pytest.approx(difference, abs=1e-8 * (1 + np.abs(exact).max()))
    # A discrete gradient times the step is the difference of the function (Y 3.6).
    change = system.constraint_values(q1) - system.constraint_values(q0)
    assert system.discrete_jacobian(q0, q1) @ (q1 - q0) == pytest.approx(change, abs=1e-12)
    work = system.discrete_potential_gradient(q0, q1) @ (q1 - q0)
    assert work == pytest.approx(system.potential(q1) - system.potential(q0), abs=1e-9)


def test_discrete_gradient_of_a_small_step_is_the_gradient() -> None:
    system, start = multibody.assemble(multibody.squeezer())
    near = start.q + 1e-7
    middle = 0.5 * (start.q + near)
    assert system.discrete_jacobian(start.q, near) == pytest.approx(
        system.constraint_jacobian(middle), abs=1e-12
    )


def test_the_rotary_crane_has_the_sources_size() -> None:
    system, start = multibody.assemble(multibody.rotary_crane())
    ends = [name.partition(".")[0] for name in system.constraint_names]
    counts = {name: ends.count(name) for name in dict.fromkeys(ends)}
    assert len(system.names) == 42
    assert [counts[body] for body in ("girder", "trolley", "winch")] == [6, 6, 6]
    assert [counts[joint] for joint in ("tower", "rail", "axle", "hoist")] == [5, 5, 5, 1]
    assert [counts[name] for name in ("bridge", "along", "winding")] == [1, 1, 1]
    assert system.degrees_of_freedom == 5
    assert start.v[system.index("bridge")] == pytest.approx(1.0)
    # Kinetic energy and momentum of the girder's inertia 19.01 and of 63 kg at 2.5 m.
    moment = 19.01 + 63 * 2.5**2
    assert 0.5 * start.v @ system.mass @ start.v == pytest.approx(0.5 * moment)
    assert system.angular_momentum(start.q, start.v)[2] == pytest.approx(moment)


@pytest.mark.parametrize("place", [1.5, 2.5])
def test_the_crane_moves_as_the_generated_equations_of_its_rig(place: float) -> None:
    system, start = multibody.assemble(multibody.rotary_crane(place=place))
    times = np.linspace(0, 1, 6)
    run = integrators.integrate_index_one(system, start.q, start.v, times)
    rig = rotary_crane_small()
    values = {"bridge.angle": 0.0, "trolley.position": place}
    values |= {"load.x": place, "load.y": 0.0, "load.z": -5.0}
    rates = dict.fromkeys(values, 0.0) | {"bridge.angle": 1.0, "load.y": place}
    equations = feedforward.equations_of(rig)
    q, v = feedforward.redundant(equations, values, rates)
    n, inputs = len(q), np.zeros((1, len(rig.input_names)))

    def rate(_: float, state: Array) -> Array:
        found, _ = equations.accelerations(state[None, :n], state[None, n:], inputs)
        return np.concatenate((state[n:], found[0]))

    other = solve_ivp(
        rate, (0, 1), np.concatenate((q, v)), "DOP853", times, rtol=1e-12, atol=1e-12
    ).y.T
    column = {name: other[:, i] for i, name in enumerate(equations.names)}

    def ours(name: str) -> Array:
        return run.q[:, system.index(name)]

    for name in ("load.x", "load.y", "load.z"):
        assert ours(name) == pytest.approx(column[name], abs=1e-9)
    assert ours("along") == pytest.approx(column["trolley.position"], abs=1e-9)
    assert np.cos(ours("bridge")) == pytest.approx(column["bridge.cos"], abs=1e-9)
    assert np.sin(ours("bridge")) == pytest.approx(column["bridge.sin"], abs=1e-9)
    (length,) = (column[rope.coordinate] for rope in rig.ropes)
    assert 5 + 0.1 * ours("winding") == pytest.approx(length, abs=1e-9)
    assert ours("winding")[-1] > 30  # radians, several turns


def test_reduced_equations_give_the_accelerations_of_the_full_ones() -> None:
    system, start = multibody.assemble(multibody.rotary_crane())
    run = integrators.integrate_index_one(system, start.q, start.v, [0.0, 0.4, 0.8])
    for q, v in zip(run.q, run.v, strict=True):
        full, _ = system.accelerations(q, v)
        assert multibody.reduced_accelerations(system, q, v) == pytest.approx(
            full, abs=1e-9 * np.abs(full).max()
        )


def test_a_free_body_obeys_newton_and_euler() -> None:
    inertia, spin = np.array([0.4, 0.5, 0.7]), np.array([0.3, -2.0, 1.0])
    rotation = Rotation.from_rotvec([0.5, -0.2, 0.9]).as_matrix()
    body = Body(
        "body",
        3.0,
        multibody.euler_of(inertia),
        (1.0, 2.0, 3.0),
        tuple(map(tuple, rotation)),
        spin=tuple(spin),
    )
    system, start = multibody.assemble(Mechanism("free", (body,), gravity=(0.0, 0.0, -9.81)))
    basis = multibody.twist_basis(rotation.T)
    moments = rotation @ np.diag(inertia) @ rotation.T
    # Y 2.54: the reduced mass matrix is mass and inertia tensor.
    reduced = basis.T @ system.mass @ basis
    assert reduced[:3, :3] == pytest.approx(3 * np.eye(3))
    assert reduced[3:, 3:] == pytest.approx(moments)
    assert system.constraint_jacobian(start.q) @ basis == pytest.approx(0, abs=1e-12)
    assert start.v == pytest.approx(basis @ [0, 0, 0, *spin])
    # Y 2.57b, and the director's second derivative.
    angular = np.linalg.solve(moments, -np.cross(spin, moments @ spin))
    found, _ = system.accelerations(start.q, start.v)
    expected = np.cross(angular, rotation.T) + np.cross(spin, np.cross(spin, rotation.T))
    assert found == pytest.approx([0, 0, -9.81, *expected.ravel()], abs=1e-12)


@pytest.mark.parametrize("degrees", [-45, 0, 100, 135, 179])
def test_an_added_angle_is_regular_everywhere_and_takes_a_torque(degrees: float) -> None:
    angle, torque = np.deg2rad(degrees), 3.0
    system, start = multibody.assemble(pendulum(angle, torque))
    index = system.index("swing")
    assert start.q[index] == pytest.approx(angle)
    assert system.constraint_jacobian(start.q)[-1, index] == pytest.approx(-1)
    found, _ = system.accelerations(start.q, start.v)
    moment = 0.3 + 2.0 * 0.5**2
    assert found[index] == pytest.approx((torque - 9.81 * 0.5 * 2.0 * np.cos(angle)) / moment)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_slider_on_a_tilted_guide_falls_along_it(dimension: int) -> None:
    axis = (0.8, 0.0, -0.6)[:: 2 if dimension == 2 else 1]
    block = Body("block", 4.0, (0.1,) * dimension, (0.0,) * dimension)
    wide = Body("load", 1.0, (), (0.0,) * dimension)
    down = (*(0.0,) * (dimension - 1), -9.81)
    rest, stiffness = 0.5, 40.0
    mechanism = Mechanism(
        "slide",
        (block,),
        (Prismatic("guide", Point(GROUND), Point("block"), axis),),
        (Slide("along", Point(GROUND), Point("block"), axis),),
        springs=(Spring("s", Point(GROUND, axis), Point("block"), stiffness, rest),),
        gravity=down,
    )
    system, start = multibody.assemble(mechanism)
    found, _ = system.accelerations(start.q, start.v)
    pull = stiffness * (1 - rest)
    assert found[system.index("along")] == pytest.approx(0.6 * 9.81 + pull / 4.0)
    assert multibody.track(mechanism, Point("block", axis), start.q) == pytest.approx(axis)
    with pytest.raises(RigError, match="no constraints"):
        multibody.assemble(Mechanism("loose", (wide,)))


def test_a_rig_of_the_catalogue_is_a_system_too() -> None:
    rig = models.navy_crane_2d(pulley_mass=150.0)
    equations = feedforward.equations_of(rig)
    system = multibody.of_equations(equations)
    q, v = feedforward.redundant(
        equations,
        dict.fromkeys(rig.coordinate_names, 0.0) | home_of(rig),
        dict.fromkeys(rig.coordinate_names, 0.0),
    )
    inputs = np.zeros((1, len(rig.input_names)))
    expected, multipliers = equations.accelerations(q[None], v[None], inputs)
    found = system.accelerations(q, v)
    assert found[0] == pytest.approx(expected[0], abs=1e-9)
    assert found[1] == pytest.approx(multipliers[0], abs=1e-9)


def home_of(rig: models.Rig) -> dict[str, float]:
    """Coordinates of the masses at home."""
    return {
        f"{part.name}.{axis}": float(value)
        for part in rig.masses
        for axis, value in zip("xyz", rig.home_point(part.name), strict=True)
        if axis in rig.axes
    }


def four_bar() -> Mechanism:
    """A closed loop in space, whose pins repeat constraints."""
    axis = (0.0, 0.0, 1.0)
    bars = [
        Body("a", 1.0, (0.1, 0.1, 0.1), (0.0, 0.5, 0.0)),
        Body("b", 1.0, (0.1, 0.1, 0.1), (0.5, 1.0, 0.0)),
        Body("c", 1.0, (0.1, 0.1, 0.1), (1.0, 0.5, 0.0)),
    ]
    pins = [
        Revolute("1", Point(GROUND), Point("a", (0.0, -0.5, 0.0)), axis),
        Revolute("2", Point("a", (0.0, 0.5, 0.0)), Point("b", (-0.5, 0.0, 0.0)), axis),
        Revolute("3", Point("b", (0.5, 0.0, 0.0)), Point("c", (0.0, 0.5, 0.0)), axis),
        Revolute("4", Point("c", (0.0, -0.5, 0.0)), Point(GROUND, (1.0, 0.0, 0.0)), axis),
    ]
    return Mechanism("four-bar", tuple(bars), tuple(pins))


BALL = Body("ball", 1.0, (0.1, 0.1, 0.1), (0.0, 0.0, 0.0))
PIN = Revolute("pin", Point(GROUND), Point("ball"), (0.0, 0.0, 1.0))


@pytest.mark.parametrize(
    ("mechanism", "message"),
    [
        (four_bar(), "of 38 constraints only 35 are independent"),
        (Mechanism("m", ()), "no bodies"),
        (Mechanism("m", (BALL, BALL)), "'ball' stands twice"),
        (Mechanism("m", (BALL,), (Revolute("pin", Point("bal"), Point("ball")),)), "mean ball?"),
        (Mechanism("m", (BALL,), (Revolute("pin", Point(GROUND), Point("ball")),)), "the axis"),
        (
            Mechanism("m", (BALL,), (Revolute("p", Point("ball", (1.0,)), Point(GROUND)),)),
            "3 numbers",
        ),
        (Mechanism("m", (BALL,), (PIN,), efforts=(Effort("turn", 1.0),)), "coordinate 'turn'"),
        (Mechanism("m", (Body("b", 0.0, (), (0.0, 0.0)),), (PIN,)), "above 0"),
        (Mechanism("m", (Body("b", 1.0, (0.1,), (0.0, 0.0)),)), "it must be 2"),
        (Mechanism("m", (Body("b", 1.0, (), (0.0,)),), (PIN,)), "two or three"),
        (
            Mechanism("m", (Body("b", 1.0, (0.1, 0.1), (0.0, 0.0), spin=(1.0, 0.0)),)),
            "the spin .* 1 entries",
        ),
        (
            Mechanism("m", (Body("ball", 1.0, (0.1,) * 3, (1.0, 0.0, 0.0)),), (PIN,)),
            "pin.x is 1, it must be 0",
        ),
        (
            Mechanism("m", (Body("ball", 1.0, (0.1,) * 3, (0.0,) * 3, spin=(1.0, 0, 0)),), (PIN,)),
            "velocities do not fit",
        ),
    ],
)
def test_a_mistake_is_said_in_one_line(mechanism: Mechanism, message: str) -> None:
    with pytest.raises(RigError, match=message) as caught:
        multibody.assemble(mechanism)
    assert "\n" not in str(caught.value)


def test_an_unknown_coordinate_is_named() -> None:
    system, _ = multibody.assemble(Mechanism("m", (BALL,), (PIN,)))
    with pytest.raises(RigError, match="did you mean"):
        system.index("ball.xx")
