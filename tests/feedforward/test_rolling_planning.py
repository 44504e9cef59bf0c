"""Planned motions: constraints, re-integration, printed formulas, and what is refused."""

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from flatrig import models
from flatrig.feedforward.rolling import plan_hand, replay, report, residuals
from flatrig.feedforward.rolling.orientation import ByAngles
from flatrig.feedforward.rolling.quadrature import integrate
from flatrig.feedforward.rolling.with_spin import WithSpin, with_spin
from flatrig.feedforward.rolling.without_spin import TwoLegs, without_spin
from flatrig.feedforward.series.rotation import angular_velocity, rotation_of, rpy_matrix
from flatrig.models import Hand, HandMove

ENDS = HandMove(start=(pi / 3, pi / 4, 0), goal=(pi / 4, 0, pi / 3), duration=10)
ROLLING = replace(ENDS, turning="rolling")
SPINNING = replace(ENDS, turning="spinning", touch=(0.1, 0.05))


def three_fingers(*axes: tuple[float, float, float]) -> Hand:
    """The three-finger hand with tips that turn about other axes."""
    hand = models.three_finger_hand()
    tips = (replace(one, surface=replace(one.surface, axes=axes)) for one in hand.fingers)
    return replace(hand, fingers=tuple(tips))


CASES = {
    **{n: (models.make_hand(n), models.default_hand_move(n)) for n in models.HAND_CATALOGUE},
    "no spin allowed": (models.ball_on_plate(spin=False), ROLLING),
    "one plate, flat": (models.ball_on_plate(), SPINNING),
    "two plates, flat": (models.ball_between_plates(), SPINNING),
    "flat, singular goal": (
        models.ball_on_plate(),
        replace(SPINNING, goal=(0.3, -pi / 2, 0.2)),
    ),
    "vertical turn": (
        models.ball_on_plate(spin=False),
        HandMove(goal=(pi / 2, 0, 0), turning="rolling"),
    ),
    "singular goal": (
        models.ball_in_corner(),
        HandMove(goal=(1, pi / 2, 1), shift=(0.01, 0.02, 0.03)),
    ),
    "oblique by angles": (models.ball_between_oblique_plates(), HandMove(goal=(1, 0.5, 0.8))),
    "printed three fingers": (
        models.three_finger_hand(),
        models.PRINTED_HAND_MOVES["three_finger_hand"],
    ),
    "ball tips": (
        three_fingers((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        HandMove(goal=(pi / 6, pi / 6, -pi / 6), shift=(0.05, 0.05, 0.1)),
    ),
    "fixed tips": (
        three_fingers(),
        HandMove(goal=(pi / 6, pi / 6, -pi / 6), turning="axis"),
    ),
}


@pytest.mark.parametrize(("hand", "move"), CASES.values(), ids=CASES)
def test_motion_keeps_all_constraints_and_meets_its_ends(hand: Hand, move: HandMove) -> None:
    motion = plan_hand(hand, move)(np.linspace(-0.1, move.duration + 0.1, 301))
    assert max(residuals(motion)) < 1e-10
    assert motion.quadrature_error < 1e-10
    np.testing.assert_allclose(motion.rotation[0], rotation_of(move.start), atol=1e-12)
    np.testing.assert_allclose(motion.rotation[-1], rotation_of(move.goal), atol=1e-12)
    np.testing.assert_allclose(motion.position[0], hand.position, atol=1e-15)
    for rate in (motion.velocity, motion.angular_velocity, motion.finger_accelerations):
        np.testing.assert_allclose(rate[[0, -1]], 0.0, atol=1e-15)


@pytest.mark.parametrize(("hand", "move"), CASES.values(), ids=CASES)
def test_driftless_system_ends_where_planned(hand: Hand, move: HandMove) -> None:
    again = replay(plan_hand(hand, move))
    assert again.orientation < 1e-8
    assert max(again.position, again.contacts) < 1e-9


@pytest.mark.parametrize(("hand", "move"), CASES.values(), ids=CASES)
def test_velocities_and_accelerations_are_derivatives(hand: Hand, move: HandMove) -> None:
    plan, step = plan_hand(hand, move), 1e-4 * move.duration
    times = np.linspace(0.1, 0.9, 7) * move.duration
    before, here, after = (plan(times + k * step) for k in (-1, 0, 1))
    pairs = [
        ("position", "velocity"),
        ("velocity", "acceleration"),
        ("angular_velocity", "angular_acceleration"),
        ("finger_positions", "finger_velocities"),
        ("finger_velocities", "finger_accelerations"),
        ("tip_turns", "tip_velocities"),
        ("tip_velocities", "tip_accelerations"),
    ]
    for value, rate in pairs:
        wanted = getattr(here, rate)
        slope = (getattr(after, value) - getattr(before, value)) / (2 * step)
        np.testing.assert_allclose(slope, wanted, atol=1e-4 * max(np.abs(wanted).max(), 1e-3))


def test_rolling_without_spin_is_the_printed_solution() -> None:
    """K 2.105 to 2.108, phi(theta) as printed in powers of theta."""
    path = without_spin(ROLLING)
    times = np.linspace(0.0, 10.0, 50)
    phi, theta, psi = path.angles(times)[0].T  # type: ignore[union-attr]
    a0, a1, a2, a3 = path.coefficients  # type: ignore[union-attr]
    first, last = pi / 4, 0.0
    np.testing.assert_allclose(psi, a0 + a1 * theta + a2 * theta**2 + a3 * theta**3, atol=1e-13)
    printed = (
        a1 * (np.cos(first) - np.cos(theta))
        + 2 * a2 * (np.sin(theta) - np.sin(first) + first * np.cos(first) - theta * np.cos(theta))
        + 3
        * a3
        * (
            first**2 * np.cos(first)
            - 2 * np.cos(first)
            - 2 * first * np.sin(first)
            - theta**2 * np.cos(theta)
            + 2 * np.cos(theta)
            + 2 * theta * np.sin(theta)
        )
        + pi / 3
    )
    np.testing.assert_allclose(phi, printed, atol=1e-13)
    assert a2 + 3 * a3 * last == pytest.approx(0.0)
    np.testing.assert_allclose(angular_velocity(path.rotation(times))[..., 2], 0.0, atol=1e-14)


@pytest.mark.parametrize("seed", range(5))
def test_any_two_orientations_are_joined_without_spin(seed: int) -> None:
    start, goal = np.random.default_rng(seed).uniform(-pi, pi, (2, 3))
    move = HandMove(start=tuple(start), goal=tuple(goal), turning="rolling")
    path = without_spin(move)
    rotation = path.rotation(np.linspace(0.0, 1.0, 40))
    np.testing.assert_allclose(rotation[0, -1], rotation_of(tuple(goal)), atol=1e-12)
    np.testing.assert_allclose(angular_velocity(rotation)[..., 2], 0.0, atol=1e-10)
    assert path.turning < 20.0


def test_a_vertical_turn_without_spin_takes_two_legs_and_says_so() -> None:
    path = without_spin(HandMove(goal=(1.0, 0, 0), turning="rolling"))
    assert isinstance(path, TwoLegs)
    assert "at rest once in between" in path.note


def test_flat_output_with_spin_is_the_printed_one() -> None:
    """zeta of K 2.86 from A X and the angles' rates, and 2.88 with the factor R."""
    path = with_spin(SPINNING, 0.05)
    place = np.linspace(0.0, 1.0, 20001)
    phi, theta = path._outputs(place)
    angles, contact = path._states(place)
    psi, (x, y) = angles[0, :, 2], contact[0].T
    y1 = 0.05 * (theta[0] * np.cos(phi[0]) + psi * np.sin(phi[0]) * np.cos(theta[0])) - x
    y2 = 0.05 * (theta[0] * np.sin(phi[0]) - psi * np.cos(phi[0]) * np.cos(theta[0])) - y
    p, q, bulge = path._moving(phi, theta)
    zeta = q[0] * y1 - p[0] * y2
    np.testing.assert_allclose(zeta, np.polynomial.Polynomial(path.zeta)(place), atol=1e-12)
    left = q[1] * y1 - p[1] * y2
    np.testing.assert_allclose(left, np.gradient(zeta, place, edge_order=2) + bulge[0], atol=1e-6)


def test_flat_plan_with_spin_ends_at_the_prescribed_contact() -> None:
    motion = plan_hand(models.ball_on_plate(), SPINNING)(np.array([0.0, 10.0]))
    touch = motion.contacts_on_fingers[:, 0, :2]
    np.testing.assert_allclose(touch, [(0.0, 0.0), SPINNING.touch], atol=1e-14)
    rate = angular_velocity(WithSpin.rotation(with_spin(SPINNING, 0.05), np.linspace(0, 10, 99)))
    assert np.abs(rate[..., 2]).max() > 0.1  # it does spin


def test_printed_three_fingers_end_where_printed() -> None:
    """K example 8: pose and contacts at the end, contacts with azimuth first."""
    hand, move = CASES["printed three fingers"]
    motion = plan_hand(hand, move)(np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(motion.position[[0, 2]], [(0.1, 0.1, 0.1), (0.15, 0.15, 0.2)])
    np.testing.assert_allclose(motion.rpy[-1], [pi / 6, pi / 6, -pi / 6])
    np.testing.assert_allclose(motion.contacts_on_object[2, 0], [0, 0, -0.1], atol=1e-15)
    distance = np.linalg.norm(motion.finger_positions - motion.position[:, None], axis=-1)
    np.testing.assert_allclose(distance, 0.12)
    np.testing.assert_allclose(motion.tip_velocities[..., 2], 0.0, atol=1e-15)


def test_planar_contacts_follow_the_integrated_constraint() -> None:
    """xi = xi0 - r / (r + R) phi in the object's axes (K example 7)."""
    hand, move = models.two_finger_hand(), HandMove(goal=(0.9,))
    motion = plan_hand(hand, move)(np.linspace(0.0, 1.0, 30))
    x, _, z = np.moveaxis(motion.contacts_on_object[:, 1], -1, 0)
    np.testing.assert_allclose(np.arctan2(z, x), -0.02 / 0.07 * motion.angle, atol=1e-14)
    assert motion.angle[-1] == pytest.approx(0.9)


def test_a_ball_on_one_plate_is_carried_as_its_only_force_allows() -> None:
    """m p'' along the plate and the rate of J w come from the same force."""
    hand = models.ball_on_plate()
    motion = plan_hand(hand, ROLLING)(np.linspace(0.0, 10.0, 30))
    force = hand.held.mass * motion.acceleration
    arm = hand.held.radius * motion.normals[:, 0]
    moment = hand.held.inertia * motion.angular_acceleration
    np.testing.assert_allclose(np.cross(arm, force), moment, atol=1e-15)


def test_quadrature_states_an_error_that_holds() -> None:
    times = np.array([0.3, 1.0, 0.0, 2.0, -1.0])
    values, error = integrate(lambda t: np.stack((np.exp(t), np.abs(t - 0.5)), 1), times, 1.0)
    ends = np.clip(times, 0, 1)
    bend = np.where(ends < 0.5, ends * (1 - ends) / 2, 0.25 - ends * (1 - ends) / 2)
    off = np.abs(values - np.stack((np.expm1(ends), bend), 1)).max()
    assert off <= error + 1e-15
    assert error < 1e-4
    smooth = integrate(lambda t: np.exp(t)[:, None], times, 1.0)
    assert smooth[1] < 1e-14


def test_singular_angles_are_noted() -> None:
    plan = plan_hand(*CASES["singular goal"])
    assert any("RPY angles are singular" in note for note in plan.notes)


def test_series_of_a_rotation_agrees_with_its_values() -> None:
    move = HandMove(goal=(1.0, 0.5, -2.0))
    rotation = ByAngles(move).rotation(np.array([0.4]))
    step = 1e-3
    near = ByAngles(move).rotation(np.array([0.4 + step]))[0]
    taylor = rotation[0] + step * rotation[1] + step**2 * rotation[2]
    np.testing.assert_allclose(near, taylor, atol=1e-6)
    identity = rpy_matrix(np.zeros((1, 1, 3)))[0, 0]
    np.testing.assert_array_equal(identity, np.eye(3))


def test_report_has_a_line_for_each_hand() -> None:
    pytest.importorskip("clarabel")
    lines = report(["ball_on_plate", "two_finger_hand"]).splitlines()
    assert [line.split()[0] for line in lines] == ["hand", "ball_on_plate", "two_finger_hand"]
    assert "outside (" in lines[2]
    assert lines[2].split()[-1] == "0.80"  # the margin of a fifth is used up


def test_motion_is_written_with_named_columns(tmp_path: Path) -> None:
    hand, move = CASES["three_finger_hand"]
    motion = plan_hand(hand, move)(np.linspace(0.0, 1.0, 5))
    motion.to_csv(tmp_path / "motion.csv")
    table = np.genfromtxt(tmp_path / "motion.csv", delimiter=",", names=True, deletechars="")
    assert tuple(table.dtype.names) == motion.column_names
    np.testing.assert_array_equal(table["finger2.position.z"], motion.finger_positions[:, 1, 2])
    np.testing.assert_array_equal(table["object.R12"], motion.rotation[:, 0, 1])


@pytest.mark.parametrize(("hand", "move"), CASES.values(), ids=CASES)
def test_what_is_left_out_of_a_motion_changes_nothing_else(hand: Hand, move: HandMove) -> None:
    plan, times = plan_hand(hand, move), np.linspace(-0.1, move.duration + 0.1, 29)
    whole, bare = plan(times), plan(times, turns=False, judged=False)
    np.testing.assert_array_equal(plan.turns(times), whole.tip_turns)
    for name, value in vars(whole).items():
        if isinstance(value, np.ndarray) and name != "tip_turns":
            np.testing.assert_array_equal(getattr(bare, name), value)
    assert not bare.tip_turns.any()
