"""MuJoCo models: accelerations, names, the armature checks, state mapping, XML, pictures."""

import dataclasses
import math

import mujoco
import numpy as np
import pytest

from flatrig import models
from flatrig.models import ModelError, OptionError, export, mjcf, render, run, state
from flatrig.models.chain import joint_names, links
from flatrig.models.rig import Anchor, Drive, Frame, Load, Rail, Rig, Rope, Sheave, Trolley

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)

GANTRY = Rig(
    name="gantry",
    frames=(Frame("bridge", "sliding", 50.0, axis=Y),),
    anchors=(Anchor("winch", (-1.0, 0.0, 0.0), frame="bridge"),),
    rails=(Rail("beam", X, frame="bridge", start=0.0, end=6.0),),
    masses=(Trolley("trolley", 7.0, "beam"), Load("load", 40.0)),
    ropes=(Rope("hoist", ("winch", "trolley", "load"), 0.2, 0.3, (Sheave("trolley", 0.05, 0.1),)),),
    drives=(
        Drive("bridge", "bridge", 1e3),
        Drive("trolley", "trolley", 1e3),
        Drive("w", "hoist", 9),
    ),
    outputs=("load.x", "load.y", "load.z"),
    home={"bridge": 1.0, "trolley": 2.0, "load": (2.0, 1.0, -3.0)},
)

NAVY = Rig(
    name="navy",
    frames=(Frame("boom", "turning", 480.0),),
    anchors=(
        Anchor("A", (4.0, 0.0, 3.0), frame="boom"),
        Anchor("P", (8.0, 0.0, 6.0), frame="boom"),
        Anchor("ashore", (0.0, -9.0, 2.0)),
    ),
    masses=(Load("load", 100.0), Load("pulley", 5.0)),
    ropes=(
        Rope("stay", ("A", "pulley"), 0.1, 0.1),
        Rope("hoist", ("P", "pulley", "load"), 0.1, 0.1),
        Rope("tag", ("ashore", "load"), 0.1, 0.1),
    ),
    drives=(
        Drive("boom", "boom", 1e3),
        Drive("stay", "stay", 50.0),
        Drive("hoist", "hoist", 200.0),
        Drive("tag", "tag", 50.0),
    ),
    outputs=("load.x", "load.y", "load.z", "pulley.z"),
    home={"boom": 0.4, "pulley": (7.0, 3.0, 1.0), "load": (7.0, 3.0, -6.0)},
)

TANDEM = Rig(
    name="tandem",
    dimensions=2,
    rails=(Rail("upper", X), Rail("lower", (-1.0, 0.0, 0.0), origin=(3.0, 0.0, -1.0))),
    masses=(Trolley("first", 10.0, "upper"), Trolley("second", 20.0, "lower"), Load("load", 50.0)),
    ropes=(Rope("one", ("first", "load"), 0.1, 0.1), Rope("two", ("second", "load"), 0.1, 0.2)),
    drives=(Drive("first", "first", 1e3), Drive("second", "second", 1e3)),
    outputs=("load.x", "load.z"),
    home={"first": -1.0, "second": 0.5, "load": (1.0, 0.0, -4.0)},
)

RIGS = {name: build() for name, build in models.CATALOGUE.items()} | {
    rig.name: rig for rig in (GANTRY, NAVY, TANDEM)
}
CATALOGUE = tuple(models.CATALOGUE)


@pytest.fixture(params=RIGS)
def rig(request: pytest.FixtureRequest) -> Rig:
    return RIGS[request.param]


