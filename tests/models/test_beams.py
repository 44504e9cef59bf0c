"""Beams, links with a mass of their own: MuJoCo against the equations, and by hand."""

from dataclasses import replace

import gymnasium as gym
import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import envs, feedforward, models
from flatrig.envs.crane.payloads import payload_bodies, payload_weight, reloaded
from flatrig.feedforward import equations_of, from_move, solve
from flatrig.feedforward.exact.equations import redundant
from flatrig.models import (
    Anchor,
    Drive,
    Frame,
    Link,
    Load,
    ModelError,
    Move,
    Rail,
    Rig,
    RigError,
    Rope,
    Trolley,
)
from flatrig.models.mjcf.armature import tendon_jacobian
from flatrig.models.mjcf.rig_model import State, coordinates, joint_state, points, tensions
from flatrig.models.mjcf.simulate import accelerations, run
from flatrig.models.rig.chain import stiff_links

STATES = 12
ENDS = Load("a", 20.0), Load("b", 30.0)


def drives(*names):
    return tuple(Drive(name, name, 1e5) for name in names)


def on_two_trolleys(**beam):
    """A beam in a plane, each of its ends on a rope from a trolley of its own."""
    return Rig(
        name="two_trolleys",
        dimensions=2,
        rails=(Rail("runway", (1.0, 0.0, 0.0)),),
        masses=(Trolley("left", 300.0, "runway"), Trolley("right", 300.0, "runway"), *ENDS),
        ropes=(Rope("rope_a", ("left", "a"), 0.3, 20.0), Rope("rope_b", ("right", "b"), 0.3, 20.0)),
        links=(Link("beam", ("a", "b"), **{"mass": 1000.0, **beam}),),
        drives=drives("left", "right", "rope_a", "rope_b"),
        outputs=("a.x", "a.z", "b.z", "left.position"),
        home={"left": -5.0, "right": 5.0, "a": (-5.0, 0, -10.0), "b": (5.0, 0, -10.0)},
    )


def under_a_hook():
    """A spreader beam with a load at either end, on two slings from a hook of a slewing crane."""
    return Rig(
        name="spreader",
        frames=(Frame("jib", "turning", 5e4),),
        rails=(Rail("rail", (1.0, 0.0, 0.0), frame="jib"),),
        masses=(Trolley("trolley", 500.0, "rail"), Load("hook", 100.0), *ENDS),
        ropes=(Rope("hoist", ("trolley", "hook"), 0.3, 20.0),),
        links=(
            Link("sling_b", ("b", "hook")),
            Link("sling_a", ("a", "hook")),
            Link("beam", ("b", "a"), mass=400.0, centre=1.5, inertia=900.0),
        ),
        drives=drives("jib", "trolley", "hoist"),
        outputs=("hook.x", "hook.y", "hook.z"),
        home={"trolley": 6.0, "hook": (6.0, 0, -4.0), "a": (5.0, 1.0, -6.0), "b": (7.0, -1, -6.0)},
    )


def rod_and_payload():
    """A heavy rod that hangs aslant from a hook, and a load on a sling below it."""
    return Rig(
        name="rod",
        frames=(Frame("bridge", "sliding", 2000.0, (0.0, 1.0, 0.0)),),
        rails=(Rail("girder", (1.0, 0.0, 0.0), frame="bridge"),),
        masses=(Trolley("trolley", 500.0, "girder"), Load("hook", 100.0), *ENDS),
        ropes=(Rope("hoist", ("trolley", "hook"), 0.3, 20.0),),
        links=(Link("rod", ("hook", "a"), mass=200.0), Link("sling", ("a", "b"))),
        drives=drives("bridge", "trolley", "hoist"),
        outputs=("b.x", "b.y", "b.z"),
        home={"hook": (0, 0, -4.0), "a": (0.3, 0.2, -7.0), "b": (0.3, 0.2, -8.0)},
    )


