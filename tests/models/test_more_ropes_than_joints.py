"""Rigs with more ropes than degrees of freedom: a rope's number may exceed every joint's."""

import math
from itertools import product

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.models import Anchor, Drive, Load, Platform, Rig, Rope
from flatrig.models.mjcf import simulate

RADIUS, INERTIA = 0.05, 0.01
CORNERS = tuple(product((-1.0, 1.0), repeat=2))


def four_ropes() -> Rig:
    """A load below the middle of four winches, the last three of which are driven."""
    places = ((4.0, 4.0), (-4.0, 4.0), (-4.0, -4.0), (4.0, -4.0))
    return Rig(
        name="four_ropes",
        anchors=tuple(Anchor(f"a{i}", (x, y, 0.0)) for i, (x, y) in enumerate(places)),
        masses=(Load("load", 5.0),),
        ropes=tuple(Rope(f"r{i}", (f"a{i}", "load"), RADIUS, INERTIA) for i in range(4)),
        drives=tuple(Drive(f"r{i}", f"r{i}", 60.0) for i in (1, 2, 3)),
        outputs=("load.x", "load.y", "load.z"),
        home={"load": (0.0, 0.0, -3.0)},
    )


def eight_ropes() -> Rig:
    """A platform on two ropes from above each corner, all driven; two lengths are outputs."""
    above = [
        Anchor(f"a{i}{k}", (5.0 * x + 0.2 * k * y, 4.0 * y - 0.2 * k * x, 5.0))
        for i, (x, y) in enumerate(CORNERS)
        for k in range(2)
    ]
    below = [
        Anchor(f"p{i}{k}", (0.5 * x, 0.4 * y * (-1) ** k, 0.3 - 0.6 * k), "box")
        for i, (x, y) in enumerate(CORNERS)
        for k in range(2)
    ]
    names = [f"r{i}{k}" for i in range(4) for k in range(2)]
    outputs = [f"box.{name}" for name in ("x", "y", "z", "alpha", "beta", "gamma")]
    return Rig(
        name="eight_ropes",
        anchors=(*above, *below),
        masses=(Platform("box", 90.0, (36.0, 35.0, 25.0)),),
        ropes=tuple(Rope(n, (f"a{n[1:]}", f"p{n[1:]}"), RADIUS, INERTIA) for n in names),
        drives=tuple(Drive(n, n, 100.0) for n in names),
        outputs=(*outputs, "r30.length", "r31.length"),
        home={"box": (0.2, 0.1, 1.5)},
    )


KINDS = ("rigid", "elastic", "slack")


@pytest.mark.parametrize("kind", KINDS)
def test_an_idle_rope_leaves_the_others_their_numbers(kind):
    rig = four_ropes()
    held = models.compile(rig, ropes=kind).key_ctrl[0]
    # r0 carries nothing, nor does r2 opposite it; r1 and r3 share the weight
    pull = 0.5 * 5.0 * 9.81 * math.hypot(4.0, 4.0, 3.0) / 3.0
    np.testing.assert_allclose(held, [-pull * RADIUS, 0.0, -pull * RADIUS], rtol=1e-8, atol=1e-8)
    at_rest = feedforward.solve(rig, feedforward.hold((0.0, 0.0, -3.0)), 0.0)
    np.testing.assert_allclose(held, at_rest.inputs[0], rtol=1e-8, atol=1e-8)


def test_a_move_with_an_idle_rope_is_the_equations():
    rig = four_ropes()
    model = models.compile(rig, visuals=False)
    path = feedforward.rest_to_rest((0.0, 0.0, -3.0), (0.6, -0.4, -2.5), duration=2.0, order=4)
    motion = feedforward.solve(rig, path, np.linspace(0.0, 2.0, 9))
    load = [motion.column(f"load.{axis}") for axis in "xyz"]
    qacc = simulate.accelerations(
        model, motion.positions[:, load], motion.velocities[:, load], motion.inputs
    )
    np.testing.assert_allclose(qacc, motion.accelerations[:, load], rtol=0, atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_eight_ropes_hold_a_platform(kind):
    rig = eight_ropes()
    pulls = -models.compile(rig, ropes=kind).key_ctrl[0] / RADIUS
    assert pulls.min() > 0.0
    force, moment = np.zeros(3), np.zeros(3)
    for rope, pull in zip(rig.ropes, pulls, strict=True):
        winch, corner = (np.array(rig.home_point(name)) for name in rope.path)
        along = pull * (winch - corner) / np.linalg.norm(winch - corner)
        force += along
        moment += np.cross(corner - rig.home["box"], along)
    np.testing.assert_allclose(force, [0.0, 0.0, 90.0 * 9.81], atol=1e-5)
    np.testing.assert_allclose(moment, 0.0, atol=1e-5)


def test_eight_lengths_and_angles_are_one_too_many():
    with pytest.raises(models.RigError, match=r"rig eight_ropes .*one equation too many"):
        feedforward.analyse(eight_ropes())