def random_states(rig: Rig, count: int = 20) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Joint positions about home, velocities, and inputs within the drives' limits."""
    generator = np.random.default_rng(7)
    home = np.array([value for link in links(rig) for value in link.home])
    limits = np.array([drive.limit for drive in rig.drives])
    return (
        home + generator.uniform(-0.8, 0.8, (count, len(home))),
        generator.uniform(-1, 1, (count, len(home))),
        limits * generator.uniform(-1, 1, (count, len(limits))),
    )


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
def test_overhead_accelerations(visuals):
    rig = models.overhead_crane()
    model = mjcf.compile(rig, visuals=visuals)
    qpos, qvel, ctrl = random_states(rig)
    qacc = run.accelerations(model, qpos, qvel, ctrl)
    values, rates = state.coordinates(rig, model, state.State(qpos, qvel))
    motion = state.points(rig, qpos, qvel, qacc)
    rope = state.spans(rig, motion)["hoist"].sum(-1)
    tension = state.tensions(rig, qpos, qvel, qacc, ctrl)
    for k in range(len(qpos)):
        names = ("trolley.position", "hoist.length", "load.x", "load.z")
        arguments = [values[name][k] for name in names] + [rates[name][k] for name in names]
        expected, force = overhead_dae(*arguments, ctrl[k])
        found = [motion["trolley"][2, k, 0], rope[2, k], *motion["load"][2, k, [0, 2]]]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * abs(expected).max())
        np.testing.assert_allclose(tension[k, 0], force, rtol=1e-10)


def test_rotary_accelerations():
    rig = models.rotary_crane()
    model = mjcf.compile(rig, visuals=False)
    qpos, qvel, ctrl = random_states(rig)
    qacc = run.accelerations(model, qpos, qvel, ctrl)
    values, rates = state.coordinates(rig, model, state.State(qpos, qvel))
    motion = state.points(rig, qpos, qvel, qacc)
    rope = state.spans(rig, motion)["hoist"].sum(-1)
    tension = state.tensions(rig, qpos, qvel, qacc, ctrl)
    for k in range(len(qpos)):
        names = ("bridge.angle", "trolley.position", "hoist.length")
        arguments = [*(values[name][k] for name in names), motion["load"][0, k]]
        arguments += [*(rates[name][k] for name in names), motion["load"][1, k]]
        expected, force = rotary_dae(*arguments, ctrl[k])
        found = [*qacc[k, :2], rope[2, k], *motion["load"][2, k]]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * abs(expected).max())
        np.testing.assert_allclose(tension[k, 0], force, rtol=1e-10)


def test_kinetic_energy_is_that_of_masses_winches_and_sheaves(rig):
    """With the potential, which is plain, this fixes the whole left side of the equations."""
    model = mjcf.compile(rig, visuals=False)
    qpos, qvel, _ = random_states(rig)
    motion, data = state.points(rig, qpos, qvel), mujoco.MjData(model)
    spans = state.spans(rig, motion)
    _, rates = state.coordinates(rig, model, state.State(qpos, qvel))
    expected = sum(frame.inertia * rates[frame.coordinate] ** 2 for frame in rig.frames)
    expected = expected + sum(m.mass * (motion[m.name][1] ** 2).sum(-1) for m in rig.masses)
    for rope in rig.ropes:
        expected = expected + rope.inertia_along * spans[rope.name][1].sum(-1) ** 2
        for sheave in rope.sheaves:
            after = spans[rope.name][1][:, rope.path.index(sheave.at) :].sum(-1)
            expected = expected + sheave.inertia / sheave.radius**2 * after**2
    for k in range(len(qpos)):
        data.qpos[:], data.qvel[:] = qpos[k], qvel[k]
        mujoco.mj_forward(model, data)
        mujoco.mj_energyVel(model, data)
        assert data.energy[1] == pytest.approx(0.5 * expected[k], rel=1e-12)


def test_power_of_inputs_and_gravity(rig):
    """d/dt of the kinetic energy is what the inputs and gravity put in (work of the inputs)."""
    model = mjcf.compile(rig, visuals=False)
    qpos, qvel, ctrl = random_states(rig)
    qacc = run.accelerations(model, qpos, qvel, ctrl)
    _, rates = state.coordinates(rig, model, state.State(qpos, qvel))
    power = np.zeros(len(qpos))
    for column, drive in enumerate(rig.drives):
        part = rig.driven(drive)
        scale = 1 / part.drum_radius if isinstance(part, Rope) else 1.0
        power += ctrl[:, column] * scale * rates[part.coordinate]
    motion = state.points(rig, qpos, qvel, qacc)
    power -= sum(rig.gravity * mass.mass * motion[mass.name][1, :, 2] for mass in rig.masses)
    data = mujoco.MjData(model)

    def kinetic(k, step):
        data.qpos[:] = qpos[k] + step * qvel[k] + 0.5 * step**2 * qacc[k]
        data.qvel[:] = qvel[k] + step * qacc[k]
        mujoco.mj_forward(model, data)
        mujoco.mj_energyVel(model, data)
        return data.energy[1]

    for k in range(len(qpos)):
        change = (kinetic(k, 1e-4) - kinetic(k, -1e-4)) / 2e-4
        assert change == pytest.approx(power[k], rel=1e-5, abs=1e-4 * abs(power).max())


