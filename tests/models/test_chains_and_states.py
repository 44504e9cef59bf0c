"""Rigs and their models' joints: what hangs from what, and the mapping there and back."""

import dataclasses

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flatrig import models
from flatrig.feedforward import from_move, solve
from flatrig.models import ModelError
from flatrig.models.mjcf import rig_model, rig_state, simulate
from flatrig.models.rig import lengths
from flatrig.models.rig.chain import apart, chain_of, joint_names
from flatrig.models.rig.frames import tensor
from flatrig.models.rig.rig import Anchor, Drive, Frame, Load, Rail, Rig, Rope, Sheave, Trolley

X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


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


FALLS = Rig(
    name="falls",
    rails=(Rail("beam", X),),
    anchors=(Anchor("winch", (-1.0, 0.0, 0.0)),),
    masses=(Trolley("trolley", 10.0, "beam"), Load("load", 30.0), Load("weight", 20.0)),
    ropes=(
        Rope("hoist", ("winch", "trolley", "load"), 0.1, 0.1, (Sheave("trolley", 0.02, 0.1),), 4),
        Rope("tail", ("load", "weight"), 0.1, 0.05, falls=2),
    ),
    drives=(
        Drive("trolley", "trolley", 1e3),
        Drive("hoist", "hoist", 50),
        Drive("tail", "tail", 50),
    ),
    outputs=("load.x", "load.z", "weight.z"),
    home={"trolley": 2.0, "load": (2.0, 0.0, -5.0), "weight": (2.0, 0.0, -6.0)},
)


RIGS = {name: rig for name, build in models.CATALOGUE.items() if not apart(rig := build())} | {
    rig.name: rig for rig in (GANTRY, NAVY, TANDEM, FALLS)
}


@pytest.fixture(params=RIGS)
def rig(request):
    return RIGS[request.param]


def given(rig):
    """Frames whose motion is given."""
    return [frame for frame in rig.frames if frame.given]


def base_joints(rig):
    """Joints of a base that moves as given: what moves it has no energy of its own."""
    return [joint_names(rig).index(frame.coordinate) for frame in given(rig)]


def test_kinetic_energy_is_that_of_masses_winches_and_sheaves(rig, random_states):
    """With the potential, which is plain, this fixes the whole left side of the equations."""
    model = rig_model.compile(rig, visuals=False)
    qpos, qvel, _ = random_states(rig)
    qvel[:, base_joints(rig)] = 0.0
    motion, data = rig_state.points(rig, qpos, qvel), mujoco.MjData(model)
    spans = lengths.spans(rig, motion)
    values, rates = rig_state.coordinates(rig, model, rig_state.State(qpos, qvel))
    expected = frame_energy(rig, values, rates)
    expected = expected + sum(m.mass * (motion[m.name][1] ** 2).sum(-1) for m in rig.masses)
    expected = expected + sum(spin_energy(body, rates, values) for body in rig.platforms)
    for rope in rig.ropes:
        parallel = np.array([1.0] * (len(rope.path) - 2) + [rope.falls])
        speeds = spans[rope.name][1] * parallel
        expected = expected + rope.inertia_along * speeds.sum(-1) ** 2
        for sheave in rope.sheaves:
            after = speeds[:, rope.after(sheave) :].sum(-1)
            expected = expected + sheave.inertia / sheave.radius**2 * after**2
    for k in range(len(qpos)):
        data.qpos[:], data.qvel[:] = qpos[k], qvel[k]
        mujoco.mj_forward(model, data)
        mujoco.mj_energyVel(model, data)
        assert data.energy[1] == pytest.approx(0.5 * expected[k], rel=1e-12)


def test_a_sheave_turns_with_the_rope_beyond_it_even_at_the_winch():
    """A rope that comes back to the anchor of its winch: the sheave is where it passes again."""
    rig = dataclasses.replace(
        GANTRY,
        ropes=(
            Rope(
                "hoist", ("winch", "trolley", "winch", "load"), 0.2, 0.3,
                (Sheave("winch", 0.05, 0.1),),
            ),
        ),
    )  # fmt: skip
    scene = rig_model.spec(rig, visuals=False)
    assert [wrap.target.name for wrap in scene.tendon("hoist.winch").path] == ["winch", "load"]


