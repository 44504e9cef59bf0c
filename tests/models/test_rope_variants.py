"""Elastic and slack ropes: at rest, in the rigid limit, falling, caught, and their tensions."""

import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.feedforward import from_move
from flatrig.models import ModelError, Ropes
from flatrig.models.mjcf import rig_model, rig_state, ropes, simulate, spools
from flatrig.models.rig import lengths
from flatrig.models.rig.chain import apart, joint_names
from flatrig.training.simulate.open_loop import open_loop

RIGS = [*models.CATALOGUE, "four falls"]
KINDS = {
    "elastic": Ropes("elastic", stiffness=1e5, damping=300.0),
    "slack": Ropes("slack"),
    "slack springs": Ropes("slack", ea=1e6),
}
LOAD, WINCH = 100.0, 10.0  # of the overhead crane: mass and J/r^2 [kg]


@pytest.fixture(params=RIGS)
def rig(request, other_rigs):
    return other_rigs.get(request.param) or models.make(request.param)


def bare(rig, made, **options):
    return rig_model.compile(rig, ropes=made, visuals=False, **options)


def tensions(rig, model, qpos, qvel, ctrl):
    return rig_state.tensions(
        rig, qpos, qvel, simulate.accelerations(model, qpos, qvel, ctrl), ctrl
    )


def hanging(model, rig, length, slack=0.0, speed=0.0):
    """The overhead crane's load straight below its trolley, with some loose rope."""
    at = {"trolley.position": 0.0, "load.x": 0.0, "load.z": -length}
    start = rig_model.joint_state(rig, model, at)
    qpos, qvel = start.qpos.copy(), start.qvel.copy()
    qpos[-1] += slack
    qvel[list(joint_names(rig)).index("load.z")] = -speed
    return qpos, qvel


def test_rigid_is_the_default_where_a_chain_holds_the_ropes(rig):
    one, other = rig_model.spec(rig).to_xml(), rig_model.spec(rig, ropes=Ropes()).to_xml()
    assert one == other
    assert ("spool" in one) == bool(apart(rig))


@pytest.mark.parametrize("made", KINDS.values(), ids=KINDS)
def test_home_is_at_rest_with_the_tensions_of_rigid_ropes(rig, made):
    rigid, model = rig_model.compile(rig, visuals=False), bare(rig, made)
    home, ctrl = model.key_qpos[0], model.key_ctrl[0]
    assert_allclose(ctrl, rigid.key_ctrl[0], atol=1e-6)
    acceleration = simulate.accelerations(model, home, 0 * home, ctrl)
    assert_allclose(acceleration, 0.0, atol=1e-6)
    found = tensions(rig, model, home[None], 0 * home[None], ctrl[None])
    start = rigid.key_qpos[0][None]
    assert_allclose(found, tensions(rig, rigid, start, 0 * start, ctrl[None]), atol=1e-6)


@pytest.mark.parametrize("visuals", [True, False])
def test_the_winch_and_the_spring_tell_the_same_tension(rig, visuals, random_states):
    model = rig_model.compile(rig, ropes=KINDS["elastic"], visuals=visuals)
    qpos, qvel, ctrl = random_states(rig)
    qpos, qvel = (values[:, : len(joint_names(rig))] for values in (qpos, qvel))
    motion = lengths.rope_lengths(rig, rig_state.points(rig, qpos, qvel))
    way = np.stack([motion[rope.name] for rope in rig.ropes], axis=-1)
    generator = np.random.default_rng(1)
    stretch, rate = generator.uniform(-0.01, 0.01, (2, *way[0].shape))
    qpos, qvel = np.hstack([qpos, way[0] - stretch]), np.hstack([qvel, way[1] - rate])
    found = tensions(rig, model, qpos, qvel, ctrl)
    found = found[:, : len(rig.ropes)]
    assert_allclose(found, 1e5 * stretch + 300.0 * rate, rtol=1e-9, atol=1e-5)


def test_a_slack_rope_does_not_push_and_an_elastic_one_does():
    rig = models.overhead_crane()
    for name, expected in (("elastic", -1e5 * 0.02), ("slack", 0.0), ("slack springs", 0.0)):
        model = bare(rig, KINDS[name])
        qpos, qvel = hanging(model, rig, 4.0, slack=0.02)
        found = tensions(rig, model, qpos[None], qvel[None], np.zeros((1, 2)))
        assert_allclose(found, expected, atol=1e-6)


