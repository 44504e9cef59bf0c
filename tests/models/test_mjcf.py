"""MuJoCo models: accelerations by the printed equations, names, and the armature checks."""

import math
import re
from itertools import pairwise

import mujoco
import numpy as np
import pytest

from flatrig import models
from flatrig.models import ModelError
from flatrig.models.mjcf import armature, rig_model, rig_state, simulate
from flatrig.models.rig import lengths
from flatrig.models.rig.chain import apart, joint_names

ON_CHAINS = [name for name in models.CATALOGUE if not apart(models.make(name))]
RIGS = [*ON_CHAINS, "cantilever", "gantry", "planar navy", "navy", "four falls"]


@pytest.fixture(params=RIGS)
def rig(request, other_rigs):
    return other_rigs.get(request.param) or models.make(request.param)


def lagrange(mass, force, gradient, curvature):
    """Solve M q'' + G' mu = f, G q'' = -curvature for (q'', mu): a printed DAE at one state."""
    size = len(mass)
    matrix = np.block([[mass, gradient[:, None]], [gradient[None], np.zeros((1, 1))]])
    solution = np.linalg.solve(matrix, np.append(force, -curvature))
    return solution[:size], solution[size]


def overhead_dae(s, rope, x, z, ds, dl, dx, dz, u):
    """Y 5.41 to 5.47: accelerations of (s, l, x, z) and the rope's tension."""
    mass = np.diag([10.0, 0.1 / 0.1**2, 100.0, 100.0])
    force = np.array([u[0], u[1] / 0.1, 0.0, -100.0 * 9.81])
    gradient = np.array([-(x - s), -rope, x - s, z])
    found, multiplier = lagrange(mass, force, gradient, (dx - ds) ** 2 + dz**2 - dl**2)
    return found, multiplier * rope


def rotary_dae(phi, s, rope, p, dphi, ds, dl, dp, u):
    """Y 5.71 to 5.77 with the signs of 5.137: accelerations of (phi, s, l, x, y, z), tension."""
    trolley = 10.0
    mass = np.diag([480.0 + trolley * s**2, trolley, 0.1 / 0.1**2, 100.0, 100.0, 100.0])
    force = np.array([u[0], u[1], u[2] / 0.1, 0.0, 0.0, -100.0 * 9.81])
    force[:2] += [-2 * trolley * s * ds * dphi, trolley * s * dphi**2]
    out = np.array([math.cos(phi), math.sin(phi), 0.0])
    side = np.array([-math.sin(phi), math.cos(phi), 0.0])
    span = p - s * out
    speed = dp - ds * out - s * dphi * side
    gradient = np.array([-s * span @ side, -span @ out, -rope, *span])
    centripetal = -(2 * ds * dphi * side - s * dphi**2 * out)
    curvature = speed @ speed + span @ centripetal - dl**2
    found, multiplier = lagrange(mass, force, gradient, curvature)
    return found, multiplier * rope


@pytest.mark.parametrize("visuals", [True, False])
def test_overhead_accelerations(visuals, random_states):
    rig = models.overhead_crane()
    model = rig_model.compile(rig, visuals=visuals)
    qpos, qvel, ctrl = random_states(rig)
    qacc = simulate.accelerations(model, qpos, qvel, ctrl)
    values, rates = rig_state.coordinates(rig, model, rig_state.State(qpos, qvel))
    motion = rig_state.points(rig, qpos, qvel, qacc)
    rope = lengths.spans(rig, motion)["hoist"].sum(-1)
    tension = rig_state.tensions(rig, qpos, qvel, qacc, ctrl)
    for k in range(len(qpos)):
        names = ("trolley.position", "hoist.length", "load.x", "load.z")
        arguments = [values[name][k] for name in names] + [rates[name][k] for name in names]
        expected, force = overhead_dae(*arguments, ctrl[k])
        found = [motion["trolley"][2, k, 0], rope[2, k], *motion["load"][2, k, [0, 2]]]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * abs(expected).max())
        np.testing.assert_allclose(tension[k, 0], force, rtol=1e-10)