def frame_energy(rig, values, rates):
    """Twice the energy of all frames, from spin and speed that each adds to those of its parent."""
    count = len(next(iter(rates.values()), np.zeros(20)))
    turned, still = np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3))
    moving, total = {"world": (turned, still, still)}, np.zeros(count)
    for frame in rig.frames:
        turned, spin, speed = moving[frame.parent]
        axis, value = turned @ frame.axis, values[frame.coordinate][:, None]
        rate = rates[frame.coordinate][:, None]
        arm = turned @ frame.origin
        if frame.kind == "turning":
            turned = turned @ Rotation.from_rotvec(value * frame.axis).as_matrix()
            speed, spin = speed + np.cross(spin, arm), spin + rate * axis
        else:
            speed = speed + np.cross(spin, arm + value * axis) + rate * axis
        moving[frame.name] = turned, spin, speed
        alone = frame.inertia if isinstance(frame.inertia, float) else 0.0
        along = rate if frame.kind == "turning" else speed
        total += alone * (along**2).sum(axis=1)
        centre = speed + np.cross(spin, turned @ frame.centre)
        about = np.einsum("nki,nk->ni", turned, spin)  # in its own axes
        total += frame.mass * (centre**2).sum(axis=1)
        total += np.einsum("ni,ij,nj->n", about, tensor(frame.inertia), about)
    return total


def spin_energy(platform, rates, values):
    """Twice the energy of a platform's turning, from its rates in its own axes (Bryant angles)."""
    (_, beta, gamma), (da, db, dc) = (
        [of[name] for name in platform.angles] for of in (values, rates)
    )
    along_x = da * np.cos(beta) * np.cos(gamma) + db * np.sin(gamma)
    along_y = -da * np.cos(beta) * np.sin(gamma) + db * np.cos(gamma)
    along_z = da * np.sin(beta) + dc
    products = [along_x**2, along_y**2, along_z**2]
    products += [2.0 * along_x * along_y, 2.0 * along_x * along_z, 2.0 * along_y * along_z]
    return np.dot(platform.inertia, np.array(products)[: len(platform.inertia)])


def test_the_last_span_counts_once_for_each_fall():
    """Four falls: the winch takes in 4 m a metre of lift, and pulls a quarter of the weight."""
    model = rig_model.compile(FALLS, visuals=False)
    home = model.key("home")
    values, _ = rig_state.coordinates(FALLS, model, rig_state.State(home.qpos, np.zeros(model.nv)))
    assert values["hoist.length"] == pytest.approx(3.0 + 4 * 5.0, abs=1e-12)
    assert values["tail.length"] == pytest.approx(2 * 1.0, abs=1e-12)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.ten_length[[0, 2]], [23.0, 2.0], rtol=0, atol=1e-12)
    assert data.tendon("hoist.trolley").length[0] == pytest.approx(20.0, abs=1e-12)
    tensions = rig_state.tensions(FALLS, home.qpos, home.qvel, np.zeros(model.nv), home.ctrl)
    np.testing.assert_allclose(tensions, [50 * 9.81 / 4, 20 * 9.81 / 2], rtol=1e-9)


def test_a_platform_is_turned_about_x_then_y_then_z_of_its_own():
    """Quarter turns whose result is plain: body x goes to y by alpha and gamma together."""
    rig = RIGS["cable_manipulator"]
    qpos = np.array([value for link in chain_of(rig) for value in link.home])
    names = list(joint_names(rig))
    quarter = {"platform.alpha": np.pi / 2, "platform.gamma": np.pi / 2}
    for name, angle in quarter.items():
        qpos[names.index(name)] = angle
    found = rig_state.points(rig, qpos, np.zeros_like(qpos))
    arm = found["corner_1"][0] - found["platform"][0]
    # Rz takes the corner from x to y, Rx then from y to z
    np.testing.assert_allclose(arm, [0.0, 0.0, 1.2 / np.sqrt(3)], rtol=0, atol=1e-12)


def test_power_of_inputs_and_gravity(rig, random_states):
    """d/dt of the kinetic energy is what the inputs and gravity put in (work of the inputs)."""
    model = rig_model.compile(rig, visuals=False)
    qpos, qvel, ctrl = random_states(rig)
    qvel[:, base_joints(rig)] = 0.0
    ctrl[:, [rig.driven(drive) in given(rig) for drive in rig.drives]] = 0.0
    qacc = simulate.accelerations(model, qpos, qvel, ctrl)
    _, rates = rig_state.coordinates(rig, model, rig_state.State(qpos, qvel))
    power = np.zeros(len(qpos))
    for column, drive in enumerate(rig.drives):
        part = rig.driven(drive)
        scale = 1 / part.drum_radius if isinstance(part, Rope) else 1.0
        power += ctrl[:, column] * scale * rates[part.coordinate]
    motion = rig_state.points(rig, qpos, qvel, qacc)
    power -= sum(rig.gravity * mass.mass * motion[mass.name][1, :, 2] for mass in rig.masses)
    data = mujoco.MjData(model)
    heavy = [frame.name for frame in rig.frames if frame.mass]
    for k, name in ((k, name) for k in range(len(qpos)) for name in heavy):
        data.qpos[:], data.qvel[:] = qpos[k], qvel[k]
        mujoco.mj_forward(model, data)
        centre, body = np.zeros((3, model.nv)), model.body(name).id
        mujoco.mj_jacBodyCom(model, data, centre, None, body)
        power[k] -= rig.gravity * model.body_mass[body] * (centre @ qvel[k])[2]

    def kinetic(k, step):
        data.qpos[:] = qpos[k] + step * qvel[k] + 0.5 * step**2 * qacc[k]
        data.qvel[:] = qvel[k] + step * qacc[k]
        mujoco.mj_forward(model, data)
        mujoco.mj_energyVel(model, data)
        return data.energy[1]

    for k in range(len(qpos)):
        change = (kinetic(k, 1e-4) - kinetic(k, -1e-4)) / 2e-4
        assert change == pytest.approx(power[k], rel=1e-5, abs=1e-4 * abs(power).max())