def test_stretch_and_frequency_are_those_of_a_spring_between_two_masses():
    rig, k, ratio = models.overhead_crane(), 1e5, 0.05
    model = bare(rig, Ropes("elastic", stiffness=k, damping_ratio=ratio))
    reduced = 1 / (1 / LOAD + 1 / WINCH)
    assert_allclose(spools.frequencies(rig, model), np.sqrt(k / reduced), rtol=1e-9)
    damping = np.ravel(model.tendon_damping)[0]
    assert_allclose(damping, 2 * ratio * np.sqrt(k * reduced), rtol=1e-9)
    home = model.key_qpos[0]
    way = rig_state.paid_out(rig, home[:-1], 0 * home[:-1])["hoist"][0]
    assert_allclose(way - home[-1], LOAD * 9.81 / k, rtol=1e-7)


def test_a_damping_ratio_may_be_given_by_rope():
    rig = models.roped_overhead_crane()
    ratios = (0.05, {"pull": 0.05, "hoist": 0.1})
    alike, by_rope = (
        np.ravel(bare(rig, Ropes("elastic", damping_ratio=ratio)).tendon_damping)
        for ratio in ratios
    )
    assert_allclose(by_rope[by_rope > 0] / alike[alike > 0], [1.0, 2.0], rtol=1e-12)


def test_ea_is_shared_out_over_the_length():
    rig = models.roped_overhead_crane()
    model = bare(rig, Ropes("elastic", ea={"pull": 1e6, "hoist": 2e6}))
    for rope, ea in zip(rig.ropes, (1e6, 2e6), strict=True):
        length = model.key_qpos[0][list(rig.ropes).index(rope) + 3] + 981.0 / ropes.stiffness(
            model, rope
        )
        assert_allclose(ropes.stiffness(model, rope), ea / length, rtol=1e-9)


@pytest.mark.parametrize("name", ["overhead_crane", "navy_crane_3d"])
def test_stiff_ropes_become_rigid(name):
    """Distance from the path and from the exact tensions fall in proportion to 1/k."""
    rig = models.make(name)
    reference = from_move(models.default_move(rig))
    runs = [open_loop(rig, reference, ropes=Ropes("elastic", k)) for k in (1e4, 1e5, 1e6)]
    distances = [one.distance.max() for one in runs]
    errors = [np.abs(one.tensions() - one.motion.tensions).max() for one in runs]
    for values in (distances, errors):
        assert_allclose(np.divide(values[:-1], values[1:]), 10.0, rtol=0.2)


def test_slack_ropes_are_rigid_while_they_pull():
    rig = models.overhead_crane()
    made = open_loop(rig, from_move(models.default_move(rig)), ropes="slack")
    assert made.distance.max() < 5e-5
    assert np.abs(made.tensions() - made.motion.tensions).max() < 2.0


def test_fall_and_catch():
    """Free fall over the slack, a blow that leaves one speed, then winch and load as one."""
    rig, slack, g = models.overhead_crane(), 0.5, 9.81
    model = bare(rig, "slack", timestep=1e-3)
    start = hanging(model, rig, 4.0, slack)
    fall = np.sqrt(2 * slack / g)
    before, after = round(0.9 * fall / 1e-3), round(1.2 / 1e-3)
    found = simulate.run(model, *start, np.zeros((after, 2)))
    ways = lengths.rope_lengths(rig, rig_state.points(rig, found.qpos, found.qvel))["hoist"]
    falling = slice(0, before + 1)
    time = 1e-3 * np.arange(before + 1)
    assert_allclose(ways[0][falling], 4.0 + g * time**2 / 2, atol=1e-10)
    assert_allclose(tensions(rig, model, *(x[falling] for x in found), np.zeros((len(time), 2))), 0)

    speed = LOAD * g * fall / (LOAD + WINCH)
    gain = LOAD * g / (LOAD + WINCH)
    left = after * 1e-3 - fall
    assert_allclose(found.qvel[-1, -1], speed + gain * left, rtol=2e-3)
    assert_allclose(ways[0][-1], found.qpos[-1, -1], atol=2e-4)
    last = [x[-1:] for x in found]
    held = tensions(rig, model, *last, np.zeros((1, 2)))
    assert_allclose(held, WINCH * gain, rtol=1e-2)