def test_points_and_sensors_agree_with_mujoco(rig):
    model = mjcf.compile(rig)
    qpos, qvel, _ = random_states(rig)
    values, rates = state.coordinates(rig, model, state.State(qpos, qvel))
    motion, data = state.points(rig, qpos, qvel), mujoco.MjData(model)
    for k in range(len(qpos)):
        data.qpos[:], data.qvel[:] = qpos[k], qvel[k]
        mujoco.mj_forward(model, data)
        for name, point in motion.items():
            np.testing.assert_allclose(data.site(name).xpos, point[0, k], atol=1e-12)
        for part in (*rig.frames, *rig.trolleys, *rig.ropes):
            name = part.coordinate
            assert data.sensor(name).data[0] == pytest.approx(values[name][k], abs=1e-12)
            assert data.sensor(f"{name}.rate").data[0] == pytest.approx(rates[name][k], abs=1e-12)
    moved = state.points(rig, qpos + 1e-5 * qvel, qvel), state.points(rig, qpos - 1e-5 * qvel, qvel)
    still = state.points(rig, qpos, qvel, np.zeros_like(qvel))
    for name in motion:
        for order in (0, 1):
            slope = (moved[0][name][order] - moved[1][name][order]) / 2e-5
            np.testing.assert_allclose(slope, still[name][order + 1], atol=1e-7)


def test_joint_state_and_back(rig):
    model = mjcf.compile(rig, visuals=False)
    qpos, qvel, _ = random_states(rig)
    values, rates = state.coordinates(rig, model, state.State(qpos, qvel))
    assert tuple(values) == tuple(rates) == rig.coordinate_names
    back = state.joint_state(rig, model, values, rates)
    np.testing.assert_allclose(back.qpos, qpos, atol=1e-12)
    np.testing.assert_allclose(back.qvel, qvel, atol=1e-12)
    single = state.joint_state(rig, model, {name: value[3] for name, value in values.items()})
    np.testing.assert_allclose(single.qpos, qpos[3], atol=1e-12)
    assert not single.qvel.any()


def test_coordinates_are_copies():
    rig = models.overhead_crane()
    model = mjcf.compile(rig)
    qpos = np.zeros((2, model.nq))
    values, _ = state.coordinates(rig, model, state.State(qpos, qpos))
    values["trolley.position"][:] = 5.0
    assert not qpos.any()
    values, _ = state.coordinates(rig, model, mujoco.MjData(model))
    assert values["load.z"] == -4.0


def test_everything_is_named(rig):
    model = mjcf.compile(rig)
    kinds = {
        "BODY": model.nbody, "JOINT": model.njnt, "GEOM": model.ngeom, "SITE": model.nsite,
        "CAMERA": model.ncam, "LIGHT": model.nlight, "TENDON": model.ntendon,
        "ACTUATOR": model.nu, "SENSOR": model.nsensor, "KEY": model.nkey,
        "MATERIAL": model.nmat, "TEXTURE": model.ntex,
    }  # fmt: skip
    for kind, count in kinds.items():
        names = [mujoco.mj_id2name(model, mujoco.mjtObj.__members__[f"mjOBJ_{kind}"].value, k) for k in range(count)]
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
    bare = mjcf.compile(rig, visuals=False)
    for count in (bare.ngeom, bare.ncam, bare.nlight, bare.nmat, bare.ntex, bare.nsensor):
        assert count == 0
    both = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    assert bare.opt.disableflags == both
    assert mjcf.compile(rig, friction=True).opt.disableflags == mujoco.mjtDisableBit.mjDSBL_CONTACT
    dressed = mjcf.compile(rig)
    assert not dressed.geom_contype.any()
    assert not dressed.geom_conaffinity.any()
    np.testing.assert_array_equal(dressed.body_mass, bare.body_mass)
    np.testing.assert_array_equal(dressed.body_inertia, bare.body_inertia)