def test_points_and_sensors_agree_with_mujoco(rig, random_states):
    model = rig_model.compile(rig)
    qpos, qvel, _ = random_states(rig)
    values, rates = rig_state.coordinates(rig, model, rig_state.State(qpos, qvel))
    motion, data = rig_state.points(rig, qpos, qvel), mujoco.MjData(model)
    for k in range(len(qpos)):
        data.qpos[:], data.qvel[:] = qpos[k], qvel[k]
        mujoco.mj_forward(model, data)
        for name, point in motion.items():
            np.testing.assert_allclose(data.site(name).xpos, point[0, k], atol=1e-12)
        for part in (*rig.frames, *rig.trolleys, *rig.ropes):
            name = part.coordinate
            assert data.sensor(name).data[0] == pytest.approx(values[name][k], abs=1e-12)
            assert data.sensor(f"{name}.rate").data[0] == pytest.approx(rates[name][k], abs=1e-12)
    moved = (
        rig_state.points(rig, qpos + 1e-5 * qvel, qvel),
        rig_state.points(rig, qpos - 1e-5 * qvel, qvel),
    )
    still = rig_state.points(rig, qpos, qvel, np.zeros_like(qvel))
    for name in motion:
        for order in (0, 1):
            slope = (moved[0][name][order] - moved[1][name][order]) / 2e-5
            np.testing.assert_allclose(slope, still[name][order + 1], atol=1e-7)


def test_joint_state_and_back(rig, random_states):
    model = rig_model.compile(rig, visuals=False)
    qpos, qvel, _ = random_states(rig)
    values, rates = rig_state.coordinates(rig, model, rig_state.State(qpos, qvel))
    assert tuple(values) == tuple(rates) == rig.coordinate_names
    back = rig_state.joint_state(rig, model, values, rates)
    np.testing.assert_allclose(back.qpos, qpos, atol=1e-12)
    np.testing.assert_allclose(back.qvel, qvel, atol=1e-12)
    single = rig_state.joint_state(rig, model, {name: value[3] for name, value in values.items()})
    np.testing.assert_allclose(single.qpos, qpos[3], atol=1e-12)
    assert not single.qvel.any()


def test_joint_state_takes_the_columns_of_a_motion():
    """Names that feedforward adds are left aside; others are mistakes."""
    rig = models.rotary_crane()
    model = rig_model.compile(rig, visuals=False)
    home = {"bridge.angle": 0.0, "trolley.position": 5.0}
    home |= {"load.x": 5.0, "load.y": 0.0, "load.z": -5.0}
    motion = solve(rig, from_move(models.default_move(rig.name)), [0.0, 20.0])
    columns = dict(zip(motion.coordinate_names, motion.positions.T, strict=True))
    rates = dict(zip(motion.coordinate_names, motion.velocities.T, strict=True))
    assert set(columns) > set(rig.coordinate_names)
    found = rig_state.joint_state(rig, model, columns, rates)
    np.testing.assert_allclose(
        found.qpos[0], rig_state.joint_state(rig, model, home).qpos, rtol=0, atol=1e-9
    )
    spans = models.roped_overhead_crane()
    values = {"trolley.position": 0.0, "load.x": 0.0, "load.z": -4.0, "hoist.span1": 3.0}
    assert not rig_state.joint_state(spans, rig_model.compile(spans), values).qvel.any()


