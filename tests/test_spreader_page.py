"""The page docs/how-to/spreader.md, its crane, and that crane by an independent balance."""

from dataclasses import replace
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from flatrig import envs, feedforward, models
from flatrig.models import PathError, RigError

ROOT = Path(__file__).resolve().parents[1]
CRANE = ROOT / "docs" / "how-to" / "spreader.toml"


def moved(**changes):
    rig, move = models.load(CRANE)
    path = feedforward.from_move(replace(move, **changes))
    return rig, path, feedforward.solve(rig, path, np.linspace(0.0, path.duration, 201))


def test_forces_and_torques_balance():
    """Of the box, of the trolley and of each winch, from places and accelerations alone."""
    rig, path, motion = moved()
    assert feedforward.residuals(motion, path).max() < 1e-9
    box, at = rig.platform("box"), motion.column
    angles = [at(name) for name in box.angles]
    turned = Rotation.from_euler("XYZ", motion.positions[:, angles]).as_matrix()
    centre = motion.positions[:, [at(f"box.{axis}") for axis in "xyz"]]
    force = np.zeros_like(centre)
    torque = np.zeros_like(centre)
    trolley = np.zeros(len(centre))
    places = {anchor.name: np.array(anchor.position) for anchor in rig.anchors}
    for column, rope in enumerate(rig.ropes):
        near, far = rope.path
        top = places[near] + np.outer(motion.positions[:, at("trolley.position")], (1, 0, 0))
        lever = turned @ places[far]
        way = top - centre - lever
        pull = motion.tensions[:, [column]] * way / np.linalg.norm(way, axis=1, keepdims=True)
        force += pull
        torque += np.cross(lever, pull)
        trolley -= pull[:, 0]
        speedup = motion.accelerations[:, at(rope.coordinate)]
        winch = rope.winch_inertia * speedup / rope.drum_radius
        drive = motion.inputs[:, column + 1]
        assert_allclose(winch, drive + motion.tensions[:, column] * rope.drum_radius, atol=1e-6)
    second = motion.accelerations[:, [at(f"box.{axis}") for axis in "xyz"]]
    expected = box.mass * (second + np.array([0, 0, rig.gravity]))
    assert_allclose(force, expected, atol=1e-9 * rig.weight)
    # It leans about y alone, so that its spin is the rate of beta, and nothing is gyroscopic.
    lean = motion.accelerations[:, at("box.beta")]
    assert_allclose(torque, np.outer(lean, (0, box.inertia[1], 0)), atol=1e-8 * rig.weight)
    own = motion.accelerations[:, at("trolley.position")] * rig.frames[0].along
    assert_allclose(own, motion.inputs[:, 0] + trolley, atol=1e-6)


def test_what_is_held_must_be_at_rest():
    rig, move = models.load(CRANE)
    with pytest.raises(RigError, match=r"say so: held = \['box.y'\]"):
        feedforward.solve(replace(rig, held=()), feedforward.from_move(move), 0.0)
    message = r"box\.y is held, but at t = .* s it would take .* N to keep it at rest"
    for goal in ((16.0, -10.0, 0.0, 0.0, 0.1), (16.0, -10.0, 0.05, 0.0, 0.0)):
        with pytest.raises(PathError, match=message):
            moved(goal=goal)
    skew = replace(rig.anchors[0], position=(1.5, 3.2, 0.0))
    crooked = replace(rig, anchors=(skew, *rig.anchors[1:]))
    with pytest.raises(PathError, match=r"box\.y is held, but even at rest it would take .* N to"):
        feedforward.solve(crooked, feedforward.from_move(move), 0.0)


def test_slings_that_are_too_many_or_lead_nowhere_are_refused():
    masses = models.Platform("p", 5000.0, (2e4, 4e4, 5e4)), models.Load("hook", 500.0)
    corners = [(2, 1, 1.0), (2, -1, 1.0), (-2, 1, 1.0), (-2, -1, 1.0)]
    anchors = tuple(models.Anchor(f"c{i}", corner, "p") for i, corner in enumerate(corners))
    links = tuple(models.Link(f"s{i}", ("hook", f"c{i}")) for i in range(4))
    crane = replace(
        models.double_pendulum_crane(),
        masses=(models.Trolley("trolley", 500.0, "girder"), *masses),
        anchors=anchors,
        links=links[:3],
        outputs=("p.x", "p.y", "p.z"),
        home={"trolley": 3.0, "hook": (3.0, 0, -4.0), "p": (3.0, 0, -9.0)},
    )
    with pytest.raises(RigError, match="is not flat: its outputs leave 6 degrees of freedom"):
        feedforward.solve(crane, feedforward.hold((3.0, 0, -9.0)), 0.0)
    with pytest.raises(RigError, match="of links s0, s1, s2, s3 one is redundant at home"):
        feedforward.analyse(replace(crane, links=links))


def test_programs_say_the_same_and_what_is_held_is_in_them():
    rig, path, motion = moved()
    stepper = feedforward.Stepper(rig, path.start)
    for i, time in enumerate(motion.times[:40]):
        step = stepper.step(path.derivatives([time], 4)[:, 0], motion.times[1])
        assert_allclose(step.inputs, motion.inputs[i], atol=1e-6)
        assert_allclose(step.tensions, motion.tensions[i], atol=1e-6)
    assert "box.y" in feedforward.source(rig, "c")


def test_an_operator_keeps_what_would_move_the_held_still():
    rig, move = models.load(CRANE)
    stream = feedforward.Stream(rig, move.start, rate=20.0)
    for _ in range(20):
        sample = stream.tick((0.5, 0.1, 0.2, 0.0, 0.2))
    assert_allclose(sample.velocity[[2, 4]], 0.0)
    assert stream.outputs[0] > 0.01


def test_it_runs_as_an_environment():
    env = envs.Feedforward(envs.PD(gym.make(envs.OWN, rig=str(CRANE), sensors="full")))
    env.reset(seed=0)
    over = False
    while not over:
        *_, late, info = env.step(np.zeros(5))
        over = late
    assert np.linalg.norm(info["load"] - models.load(CRANE)[1].goal) < 1e-4
