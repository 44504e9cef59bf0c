"""Moves that a hand cannot make, each told in one line with finger, time and amount."""

import re
from dataclasses import replace
from math import pi

import pytest

from flatrig import models
from flatrig.feedforward.rolling import plan_hand
from flatrig.models import Hand, HandMove, PathError

ROLLING = HandMove(
    start=(pi / 3, pi / 4, 0), goal=(pi / 4, 0, pi / 3), duration=10, turning="rolling"
)


def fixed_tips() -> Hand:
    """The three-finger hand with tips that do not turn."""
    hand = models.three_finger_hand()
    tips = (replace(one, surface=replace(one.surface, axes=())) for one in hand.fingers)
    return replace(hand, fingers=tuple(tips))


REFUSED = {
    "spin": (
        models.ball_on_plate(spin=False),
        HandMove(goal=(1.0, 0, 0), turning="axis"),
        r"t = 0\.\d+ s on the object would spin about its contacts by up to 2\.46 rad/s",
    ),
    "plate": (
        models.ball_in_corner(plate_radius=0.005),
        HandMove(goal=(1.0, 0, 0)),
        r"t = 0\.50\d+ s on the contact leaves the plate of finger plate_[xy] by up to 5 mm",
    ),
    "shift": (
        models.ball_on_plate(),
        replace(ROLLING, shift=(0.1, 0, 0)),
        r"cannot shift the object by \(0\.1, 0, 0\) m",
    ),
    "angles": (
        models.two_finger_hand(),
        HandMove(goal=(1.0, 0, 0)),
        "needs one angle for an orientation, the move has 3",
    ),
    "fixed tips": (
        fixed_tips(),
        HandMove(goal=(1.0, 0.5, 0)),
        'the tip of finger finger1 is fixed .* turning="axis"',
    ),
    "contacts": (
        models.three_finger_hand(),
        HandMove(goal=(0.1, 0, 0), contacts=((1.0, 0.5),)),
        "the move has 1 contacts, hand three_finger_hand has 3 tips",
    ),
    "rolling in a corner": (
        models.ball_in_corner(),
        HandMove(goal=(1.0, 0, 0), turning="rolling"),
        "not a level plate under a ball",
    ),
    "touch": (
        models.ball_on_plate(),
        replace(ROLLING, touch=(0.1, 0)),
        'touch is .* needs turning="spinning"',
    ),
    "rough": (models.ball_on_plate(), replace(ROLLING, order=1), "order is 1"),
    "short": (models.ball_on_plate(), replace(ROLLING, duration=0.0), "duration is 0 s"),
    "level tip": (
        models.three_finger_hand(),
        HandMove(goal=(pi / 6, pi / 6, -pi / 6)),
        r"t = 0\.7925 s on the contact of finger finger1 is up to 0\.926 degrees too near",
    ),
    "meeting": (
        models.three_finger_hand(),
        HandMove(
            goal=(0, 0, 0),
            contacts=((7 * pi / 6, -pi / 4), (11 * pi / 6, -pi / 4), (11 * pi / 6, -1.0)),
        ),
        r"fingers finger2 and finger3 would be up to 14\.\d mm inside each other",
    ),
}


@pytest.mark.parametrize(("hand", "move", "message"), REFUSED.values(), ids=REFUSED)
def test_impossible_moves_are_refused(hand: Hand, move: HandMove, message: str) -> None:
    with pytest.raises(PathError, match=message) as caught:
        plan_hand(hand, move)
    assert "\n" not in str(caught.value)


def test_a_contact_that_leaves_a_fixed_tip_is_refused() -> None:
    hand = models.two_finger_hand()
    small = replace(hand.fingers[1], surface=replace(hand.fingers[1].surface, reach=0.5))
    hand = replace(hand, fingers=(hand.fingers[0], small))
    message = re.escape("the contact leaves the tip of finger right by up to 12.3 degrees")
    with pytest.raises(PathError, match=message):
        plan_hand(hand, HandMove(goal=(1.0,)))


def test_a_finger_behind_a_plate_is_refused() -> None:
    hand = models.three_finger_hand()
    ground = replace(models.ball_on_plate().fingers[0], name="ground")
    mixed = replace(hand, fingers=(ground, hand.fingers[0]))
    move = HandMove(goal=(0.0, 0, 0), contacts=((7 * pi / 6, -1.4),))
    with pytest.raises(PathError, match=r"finger finger1 would be up to .* mm behind the plate"):
        plan_hand(mixed, move)