def test_friction_can_be_set_at_run_time():
    rig = models.overhead_crane()
    model = mjcf.compile(rig, visuals=False, friction=True)
    model.tendon_frictionloss[model.tendon("hoist").id] = 30.0
    home = model.key("home")
    push = home.ctrl + np.array([0.0, 2.9])  # 29 N along the rope
    held = run.run(model, home.qpos, np.zeros(model.nv), np.tile(push, (500, 1)))
    assert abs(held.qvel[-1]).max() < 1e-3
    let_go = run.run(
        model, home.qpos, np.zeros(model.nv), np.tile(push + np.array([0.0, 1.1]), (500, 1))
    )
    assert let_go.qvel[-1, 2] < -0.01


@pytest.mark.parametrize("name", CATALOGUE)
def test_home_is_at_rest_under_its_inputs(name):
    rig = RIGS[name]
    model = mjcf.compile(rig, visuals=False)
    home = model.key("home")
    np.testing.assert_allclose(home.qpos, model.qpos0, atol=1e-15)
    qacc = run.accelerations(model, home.qpos, np.zeros(model.nv), home.ctrl)
    assert abs(qacc).max() < 1e-10
    tensions = state.tensions(rig, home.qpos, np.zeros(model.nv), qacc[0], home.ctrl)
    np.testing.assert_allclose(tensions, 100 * 9.81)
    values, _ = state.coordinates(rig, model, state.State(home.qpos, np.zeros(model.nv)))
    for axis, place in zip("xyz", rig.home["load"], strict=True):
        assert values.get(f"load.{axis}", 0.0) == pytest.approx(place, abs=1e-15)


def wrong_spec() -> mujoco.MjSpec:
    """The rotary crane as one would write it first: the load on a tree of its own."""
    scene = mjcf.spec(models.rotary_crane(), visuals=False)
    scene.delete(scene.body("load"))
    scene.delete(scene.key("home"))
    load = scene.worldbody.add_body(name="load", pos=[5, 0, -5])
    for axis, direction in zip("xyz", (X, Y, Z), strict=True):
        load.add_joint(name=f"load.{axis}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=direction)
    load.explicitinertial, load.mass, load.inertia = True, 100.0, [1e-12] * 3
    load.add_site(name="load")
    return scene


@pytest.mark.parametrize("check", ["check", "check_structure", "check_numbers"])
def test_checks_refuse_a_load_on_its_own_tree(check):
    from flatrig.models import armature

    scene = wrong_spec()
    if not any(tendon.name == "hoist" for tendon in scene.tendons):
        tendon = scene.add_tendon(name="hoist", armature=10.0)
        tendon.wrap_site("trolley")
        tendon.wrap_site("load")
    model = scene.compile()
    with pytest.raises(ModelError, match=r"tendon hoist couples joints .* and load\.\w"):
        getattr(armature, check)(model)
    model.tendon_armature[:] = 0.0
    getattr(armature, check)(model)


def test_checks_pass_on_sound_models(rig):
    mjcf.check(mjcf.compile(rig))


@pytest.mark.parametrize("name", CATALOGUE)
def test_exported_scenes_are_current_and_stand_alone(name, tmp_path):
    rig, stored = RIGS[name], export.FOLDER / f"{name}.xml"
    assert stored.read_text() == export.xml(rig), "run `python -m flatrig.models.export`"
    (tmp_path / "alone.xml").write_text(stored.read_text())
    alone = mujoco.MjModel.from_xml_path(str(tmp_path / "alone.xml"))
    mjcf.check(alone)
    model = mjcf.compile(rig)
    state_of = random_states(rig)
    expected, found = run.accelerations(model, *state_of), run.accelerations(alone, *state_of)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-15 * abs(expected).max())
    sections = ["compiler", "option", "default", "asset", "worldbody", "tendon", "actuator"]
    sections += ["sensor", "keyframe"]
    places = [stored.read_text().index(f"\n  <{section}") for section in sections]
    assert places == sorted(places)


