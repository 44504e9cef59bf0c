"""Driftless systems against the printed ones, and the classification of K's table 2.1."""

from dataclasses import replace

import numpy as np
import pytest

from flatrig import models
from flatrig.feedforward.rolling import Rolling, classify, constraint_matrix, table
from flatrig.feedforward.rolling.classification import random_state
from flatrig.feedforward.rolling.kinematics import spin_direction
from flatrig.feedforward.series.rotation import rotation_of
from flatrig.models.types import Array

R = 0.05
HANDS = {
    **{name: build() for name, build in models.HAND_CATALOGUE.items()},
    "ball_on_plate without spin": models.ball_on_plate(spin=False),
    "ball_between_plates without spin": models.ball_between_plates(spin=False),
}


def rpy_rates(rotation: Array, rate: Array) -> Array:
    """Rates of (phi, theta, psi) from a rotation and its rate, by differentiating K 2.15."""
    level = rotation[0, 0] ** 2 + rotation[1, 0] ** 2
    phi = (rate[1, 0] * rotation[0, 0] - rate[0, 0] * rotation[1, 0]) / level
    psi = (rate[2, 1] * rotation[2, 2] - rate[2, 2] * rotation[2, 1]) / level
    return np.array([phi, -rate[2, 0] / np.sqrt(level), psi])


def derived(hand: models.Hand, angles: Array, inputs: Array) -> tuple[Array, dict[str, Array]]:
    """RPY rates and the rates of the contact points on plates at an orientation."""
    rolling = Rolling.of(hand)
    state = rolling.state(rotation_of(tuple(angles)), np.zeros(3))
    rate = rolling.rates(state, inputs)
    matrix, turned = (array[:9].reshape(3, 3).T for array in (state, rate))
    contacts = {name: rate[rolling.blocks[f"c.{name}"]] for name in hand.finger_names}
    return rpy_rates(matrix, turned), contacts


@pytest.mark.parametrize("spin", [True, False])
@pytest.mark.parametrize("two", [False, True])
def test_ball_on_plates_matches_print(spin: bool, two: bool) -> None:
    """K 2.85 with spin and 2.91 without, for both examples."""
    build = models.ball_between_plates if two else models.ball_on_plate
    hand = build(radius=R, spin=spin)
    names = Rolling.of(hand).input_names
    random = np.random.default_rng(1)
    for _ in range(20):
        angles = random.uniform(-1.2, 1.2, 3)
        inputs = random.standard_normal(len(names))
        rates, contacts = derived(hand, angles, inputs)
        u1, u2 = contacts[hand.finger_names[0]][:2]
        u3 = inputs[names.index("w.z")] if spin else 0.0
        phi, theta, _ = angles
        printed = [
            u1 / R * np.sin(phi) * np.tan(theta) - u2 / R * np.cos(phi) * np.tan(theta) + u3,
            u1 / R * np.cos(phi) + u2 / R * np.sin(phi),
            u1 * np.sin(phi) / (R * np.cos(theta)) - u2 * np.cos(phi) / (R * np.cos(theta)),
        ]
        np.testing.assert_allclose(rates, printed, atol=1e-11)
        if two:  # K 2.32
            np.testing.assert_allclose(contacts["upper"], -contacts["lower"], atol=1e-15)


def test_ball_in_corner_matches_print() -> None:
    """K 2.47 and the integrated constraints 2.44."""
    hand = models.ball_in_corner(radius=R)
    random = np.random.default_rng(2)
    for _ in range(20):
        angles = random.uniform(-1.2, 1.2, 3)
        rates, contacts = derived(hand, angles, random.standard_normal(6))
        first, second, third = (contacts[name] for name in ("plate_y", "plate_x", "plate_z"))
        u1, u2, u3 = first[0], second[2], first[2]
        phi, theta, _ = angles
        printed = [
            (-u1 - u2 * np.sin(phi) * np.tan(theta) + u3 * np.cos(phi) * np.tan(theta)) / R,
            (-u2 * np.cos(phi) - u3 * np.sin(phi)) / R,
            (-u2 * np.sin(phi) + u3 * np.cos(phi)) / (R * np.cos(theta)),
        ]
        np.testing.assert_allclose(rates, printed, atol=1e-11)
        integrated = [first[2] + third[1], second[2] + third[0], first[0] + second[1]]
        np.testing.assert_allclose(integrated, 0.0, atol=1e-15)


def test_oblique_plates_keep_the_printed_constraints() -> None:
    """K 2.37 to 2.40; in 2.40 the sign of the vertical velocity is a misprint, put right here."""
    hand = models.ball_between_oblique_plates(radius=R, tilt=0.4)
    rolling = Rolling.of(hand)
    normal = np.array(hand.fingers[1].contact) * -1.0
    x, _, z = normal
    random = np.random.default_rng(3)
    for _ in range(20):
        inputs = random.standard_normal(4)
        moving, turning = np.split((rolling.basis @ inputs)[:6], 2)
        _, contacts = derived(hand, random.uniform(-1, 1, 3), inputs)
        np.testing.assert_allclose(contacts["lower"][:2], [R * turning[1], -R * turning[0]])
        sideways = moving[1] * x + R * turning[0] * x * z - R * turning[2] * x * x
        along = moving[0] * x * z - moving[2] * x * x - R * turning[1] * x
        # K 2.39 and 2.40 with the upper plate's normal in the plane y = 0.
        assert abs(sideways) < 1e-14
        assert abs(along) < 1e-14