def test_rotary_accelerations(random_states):
    rig = models.rotary_crane()
    model = rig_model.compile(rig, visuals=False)
    qpos, qvel, ctrl = random_states(rig)
    qacc = simulate.accelerations(model, qpos, qvel, ctrl)
    values, rates = rig_state.coordinates(rig, model, rig_state.State(qpos, qvel))
    motion = rig_state.points(rig, qpos, qvel, qacc)
    rope = lengths.spans(rig, motion)["hoist"].sum(-1)
    tension = rig_state.tensions(rig, qpos, qvel, qacc, ctrl)
    for k in range(len(qpos)):
        names = ("bridge.angle", "trolley.position", "hoist.length")
        arguments = [*(values[name][k] for name in names), motion["load"][0, k]]
        arguments += [*(rates[name][k] for name in names), motion["load"][1, k]]
        expected, force = rotary_dae(*arguments, ctrl[k])
        found = [*qacc[k, :2], rope[2, k], *motion["load"][2, k]]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * abs(expected).max())
        np.testing.assert_allclose(tension[k, 0], force, rtol=1e-10)


def test_everything_is_named(rig):
    model = rig_model.compile(rig)
    kinds = {
        "BODY": model.nbody, "JOINT": model.njnt, "GEOM": model.ngeom, "SITE": model.nsite,
        "CAMERA": model.ncam, "LIGHT": model.nlight, "TENDON": model.ntendon,
        "ACTUATOR": model.nu, "SENSOR": model.nsensor, "KEY": model.nkey,
        "MATERIAL": model.nmat, "TEXTURE": model.ntex,
    }  # fmt: skip
    for kind, count in kinds.items():
        names = [
            mujoco.mj_id2name(model, mujoco.mjtObj.__members__[f"mjOBJ_{kind}"].value, k)
            for k in range(count)
        ]
        assert all(names)
        assert len(set(names)) == count
    joints = tuple(model.joint(k).name for k in range(model.njnt))
    assert joints == joint_names(rig)
    assert tuple(model.actuator(k).name for k in range(model.nu)) == rig.input_names
    assert {"overview", "side"} == {model.camera(k).name for k in range(model.ncam)}
    assert {point.name for point in (*rig.anchors, *rig.masses)} == {
        model.site(k).name for k in range(model.nsite)
    }


def test_scenes_carry_only_what_they_need(rig):
    bare = rig_model.compile(rig, visuals=False)
    for count in (bare.ngeom, bare.ncam, bare.nlight, bare.nmat, bare.ntex, bare.nsensor):
        assert count == 0
    both = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    assert bare.opt.disableflags == both
    assert (
        rig_model.compile(rig, friction=True).opt.disableflags
        == mujoco.mjtDisableBit.mjDSBL_CONTACT
    )
    dressed = rig_model.compile(rig)
    assert not dressed.geom_contype.any()
    assert not dressed.geom_conaffinity.any()
    np.testing.assert_array_equal(dressed.body_mass, bare.body_mass)
    np.testing.assert_array_equal(dressed.body_inertia, bare.body_inertia)


def test_friction_can_be_set_at_run_time():
    rig = models.overhead_crane()
    model = rig_model.compile(rig, visuals=False, friction=True)
    model.tendon_frictionloss[model.tendon("hoist").id] = 30.0
    home = model.key("home")
    push = home.ctrl + np.array([0.0, 2.9])  # 29 N along the rope
    held = simulate.run(model, home.qpos, np.zeros(model.nv), np.tile(push, (500, 1)))
    assert abs(held.qvel[-1]).max() < 1e-3
    let_go = simulate.run(
        model, home.qpos, np.zeros(model.nv), np.tile(push + np.array([0.0, 1.1]), (500, 1))
    )
    assert let_go.qvel[-1, 2] < -0.01