def derrick():
    """A boom that is a beam, hinged at a slewing mast, on a luffing rope from the mast's top."""
    return Rig(
        name="derrick",
        frames=(Frame("mast", "turning", 3e3),),
        anchors=(Anchor("foot", (0.5, 0, 0), "mast"), Anchor("top", (0.0, 0, 9.0), "mast")),
        masses=(Load("tip", 40.0), Load("load", 500.0)),
        ropes=(Rope("luff", ("top", "tip"), 0.3, 20.0), Rope("hoist", ("tip", "load"), 0.3, 20.0)),
        links=(Link("boom", ("tip", "foot"), mass=600.0, centre=7.0),),
        drives=drives("mast", "luff", "hoist"),
        outputs=("load.x", "load.y", "load.z"),
        home={"tip": (8.5, 0, 6.0), "load": (8.5, 0, 2.0)},
    )


def tandem(mass=3500.0):
    """Two slewing cranes that carry a beam by its shackles."""
    rig = models.tandem_lift(end_mass=150.0)
    return replace(rig, links=(Link("beam", ("left", "right"), mass=mass, centre=4.0),))


CHAINS, APART = [on_two_trolleys, under_a_hook, rod_and_payload], [derrick, tandem]


def drawn(rig, model, spread=0.3):
    """Random joints and rates that keep what constraints and stiff links keep."""
    dice, data = np.random.default_rng(0), mujoco.MjData(model)
    qpos = model.key_qpos[0] + spread * dice.uniform(-1, 1, (STATES, model.nq))
    qvel = spread * dice.uniform(-1, 1, (STATES, model.nv))
    rows = [model.tendon(link.name).id for link in stiff_links(rig)]
    rows += [int(tendon) for tendon in model.eq_obj1id]
    if not rows:
        return qpos, qvel
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_fwdPosition(model, data)
    lengths = data.ten_length[rows].copy()
    for q, v in zip(qpos, qvel, strict=True):
        for _ in range(20):
            data.qpos[:] = q
            mujoco.mj_fwdPosition(model, data)
            inverse = np.linalg.pinv(tendon_jacobian(model, data)[rows])
            q -= inverse @ (data.ten_length[rows] - lengths)
        v -= inverse @ tendon_jacobian(model, data)[rows] @ v
    return qpos, qvel


def held_accelerations(model, qpos, qvel, ctrl):
    """Joint accelerations at rest under constraints that do not give way, as MuJoCo's do."""
    data, found = mujoco.MjData(model), []
    for q, v, inputs in zip(qpos, qvel, ctrl, strict=True):
        data.qpos[:], data.qvel[:], data.ctrl[:] = q, v, inputs
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        held = tendon_jacobian(model, data)[model.eq_obj1id]
        none = np.zeros((len(held), len(held)))
        force = data.qfrc_actuator + data.qfrc_passive - data.qfrc_bias
        matrix = np.block([[mass, held.T], [held, none]])
        found.append(np.linalg.solve(matrix, [*force, *none[0]])[: model.nv])
    return np.array(found)


@pytest.mark.parametrize("make", [*CHAINS, *APART])
def test_accelerations_and_tensions_are_equal(make):
    rig = make()
    model = models.compile(rig, visuals=False)
    qpos, qvel = drawn(rig, model)
    if make in APART:
        qvel = np.zeros_like(qvel)
    ctrl = np.random.default_rng(1).uniform(-3e3, 3e3, (STATES, model.nu))
    values, rates = coordinates(rig, model, State(qpos, qvel))
    back = joint_state(rig, model, values, rates)
    assert_allclose(back.qpos, qpos, atol=1e-11)
    assert_allclose(back.qvel, qvel, atol=1e-11)
    equations = equations_of(rig)
    state, rate = redundant(equations, values, rates)
    second, multipliers = equations.accelerations(state, rate, ctrl)
    find = held_accelerations if make in APART else accelerations
    qacc = find(model, qpos, qvel, ctrl)
    world = points(rig, qpos, qvel, qacc)
    loose = 3e-8 if stiff_links(rig) else 1e-11  # a stiff tendon gives way a little
    for part in rig.hanging:
        for axis in rig.axes:
            mine = world[part.name][2][:, "xyz".index(axis)]
            exact = second[:, equations.names.index(f"{part.name}.{axis}")]
            assert_allclose(mine, exact, atol=loose * np.abs(second).max())
    found = tensions(rig, qpos, qvel, qacc, ctrl)
    expected = equations.tensions(state, multipliers)
    assert_allclose(found, expected, atol=10 * loose * np.abs(expected).max())