@pytest.mark.parametrize(
    ("values", "rates", "message"),
    [
        ({"load.x": np.nan}, {}, r"coordinate load\.x is nan, it must be finite"),
        ({"load.x": [0.0, np.inf]}, {}, r"coordinate load\.x is inf, it must be finite"),
        ({"load.x": "left"}, {}, r"coordinate load\.x is 'left', it must be finite numbers"),
        ({}, {"load.x": np.nan}, r"rate of load\.x is nan, it must be finite"),
        ({}, {"trolly.position": 1.0}, r"no coordinate trolly\.position; did you mean trolley\.po"),
        ({"load.X": 1.0}, {}, r"overhead_crane has no coordinate load\.X; did you mean load\."),
        ({"hoist.span1": 1.0}, {}, r"no coordinate hoist\.span1"),
        ({"load.x": [0, 0]}, {"load.z": [0, 0, 0]}, r"have shapes \(2,\) and \(3,\), they must"),
    ],
)
def test_joint_state_refuses_what_cannot_be(values, rates, message):
    rig = models.overhead_crane()
    home = {"trolley.position": 0.0, "load.x": 0.0, "load.z": -4.0}
    with pytest.raises(ModelError, match=message):
        rig_state.joint_state(rig, rig_model.compile(rig, visuals=False), home | values, rates)


def test_coordinates_are_copies():
    rig = models.overhead_crane()
    model = rig_model.compile(rig)
    qpos = np.zeros((2, model.nq))  # a rope without length, too
    values, _ = rig_state.coordinates(rig, model, rig_state.State(qpos, qpos))
    values["trolley.position"][:] = 5.0
    assert not qpos.any()
    assert not values["hoist.length"].any()
    values, _ = rig_state.coordinates(rig, model, mujoco.MjData(model))
    assert values["load.z"] == -4.0


def test_rigs_that_cannot_be_one_chain_hold_their_ropes_by_constraints():
    skew = dataclasses.replace(TANDEM, rails=(Rail("upper", X), Rail("lower", (0.6, 0.0, 0.8))))
    assert "rail upper is not parallel to rail lower" in apart(skew)
    two = dataclasses.replace(
        NAVY,
        frames=(*NAVY.frames, Frame("quay", "sliding", 9.0, axis=X)),
        anchors=(*NAVY.anchors[:2], dataclasses.replace(NAVY.anchors[2], frame="quay")),
    )
    assert "tie frames boom and quay together" in apart(two)
    fixed = dataclasses.replace(
        NAVY,
        rails=(Rail("quay", X),),
        masses=(*NAVY.masses, Trolley("cart", 5.0, "quay")),
        ropes=(*NAVY.ropes[:2], Rope("tag", ("cart", "load"), 0.1, 0.1)),
    )
    assert "tie trolley cart, whose rail is fixed, to frame boom" in apart(fixed)
    manipulator = RIGS["cable_manipulator"]
    turning = dataclasses.replace(
        manipulator,
        frames=(Frame("gantry", "turning", 9.0),),
        home={**manipulator.home, "gantry": 0.0},
    )
    assert "platform platform hangs from turning frame gantry" in apart(turning)
    second = dataclasses.replace(manipulator.platforms[0], name="second")
    double = dataclasses.replace(
        manipulator,
        anchors=(*manipulator.anchors, Anchor("eye", X, "second")),
        masses=(*manipulator.masses, second),
        ropes=(*manipulator.ropes, Rope("link", ("corner_1", "eye"), 0.1, 0.1)),
        home={**manipulator.home, "second": (1.0, 1.0, -9.0)},
    )
    assert "ropes tie platforms platform and second together" in apart(double)
    for rig in (skew, two, fixed, turning, double):
        model = rig_model.compile(rig, visuals=False, massless=1e-3)
        assert model.neq == len(rig.ropes)
        assert not model.tendon_armature.any()
    assert [name for name in models.CATALOGUE if apart(models.make(name))] == ["tandem_lift"]


@pytest.mark.parametrize("build", [models.navy_crane_2d, models.navy_crane_3d])
def test_a_small_mass_without_weight_stands_in_for_none(build):
    rig = build(pulley_mass=0.0)
    with pytest.raises(ModelError, match=r"load pulley: mass is 0 kg, .* massless=1e-3"):
        rig_model.compile(rig)
    model = rig_model.compile(rig, massless=1e-3)
    pulley, load = model.body("pulley").id, model.body("load").id
    assert model.body_mass[pulley] == 1e-3
    assert model.body_gravcomp[[pulley, load]].tolist() == [1.0, 0.0]
    assert not model.dof_damping.any()
    for value in (0, -1.0, np.nan, 10.1, "1", True):
        with pytest.raises(ModelError, match=rf"massless is {value!r} kg, .* > 0 and at most 10,"):
            rig_model.compile(rig, massless=value)
    heavy = rig_model.compile(build(), massless=1e-3)
    np.testing.assert_array_equal(heavy.body_mass, rig_model.compile(build()).body_mass)
