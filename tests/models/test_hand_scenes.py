"""MuJoCo scenes of rolling hands: dynamics of the fingers, what contacts do, runs, the command."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from flatrig import models
from flatrig.feedforward.rolling import grasp_matrix, in_cones, joint_forces, plan_hand
from flatrig.models import ModelError
from flatrig.models.hand.catalogue import HAND_CATALOGUE, default_hand_move, make_hand
from flatrig.models.hand.holding import holding_forces
from flatrig.models.mjcf.hand_contacts import ContactLog, contacts
from flatrig.models.mjcf.hand_model import (
    MUJOCO_DEFAULTS,
    RECOMMENDED,
    ContactSettings,
    compile_hand,
    hand_spec,
    resting_depth,
)
from flatrig.models.mjcf.hand_state import HandIndex, joint_positions, object_poses, slide_positions
from flatrig.training import cli
from flatrig.training.bench import rolling_accuracy as hand_table
from flatrig.training.simulate.hand_runs import Track, run_track, there_and_back

HANDS = tuple(HAND_CATALOGUE)


def at_home(model):
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    return data


def plan_of(name, duration=2.0):
    return plan_hand(make_hand(name), replace(default_hand_move(name), duration=duration))


@pytest.mark.parametrize("name", HANDS)
def test_motors_are_those_that_the_plan_has_forces_for(name):
    plan, model = plan_of(name), compile_hand(make_hand(name), visuals=False)
    still = plan(np.zeros(1))
    wanted = joint_forces(still, in_cones(still)).names
    assert tuple(model.actuator(k).name for k in range(len(wanted))) == wanted
    rest = {model.actuator(k).name for k in range(len(wanted), model.nu)}
    assert all(actuator.endswith(".bearing") for actuator in rest)


@pytest.mark.parametrize("name", HANDS)
def test_scene_stands_alone_and_survives_noise(name):
    model = mujoco.MjModel.from_xml_string(hand_spec(make_hand(name)).to_xml())
    assert [model.camera(k).name for k in range(model.ncam)] == ["overview", "side"]
    data, generator = at_home(model), np.random.default_rng(1)
    np.testing.assert_allclose(data.contact.dist, 0, rtol=0, atol=1e-15)
    for _ in range(300):
        data.ctrl[:] = model.key("home").ctrl + 0.1 * generator.normal(size=model.nu)
        mujoco.mj_step(model, data)
    assert not any(warning.number for warning in data.warning)


def test_slides_move_the_masses_of_the_description():
    hand = make_hand("two_finger_hand")
    model = compile_hand(hand, visuals=False)
    data, inertia = at_home(model), np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    held = (hand.held.mass, hand.held.mass, hand.held.inertia)
    masses = [
        finger.masses[k]
        for finger in hand.fingers
        for k in sorted(range(2), key=lambda k: -finger.masses[k])
    ]
    np.testing.assert_allclose(inertia, np.diag([*held, *masses]), rtol=0, atol=1e-15)


@pytest.mark.parametrize("name", HANDS)
def test_home_is_in_balance(name):
    hand = make_hand(name)
    forces, motion = holding_forces(hand), plan_hand(hand, default_hand_move(name))(np.zeros(1))
    contacts_at_home = replace(motion, normals=np.array([[f.contact for f in hand.fingers]]))
    balance = grasp_matrix(contacts_at_home)[0] @ forces.ravel()
    weight = hand.held.mass * np.array(hand.gravity)
    np.testing.assert_allclose(balance, [*-weight, 0, 0, 0], rtol=0, atol=1e-12)


def test_a_smooth_hand_is_refused():
    with pytest.raises(ModelError, match="two_finger_hand drops its object at home: finger left"):
        models.compile_hand(make_hand("two_finger_hand", friction=0.05))
    assert compile_hand(make_hand("two_finger_hand", friction=0.05), squeeze=60.0)


def test_contacts_of_known_velocities():
    hand = make_hand("ball_on_plate")
    model = compile_hand(hand, visuals=False)
    data, radius = at_home(model), hand.held.radius
    data.qvel[:] = [0.3, 0.1, 0.0, 1.0, 2.0, 3.0, 0.05, -0.1, 0.0]  # of ball, its spin, plate
    data.qpos[9] += 1e-6
    mujoco.mj_forward(model, data)
    now = contacts(hand, model, data)
    relative = np.array([0.25, 0.2]) + radius * np.array([-2.0, 1.0])
    assert now.touching.all()
    np.testing.assert_allclose(now.slip, np.linalg.norm(relative), rtol=1e-4)
    np.testing.assert_allclose(now.roll, radius * np.hypot(1, 2), rtol=1e-12)
    np.testing.assert_allclose(now.spin, -3.0, rtol=1e-12)  # about the normal, downwards
    np.testing.assert_allclose(now.penetration, 1e-6, rtol=1e-6)


def test_contacts_of_a_turning_tip():
    hand = make_hand("three_finger_hand")
    model = compile_hand(hand, visuals=False)
    data, tip = at_home(model), hand.fingers[0].surface
    turn = np.array([0.7, -0.4, 0.2])
    data.qvel[model.joint("finger1.tip").dofadr[0] :][:3] = turn
    data.qpos[model.joint("finger1.slide3").qposadr[0]] += 1e-7
    mujoco.mj_forward(model, data)
    now, normal = contacts(hand, model, data), np.array(hand.fingers[0].contact)
    assert now.touching[0]
    slip = tip.radius * np.linalg.norm(np.cross(turn, normal))
    np.testing.assert_allclose(now.slip, [slip, 0, 0], atol=1e-6)
    np.testing.assert_allclose(now.spin, [-turn @ normal, 0, 0], atol=1e-6)
    np.testing.assert_allclose(now.roll, 0, atol=1e-15)


def test_another_hands_model_is_refused():
    model = compile_hand(make_hand("ball_on_plate"), visuals=False)
    with pytest.raises(ModelError, match=r"not one of hand ball_in_corner: .* 'plate_y'$"):
        ContactLog(make_hand("ball_in_corner"), model)
    with pytest.raises(ModelError, match=r"not one of hand ball_in_corner: .* 'plate_y.slide1'$"):
        HandIndex.of(make_hand("ball_in_corner"), model)


def test_a_track_needs_the_models_time_step():
    model = compile_hand(make_hand("ball_on_plate"), visuals=False)
    with pytest.raises(ModelError, match=r"track has steps of 0.002 s, the model of 0.001"):
        run_track(model, Track.of(plan_of("ball_on_plate"), 2e-3, 0.1))


def test_tips_turn_about_axes_of_the_palm():
    hand = make_hand("three_finger_hand")
    model = compile_hand(hand, visuals=False)
    data, joint = mujoco.MjData(model), model.joint("finger2.tip")
    data.qpos[:] = model.key("home").qpos
    data.qpos[2] += 1.0  # the ball is away
    quaternion = np.array([0.5, -0.1, 0.7, 0.3])
    quaternion /= np.linalg.norm(quaternion)
    data.qpos[joint.qposadr[0] :][:4] = quaternion
    data.ctrl[model.actuator("finger2.turn1").id] = 2e-3
    data.ctrl[model.actuator("finger2.turn2").id] = -1e-3
    mujoco.mj_forward(model, data)
    turning = np.zeros(3)
    mujoco.mju_rotVecQuat(turning, data.qacc[joint.dofadr[0] :][:3], quaternion)
    np.testing.assert_allclose(turning * 1e-5, [2e-3, -1e-3, 0.0], atol=1e-12)
    data.qvel[joint.dofadr[0] :][:3] = 1.0
    for _ in range(10):
        mujoco.mj_step(model, data)
    now, at = np.zeros(3), data.qpos[joint.qposadr[0] :][:4]
    mujoco.mju_rotVecQuat(now, data.qvel[joint.dofadr[0] :][:3], at)
    assert abs(now[2]) < 1e-3 * np.hypot(now[0], now[1])  # the bearing


def test_a_ball_rests_as_deep_as_reckoned():
    hand = make_hand("ball_on_plate")
    model = compile_hand(hand, visuals=False)
    run = run_track(model, Track.still(plan_of("ball_on_plate"), 1e-3, 0.2))
    depth = resting_depth(model, "plate", 9.81 * hand.held.mass)
    # it starts at that depth, and stays
    assert run.log.penetration == pytest.approx(depth, rel=0.02)


def test_contact_dimensions():
    assert (compile_hand(make_hand("ball_in_corner")).geom_condim[:4] == 3).all()
    still = make_hand("ball_on_plate", spin=False)
    geoms = compile_hand(still, visuals=False)
    assert (geoms.geom_condim == 4).all()
    other = compile_hand(still, replace(RECOMMENDED, condim=6), visuals=False)
    assert (other.geom_condim == 6).all()


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"integrator": "RK5"}, "no integrator 'RK5'; did you mean RK4"),
        ({"cone": "eliptic"}, "no cone 'eliptic'; did you mean elliptic"),
        ({"timestep": 0.0}, "timestep is 0.0, it must be a number > 0"),
        ({"solref": (0.004,)}, r"solref is \(0.004,\), it must be 2 numbers > 0"),
        ({"solimp": (0.9, float("nan"), 0.001)}, "solimp is .* it must be 3 numbers > 0"),
        ({"noslip": 1.5}, "noslip is 1.5, it must be a whole number >= 0"),
        ({"condim": 2}, "condim is 2, it must be 1, 3, 4, 6"),
    ],
)
def test_settings_that_cannot_be(settings, said):
    with pytest.raises(ModelError, match=said):
        ContactSettings(**settings)


def test_a_servo_brings_slides_where_they_shall_be():
    hand = make_hand("ball_on_plate")
    model = compile_hand(hand, servo=100.0, visuals=False)
    data = at_home(model)
    gain = model.actuator("plate.slide3").gainprm[0]
    assert gain == pytest.approx(0.1 * 100.0**2)
    data.ctrl[:] += [0.01, 0.0, 0.0]
    for _ in range(150):
        mujoco.mj_step(model, data)
    np.testing.assert_allclose(data.qpos[7:10], [0.01, 0, 0], atol=2e-5)
    with pytest.raises(ModelError, match=r"servo is -1.0 rad/s"):
        compile_hand(hand, servo=-1.0)


def test_there_and_back_is_a_motion():
    plan = plan_of("three_finger_hand", 1.0)
    times = np.linspace(0.7, 1.9, 2401)
    motion = there_and_back(plan, times)
    for place, rate in (
        (motion.position, motion.velocity),
        (motion.velocity, motion.acceleration),
        (motion.finger_positions, motion.finger_velocities),
        (motion.finger_velocities, motion.finger_accelerations),
        (motion.tip_turns, motion.tip_velocities),
        (motion.tip_velocities, motion.tip_accelerations),
    ):
        found = (place[2:] - place[:-2]) / (times[2] - times[0])
        np.testing.assert_allclose(found, rate[1:-1], rtol=0, atol=2e-4 * np.abs(rate).max())


@pytest.mark.parametrize("name", HANDS)
def test_contacts_roll(name):
    case = hand_table.Case.of(name)
    run = case.roll(RECOMMENDED, 1.2)  # the first half and a little more
    assert not run.lost
    assert run.log.slip_ratio < case.slip
    assert run.log.friction_use < 0.9
    assert run.distance.max() < 1e-4
    assert np.degrees(run.turned.max()) < 0.2
    assert run.log.seconds == pytest.approx(1.2)


def test_a_grasp_creeps_less_with_a_higher_impratio():
    case = hand_table.Case.of("two_finger_hand")
    much, little = (
        case.hold(replace(RECOMMENDED, impratio=ratio), 0.3).distance[-1] for ratio in (10, 100)
    )
    assert 5 < much / little < 20
    assert little * 10 / 0.3 < hand_table.CREEP


def test_a_lost_object_ends_the_run():
    plan = plan_of("two_finger_hand")
    slippery = replace(plan.hand, friction=0.1)
    model = compile_hand(slippery, squeeze=60.0, visuals=False)
    run = run_track(model, Track.of(plan, 1e-3, 2.0))
    assert run.lost in plan.hand.finger_names
    assert len(run.qpos) < 2000
    assert run.log.apart.max() > 0.05


@pytest.mark.parametrize("name", HANDS)
def test_states_go_both_ways(name):
    plan, hand = plan_of(name), make_hand(name)
    motion, model = plan(np.array([1.2])), compile_hand(make_hand(name), visuals=False)
    fingers = motion.finger_positions[0]
    qpos = joint_positions(hand, model, motion.position[0], motion.rotation[0], fingers)
    place, rotation = object_poses(hand, qpos[None])
    np.testing.assert_allclose(place, motion.position, rtol=0, atol=1e-15)
    np.testing.assert_allclose(rotation, motion.rotation, rtol=0, atol=1e-14)
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    found = [data.body(finger).xpos for finger in hand.finger_names]
    np.testing.assert_allclose(found, fingers, rtol=0, atol=1e-14)
    slides = slide_positions(hand, fingers[None])[0]
    np.testing.assert_array_equal(qpos[HandIndex.of(hand, model).slides], slides)
    now = contacts(hand, model, data)
    np.testing.assert_allclose(now.penetration[now.touching], 0, atol=1e-12)


def test_planar_poses_turn_from_x_to_z():
    hand = make_hand("two_finger_hand")
    place, rotation = object_poses(hand, np.array([[0.1, 0.3, np.pi / 2, 0, 0, 0, 0]]))
    np.testing.assert_allclose(place, [[0.1, 0.0, 0.3]])
    np.testing.assert_allclose(rotation[0] @ [1, 0, 0], [0, 0, 1], atol=1e-12)


def test_the_command_prints_its_tables(monkeypatch, capsys):
    monkeypatch.setattr(hand_table, "SECONDS", 0.1)
    assert cli.main(["hands", "ball-on-plate"]) == 0
    said = capsys.readouterr().out
    assert "…" not in said
    assert "Rolling for 0.1 s" in said
    assert hand_table.describe(MUJOCO_DEFAULTS).split(",")[0] in said
    assert cli.main(["hands", "--output", "a.gif"]) == 2
    assert "--output films one hand, name it" in capsys.readouterr().err
    assert cli.main(["hands", "ball_on_plte"]) == 2
    assert "did you mean ball_on_plate" in capsys.readouterr().err
