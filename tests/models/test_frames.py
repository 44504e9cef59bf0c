"""Frames on frames, about and along any axis: what is refused, files, and places at home."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flatrig import models
from flatrig.feedforward import analyse, equations_of, redundant
from flatrig.models import Anchor, Drive, Frame, Load, Rig, RigError, Rope
from flatrig.models.mjcf import rig_model
from flatrig.models.mjcf.simulate import accelerations
from flatrig.models.rig.chain import apart, joint_names
from flatrig.training.stress.random_frames import boom_crane
from flatrig.training.stress.random_parts import Dice

TOWER = Frame("tower", "turning", 1e5)
BOOM = Frame(
    "boom",
    "turning",
    (100.0, 5e4, 5e4),
    axis=(0.0, -1.0, 0.0),
    origin=(1.0, 0.0, 10.0),
    parent="tower",
    mass=2e3,
    centre=(9.0, 0.0, 0.5),
)
CRANE = Rig(
    name="luffing",
    frames=(BOOM, TOWER),
    anchors=(Anchor("tip", (20.0, 0.0, 0.0), "boom"),),
    masses=(Load("load", 500.0),),
    ropes=(Rope("hoist", ("tip", "load"), 0.2, 1.0),),
    drives=(Drive("slew", "tower", 1e5), Drive("luff", "boom", 1e6), Drive("hoist", "hoist", 1e4)),
    outputs=("load.x", "load.y", "load.z"),
    home={"tower": 0.3, "boom": 0.8, "load": (14.0, 4.5, 5.0)},
)


def test_frames_follow_their_parents_and_live_in_files() -> None:
    assert [frame.name for frame in CRANE.frames] == ["tower", "boom"]
    assert models.loads(models.dumps(CRANE))[0] == CRANE
    assert "parent" not in models.dumps(models.make("rotary_crane"))  # no field at its default


def test_a_point_of_a_chain_of_frames_is_where_rotations_put_it() -> None:
    random = np.random.default_rng(2)
    axes = [tuple(axis / np.linalg.norm(axis)) for axis in random.normal(size=(3, 3))]
    origins, point = random.normal(size=(3, 3)), random.normal(size=3)
    kinds: tuple[Any, ...] = ("turning", "sliding", "turning")
    frames = tuple(
        Frame(f"f{i}", kinds[i], 1.0, axes[i], tuple(origins[i]), f"f{i - 1}" if i else "world")
        for i in range(3)
    )
    values = random.normal(size=3)
    expected = point
    for i in (2, 1, 0):
        if kinds[i] == "turning":
            expected = Rotation.from_rotvec(values[i] * np.array(axes[i])).apply(expected)
        else:
            expected = expected + values[i] * np.array(axes[i])
        expected = expected + origins[i]
    rig = replace(
        CRANE,
        frames=frames,
        anchors=(Anchor("tip", tuple(point), "f2"),),
        drives=tuple(Drive(f.name, f.name, 1.0) for f in frames),
        home={f.name: v for f, v in zip(frames, values, strict=True)} | {"load": (9.0, 9.0, 9.0)},
    )
    assert np.allclose(rig.home_point("tip"), expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"parent": "towr"}, "parent is 'towr', which does not exist; did you mean tower?"),
        ({"parent": "boom"}, "frame boom, which stands on boom; one of them must stand in the"),
        ({"axis": (0.0, 0.0, 0.0)}, "axis is (0.0, 0.0, 0.0), it has no length and no direction"),
        ({"axis": (3.0, 0.0, 4.0)}, "it must be a unit vector: (0.6, 0, 0.8)"),
        ({"inertia": (1.0, 1.0, 3.0)}, "inertia is (1.0, 1.0, 3.0), which no body has"),
        ({"inertia": (9.0, 9.0, 9.0, 0.0, 20.0, 0.0)}, "which no body has: no principal moment"),
        ({"inertia": (-1.0, -1.0, -1.0)}, "which no body has"),
        ({"inertia": (1.0, 1.0)}, "inertia has 2 numbers, it needs 1 about the axis, 3"),
        ({"inertia": (1.0, 1.0, 1.0), "mass": 0.0, "centre": (0.0, 0.0, 0.0)}, "needs one > 0"),
        ({"mass": 0.0, "inertia": 1.0}, "centre is (9.0, 0.0, 0.5) m of a mass of 0 kg"),
        ({"mass": -1.0}, "mass is -1 kg, it must be >= 0"),
        ({"inertia": -1.0}, "inertia is -1 kg m2, it must be > 0"),
        ({"mass": 0.0, "centre": (0.0, 0.0, 0.0), "inertia": 0.0}, "inertia is 0 kg m2, it must"),
        ({"inertia": 0.0, "centre": (0.0, 2.0, 0.0)}, "no inertia about its axis"),
        ({"kind": "sliding", "inertia": 5.0}, "its mass is given twice, as mass 2000 kg and as"),
        ({"inertia": "heavy"}, "inertia is 'heavy', it must be a number"),
        ({"inertia": (1.0, "b", 1.0)}, "inertia is 'b', it must be a number"),
    ],
)
def test_frames_that_cannot_be(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(RigError) as error:
        replace(CRANE, frames=(TOWER, replace(BOOM, **changes)))
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_frames_that_carry_one_another() -> None:
    with pytest.raises(RigError, match="tower, which stands on boom, which stands on tower"):
        replace(CRANE, frames=(replace(TOWER, parent="boom"), BOOM))


def test_a_plane_has_booms_that_turn_about_its_normal() -> None:
    planar = replace(
        CRANE,
        dimensions=2,
        frames=(replace(BOOM, parent="world"),),
        drives=CRANE.drives[1:],
        outputs=("load.x", "load.z"),
        home={"boom": 0.8, "load": (14.0, 0.0, 5.0)},
    )
    tip = planar.home_point("tip")
    assert tip == pytest.approx((1 + 20 * np.cos(0.8), 0.0, 10 + 20 * np.sin(0.8)))
    with pytest.raises(RigError, match=r"no turning frame but about \(0, 1, 0\) or \(0, -1, 0\)"):
        replace(planar, frames=(replace(planar.frames[0], axis=(1.0, 0.0, 0.0)),))


@pytest.mark.parametrize("seed", range(12))
def test_random_chains_of_frames_move_in_mujoco_as_the_equations_say(seed: int) -> None:
    """Depth 1 to 4, any axis, origin and tensor, with trolleys and without."""
    random = np.random.default_rng([8, seed])
    dice = Dice(random, float(10.0 ** random.uniform(0.0, 1.5)))
    rig = boom_crane(dice)
    analysis, equations, model = analyse(rig), equations_of(rig), rig_model.compile(rig)
    assert (analysis.flat, analysis.index, analysis.reference_order) == (True, 5, 4)
    homes = rig.home_coordinates
    size = {name: 0.5 if name.endswith("angle") else 0.3 * dice.size for name in homes}
    values = {name: home + size[name] * random.normal(size=3) for name, home in homes.items()}
    rates = {name: size[name] * random.normal(size=3) for name in homes}
    inputs = rig.weight * random.normal(size=(3, len(rig.drives)))
    state, speeds = redundant(equations, values, rates)
    assert np.abs(equations.constraint_values(state)).max() < 1e-12 * dice.size**2
    rank = np.linalg.matrix_rank(equations.constraint_jacobian(state[0]))
    assert rank == len(equations.constraint_names)
    expected, multipliers = equations.accelerations(state, speeds, inputs)
    joints = rig_model.joint_state(rig, model, values, rates)
    back = rig_model.coordinates(rig, model, joints)
    for given, found in zip((values, rates), back, strict=True):
        for name, value in given.items():
            assert found[name] == pytest.approx(value, rel=1e-12, abs=1e-12 * dice.size)
    turn = accelerations(model, *joints, inputs)
    world = rig_model.points(rig, *joints, turn)
    columns = {f"load.{axis}": world["load"][2][:, "xyz".index(axis)] for axis in rig.axes}
    for frame in rig.frames:
        joint = turn[:, joint_names(rig).index(frame.coordinate)]
        if frame.kind == "sliding":
            columns[frame.coordinate] = joint
        else:
            angle, rate = values[frame.coordinate], rates[frame.coordinate]
            columns[f"{frame.name}.sin"] = np.cos(angle) * joint - np.sin(angle) * rate**2
    for name, found in columns.items():
        error = np.abs(found - expected[:, equations.names.index(name)])
        assert (error <= 1e-9 * np.abs(expected).max(axis=1)).all()
    pulls = rig_model.tensions(rig, *joints, turn, inputs)
    assert pulls == pytest.approx(equations.tensions(state, multipliers), rel=1e-7)


def test_a_boom_beside_the_tower_that_should_carry_it_is_refused() -> None:
    beside = replace(CRANE, frames=(TOWER, replace(BOOM, parent="world")))
    with pytest.raises(RigError, match="frame tower carries nothing, what stands on it names it"):
        analyse(beside)


def test_two_booms_side_by_side_hold_one_load_by_constraints_in_mujoco() -> None:
    other = replace(BOOM, name="other", parent="world", origin=(30.0, 0.0, 10.0))
    second = Anchor("end", (20.0, 0.0, 0.0), "other")
    rig = replace(
        CRANE,
        frames=(TOWER, BOOM, other),
        anchors=(*CRANE.anchors, second),
        ropes=(*CRANE.ropes, Rope("second", ("end", "load"), 0.2, 1.0)),
        drives=(*CRANE.drives, Drive("other", "other", 1e6)),
        outputs=(*CRANE.outputs, "other.angle"),
    )
    assert "tie frames boom and other together" in apart(rig)
    assert rig_model.compile(rig, visuals=False).neq == len(rig.ropes)
