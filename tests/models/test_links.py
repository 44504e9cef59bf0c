"""Links, loads that swing on them, and planar platforms: MuJoCo against the equations.

Every number is found twice: accelerations and tensions by the index-1 equations and by MuJoCo's
joints, moves by exact feedforward and by stepping MuJoCo under it.
"""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.feedforward import check, equations_of, from_move, solve
from flatrig.feedforward.exact.equations import redundant
from flatrig.models import (
    Anchor,
    Drive,
    Frame,
    Link,
    Load,
    Move,
    Platform,
    Rail,
    Rig,
    RigError,
    Rope,
    Trolley,
)
from flatrig.models.mjcf.armature import tendon_jacobian
from flatrig.models.mjcf.rig_model import State, coordinates, joint_state, points, spec, tensions
from flatrig.models.mjcf.simulate import accelerations, run
from flatrig.models.rig.chain import stiff_links
from flatrig.models.rig.lengths import rope_lengths

STATES = 12


def gantry(name, masses, links, outputs, home, anchors=(), **more):
    """A bridge and a trolley with a hook, and what hangs on it."""
    return Rig(
        name=name,
        frames=(Frame("bridge", "sliding", 2000.0, (0.0, 1.0, 0.0)),),
        anchors=anchors,
        rails=(Rail("beam", (1.0, 0.0, 0.0), frame="bridge"),),
        masses=(Trolley("trolley", 1000.0, "beam"), Load("hook", 500.0), *masses),
        ropes=(Rope("hoist", ("trolley", "hook"), 0.3, 90.0),),
        links=links,
        drives=tuple(Drive(name, name, 1e5) for name in ("bridge", "trolley", "hoist")),
        outputs=outputs,
        home={"hook": (0, 0, -5.0), **home},
        **more,
    )


def double_pendulum(**more):
    place = ("p.x", "p.y", "p.z")
    return gantry(
        "double", (Load("p", 2000.0),), (Link("sling", ("hook", "p")),), place,
        {"p": (0, 0, -8.0)}, **more
    )  # fmt: skip


def triple_pendulum():
    links = Link("upper", ("hook", "q")), Link("lower", ("q", "p"))
    home = {"q": (0, 0, -7.0), "p": (0, 0, -10.0)}
    masses = Load("q", 700.0), Load("p", 2000.0)
    return gantry("triple", masses, links, ("p.x", "p.y", "p.z"), home)


def slung_from_a_boom():
    """A fixed sling on a turning jib, and a second load below the first, aslant at home."""
    return Rig(
        name="boom",
        frames=(Frame("jib", "turning", 900.0),),
        anchors=(Anchor("tip", (6.0, 0.0, 1.0), "jib"),),
        masses=(Load("upper", 30.0), Load("lower", 70.0)),
        ropes=(),
        links=(Link("a", ("tip", "upper")), Link("b", ("lower", "upper"))),
        drives=(Drive("jib", "jib", 1e4),),
        outputs=("jib.angle",),
        home={"jib": 0.4, "upper": (6.0, 2.0, -2.0), "lower": (5.0, 1.0, -4.0)},
    )


def spreader_of_loads():
    """Two loads on two slings with a strut between them: a loop of links."""
    links = (
        Link("left", ("hook", "a")),
        Link("right", ("hook", "b")),
        Link("strut", ("a", "b"), pushes=True),
    )
    home = {"a": (2.0, 0, -7.0), "b": (-2.0, 0, -7.0)}
    masses = Load("a", 700.0), Load("b", 800.0)
    return gantry("spreader", masses, links, ("a.x", "a.y", "a.z"), home)


def platform_on_slings(count=3):
    corners = ((2, 1, 1.0), (2, -1, 1.0), (-2, 1, 1.0), (-2, -1, 1.0))[:count]
    names = [f"c{i}" for i in range(count)]
    return gantry(
        "slung",
        (Platform("p", 5000.0, (2e4, 4e4, 5e4)),),
        tuple(Link(f"s{i}", ("hook", name)) for i, name in enumerate(names)),
        ("p.x", "p.y", "p.z"),
        {"p": (0, 0, -10.0)},
        tuple(Anchor(name, corner, "p") for name, corner in zip(names, corners, strict=True)),
    )


