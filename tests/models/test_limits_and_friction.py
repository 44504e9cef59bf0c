"""Friction, drives' limits and rope ends in a description: kept, written, read, refused."""

from dataclasses import replace

import pytest

from flatrig import models
from flatrig.models.errors import RigError
from flatrig.models.friction import Friction
from flatrig.models.rig.rig import Drive

CRANE = models.overhead_crane()
RUBBING = replace(
    CRANE,
    masses=(
        replace(CRANE.trolleys[0], friction=Friction(12.0, 80.0)),
        replace(CRANE.loads[0], drag=2.0),
    ),
    ropes=(
        replace(
            CRANE.ropes[0],
            friction=Friction(viscous=30.0),
            shortest=0.5,
            longest=9.0,
            two_block=0.6,
        ),
    ),
    drives=(
        Drive("trolley", "trolley", 900.0, -700.0, speed=2.0, acceleration=1.0, rate=1e4),
        Drive("winch", "hoist", 1.0, lower=-12.0, power=3e3, gear=20.0, efficiency=0.9),
    ),
)


def test_a_file_keeps_what_rubs_and_what_is_limited():
    text = models.dumps(RUBBING)
    assert models.loads(text)[0] == RUBBING
    assert "inf" not in text.split("[[ropes]]")[1]  # limits that are none are not written
    assert models.fingerprint(RUBBING) != models.fingerprint(CRANE)


def test_a_file_of_a_rig_without_them_has_no_word_of_them():
    text = models.dumps(CRANE)
    for word in ("friction", "drag", "shortest", "lower", "speed", "gear", "efficiency"):
        assert word not in text


def test_limits_that_are_left_out_are_the_symmetric_ones():
    assert (Drive("d", "x", 5.0).lowest, Drive("d", "x", 5.0).largest) == (-5.0, 5.0)
    hoist = Drive("d", "x", 1.0, lower=-12.0)
    assert (hoist.lowest, hoist.largest) == (-12.0, 12.0)


def changed(part, **values):
    """The rubbing crane with values of one part changed."""
    for kind in ("ropes", "drives", "masses"):
        parts = getattr(RUBBING, kind)
        if any(item.name == part for item in parts):
            parts = tuple(replace(p, **values) if p.name == part else p for p in parts)
            return replace(RUBBING, **{kind: parts})
    raise AssertionError(part)


@pytest.mark.parametrize(
    ("part", "values", "message"),
    [
        ("hoist", {"shortest": 5.0}, "home of rope hoist is 4 m long"),
        ("hoist", {"longest": 3.0}, "home of rope hoist is 4 m long"),
        ("hoist", {"two_block": 4.5}, "its last span is 4 m, its blocks meet at two_block = 4.5 m"),
        ("hoist", {"two_block": -1.0}, "two_block is -1 m, it must be >= 0"),
        ("hoist", {"shortest": 9.0}, "shortest 9 m must lie below longest 9 m"),
        ("hoist", {"friction": Friction(1.0, static=2.0)}, "takes coulomb and viscous alone"),
        ("hoist", {"friction": 3.0}, "friction is 3.0, it must be a Friction"),
        ("load", {"drag": -1.0}, "drag is -1 N s/m, it must be >= 0"),
        ("winch", {"lower": 2.0}, "lower is 2 N or N m, it must be below limit 1"),
        ("winch", {"lower": None, "limit": -1.0}, "limit is -1 N or N m, it must be > 0"),
        ("winch", {"lower": "low"}, "lower is 'low', it must be a number"),
        ("winch", {"speed": 0.0}, "speed is 0 m/s or rad/s, it must be > 0"),
        ("winch", {"power": -1.0}, "power is -1 W, it must be > 0"),
        ("winch", {"gear": 0.0}, "gear is 0, it must be > 0"),
        ("winch", {"efficiency": 1.2}, "efficiency is 1.2, it must be > 0 and at most 1"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(part, values, message):
    with pytest.raises(RigError, match=message) as caught:
        changed(part, **values)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("3.0", "trolleys trolley: friction is 3.0, it must be a table"),
        ("{dry = 3.0}", "friction has no 'dry'"),
        ("{coulomb = -3.0}", "coulomb is -3.0, it must be >= 0"),
    ],
)
def test_a_file_says_what_is_wrong_with_friction(entry, message):
    text = models.dumps(CRANE).replace('rail = "beam" }', f'rail = "beam", friction = {entry} }}')
    with pytest.raises(RigError, match=message):
        models.loads(text)


def test_dry_friction_where_no_drive_acts_is_refused():
    crane = models.roped_overhead_crane()
    trolley = replace(crane.trolleys[0], friction=Friction(2.0, 5.0))
    with pytest.raises(RigError, match=r"trolley .*coulomb friction is 2 N on what no drive acts"):
        replace(crane, masses=(trolley, *crane.masses[1:]))