@pytest.mark.parametrize("name", CATALOGUE)
def test_noise_on_the_inputs_raises_no_warning(name):
    model = mujoco.MjModel.from_xml_path(str(export.FOLDER / f"{name}.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    generator, home = np.random.default_rng(1), model.key("home").ctrl
    spread = 0.1 * model.actuator_ctrlrange[:, 1]
    for _ in range(1000):
        data.ctrl[:] = home + spread * generator.normal(size=model.nu)
        mujoco.mj_step(model, data)
    assert not any(warning.number for warning in data.warning)
    assert np.isfinite(data.qpos).all()


def test_export_writes_to_a_folder(tmp_path):
    written = export.export(tmp_path / "new")
    assert [path.stem for path in written] == list(CATALOGUE)


def test_run_returns_the_start_and_every_step():
    rig = models.rotary_crane()
    model = mjcf.compile(rig, visuals=False)
    home, data = model.key("home"), mujoco.MjData(model)
    controls = home.ctrl + np.random.default_rng(0).normal(size=(50, model.nu))
    speed = np.linspace(-0.1, 0.1, model.nv)
    found = run.run(model, home.qpos, speed, controls)
    assert found.qpos.shape == (51, model.nq)
    data.qpos[:], data.qvel[:] = home.qpos, speed
    for k, row in enumerate(controls):
        np.testing.assert_array_equal(found.qpos[k], data.qpos)
        data.ctrl[:] = row
        mujoco.mj_step(model, data)
    np.testing.assert_array_equal(found.qvel[-1], data.qvel)


def test_run_refuses_what_cannot_be():
    model = mjcf.compile(models.overhead_crane(), visuals=False)
    start = model.key("home").qpos, np.zeros(model.nv)
    with pytest.raises(ModelError, match=r"shape \(3, 1\), it must be \(N, 2\)"):
        run.run(model, *start, np.zeros((3, 1)))
    with pytest.raises(ModelError, match="not finite at step 1"):
        run.run(model, *start, np.array([[0, 0], [np.nan, 0]]))
    with pytest.raises(ModelError, match="breaks down"):
        run.run(model, *start, np.full((50, 2), 1e13))


def corners_in_picture(model, camera, spots):
    """Whether points lie inside a 4:3 picture of a camera."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    view = model.camera(camera).id
    seen = (np.asarray(spots) - data.cam_xpos[view]) @ data.cam_xmat[view].reshape(3, 3)
    slope = math.tan(math.radians(model.cam_fovy[view] / 2))
    inside = (seen[:, 2] < 0) & (abs(seen[:, 1]) < -slope * seen[:, 2])
    return inside & (abs(seen[:, 0]) < -slope * 4 / 3 * seen[:, 2])


@pytest.mark.parametrize("camera", ["overview", "side"])
def test_cameras_see_the_whole_workspace(rig, camera):
    model = mjcf.compile(rig)
    qpos = np.array([value for link in links(rig) for value in link.home])
    spots = [point[0] for point in state.points(rig, qpos, np.zeros_like(qpos)).values()]
    if rig.name in CATALOGUE:
        move = models.default_move(rig.name)
        for place in (move.start, move.goal):
            spots.append(np.array([place[0], 0.0 if len(place) == 2 else place[1], place[-1]]))
    for rail in rig.rails:
        if math.isfinite(rail.start) and rig.frame(rail.frame) is None:
            spots += [
                np.add(rail.origin, np.multiply(end, rail.direction))
                for end in (rail.start, rail.end)
            ]
    if rig.name == "rotary_crane":
        circle = np.linspace(0, 2 * np.pi, 24)
        spots += [np.array([8 * np.cos(a), 8 * np.sin(a), z]) for a in circle for z in (0, -5)]
    assert corners_in_picture(model, camera, spots).all()


@pytest.fixture
def drawing():
    try:
        return render.backend()
    except ModelError as error:
        pytest.skip(str(error))


def test_pictures(drawing, tmp_path):
    rig = models.rotary_crane()
    model = mjcf.compile(rig)
    turned = state.joint_state(
        rig,
        model,
        {
            "bridge.angle": [0.0, 1.0],
            "trolley.position": [5.0, 5.0],
            "load.x": [5.0, 5 * math.cos(1)],
            "load.y": [0.0, 5 * math.sin(1)],
            "load.z": [-5.0, -3.0],
        },
    )
    images = list(render.frames(model, turned.qpos, [0.0, 1.0], "side", 160, 120, fps=2.0))
    assert [image.shape for image in images] == [(120, 160, 3)] * 3
    assert all(image.dtype == np.uint8 and image.std() > 10 for image in images)
    assert (images[0] != images[2]).any()
    saved = render.save_animation(tmp_path / "crane.gif", images, fps=2.0)
    from PIL import Image

    with Image.open(saved) as animation:
        assert animation.n_frames == 3
        assert animation.info["duration"] == 500
    with pytest.raises(ModelError, match="no camera 'top', it has overview, side"):
        next(render.frames(model, turned.qpos, [0.0, 1.0], "top"))


def test_pictures_refuse_what_cannot_be(tmp_path):
    with pytest.raises(OptionError, match=r"ending must be \.gif or \.mp4"):
        render.save_animation(tmp_path / "crane.avi", [])
    with pytest.raises(OptionError, match="no picture"):
        render.save_animation(tmp_path / "crane.gif", [])
    assert not list(tmp_path.iterdir())
    model = mjcf.compile(models.overhead_crane())
    with pytest.raises(OptionError, match=r"qpos has shape \(2, 2\), it must be \(2, 3\)"):
        next(render.frames(model, np.zeros((2, 2)), [0.0, 1.0]))
    with pytest.raises(OptionError, match="4000 x 480"):
        render.renderer(model, 4000, 480)


def test_no_backend_is_one_clear_line(monkeypatch):
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(render, "_works", lambda name: False)
    monkeypatch.setattr(render.sys, "modules", {})
    monkeypatch.setattr(render.sys, "platform", "linux")
    with pytest.raises(ModelError, match="install one of them"):
        render.backend.__wrapped__()


def test_rigs_that_cannot_be_one_chain():
    light = dataclasses.replace(NAVY, masses=(Load("load", 100.0), Load("pulley", 0.0)))
    with pytest.raises(ModelError, match=r"load pulley: mass is 0 kg, .* small one"):
        mjcf.compile(light)
    skew = dataclasses.replace(TANDEM, rails=(Rail("upper", X), Rail("lower", (0.6, 0.0, 0.8))))
    with pytest.raises(ModelError, match="rail upper is not parallel to rail lower"):
        mjcf.compile(skew)
    two = dataclasses.replace(
        NAVY,
        frames=(*NAVY.frames, Frame("quay", "sliding", 9.0, axis=X)),
        anchors=(*NAVY.anchors[:2], dataclasses.replace(NAVY.anchors[2], frame="quay")),
    )
    with pytest.raises(ModelError, match="tie frames boom and quay together"):
        mjcf.compile(two)
    fixed = dataclasses.replace(
        NAVY,
        rails=(Rail("quay", X),),
        masses=(*NAVY.masses, Trolley("cart", 5.0, "quay")),
        ropes=(*NAVY.ropes[:2], Rope("tag", ("cart", "load"), 0.1, 0.1)),
    )
    with pytest.raises(ModelError, match="tie trolley cart, whose rail is fixed, to frame boom"):
        mjcf.compile(fixed)


def test_wrong_options():
    rig = models.overhead_crane()
    with pytest.raises(ModelError, match="no integrator 'RK5'; did you mean RK4"):
        mjcf.compile(rig, integrator="RK5")
    with pytest.raises(ModelError, match=r"timestep is -1\.0 s"):
        mjcf.compile(rig, timestep=-1.0)
    other = mjcf.compile(models.rotary_crane())
    with pytest.raises(ModelError, match="has 5 joints, rig overhead_crane has 3"):
        state.coordinates(rig, other, state.State(other.qpos0, np.zeros(5)))
    with pytest.raises(ModelError, match=r"coordinate load\.z is missing"):
        state.joint_state(rig, mjcf.compile(rig), {"trolley.position": 0.0, "load.x": 0.0})
