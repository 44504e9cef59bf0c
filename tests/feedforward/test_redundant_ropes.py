"""More ropes than freedoms: tensions as outputs, the default distribution, singular geometries."""

from dataclasses import replace
from pathlib import Path

import gymnasium as gym
import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import linprog, minimize

from flatrig import envs, feedforward, models
from flatrig.feedforward import dae
from flatrig.models import Anchor, Drive, Load, Move, Platform, Rig, Rope
from flatrig.models.errors import RigError
from flatrig.models.mjcf import rig_model
from flatrig.models.mjcf.simulate import accelerations

POSE = tuple(f"platform.{axis}" for axis in ("x", "y", "z", "alpha", "beta", "gamma"))
POINTS = ((4.0, 4.0, 0.0), (-4.0, 4.0, 0.0), (-4.0, -4.0, 0.0), (4.0, -4.0, 0.0))


def four_ropes(outputs=("load.x", "load.y", "load.z"), **fields):
    """A load on four ropes, one too many."""
    return Rig(
        name="four_ropes",
        anchors=tuple(Anchor(f"a{i}", point) for i, point in enumerate(POINTS)),
        masses=(Load("load", 5.0),),
        ropes=tuple(Rope(f"r{i}", (f"a{i}", "load"), 0.05, 0.01) for i in range(4)),
        drives=tuple(Drive(f"r{i}", f"r{i}", 60.0) for i in range(4)),
        outputs=outputs,
        home={"load": (0.0, 0.0, -3.0)},
        **fields,
    )


def robot(**fields):
    return replace(models.cable_robot(), **fields)


def wrenches(motion, sample):
    """Forces and moments of unit tensions on the platform, and what they have to be, by hand.

    From Newton and Euler for the whole body, not from the package's directors.
    """
    rig = motion.rig
    (platform,) = rig.platforms
    place = dict(zip(motion.coordinate_names, motion.positions[sample], strict=True))
    second = dict(zip(motion.coordinate_names, motion.accelerations[sample], strict=True))
    rates = dict(zip(motion.coordinate_names, motion.velocities[sample], strict=True))
    a, b, g = (place[f"platform.{x}"] for x in ("alpha", "beta", "gamma"))

    def turn(axis, angle):
        c, s = np.cos(angle), np.sin(angle)
        i, k = [(1, 2), (2, 0), (0, 1)][axis]
        matrix = np.eye(3)
        matrix[i, i] = matrix[k, k] = c
        matrix[i, k], matrix[k, i] = -s, s
        return matrix

    rotation = turn(0, a) @ turn(1, b) @ turn(2, g)
    # Angular velocity along the platform's axes: of gamma about z, beta about y then, alpha last.
    axes = np.array([turn(2, g).T @ turn(1, b).T[:, 0], turn(2, g).T[:, 1], [0.0, 0.0, 1.0]])
    da, db, dg = (rates[f"platform.{x}"] for x in ("alpha", "beta", "gamma"))
    spin = da * axes[0] + db * axes[1] + dg * axes[2]
    step = 1e-6
    moved = turn(2, g + step * dg).T
    later = np.array([moved @ turn(1, b + step * db).T[:, 0], moved[:, 1], [0.0, 0.0, 1.0]])
    drift = (np.array([da, db, dg]) @ later - spin) / step
    turned = np.array([second[f"platform.{x}"] for x in ("alpha", "beta", "gamma")]) @ axes + drift
    xx, yy, zz, xy, xz, yz = platform.inertia
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    moment = rotation @ (tensor @ turned + np.cross(spin, tensor @ spin))
    force = platform.mass * np.array([second[f"platform.{x}"] for x in "xyz"])
    force[2] += platform.mass * rig.gravity
    centre = np.array([place[f"platform.{x}"] for x in "xyz"])
    corners = {anchor.name: np.array(anchor.position) for anchor in rig.anchors}
    columns, lengths = [], []
    for rope in rig.ropes:
        arm = rotation @ corners[rope.path[1]]
        way = corners[rope.path[0]] - centre - arm
        lengths.append(np.linalg.norm(way))
        columns.append(np.concatenate((way, np.cross(arm, way))) / lengths[-1])
    return np.array(columns).T, np.concatenate((force, moment)), np.array(lengths)