def test_a_slack_spring_throws_the_load_back_without_loss():
    rig = models.overhead_crane()
    model = bare(rig, Ropes("slack", stiffness=1e5), timestep=1e-4)
    found = simulate.run(model, *hanging(model, rig, 4.0, 0.1), np.zeros((8000, 2)))
    way, rate = lengths.rope_lengths(rig, rig_state.points(rig, found.qpos, found.qvel))["hoist"]
    stretch = np.maximum(way - found.qpos[:, -1], 0.0)
    winch = WINCH * found.qvel[:, -1] ** 2
    energy = 0.5 * (LOAD * rate**2 + winch + 1e5 * stretch**2) - LOAD * 9.81 * way
    assert stretch.max() > 0.01  # it was caught
    assert (np.diff(np.sign(stretch)) < 0).any()  # and let go
    assert_allclose(energy, energy[0], atol=1e-3)


@pytest.mark.parametrize("name", ["rotary_crane", "navy_crane_2d", "cable_manipulator"])
def test_joint_state_and_back(name):
    rig = models.make(name)
    model = bare(rig, KINDS["elastic"])
    rigid = rig_model.compile(rig, visuals=False)
    home = rig_model.State(rigid.key_qpos[0], np.full(rigid.nv, 0.1))
    values, rates = rig_model.coordinates(rig, rigid, home)
    pulls = np.linspace(10.0, 500.0, len(rig.ropes))
    found = rig_model.joint_state(rig, model, values, rates, tensions=pulls)
    for wanted, got in zip((values, rates), rig_model.coordinates(rig, model, found), strict=True):
        for coordinate, value in wanted.items():
            assert_allclose(got[coordinate], value, atol=1e-12)
    paid = rig_state.paid_out(rig, *found)
    for rope, pull in zip(rig.ropes, pulls, strict=True):
        assert_allclose(values[rope.coordinate] - paid[rope.name][0], pull / 1e5, atol=1e-12)


def test_sensors_read_the_winch():
    rig = models.overhead_crane()
    model = rig_model.compile(rig, ropes=KINDS["elastic"])
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert data.sensor("hoist.length").data[0] == data.joint("hoist.spool").qpos[0]
    assert_allclose(data.tendon("hoist").length - data.qpos[-1], 981.0 / 1e5, rtol=1e-7)


def test_only_limits_leave_constraints_on():
    rig, off = models.overhead_crane(), mujoco.mjtDisableBit
    assert bare(rig, "elastic").opt.disableflags & off.mjDSBL_CONSTRAINT
    flags = bare(rig, "slack").opt.disableflags
    assert not flags & (off.mjDSBL_CONSTRAINT | off.mjDSBL_LIMIT)
    for bit in (off.mjDSBL_CONTACT, off.mjDSBL_EQUALITY, off.mjDSBL_FRICTIONLOSS):
        assert flags & bit


def test_a_spool_that_has_run_out_is_refused():
    rig = models.overhead_crane()
    model = bare(rig, "elastic")
    qpos = model.key_qpos[0].copy()
    qpos[-1] = ropes.reach(rig, rig.ropes[0])
    with pytest.raises(ModelError, match=r"rope hoist: 400 m are paid out, its spool holds 400 m"):
        rig_state.tensions(rig, qpos, 0 * qpos, 0 * qpos, np.zeros(2))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: "elastik", r"ropes cannot be 'elastik'; did you mean elastic\?"),
        (lambda: Ropes("elastic", stiffness=1e5, ea=1e6), "give stiffness or ea, not both"),
        (lambda: Ropes("rigid", ea=1e6), "rigid ropes have no ea"),
        (lambda: Ropes("slack", damping=1.0), "slack ropes have no damping"),
        (lambda: Ropes("elastic", stiffness=0.0), r"stiffness is 0.0, it must be a number > 0"),
        (lambda: Ropes("elastic", damping=-1.0), r"damping is -1.0, it must be a number >= 0"),
        (lambda: Ropes("elastic", ea=float("nan")), r"ea is nan, it must be a number > 0"),
        (lambda: Ropes("elastic", ea={"hosit": 1.0}), r"no rope 'hosit'; did you mean hoist\?"),
    ],
)
def test_wrong_options(make, message):
    with pytest.raises(ModelError, match=message):
        rig_model.compile(models.roped_overhead_crane(), ropes=make())


def test_a_rope_without_its_number_is_named():
    with pytest.raises(ModelError, match="ea is given by rope, but not for pull"):
        rig_model.compile(models.roped_overhead_crane(), ropes=Ropes("elastic", ea={"hoist": 1e6}))
