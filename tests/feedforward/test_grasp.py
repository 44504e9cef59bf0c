"""Contact forces: balance, least norm, friction cones, motors, and what no hand can give."""

import sys
from dataclasses import replace
from math import pi

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.optimize import minimize

from flatrig import models
from flatrig.feedforward.rolling import (
    ContactForces,
    HandMotion,
    grasp_matrix,
    in_cones,
    joint_forces,
    least_norm,
    plan_hand,
    wrench,
)
from flatrig.models import Hand, HandMove, OptionError, PathError
from flatrig.models.types import Array

pytest.importorskip("clarabel")


def moved(hand: Hand, move: HandMove | None = None, samples: int = 101) -> HandMotion:
    move = move or models.default_hand_move(hand)
    return plan_hand(hand, move)(np.linspace(0.0, move.duration, samples))


def at_rest(hand: Hand) -> HandMotion:
    return moved(hand, HandMove(goal=(0.0,) * (1 if hand.planar else 3), turning="axis"), 3)


@pytest.mark.parametrize("name", models.HAND_CATALOGUE)
def test_forces_in_the_cones_make_the_motion(name: str) -> None:
    """Newton and Euler (K 2.48, 2.49) hold, and the margin is kept."""
    motion = moved(models.make_hand(name, friction=1.2))
    forces = in_cones(motion, margin=0.25, press=0.1)
    sums = np.einsum("nij,nj->ni", grasp_matrix(motion), forces.values.reshape(101, -1))
    weight = motion.hand.held.mass * 9.81
    np.testing.assert_allclose(sums, wrench(motion), atol=1e-9 * weight)
    assert forces.friction_use.max() < 1.2 * 0.75 * (1 + 1e-5)
    assert forces.normal.min() > 0.1 * weight * (1 - 1e-5)
    assert forces.outside is None


@pytest.mark.parametrize("name", models.HAND_CATALOGUE)
def test_least_norm_is_the_printed_pseudoinverse(name: str) -> None:
    """f = B^T (B B^T)^-1 w (K examples 7 and 8), wherever B has full rank; shorter never is."""
    motion = moved(models.make_hand(name))
    forces = least_norm(motion)
    flat = forces.values.reshape(101, -1)
    rows = [0, 2, 4] if motion.hand.planar else list(range(6))
    matrix, right = grasp_matrix(motion)[:, rows], wrench(motion)[:, rows]
    if motion.hand.planar:
        matrix[:, :, 1::3] = 0.0
    np.testing.assert_allclose(np.einsum("nij,nj->ni", matrix, flat), right, atol=1e-9)
    if len(motion.hand.fingers) == 3 or motion.hand.planar:
        printed = np.einsum(
            "nji,njk,nk->ni", matrix, np.linalg.inv(matrix @ matrix.swapaxes(1, 2)), right
        )
        np.testing.assert_allclose(flat, printed, atol=1e-9)
    sizes = np.linalg.norm(flat, axis=1)
    assert (sizes <= np.linalg.norm(in_cones(motion).values.reshape(101, -1), axis=1) + 1e-9).all()


def test_least_norm_leaves_the_cones_where_it_does() -> None:
    """K 2.52 is not met: with two plates the upper one would have to pull half the weight."""
    motion = at_rest(models.ball_between_plates(mass=0.2))
    outside = least_norm(motion).outside
    assert outside is not None
    assert (outside.finger, outside.time) == ("upper", 0.0)
    assert outside.normal == pytest.approx(-0.1 * 9.81)
    assert "pulls with up to 0.981 N" in str(outside)
    assert least_norm(at_rest(models.ball_on_plate())).outside is None


def test_squeeze_of_two_fingers_in_closed_form() -> None:
    """Half the weight each by friction: normal m g / (2 mu (1 - margin))."""
    motion = at_rest(models.two_finger_hand(mass=0.5, friction=0.6))
    forces = in_cones(motion, margin=0.5, press=0.0)
    np.testing.assert_allclose(forces.tangential, 0.25 * 9.81, rtol=1e-6)
    np.testing.assert_allclose(forces.normal, 0.25 * 9.81 / 0.3, rtol=1e-5)
    np.testing.assert_allclose(forces.cosines, -1 / np.hypot(1, 0.3), rtol=1e-5)