@pytest.mark.parametrize("name", models.CATALOGUE)
def test_home_is_at_rest_under_its_inputs(name):
    rig = models.make(name)
    model = rig_model.compile(rig, visuals=False)
    home = model.key("home")
    np.testing.assert_allclose(home.qpos, model.qpos0, atol=1e-15)
    qacc = simulate.accelerations(model, home.qpos, np.zeros(model.nv), home.ctrl)
    # The inputs are rounded to 1e-9.  A length that an equality holds is known to its last digit,
    # and 1/(impedance times time constant)^2 of that is an acceleration (MuJoCo's solref).
    stiff = 1.0 / (model.eq_solimp[:, 0] * model.eq_solref[:, 0]) ** 2
    digit = np.spacing(model.tendon_length0[model.eq_obj1id])
    assert abs(qacc).max() < 1e-9 + (stiff * digit).max(initial=0.0)
    tensions = rig_state.tensions(rig, home.qpos, np.zeros(model.nv), qacc[0], home.ctrl)
    assert (tensions[list(rig.pulling)] > 0).all()
    places = {name: point[0] for name, point in rig_state.points(rig, home.qpos, home.qvel).items()}
    for mass in (*rig.loads, *rig.platforms):
        np.testing.assert_allclose(places[mass.name], rig.home[mass.name], rtol=0, atol=1e-12)
        pull = np.array([0.0, 0.0, -mass.mass * rig.gravity])
        own = {mass.name, *(anchor.name for anchor in rig.anchors if anchor.frame == mass.name)}
        paths = [(rope.path, rope.falls) for rope in rig.ropes]
        paths += [(link.ends, 1) for link in rig.links]
        for (path, falls), tension in zip(paths, tensions, strict=True):
            for pair in pairwise(path):
                times = falls if pair == path[-2:] else 1
                for here, there in (pair, pair[::-1]):
                    if here in own:
                        way = places[there] - places[here]
                        pull += times * tension * way / np.linalg.norm(way)
        np.testing.assert_allclose(pull, 0.0, rtol=0, atol=1e-9 * rig.weight)


def wrong_spec() -> mujoco.MjSpec:
    """The rotary crane as one would write it first: the load on a tree of its own."""
    scene = rig_model.spec(models.rotary_crane(), visuals=False)
    scene.delete(scene.body("load"))
    scene.delete(scene.key("home"))
    load = scene.worldbody.add_body(name="load", pos=[5, 0, -5])
    for axis, direction in zip("xyz", np.eye(3), strict=True):
        load.add_joint(name=f"load.{axis}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=direction)
    load.explicitinertial, load.mass, load.inertia = True, 100.0, [1e-12] * 3
    load.add_site(name="load")
    tendon = scene.add_tendon(name="hoist", armature=10.0)  # the old one went with the old load
    tendon.wrap_site("trolley")
    tendon.wrap_site("load")
    return scene


@pytest.mark.parametrize("check", ["check", "check_structure", "check_numbers"])
def test_checks_refuse_a_load_on_its_own_tree(check):
    model = wrong_spec().compile()
    with pytest.raises(ModelError, match=r"tendon hoist couples joints .* and load\.\w"):
        getattr(armature, check)(model)
    model.tendon_armature[:] = 0.0
    getattr(armature, check)(model)


def test_checks_pass_on_sound_models(rig):
    rig_model.check(rig_model.compile(rig))


def test_wrong_options():
    rig = models.overhead_crane()
    with pytest.raises(ModelError, match="no integrator 'RK5'; did you mean RK4"):
        rig_model.compile(rig, integrator="RK5")
    with pytest.raises(ModelError, match="no integrator 3; known are EULER, RK4"):
        rig_model.compile(rig, integrator=3)
    for timestep in (-1.0, 0, math.inf, math.nan, 1e-300, 1e300, None, "1", True):
        with pytest.raises(
            ModelError, match=rf"timestep is {re.escape(repr(timestep))} s, it must be a number"
        ):
            rig_model.compile(rig, timestep=timestep)
    other = rig_model.compile(models.rotary_crane())
    with pytest.raises(ModelError, match="has 5 joints, rig overhead_crane has 3"):
        rig_state.coordinates(rig, other, rig_state.State(other.qpos0, np.zeros(5)))
    with pytest.raises(ModelError, match=r"coordinate load\.z is missing"):
        rig_state.joint_state(rig, rig_model.compile(rig), {"trolley.position": 0.0, "load.x": 0.0})