def solved(rig, move):
    path = from_move(move)
    motion = solve(rig, path, np.linspace(0.0, path.duration, 51))
    assert feedforward.residuals(motion, path).max() < 1e-9
    return motion


IN_PLANE = Move((-5.0, -10.0, -10.0, -5.0), (-2.0, -8.0, -8.5, -3.0), 15.0)
IN_SPACE = models.default_move(models.tandem_lift())


@pytest.mark.parametrize(
    ("rig", "move"), [(on_two_trolleys(), IN_PLANE), (tandem(), IN_SPACE)], ids=["plane", "space"]
)
def test_forces_and_moments_balance(rig, move):
    """Of the whole beam with its shackles, from places and accelerations of its ends alone."""
    motion = solved(rig, move)
    (link,), gravity = rig.links, np.array([0.0, 0.0, rig.gravity])
    length = rig.link_length(link)
    share = (0.5 * length if link.centre is None else link.centre) / length

    def place(name, table):
        columns = [motion.column(f"{name}.{axis}") for axis in rig.axes]
        own = np.zeros((len(table), 3))
        own[:, ["xyz".index(axis) for axis in rig.axes]] = table[:, columns]
        return own

    ends = {n: (place(n, motion.positions), place(n, motion.accelerations)) for n in link.ends}
    (a, a2), (b, b2) = (ends[name] for name in link.ends)
    centre, centre2 = a + share * (b - a), a2 + share * (b2 - a2)
    way, way2 = (b - a) / length, (b2 - a2) / length
    force = link.mass * (centre2 + gravity)
    turning = link.mass * length**2 / 12.0 * np.cross(way, way2)  # J d x d''
    for load in rig.loads:
        at, second = ends[load.name]
        force += load.mass * (second + gravity)
        turning += np.cross(at - centre, load.mass * (second + gravity))
    for column, rope in enumerate(rig.ropes):
        trolley, end = rope.path
        top = place_of_trolley(rig, motion, trolley)
        pull = top - ends[end][0]
        pull *= motion.tensions[:, [column]] / np.linalg.norm(pull, axis=1, keepdims=True)
        force -= pull
        turning -= np.cross(ends[end][0] - centre, pull)
    assert_allclose(force, 0.0, atol=1e-9 * rig.weight)
    assert_allclose(turning, 0.0, atol=1e-9 * rig.weight * length)


def place_of_trolley(rig, motion, name):
    trolley = next(part for part in rig.trolleys if part.name == name)
    rail = rig.rail(trolley.rail)
    along = np.outer(motion.positions[:, motion.column(trolley.coordinate)], rail.direction)
    frame = rig.frame(rail.frame)
    if frame is None:
        return along
    angle = motion.positions[:, motion.column(frame.coordinate)]
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = along.T
    return np.stack((cos * x - sin * y, sin * x + cos * y, z), axis=1) + frame.origin


def test_a_uniform_beam_is_three_masses():
    """m/6 at either end and 2m/3 in the middle, which a third load on stiff links would be."""
    mass = equations_of(on_two_trolleys(mass=600.0)).mass
    bare = equations_of(on_two_trolleys(mass=600.0, inertia=0.0, centre=0.0)).mass
    names = equations_of(on_two_trolleys()).names
    a, b = names.index("a.x"), names.index("b.x")
    assert_allclose(mass[np.ix_([a, b], [a, b])], [[20 + 200, 100], [100, 30 + 200]])
    assert_allclose(bare[np.ix_([a, b], [a, b])], [[620, 0], [0, 30]], atol=1e-9)


def landed(rig, move):
    """How far from its goal a move ends in MuJoCo, open loop [m]."""
    model, step = models.compile(rig, visuals=False), 1e-3
    times = (np.arange(round(move.duration / step)) + 0.5) * step
    motion = solve(rig, from_move(move), np.array([0.0, *times, move.duration]))
    start = {n: motion.positions[0, motion.column(n)] for n in rig.home_coordinates}
    state = run(model, *joint_state(rig, model, start), motion.inputs[1:-1])
    values, _ = coordinates(rig, model, State(state.qpos[-1:], state.qvel[-1:]))
    ends = [values[n][0] - motion.positions[-1, motion.column(n)] for n in rig.home_coordinates]
    return np.abs(ends).max()


