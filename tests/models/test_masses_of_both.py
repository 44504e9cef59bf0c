"""Every mass of the MuJoCo model stands in the equations, and the other way round, for every part.

The equations' terms are brought into the coordinates of the model's joints by the velocities that
these give the rig, and compared one by one with what MuJoCo computes.
"""

import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import feedforward, models
from flatrig.feedforward import equations_of, redundant
from flatrig.models import Anchor, Drive, Frame, Load, Rail, Rig, Rope, Trolley
from flatrig.models.mjcf import rig_model
from flatrig.training.simulate.open_loop import open_loop
from flatrig.training.stress.random_parts import Dice
from flatrig.training.stress.random_rigs import KINDS

DRAWS = 6
RIGS = [(kind, number) for kind in KINDS for number in range(DRAWS)]
NAMES = [f"{kind.__name__}-{number}" for kind, number in RIGS]


@pytest.fixture
def rig(request):
    kind, number = request.param
    rng = np.random.default_rng([11, KINDS.index(kind), number])
    return kind(Dice(rng, float(10.0 ** rng.uniform(-0.5, 1.5))))


def equations_in_joints(rig, model, qpos):
    """Mass matrix, gravity and inputs of the equations, in the coordinates of the joints."""
    equations = equations_of(rig)
    rates = np.eye(model.nv)
    state = rig_model.State(np.broadcast_to(qpos, rates.shape), rates)
    place, slope = redundant(equations, *rig_model.coordinates(rig, model, state))
    mass = slope @ equations.mass @ slope.T
    return mass, slope @ equations.force, slope @ equations.input_matrix(place[0])


def model_in_joints(model, qpos):
    """The same from MuJoCo."""
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    mass, motors = np.zeros((model.nv, model.nv)), np.zeros((model.nu, model.nv))
    mujoco.mj_fullM(model, data, mass)
    rows = data.moment_rownnz, data.moment_rowadr, data.moment_colind
    mujoco.mju_sparse2dense(motors, data.actuator_moment, *rows)
    return mass, -data.qfrc_bias, motors.T


@pytest.mark.parametrize("rig", RIGS, ids=NAMES, indirect=True)
def test_masses_weights_and_inputs_are_equal(rig):
    model = rig_model.compile(rig, visuals=False)
    rng = np.random.default_rng(3)
    size = model.tendon_length0.max()
    for _ in range(4):
        qpos = model.key_qpos[0] + 0.1 * size * rng.uniform(-1, 1, model.nq)
        mass, weight, motors = model_in_joints(model, qpos)
        expected = equations_in_joints(rig, model, qpos)
        share = np.sqrt(np.diag(mass))
        # 1e-10: a point mass needs some moment of inertia, 1e-12 kg m2, in MuJoCo
        assert (np.abs(mass - expected[0]) <= 1e-10 * np.outer(share, share)).all()
        assert_allclose(weight, expected[1], rtol=0, atol=1e-13 * np.abs(weight).max())
        assert_allclose(motors, expected[2], rtol=0, atol=1e-12 * np.abs(motors).max())


@pytest.mark.parametrize("ropes", ["rigid", "elastic"])
@pytest.mark.parametrize("rig", RIGS[1::3], ids=NAMES[1::3], indirect=True)
def test_the_same_inputs_hold_a_rig_at_home(rig, ropes):
    held = rig_model.compile(rig, visuals=False, ropes=ropes).key_ctrl[0]
    arms = {f"{drive.on}.tension": rig.arm(drive) for drive in rig.drives}
    # Of more ropes than freedoms the model chooses tensions, and the others follow from these.
    pulled = {name: -u / arm for (name, arm), u in zip(arms.items(), held, strict=True)}
    home = rig.home_coordinates | pulled
    outputs = [sum(a * home[name] for a, name in rig.terms(output)) for output in rig.outputs]
    inputs = held_by(rig, outputs)
    rounding = np.full(len(inputs), 5.1e-10)  # the model's are rounded to nine decimals
    for column, output in enumerate(rig.outputs):
        if output in arms:
            more = np.array(outputs) + np.eye(len(outputs))[column]
            rounding += 5.1e-10 / arms[output] * np.abs(held_by(rig, more) - inputs)
    assert (np.abs(held - inputs) <= 1e-9 * np.abs(inputs).max() + rounding).all()


def held_by(rig, outputs):
    """Inputs that hold a rig where these are its outputs."""
    return feedforward.solve(rig, feedforward.hold(outputs), 0.0).inputs[0]


def test_the_drive_of_an_inclined_car_carries_car_and_load():
    slope = np.radians(20.0)
    rig = Rig(
        name="inclined_car",
        dimensions=2,
        frames=(Frame("car", "sliding", 200.0, (np.cos(slope), 0.0, np.sin(slope))),),
        anchors=(Anchor("hook", (0.0, 0.0, -1.0), "car"),),
        masses=(Load("load", 100.0),),
        ropes=(Rope("hoist", ("hook", "load"), 0.1, 0.1),),
        drives=(Drive("car", "car", 1e3), Drive("winch", "hoist", 2e3)),
        outputs=("load.x", "load.z"),
        home={"load": (0.0, 0.0, -4.0)},
    )
    expected = [300 * 9.81 * np.sin(slope), -100 * 9.81 * 0.1]
    path = feedforward.rest_to_rest((0.0, -4.0), (1.0, -3.0), 3.0)
    assert_allclose(feedforward.solve(rig, path, 0.0).inputs[0], expected, rtol=1e-12)
    assert_allclose(models.compile(rig).key_ctrl[0], expected, rtol=1e-9)
    regulator = feedforward.Regulator(rig, (0.0, -4.0), (100.0, 100.0), (0.0, 0.0))
    assert_allclose(regulator.rest.inputs[0], expected, rtol=1e-12)
    assert not feedforward.check(rig, path).feasible  # 1007 N are more than the car has
    assert open_loop(rig, path).distance.max() < 1e-5


def test_a_crane_on_a_heaving_deck_follows_its_path():
    rig = Rig(
        name="heaving_ship",
        dimensions=2,
        frames=(Frame("deck", "sliding", 5e6),),
        rails=(Rail("beam", (1.0, 0.0, 0.0), frame="deck"),),
        masses=(Trolley("trolley", 1e3, "beam"), Load("load", 4e3)),
        ropes=(Rope("hoist", ("trolley", "load"), 0.3, 10.0),),
        drives=(
            Drive("trolley", "trolley", 2e4),
            Drive("hoist", "hoist", 3e4),
            Drive("sea", "deck", 2e8),
        ),
        outputs=("load.x", "load.z", "deck.position"),
        home={"load": (0.0, 0.0, -12.0)},
    )
    path = feedforward.rest_to_rest((0.0, -12.0, 0.0), (3.0, -10.0, 1.5), 8.0)
    report = feedforward.check(rig, path)
    assert report.feasible
    lift = path.derivatives(report.motion.times, 2)[2]
    whole = 9.81 * (5e6 + 1e3 + 4e3) + (5e6 + 1e3) * lift[:, 2] + 4e3 * lift[:, 1]
    assert_allclose(report.motion.inputs[:, 2], whole, rtol=1e-12)
    found = open_loop(rig, path)
    assert found.distance.max() < 1e-5
    assert_allclose(found.tensions(), found.motion.tensions, rtol=1e-6)