def test_planar_constraint_integrates_as_printed() -> None:
    """K example 7: xi' + r / (r + R) phi' = 0 for the contact angle in the object's axes."""
    hand = models.two_finger_hand(radius=0.05, tip_radius=0.02)
    rolling = Rolling.of(hand)
    state = random_state(rolling, np.random.default_rng(4))
    rate = rolling.rates(state, np.array([0.3, -0.2, 0.7]))
    phi_rate = -0.7  # about -y, from x to z
    for name in hand.finger_names:
        x, _, z = state[rolling.blocks[f"e.{name}"]]
        x_rate, _, z_rate = rate[rolling.blocks[f"e.{name}"]]
        xi_rate = x * z_rate - z * x_rate - phi_rate
        assert xi_rate == pytest.approx(-0.02 / 0.07 * phi_rate, abs=1e-14)


@pytest.mark.parametrize("hand", HANDS.values(), ids=HANDS)
def test_admissible_velocities_satisfy_all_constraints(hand: models.Hand) -> None:
    rolling = Rolling.of(hand)
    random = np.random.default_rng(5)
    for _ in range(5):
        state = random_state(rolling, random)
        normals = np.array(
            [
                state[rolling.blocks[f"e.{finger.name}"]]
                if f"e.{finger.name}" in rolling.blocks
                else finger.contact
                for finger in hand.fingers
            ]
        )
        matrix = constraint_matrix(hand, normals)
        inputs = random.standard_normal(len(rolling.input_names))
        velocities = rolling.velocities(inputs, normals)
        np.testing.assert_allclose(matrix @ velocities, 0.0, atol=1e-14)
        null = matrix.shape[1] - np.linalg.matrix_rank(matrix)
        assert null == len(inputs)


def test_spin_is_about_the_common_normal_of_two_contacts_and_of_no_three() -> None:
    down, up, side = (0.0, 0.0, -1.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
    hand = models.ball_between_plates()
    np.testing.assert_allclose(
        spin_direction(hand, np.array([down, up])), [0, 0, 0, 0, 0, 1], atol=1e-15
    )
    with pytest.raises(models.RigError, match="cannot spin about all its 3 contacts"):
        spin_direction(hand, np.array([down, up, side]))
    with pytest.raises(models.RigError, match="leave spin=True"):
        classify(replace(models.ball_in_corner(), spin=False))


@pytest.mark.parametrize(
    ("name", "flag", "holonomic", "flat", "liouvillian"),
    [
        ("ball_on_plate", (2, 0), False, "yes", "yes"),
        ("ball_on_plate without spin", (3, 2, 0), False, "no", "yes"),
        ("ball_between_plates", (2, 0), False, "yes", "yes"),
        ("ball_between_plates without spin", (3, 2, 0), False, "no", "yes"),
        ("ball_between_oblique_plates", (3, 0), False, "?", "yes"),
        ("ball_in_corner", (3, 0), False, "?", "yes"),
        ("two_finger_hand", (0,), True, "yes", "yes"),
        ("three_finger_hand", (6, 0), False, "?", "yes"),
    ],
)
def test_classification_is_the_printed_one(
    name: str, flag: tuple[int, ...], holonomic: bool, flat: str, liouvillian: str
) -> None:
    """K table 2.1 and the derived flags of lemmas 1 and 2 and proposition 6."""
    found = classify(HANDS[name])
    assert found.derived_flag == flag
    assert (found.holonomic, found.flat, found.liouvillian) == (holonomic, flat, liouvillian)
    assert all(found.reasons)


@pytest.mark.parametrize(
    ("name", "dimension"),
    [
        ("ball_on_plate", 8),
        ("ball_between_plates", 6),
        ("ball_between_oblique_plates", 7),
        ("ball_in_corner", 9),
    ],
)
def test_dimension_after_integration_is_the_printed_one(name: str, dimension: int) -> None:
    """dim M_A of K's examples 1 to 4."""
    assert classify(HANDS[name]).dimension == dimension


@pytest.mark.parametrize("radius", [1e-9, 1e6])
def test_size_does_not_matter_to_the_classification(radius: float) -> None:
    for name in ("ball_on_plate", "ball_between_oblique_plates", "ball_in_corner"):
        sized, own = (classify(models.make_hand(name, **size)) for size in ({"radius": radius}, {}))
        assert sized == own


def test_fixed_tips_in_space_are_not_shown_to_be_liouvillian() -> None:
    hand = models.three_finger_hand()
    fixed = tuple(replace(one, surface=replace(one.surface, axes=())) for one in hand.fingers)
    found = classify(replace(hand, fingers=fixed))
    assert (found.flat, found.liouvillian) == ("?", "?")


def test_table_has_a_line_for_each_hand() -> None:
    lines = table(HANDS.values()).splitlines()
    assert len(lines) == len(HANDS) + 1
    assert [line.split()[-1] for line in lines[1:]].count("0)") == len(HANDS) - 1
    assert lines[-1].split()[-8:] == ["6", "3", "no", "no", "yes", "(3,", "2,", "0)"]