def test_moves_land_in_mujoco():
    assert landed(on_two_trolleys(centre=4.0, inertia=9000.0), IN_PLANE) < 2e-7
    assert landed(tandem(), replace(IN_SPACE, duration=8.0)) < 1e-6


def test_a_level_beam_turns_as_it_likes():
    """A quarter turn about the vertical and more: no hinge of it is lost there."""
    rig = tandem()
    model = models.compile(rig, visuals=False)
    for angle in np.linspace(0.0, 3.0, 7):
        half = 5.0 * np.array([np.cos(angle), np.sin(angle), 0.1])
        half *= 5.0 / np.linalg.norm(half)
        ends = {"left": -half, "right": half}
        place = {f"{n}.{x}": v for n in ends for x, v in zip("xyz", ends[n], strict=True)}
        place |= {part.coordinate: 0.0 for part in rig.frames}
        place |= {part.coordinate: 7.0 for part in rig.trolleys}
        state = joint_state(rig, model, place)
        back, _ = coordinates(rig, model, State(*(values[None] for values in state)))
        for name, value in place.items():
            assert_allclose(back[name], value, atol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mass": -1.0}, "link beam: mass is -1 kg, it must be >= 0"),
        ({"mass": 0.0, "inertia": 5.0}, "inertia is 5 kg m2 of a mass of 0 kg; give its mass"),
        ({"centre": 12.0}, "centre is 12 m from its first end, it must be 0 to its length 10 m"),
        ({"inertia": -2.0}, "inertia is -2 kg m2, it must be >= 0"),
    ],
)
def test_what_no_beam_has_is_said_in_one_line(change, message):
    with pytest.raises(RigError, match=message):
        on_two_trolleys(**change)


def test_what_hangs_at_its_ends_has_a_mass():
    rig = on_two_trolleys()
    with pytest.raises(RigError, match="load b: mass is 0 kg, what hangs at the end of beam beam"):
        replace(rig, masses=(*rig.masses[:3], Load("b", 0.0)))
    tie = Link("tie", ("left", "right"), mass=5.0)
    with pytest.raises(RigError, match="none of its ends left and right is a load"):
        replace(rig, links=(*rig.links, tie))


def test_a_ring_of_beams_is_no_tree():
    rig = under_a_hook()
    ring = tuple(replace(link, mass=10.0) for link in rig.links)
    with pytest.raises(ModelError, match="it closes a ring of beams"):
        models.compile(replace(rig, links=ring))


def test_files_have_them():
    rig = on_two_trolleys(centre=4.0, inertia=9000.0)
    assert models.loads(models.dumps(rig, IN_PLANE)) == (rig, IN_PLANE)
    assert "centre" not in models.dumps(on_two_trolleys())


def test_a_beam_that_leans_is_all_payload():
    rig = on_two_trolleys()
    leaning = replace(rig, home={**rig.home, "b": (4.9, 0, -9.0)})
    for crane in (rig, leaning):
        assert payload_bodies(crane) == ["a", "b", "beam"]
        assert payload_weight(reloaded(crane, 1.2)) == pytest.approx(1.2 * crane.weight)
    spreader = under_a_hook()
    for low in (-6.0, -6.2):
        crane = replace(spreader, home={**spreader.home, "a": (5.0, 1.0, low)})
        assert payload_bodies(crane) == ["a", "b", "beam"]
    assert payload_bodies(derrick()) == ["load"]
    assert payload_bodies(rod_and_payload()) == ["b"]  # the rod belongs to the crane


def test_environments_swing_it_and_read_its_tension():
    """A girder on two slewing cranes, and one on two trolleys, under feedforward and PD."""
    for rig, move, close in ((on_two_trolleys(), IN_PLANE, 1e-5), (tandem(), IN_SPACE, 1e-4)):
        drives = tuple(replace(part, limit=2e4, lower=None) for part in rig.drives)
        rig, path = replace(rig, drives=drives), from_move(move)
        env = envs.Feedforward(envs.PD(gym.make(envs.OWN, rig=rig, reference=path)))
        env.reset(seed=0)
        for _ in range(150):
            *_, ended, _, info = env.step(np.zeros(len(drives)))
            assert not ended
            assert_allclose(info["load"], info["reference"], atol=close)
        told = solve(rig, path, [3.0]).tensions[0]
        assert_allclose(info["tension"], told, atol=1e-3 * np.abs(told).max())