MOVE = Move(
    start=(0.0, 0.0, 1.5, 0.0, 0.0, 0.0), goal=(1.5, -1.0, 2.2, 0.1, -0.1, 0.3), duration=3.0
)


@pytest.mark.parametrize("tension", [0.0, 700.0])
def test_tensions_are_the_least_squares_of_force_densities(tension):
    rig = models.cable_robot(tension=tension)
    path = feedforward.from_move(MOVE)
    motion = feedforward.solve(rig, path, np.linspace(0.0, 3.0, 7))
    home = feedforward.solve(rig, feedforward.hold((0.0, 0.0, 1.5, 0.0, 0.0, 0.0)), 0.0)
    wanted = tension / home.rope_lengths[0]
    for sample in range(7):
        matrix, needed, lengths = wrenches(motion, sample)
        densities = matrix * lengths
        chosen = wanted + np.linalg.pinv(densities) @ (needed - densities @ wanted)
        assert_allclose(motion.tensions[sample], chosen * lengths, rtol=2e-6)
    assert feedforward.residuals(motion, path).max() < 1e-9


def test_a_linear_program_finds_tensions_where_the_distribution_does():
    """It says how high the least tension can be; the distribution is below, and taut as well."""
    rig = models.cable_robot()
    motion = feedforward.solve(rig, feedforward.from_move(MOVE), [0.0, 1.3, 3.0])
    for sample, tensions in enumerate(motion.tensions):
        matrix, needed, _ = wrenches(motion, sample)
        best = linprog(
            np.append(np.zeros(8), -1.0),
            A_eq=np.hstack((matrix, np.zeros((6, 1)))), b_eq=needed,
            A_ub=np.hstack((-np.eye(8), np.ones((8, 1)))), b_ub=np.zeros(8),
            bounds=[(0.0, 5000.0)] * 8 + [(None, None)],
        )  # fmt: skip
        assert 0.0 < tensions.min() <= best.x[8] * (1.0 + 1e-9)
        assert_allclose(matrix @ tensions, needed, atol=1e-5 * np.abs(needed).max())


def test_tensions_that_are_outputs_are_as_prescribed():
    rig = robot(outputs=(*POSE, "rope_7.tension", "rope_2.tension"))
    analysis = feedforward.analyse(rig)
    assert analysis.flat
    assert analysis.reference_order == 2
    path = feedforward.rest_to_rest(
        (*MOVE.start, 300.0, 250.0), (*MOVE.goal, 500.0, 260.0), duration=3.0, order=3
    )
    motion = feedforward.solve(rig, path, np.linspace(0.0, 3.0, 31))
    prescribed = path.derivatives(motion.times, 0)[0]
    assert_allclose(motion.tensions[:, [6, 1]], prescribed[:, 6:], rtol=1e-9)
    assert_allclose(motion.outputs, prescribed, atol=1e-9)
    matrix, needed, _ = wrenches(motion, 17)
    assert_allclose(matrix @ motion.tensions[17], needed, atol=2e-6 * np.abs(needed).max())


def test_one_tension_prescribed_leaves_the_others_to_the_distribution():
    rig = robot(outputs=(*POSE, "rope_7.tension"), distribution={"rope_1": 200.0})
    path = feedforward.hold((0.5, 0.2, 2.0, 0.0, 0.0, 0.0, 333.0))
    motion = feedforward.solve(rig, path, 0.0)
    matrix, needed, lengths = wrenches(motion, 0)
    home = feedforward.solve(rig, feedforward.hold((0.0, 0.0, 1.5, 0.0, 0.0, 0.0, 333.0)), 0.0)
    wanted = np.append(200.0 / home.rope_lengths[0, 0], np.zeros(7))

    def cost(density):
        return ((density - wanted)[[0, 1, 2, 3, 4, 5, 7]] ** 2).sum()

    whole = [{"type": "eq", "fun": lambda w: (matrix * lengths) @ w - needed},
             {"type": "eq", "fun": lambda w: w[6] * lengths[6] - 333.0}]  # fmt: skip
    best = minimize(cost, np.full(8, 30.0), constraints=whole, tol=1e-14)
    assert motion.tensions[0, 6] == pytest.approx(333.0)
    assert_allclose(motion.tensions[0], best.x * lengths, rtol=1e-5)


