"""Descriptions of hands: the catalogue, and what a wrong one is told."""

import math
import re
from collections.abc import Callable
from dataclasses import replace

import pytest

from flatrig import models
from flatrig.models import Finger, Hand, HandMove, HeldObject, Plate, RigError, Tip


@pytest.mark.parametrize("name", models.HAND_CATALOGUE)
def test_catalogue_makes_hands_by_name(name: str) -> None:
    hand = models.make_hand(name.replace("_", "-"), friction=0.7)
    assert (hand.name, hand.friction) == (name, 0.7)
    assert models.default_hand_move(hand).duration > 0
    assert len({hand, models.make_hand(name, friction=0.7)}) == 1


def test_solid_objects_have_their_inertia() -> None:
    assert HeldObject("sphere", 0.1, 2.0).inertia == pytest.approx(0.4 * 2.0 * 0.01)
    assert HeldObject("disc", 0.1, 2.0).inertia == pytest.approx(0.5 * 2.0 * 0.01)
    assert HeldObject("sphere", 0.1, 2.0, 0.5).inertia == 0.5


def test_directions_are_made_unit_vectors_and_a_plate_touches_against_its_normal() -> None:
    finger = Finger("a", Plate((0, 0, 2)), slides=((3, 0, 0),))
    assert finger.contact == (0.0, 0.0, -1.0)
    assert finger.slides == ((1.0, 0.0, 0.0),)
    assert finger.masses == (0.1,)


BALL = HeldObject("sphere", 0.1, 0.2)
TIP = Finger("a", Tip(0.02), (0, 0, -1))


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: HeldObject("cube", 0.1, 1.0), "'cube'; known are sphere, disc"),  # type: ignore[arg-type]
        (lambda: HeldObject("sphere", -0.1, 1.0), "radius is -0.1, it must be > 0"),
        (lambda: HeldObject("sphere", 0.1, math.nan), "mass is nan"),
        (lambda: Plate((0, 0, 0)), "normal is (0, 0, 0), it must point somewhere"),
        (lambda: Tip(0.02, axes=((1, 0, 0),)), "one axis, a tip needs none, two or three"),
        (lambda: Tip(0.02, axes=((1, 0, 0), (1, 1, 0))), "must be perpendicular"),
        (lambda: Finger("a", TIP), "must be a Plate or a Tip"),  # type: ignore[arg-type]
        (lambda: replace(TIP, slides=((1, 0, 0), (1, 1, 0))), "must be perpendicular"),
        (lambda: replace(TIP, masses=(1.0,)), "3 slides and 1 masses"),
        (lambda: replace(TIP, name="object"), "name is 'object', which is taken"),
        (lambda: replace(TIP, name="a,b"), "must be 1 to 64 letters, digits"),
        (lambda: Hand("h", 0.1, (TIP,)), "held is 0.1, it must be a HeldObject"),  # type: ignore[arg-type]
        (lambda: Hand("h", BALL, (TIP,), spin="no"), "spin is 'no', it must be True"),  # type: ignore[arg-type]
        (lambda: Hand("h", BALL, ()), "must be one Finger or more"),
        (lambda: Hand("h", BALL, (TIP, TIP)), "must differ in name"),
        (lambda: Hand("h", BALL, (replace(TIP, slides=((1, 0, 0),), masses=()),)), "it needs 3"),
        (lambda: Hand("h", BALL, (TIP,), planar=True), "a disc needs a planar hand"),
        (lambda: models.make_hand("ball_on_plat"), "did you mean ball_on_plate or"),
        (lambda: models.make_hand("ball_on_plate", radus=1), "did you mean radius?"),
        (lambda: models.ball_on_plate().finger("plat"), "did you mean plate?"),
        (lambda: models.ball_between_oblique_plates(tilt=0.0), "between 0 and pi/2"),
        (lambda: HandMove(goal=(1, 2)), "goal has 2 angles"),
        (lambda: HandMove(goal=(1.0,), start=(0, 0, 0)), "start has 3 angles and goal 1"),
        (lambda: HandMove(goal=(1.0,), turning="rolls"), "did you mean rolling?"),  # type: ignore[arg-type]
        (lambda: HandMove(goal=(1.0,), contacts=((1.0,),)), "it needs 2"),  # type: ignore[arg-type]
    ],
)
def test_mistakes_are_told_in_one_line(build: Callable[[], object], message: str) -> None:
    with pytest.raises(RigError, match=re.escape(message)) as caught:
        build()
    assert "\n" not in str(caught.value)


def test_a_planar_hand_keeps_to_its_plane() -> None:
    hand = models.two_finger_hand()
    out = replace(hand.fingers[0], contact=(0, 1, 0))
    with pytest.raises(RigError, match="finger left must slide and touch in the plane y = 0"):
        replace(hand, fingers=(out, hand.fingers[1]))
    turning = replace(hand.fingers[0], surface=Tip(0.02, axes=((1, 0, 0), (0, 0, 1))))
    with pytest.raises(RigError, match="turning tip, a planar hand's are fixed"):
        replace(hand, fingers=(turning, hand.fingers[1]))