def test_three_perpendicular_plates_squeeze_only_with_much_friction() -> None:
    """Each normal force N is borne by N / 2 along both other plates: mu >= 1 / sqrt(2)."""
    enough, too_little = (at_rest(models.ball_in_corner(friction=mu)) for mu in (0.71, 0.70))
    assert in_cones(enough, margin=0.0, press=1000.0).friction_use.max() > 0.70
    with pytest.raises(PathError, match="leaves its friction cone"):
        in_cones(too_little, margin=0.0, press=1000.0)


def test_cone_program_finds_what_a_general_optimiser_finds() -> None:
    """Over the internal forces, which are the null space of B."""
    motion = moved(models.three_finger_hand(friction=0.8), samples=5)
    found = in_cones(motion, margin=0.0, press=0.0).values[3].ravel()
    start, normals = least_norm(motion).values[3].ravel(), motion.normals[3]
    internal = null_space(grasp_matrix(motion)[3])

    def room(z: Array) -> Array:
        forces = (start + internal @ z).reshape(3, 3)
        normal = -(forces * normals).sum(axis=1)
        tangential = forces + normal[:, None] * normals
        return 0.8 * normal - np.linalg.norm(tangential, axis=1)

    best = minimize(
        lambda z: z @ z,
        np.zeros(3),
        jac=lambda z: 2 * z,
        method="SLSQP",
        constraints={"type": "ineq", "fun": room},
        options={"ftol": 1e-13},
    )
    assert internal.shape == (9, 3)
    np.testing.assert_allclose(found, start + internal @ best.x, atol=1e-5)


def test_printed_three_finger_move_needs_a_finger_that_pulls() -> None:
    """K figure 2.19 has B with contact points in the object's axes; in space a finger pulls."""
    hand = models.three_finger_hand()
    motion = moved(hand, models.PRINTED_HAND_MOVES["three_finger_hand"])
    assert least_norm(motion).cosines[:, 0].max() > 0.7
    with pytest.raises(
        PathError, match=r"from t = 0\.5\d s on: the force of finger finger1 leaves"
    ):
        in_cones(motion, margin=0.0, press=0.0)

    upright = replace(motion, rotation=np.broadcast_to(np.eye(3), motion.rotation.shape))
    own = replace(upright, normals=motion.contacts_on_object / hand.held.radius)
    assert least_norm(own).cosines.max() < -0.17


def energy_rate(motion: HandMotion) -> Array:
    """Rate of kinetic and potential energy of object, slides and tips, (N,) [W]."""
    hand = motion.hand
    gravity = np.array(hand.gravity)
    lifted = motion.acceleration - gravity
    power = hand.held.mass * (motion.velocity * lifted).sum(axis=1)
    turning = motion.angular_velocity * motion.angular_acceleration
    power += hand.held.inertia * turning.sum(axis=1)
    for i, finger in enumerate(hand.fingers):
        lifted = motion.finger_accelerations[:, i] - gravity
        for slide, mass in zip(finger.slides, finger.masses, strict=True):
            along = np.array(slide)
            power += mass * (motion.finger_velocities[:, i] @ along) * (lifted @ along)
        if isinstance(finger.surface, models.Tip):
            spin = motion.tip_velocities[:, i] * motion.tip_accelerations[:, i]
            power += finger.surface.inertia * spin.sum(axis=1)
    return power


@pytest.mark.parametrize("name", models.HAND_CATALOGUE)
def test_motors_supply_the_energy(name: str) -> None:
    """Rolling contacts do no work, internal forces neither (K 2.50, 2.62)."""
    motion = moved(models.make_hand(name))
    for forces in (in_cones(motion), least_norm(motion)):
        inputs = joint_forces(motion, forces)
        assert len(inputs.names) == inputs.values.shape[1] == len(inputs.limits)
        rates = []
        for i, finger in enumerate(motion.hand.fingers):
            rates += [motion.finger_velocities[:, i] @ np.array(slide) for slide in finger.slides]
            if isinstance(finger.surface, models.Tip):
                axes = finger.surface.axes
                rates += [motion.tip_velocities[:, i] @ np.array(axis) for axis in axes]
        power = (inputs.values * np.stack(rates, axis=1)).sum(axis=1)
        np.testing.assert_allclose(power, energy_rate(motion), atol=1e-9)