def load_below_a_platform():
    """A platform on a rope from a gantry, and a load on a sling from its corner."""
    rig = gantry(
        "below",
        (Platform("p", 900.0, (200.0, 300.0, 400.0)), Load("q", 150.0)),
        (Link("sling", ("corner", "q")),),
        ("p.x", "p.y", "p.z"),
        {"p": (0, 0, -10.0), "q": (1.0, 0.3, -12.0)},
        (Anchor("eye", (0, 0, 1.0), "p"), Anchor("corner", (1, 0.3, -0.5), "p")),
    )
    hung = Rope("hang", ("hook", "eye"), 0.2, 3.0)
    return replace(rig, ropes=(*rig.ropes, hung))


def planar_beam(pushes=False):
    """A beam in a plane on two ropes from two trolleys."""
    return Rig(
        name="beam",
        dimensions=2,
        anchors=(Anchor("c1", (-5.0, 0, 0.3), "beam"), Anchor("c2", (5.0, 0, 0.3), "beam")),
        rails=(Rail("runway", (1.0, 0.0, 0.0)),),
        masses=(
            Trolley("a", 3000.0, "runway"),
            Trolley("b", 3000.0, "runway"),
            Platform("beam", 10000.0, (1000.0, 120000.0, 120000.0)),
        ),
        ropes=(
            Rope("ra", ("a", "c1"), 0.3, 20.0, pushes=pushes),
            Rope("rb", ("b", "c2"), 0.3, 20.0, pushes=pushes),
        ),
        drives=tuple(Drive(name, name, 3e4) for name in ("a", "b", "ra", "rb")),
        outputs=("beam.x", "beam.z", "beam.beta", "a.position"),
        home={"a": -5.0, "b": 5.0, "beam": (0, 0, -10.0)},
    )


EXACT = [double_pendulum, triple_pendulum, slung_from_a_boom, load_below_a_platform, planar_beam]
LOOPS = [spreader_of_loads, platform_on_slings]


def drawn(rig, model, spread=0.3):
    """Random joints and rates that keep the lengths of all links."""
    dice = np.random.default_rng(0)
    qpos = model.key_qpos[0] + spread * dice.uniform(-1, 1, (STATES, model.nq))
    qvel = spread * dice.uniform(-1, 1, (STATES, model.nv))
    return tied(rig, model, qpos, qvel)


def tied(rig, model, qpos, qvel, tensions=None):
    """The next joints and rates that keep the lengths of links which close loops.

    With tensions (states, links) at the stretch at which their springs bear these.
    """
    stiff, data = stiff_links(rig), mujoco.MjData(model)
    if not stiff:
        return qpos, qvel
    rows = [model.tendon(link.name).id for link in stiff]
    wanted = np.tile([rig.link_length(link) for link in stiff], (STATES, 1))
    if tensions is not None:
        stiffness = model.tendon_stiffness.reshape(model.ntendon, -1)[rows, 0]
        wanted = model.tendon_lengthspring[rows, 0] + tensions / stiffness
    qpos, qvel = qpos.copy(), qvel.copy()
    for q, v, lengths in zip(qpos, qvel, wanted, strict=True):
        for _ in range(20):
            data.qpos[:] = q
            mujoco.mj_fwdPosition(model, data)
            inverse = np.linalg.pinv(tendon_jacobian(model, data)[rows])
            q -= inverse @ (data.ten_length[rows] - lengths)
        v -= inverse @ tendon_jacobian(model, data)[rows] @ v
    return qpos, qvel