@pytest.mark.parametrize("rig", [models.cable_robot(), four_ropes()], ids=lambda rig: rig.name)
def test_accelerations_tensions_and_holding_inputs_are_those_of_mujoco(rig, random_states):
    qpos, qvel, inputs = random_states(rig, 10)
    model, equations = rig_model.compile(rig), feedforward.equations_of(rig)
    values, rates = rig_model.coordinates(rig, model, rig_model.State(qpos, qvel))
    q, v = feedforward.redundant(equations, values, rates)
    expected, multipliers = equations.accelerations(q, v, inputs)
    qacc = accelerations(model, qpos, qvel, inputs)
    found = rig_model.tensions(rig, qpos, qvel, qacc, inputs)
    tensions = equations.tensions(q, multipliers)
    assert_allclose(found, tensions, atol=1e-11 * np.abs(tensions).max())
    body = rig.hanging[0].name
    places = rig_model.points(rig, qpos, qvel, qacc)[body][2]
    columns = [equations.names.index(f"{body}.{axis}") for axis in "xyz"]
    assert_allclose(places, expected[:, columns], atol=1e-12 * np.abs(expected).max())
    home = [rig.home_coordinates[name] for name in rig.outputs]
    still = feedforward.solve(rig, feedforward.hold(home), 0.0)
    assert_allclose(model.key_ctrl[0], still.inputs[0], atol=1e-8)


def test_eight_ropes_arrive_open_loop():
    rig, path = models.cable_robot(), feedforward.from_move(MOVE)
    motion = feedforward.solve(rig, path, 1e-3 * (np.arange(3000) + 0.5))
    model = models.compile(rig, visuals=False)
    data, start = mujoco.MjData(model), feedforward.solve(rig, path, 0.0)
    place = dict(zip(start.coordinate_names, start.positions[0], strict=True))
    data.qpos[:] = rig_model.joint_state(rig, model, place).qpos
    for inputs in motion.inputs:
        data.ctrl[:] = inputs
        mujoco.mj_step(model, data)
    end = rig_model.coordinates(rig, model, data)[0]
    assert max(abs(end[name] - goal) for name, goal in zip(POSE, MOVE.goal, strict=True)) < 1.2e-7


def test_a_geometry_that_is_singular_by_symmetry_is_refused_with_its_condition():
    """All ropes lead away from one axis, by x F_y = y F_x: none turns the platform about it."""
    corners = [(x, y, z) for z in (0.3, -0.3) for x in (-0.5, 0.5) for y in (-0.4, 0.4)]
    exits = [(8.0 * x, 8.0 * y, 5.0) for x, y, _ in corners]
    with pytest.raises(
        RigError, match=r"singular place at home \(condition number (inf|\d.*e\+1\d)"
    ):
        Rig(
            name="box",
            anchors=(
                *(Anchor(f"f{i}", place) for i, place in enumerate(exits)),
                *(Anchor(f"p{i}", place, "platform") for i, place in enumerate(corners)),
            ),
            masses=(Platform("platform", 30.0, (3.0, 3.0, 2.0)),),
            ropes=tuple(Rope(f"r{i}", (f"f{i}", f"p{i}"), 0.05, 0.01) for i in range(8)),
            drives=tuple(Drive(f"r{i}", f"r{i}", 100.0) for i in range(8)),
            outputs=POSE,
            home={"platform": (0.0, 0.0, 1.5)},
        )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"distribution": {"r9": 1.0}}, "names 'r9', which is none of more ropes than freedoms"),
        ({"distribution": {"r1": -5.0}}, "distribution of r1 is -5.0, it must be a tension >= 0"),
        ({"distribution": 3.0}, "distribution is 3.0, it must map names to numbers"),
        ({"outputs": ("load.x", "load.y")}, "2 outputs .and 1 open tensions .* for 4 drives"),
        (
            {"outputs": ("load.x", "load.y", "r1.tension", "r2.tension")},
            "2 tensions of ropes to load are outputs, of 4 ropes for 3 freedoms only 1 are open",
        ),
        ({"outputs": ("load.x", "load.y", "load.z", "r9.tension")}, "'r9.tension' is not a coord"),
    ],
)
def test_what_cannot_be_distributed_is_refused(change, message):
    with pytest.raises(RigError, match=message) as caught:
        replace(four_ropes(), **change)
    assert "\n" not in str(caught.value)