def test_planar_motors_have_the_printed_forces() -> None:
    """K 2.68 at rest: vertical slides bear their mass and half the disc's weight."""
    motion = at_rest(models.two_finger_hand(mass=0.5, friction=1.0))
    inputs = joint_forces(motion, in_cones(motion, margin=0.5, press=0.0))
    assert inputs.names == ("left.slide1", "left.slide2", "right.slide1", "right.slide2")
    squeeze = 0.25 * 9.81 / 0.5
    lift = (0.4 + 0.25) * 9.81
    np.testing.assert_allclose(inputs.values[0], [squeeze, lift, -squeeze, lift], rtol=1e-5)


def test_a_finger_that_cannot_hold_is_named_with_time_and_amount() -> None:
    motion = at_rest(models.ball_in_corner(mass=0.1, friction=0.5))
    heavy = replace(motion, acceleration=motion.acceleration + np.array([0.0, 0.0, -20.0]))
    with pytest.raises(PathError) as caught:
        in_cones(heavy, press=0.0)
    message = str(caught.value)
    assert "from t = 0 s on: the force of finger plate_" in message
    assert "leaves its friction cone by up to" in message
    assert "\n" not in message


def test_spin_between_point_contacts_needs_a_moment_that_none_gives() -> None:
    move = HandMove(goal=(1.0, 0.0, 0.0), turning="axis")
    message = (
        r"the contacts of plate cannot give a moment of 0\.00187 N m along \(0, 0, -?1\), "
        r"needed at t = 0\.\d+ s, whatever the friction"
    )
    for forces in (in_cones, least_norm):
        with pytest.raises(PathError, match=message):
            forces(moved(models.ball_on_plate(), move))


def test_friction_use_of_a_force_that_does_not_press_is_infinite() -> None:
    motion = at_rest(models.ball_on_plate())
    forces = ContactForces(motion, np.zeros((3, 1, 3)))
    assert np.isinf(forces.friction_use).all()
    assert forces.outside is None


def test_options_out_of_range_are_refused() -> None:
    motion = at_rest(models.ball_on_plate())
    with pytest.raises(OptionError, match=r"margin is 1\.0, it must be from 0 to below 1"):
        in_cones(motion, margin=1.0)
    with pytest.raises(OptionError, match="press is -1"):
        in_cones(motion, press=-1.0)
    with pytest.raises(OptionError, match="margin is 'much', it must be from 0 to below 1"):
        in_cones(motion, margin="much")  # type: ignore[arg-type]


def test_without_its_solver_only_the_cone_program_is_missing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "clarabel", None)
    motion = at_rest(models.two_finger_hand())
    assert np.isfinite(joint_forces(motion, least_norm(motion)).values).all()
    with pytest.raises(OptionError, match=r"need clarabel: pip install 'flatrig\[hands\]'$"):
        in_cones(motion)


def test_forces_without_gravity() -> None:
    """Of the motion alone; none at rest."""
    hand = replace(models.ball_in_corner(), gravity=(0.0, 0.0, 0.0))
    motion = moved(hand)
    for forces in (in_cones(motion), least_norm(motion)):
        sums = np.einsum("nij,nj->ni", grasp_matrix(motion), forces.values.reshape(101, -1))
        most = np.abs(wrench(motion)).max()
        np.testing.assert_allclose(sums, wrench(motion), rtol=0, atol=1e-9 * most)
    np.testing.assert_allclose(in_cones(at_rest(hand)).values, 0.0, atol=1e-5 * hand.held.mass)


def test_more_friction_than_there_is_changes_nothing() -> None:
    found = [in_cones(moved(models.two_finger_hand(friction=mu))).values for mu in (1e4, 1e9)]
    np.testing.assert_array_equal(*found)


def test_forces_change_continuously() -> None:
    """The smallest forces are unique, so that ten times finer samples change ten times less."""
    hand = models.three_finger_hand()
    coarse, fine = (in_cones(moved(hand, samples=n)).values for n in (51, 501))
    jumps = [float(np.abs(np.diff(values, axis=0)).max()) for values in (coarse, fine)]
    assert jumps[1] < jumps[0] / 5


def test_a_turn_by_half_is_carried_by_a_squeezed_disc() -> None:
    motion = moved(models.two_finger_hand(), HandMove(goal=(pi / 2,), duration=3.0))
    forces = in_cones(motion, press=5.0)
    assert forces.normal.min() > 5.0 * 0.5 * 9.81 * (1 - 1e-6)
    assert forces.friction_use.max() < 0.25