@pytest.mark.parametrize("make", [*EXACT, *LOOPS])
def test_accelerations_and_tensions_are_equal(make):
    rig = make()
    model = models.compile(rig, visuals=False)
    qpos, qvel = drawn(rig, model)
    ctrl = np.random.default_rng(1).uniform(-3e3, 3e3, (STATES, model.nu))
    values, rates = coordinates(rig, model, State(qpos, qvel))
    back = joint_state(rig, model, values, rates)
    assert_allclose(back.qpos, qpos, atol=1e-13)
    assert_allclose(back.qvel, qvel, atol=1e-13)
    equations, columns = equations_of(rig), [link in stiff_links(rig) for link in rig.links]
    for _ in range(2):
        state, rate = redundant(equations, values, rates)
        second, multipliers = equations.accelerations(state, rate, ctrl)
        pulls = equations.tensions(state, multipliers)[:, len(rig.ropes) :][:, columns]
        qpos, qvel = tied(rig, model, qpos, qvel, pulls)
        values, rates = coordinates(rig, model, State(qpos, qvel))
    qacc = accelerations(model, qpos, qvel, ctrl)
    world = points(rig, qpos, qvel, qacc)
    # A link that closes a loop is a stiff tendon, which costs the mass matrix digits.
    size = np.abs(second).max() * (1e-9 if make in LOOPS else 1e-11)
    for part in rig.hanging:
        for axis in rig.axes:
            mine = world[part.name][2][:, "xyz".index(axis)]
            exact = second[:, equations.names.index(f"{part.name}.{axis}")]
            assert_allclose(mine, exact, atol=size)
    for name, length in rope_lengths(rig, world).items():
        exact = second[:, equations.names.index(f"{name}.length")]
        assert_allclose(length[2], exact, atol=size)
    found = tensions(rig, qpos, qvel, qacc, ctrl)
    expected = equations.tensions(state, multipliers)
    assert_allclose(
        found, expected, atol=np.abs(expected).max() * (1e-9 if make in LOOPS else 1e-10)
    )


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


