"""Balances of moments and forces, written out by hand, against what `solve` gives boom cranes."""

import numpy as np
import pytest

from flatrig import feedforward, models

UP = np.array([0.0, 0.0, 1.0])


def solved(name):
    rig = models.make(name)
    reference = feedforward.from_move(models.default_move(name))
    motion = feedforward.solve(rig, reference, np.linspace(0.0, reference.duration, 41))
    assert feedforward.residuals(motion, reference).max() < 1e-12
    return rig, motion


def parts(motion, name):
    """Value, rate and acceleration of a coordinate."""
    column = motion.column(name)
    return (motion.positions[:, column], motion.velocities[:, column],
            motion.accelerations[:, column])  # fmt: skip


def load_of(motion):
    """Place and acceleration of the load, each (N, 3)."""
    place, _, second = (
        np.stack(values, axis=-1)
        for values in zip(*(parts(motion, f"load.{axis}") for axis in "xyz"), strict=True)
    )
    return place, second


def direction(slew, raised):
    """Of a rod at an angle above level on what slews, (N, 3), and its second derivative.

    Angles are (value, rate, acceleration); the level direction is out, that to its left across.
    """
    (phi, spin, turn), (theta, rise, lift) = slew, raised
    out = np.stack([np.cos(phi), np.sin(phi), 0 * phi], axis=-1)
    across = np.stack([-np.sin(phi), np.cos(phi), 0 * phi], axis=-1)
    c, s = np.cos(theta), np.sin(theta)
    c1 = -s * rise
    c2, s2 = -s * lift - c * rise**2, c * lift - s * rise**2
    vector = c[:, None] * out + s[:, None] * UP
    second = (c2 - c * spin**2)[:, None] * out + (2 * c1 * spin + c * turn)[:, None] * across
    return vector, second + s2[:, None] * UP, out, across


def along(force, vector):
    """A force's part along a vector, of whose direction it has to be."""
    unit = vector / np.linalg.norm(vector, axis=1, keepdims=True)
    size = (force * unit).sum(axis=1)
    assert np.abs(np.cross(force, unit)).max() < 1e-9 * np.abs(size).max()
    return size, unit


def test_the_luffing_rope_holds_the_jib_s_moment():
    rig, motion = solved("luffing_crane")
    jib, luffing, hoist = rig.frames[1], rig.ropes[0], rig.ropes[1]
    length, mass, g = 40.0, jib.mass, rig.gravity
    slew, raised = parts(motion, "tower.angle"), parts(motion, "jib.angle")
    u, second, out, across = direction(slew, raised)
    foot = 1.5 * out + 40.0 * UP
    foot_second = 1.5 * (slew[2][:, None] * across - slew[1][:, None] ** 2 * out)
    place, pulled = load_of(motion)
    tip, pendant = foot + length * u, foot + 0.9 * length * u
    winch, top = -4.0 * out + 41.0 * UP, -4.0 * out + 52.0 * UP
    # two falls carry the load; the third part of the same rope runs back to the winch
    last, down = along(rig.loads[0].mass * (pulled + g * UP), tip - place)
    back = (winch - tip) / np.linalg.norm(winch - tip, axis=1, keepdims=True)
    at_tip = last[:, None] * -down + (0.5 * last)[:, None] * back
    held = (top - pendant) / np.linalg.norm(top - pendant, axis=1, keepdims=True)
    # of a uniform rod: the integral of s (acceleration + g) over its mass, s from the foot
    moment = mass * (0.5 * length * (foot_second + g * UP) + length**2 / 3.0 * second)
    missing = np.cross(u, moment) - length * np.cross(u, at_tip)
    lever = 0.9 * length * np.cross(u, held)
    force = (missing * across).sum(axis=1) / (lever * across).sum(axis=1)
    assert motion.tensions[:, 0] == pytest.approx(force / luffing.falls, rel=1e-11)
    assert motion.tensions[:, 1] == pytest.approx(last / hoist.falls, rel=1e-11)
    for index, rope in enumerate(rig.ropes):
        run = parts(motion, rope.coordinate)[2]
        torque = rope.drum_radius * (rope.inertia_along * run - motion.tensions[:, index])
        assert motion.inputs[:, index + 1] == pytest.approx(torque, rel=1e-11)
    # what slews the whole: the momentum about z of tower, jib and load
    whole = rig.frames[0].inertia * slew[2]
    swept = np.cross(foot, mass * (foot_second + 0.5 * length * second))
    swept += np.cross(u, mass * (0.5 * length * foot_second + length**2 / 3.0 * second))
    swept += rig.loads[0].mass * np.cross(place, pulled)
    size = np.abs(motion.inputs[:, 0]).max()
    assert motion.inputs[:, 0] == pytest.approx(whole + swept[:, 2], rel=0, abs=1e-11 * size)


def test_torques_of_the_knuckle_boom_balance_what_hangs_on_it():
    rig, motion = solved("knuckle_crane")
    boom, jib, g = rig.frames[1], rig.frames[2], rig.gravity
    slew, raised = parts(motion, "column.angle"), parts(motion, "boom.angle")
    bent = tuple(a + b for a, b in zip(raised, parts(motion, "jib.angle"), strict=True))
    u, u_second, _, across = direction(slew, raised)
    w, w_second, _, _ = direction(slew, bent)
    knee, knee_second = 24.0 * u, 24.0 * u_second  # from the boom's hinge, on the axis
    place, pulled = load_of(motion)
    tip = knee + 14.0 * w
    force = rig.loads[0].mass * (pulled + g * UP)
    tension, _ = along(force, tip + 10.0 * UP - place)
    assert motion.tensions[:, 0] == pytest.approx(tension, rel=1e-11)
    # moments about the knee, and about the boom's hinge, of uniform rods and the load's pull
    own = jib.mass * (7.0 * (knee_second + g * UP) + 14.0**2 / 3.0 * w_second)
    about_knee = np.cross(w, own) + np.cross(14.0 * w, force)
    pushed = jib.mass * (knee_second + 7.0 * w_second + g * UP) + force
    about_hinge = about_knee + np.cross(knee, pushed)
    about_hinge += np.cross(u, boom.mass * (12.0 * g * UP + 24.0**2 / 3.0 * u_second))
    for column, moment in ((2, about_knee), (1, about_hinge)):
        lifting = -(moment * across).sum(axis=1)  # about the axis about which a boom rises
        assert motion.inputs[:, column] == pytest.approx(lifting, rel=1e-11)
    slewing = rig.frames[0].inertia * slew[2] + about_hinge[:, 2]
    size = np.abs(motion.inputs[:, 0]).max()
    assert motion.inputs[:, 0] == pytest.approx(slewing, rel=0, abs=1e-11 * size)


@pytest.mark.parametrize("formulation", ["projection, minimal", "minimal extension, twice"])
@pytest.mark.parametrize("name", ["luffing_crane", "knuckle_crane"])
def test_stepping_through_time_arrives_where_the_exact_solution_does(name, formulation):
    rig = models.make(name)
    reference = feedforward.from_move(models.default_move(name))
    step = reference.duration / 60
    found = feedforward.integrate(rig, reference, step=step, formulation=formulation)
    exact = feedforward.solve(rig, reference, found.motion.times)
    assert np.abs(found.motion.positions - exact.positions).max() < 1e-9
    if formulation == "minimal extension, twice":  # whose inputs are differentiated by no scheme
        share = np.abs(found.motion.inputs - exact.inputs) / np.abs(exact.inputs).max(axis=0)
        assert share.max() < 1e-9