def test_lengths_that_follow_from_the_place_are_no_outputs():
    rig = four_ropes(outputs=("load.x", "load.y", "load.z", "r1.length"))
    with pytest.raises(RigError, match=r'r1\.length follows from .* "r1\.tension" in its'):
        feedforward.solve(rig, feedforward.hold((0.0, 0.0, -3.0, 6.4)), 0.0)
    assert models.compile(rig).nu == 4


def test_steps_through_time_have_nothing_to_integrate():
    assert "more ropes than freedoms" in dae.why_not(four_ropes(), "minimal extension")


@pytest.mark.parametrize("outputs", [(), ("r2.tension",)])
def test_four_ropes_make_an_episode(outputs):
    rig = four_ropes(outputs=("load.x", "load.y", "load.z", *outputs))
    extra = (25.0,) if outputs else ()
    move = Move(start=(0.0, 0.0, -3.0, *extra), goal=(1.0, 0.5, -2.0, *extra), duration=2.0)
    assert models.loads(models.dumps(rig, move)) == (rig, move)
    env = envs.Feedforward(envs.PD(gym.make("flatrig/Rig-v0", rig=rig, reference=move)))
    env.reset(seed=0)
    for _ in range(120):
        _, reward, ended, _, info = env.step(np.zeros(4))
        assert not ended
        assert np.abs(info["load"] - info["reference"])[:3].max() < 1e-3
    assert reward > 0.9
    if outputs:
        assert info["load"][3] == pytest.approx(25.0, rel=1e-3)


def test_a_full_tensor_survives_a_file_and_turns_like_a_rigid_body():
    rig = models.cable_robot()
    again = models.loads(models.dumps(rig))[0]
    assert again.platforms[0].inertia == rig.platforms[0].inertia
    principal = replace(
        rig, masses=(replace(rig.platforms[0], inertia=rig.platforms[0].inertia[:3]),)
    )
    assert models.fingerprint(principal) != models.fingerprint(rig)
    path = feedforward.from_move(MOVE)
    one, other = (feedforward.solve(r, path, 1.2).tensions for r in (rig, principal))
    assert np.abs(one - other).max() > 0.1
    odd = replace(rig.platforms[0], inertia=(1.0, 1.0, 1.0, 5.0, 0.0, 0.0))
    with pytest.raises(RigError, match="which no body has: no principal moment"):
        replace(rig, masses=(odd,))


PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "cable_robot.toml"


def test_the_page_s_own_robot_works():
    rig, move = models.load(PAGE)
    path = feedforward.from_move(move)
    assert feedforward.check(rig, path).feasible
    motion = feedforward.solve(rig, path, np.linspace(0.0, path.duration, 51))
    assert motion.tensions.min() > 20.0
    env = envs.Feedforward(envs.PD(gym.make("flatrig/Rig-v0", rig=str(PAGE))))
    env.reset(seed=0)
    for _ in range(100):
        *_, ended, _, info = env.step(np.zeros(len(rig.drives)))
        assert not ended
    assert np.linalg.norm(info["load"] - info["reference"]) < 1e-3


def test_eight_ropes_are_driven_tick_by_tick():
    stream = feedforward.Stream(models.cable_robot(), MOVE.start)
    samples = [stream.tick((0.5, 0.3, 0.4, 0.0, 0.0, 0.1)) for _ in range(60)]
    motion = feedforward.solve(
        models.cable_robot(), stream.reference, [s.time for s in samples], begin=stream.begin
    )
    assert_allclose([s.tensions for s in samples], motion.tensions, rtol=1e-8)
    assert samples[-1].tensions.min() > 0.0