@pytest.mark.parametrize(
    ("rig", "move", "goal"),
    [
        (double_pendulum(), Move((0, 0, -8.0), (5.0, 3.0, -6.0), 12.0, order=6), 1.2e-8),
        (planar_beam(), Move((0, -10.0, 0, -5.0), (8.0, -8.0, 0.05, 3.0), 15.0), 1.4e-7),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_moves_land_in_mujoco(rig, move, goal):
    assert landed(rig, move) < goal


def test_a_rigid_payload_is_two_masses_and_a_link():
    """Its centre of oscillation lands, with the whole body on a ball joint in MuJoCo."""
    mass, below, inertia = 5000.0, 6.0, 4e4  # centre of mass from the hook, moment about it
    length = below + inertia / (mass * below)
    lower = mass * below / length
    rig = gantry(
        "payload", (Load("p", lower),), (Link("rod", ("hook", "p")),), ("p.x", "p.y", "p.z"),
        {"hook": (0, 0, -10.0), "p": (0, 0, -10.0 - length)},
    )  # fmt: skip
    hook = next(part for part in rig.loads if part.name == "hook")
    rig = replace(
        rig, masses=(*rig.trolleys, replace(hook, mass=500.0 + mass - lower), *rig.loads[1:])
    )
    move = Move((0, 0, -10.0 - length), (10.0, 6.0, -7.0 - length), 12.0, order=6)
    times = (np.arange(12000) + 0.5) * 1e-3
    motion = solve(rig, from_move(move), times)
    scene = spec(rig, visuals=False)
    scene.delete(scene.body("p"))
    body = scene.body("hook").add_body(name="p", pos=[0, 0, 0])
    scene.body("hook").mass = 500.0
    body.explicitinertial, body.mass, body.ipos = True, mass, [0, 0, -below]
    body.inertia = [inertia, inertia, 3e3]
    body.add_joint(name="ball", type=mujoco.mjtJoint.mjJNT_BALL)
    body.add_site(name="p", pos=[0, 0, -length])
    scene.delete(scene.key("home"))
    model = scene.compile()
    data = mujoco.MjData(model)
    data.qpos[model.joint("hook.z").qposadr[0]] = -10.0
    for row in motion.inputs:
        data.ctrl[:] = row
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    assert_allclose(data.site("p").xpos, move.goal, atol=1.4e-8)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"links": (Link("s", ("hook",)),)}, "link s: ends are 1 points, it must be 2"),
        ({"links": (Link("s", ("hook", "P")),)}, "names 'P', which does not exist; did you mean"),
        ({"links": (Link("s", ("p", "p")),)}, "both ends are 'p', it must join two points"),
        (
            {"links": (Link("s", ("hook", "p"), 2.5),)},
            "link s: length is 2.5 m, too short for its ends hook and p, which are 3 m apart",
        ),
        ({"links": (Link("s", ("hook", "p"), -1.0),)}, "length is -1 m, it must be > 0"),
        ({"held": ("q.y",)}, "'q.y' cannot be held; did you mean"),
        ({"held": ("trolley.position",)}, "cannot be held; it must be one of hook.x, hook.y"),
        ({"held": ("hook.y", "hook.y")}, "'hook.y' is held twice"),
        ({"held": ("p.y",)}, "'p.y' is held, output 'p.y' cannot move it"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(change, message):
    with pytest.raises(RigError) as caught:
        replace(double_pendulum(), **change)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_ends_of_one_body_are_refused():
    rig = double_pendulum(
        anchors=(Anchor("a", (0, 0, 1.0), "bridge"), Anchor("b", (1.0, 0, 1.0), "bridge"))
    )
    with pytest.raises(RigError, match="a and b are both fixed in bridge, it must join two bodies"):
        replace(rig, links=(*rig.links, Link("tie", ("a", "b"))))


def test_links_and_what_is_held_are_read_and_written():
    rig = replace(spreader_of_loads(), held=("b.y",))
    text = models.dumps(rig)
    assert 'held = [\n    "b.y",\n]' in text
    assert "pushes = true" in text
    assert "length" not in text
    assert text.count("pushes") == 1
    assert models.loads(text)[0] == rig
    given = replace(rig, links=(replace(rig.links[0], length=None), *rig.links[1:]))
    assert models.fingerprint(given) == models.fingerprint(rig)


def pushed_trolley(part, pushes):
    """A trolley with a hoist that a cylinder from the wall, or a rod from another one, pushes."""
    cylinder = Rope("cylinder", ("wall", "trolley"), 0.1, 0.1, pushes=pushes)
    rod = Link("rod", ("tug", "trolley"), pushes=pushes)
    hoist = Rope("hoist", ("trolley", "load"), 0.1, 0.1)
    by_rod = part == "rod"
    return Rig(
        name="pushed",
        dimensions=2,
        anchors=(Anchor("wall", (-4.0, 0, 0)),),
        rails=(Rail("beam", (1.0, 0.0, 0.0)),),
        masses=(
            Trolley("trolley", 10.0, "beam"),
            *([Trolley("tug", 20.0, "beam")] if by_rod else []),
            Load("load", 100.0),
        ),
        ropes=(hoist,) if by_rod else (cylinder, hoist),
        links=(rod,) if by_rod else (),
        drives=(
            Drive("drive", "tug" if by_rod else "cylinder", 1e3),
            Drive("hoist", "hoist", 200.0),
        ),
        outputs=("load.x", "load.z"),
        home={"load": (0, 0, -4.0), **({"tug": -3.0} if by_rod else {})},
    )


@pytest.mark.parametrize("part", ["rod", "cylinder"])
def test_what_pushes_is_never_slack(part):
    path = from_move(Move((0, -4.0), (3.0, -2.0), 4.0))
    pulled, pushed = (check(pushed_trolley(part, pushes), path) for pushes in (False, True))
    kind = "link" if part == "rod" else "rope"
    assert {(slack.kind, slack.rope) for slack in pulled.slack} == {(kind, part)}
    assert pulled.problems[0].startswith(f"{kind} {part} would have to push from ")
    assert pushed.feasible
    assert not pushed.slack
    assert_allclose(pushed.motion.tensions, pulled.motion.tensions)
    column = pushed.rig.tension_names.index(part)
    # The rod moves trolley and load: its force is what accelerates both of them.
    moved = {"trolley.position": 10.0, "load.x": 100.0}
    force = sum(
        mass * pushed.motion.accelerations[:, pushed.motion.column(name)]
        for name, mass in moved.items()
    )
    assert_allclose(pushed.motion.tensions[:, column], -force, atol=1e-9)
