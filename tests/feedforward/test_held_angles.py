"""A platform that turns about one axis or not at all, because symmetry holds its other angles."""

from dataclasses import replace
from itertools import permutations

import gymnasium as gym
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from flatrig import envs, feedforward, models
from flatrig.feedforward.exact.platform_rows import about_one
from flatrig.models import (
    Anchor,
    Drive,
    Frame,
    Load,
    PathError,
    Platform,
    Rail,
    Rig,
    RigError,
    Rope,
)
from flatrig.models.rig import toml

SIDES = (("a", -5.0), ("b", 5.0))
MOVE = models.Move((0.0, -10.0, 0.0, -5.0), (8.0, -8.0, 0.1, 3.0), 15.0)


def two_cranes(along=0, aside=0.0):
    """Two trolleys on one runway along the x or y axis, and a 10 m beam below them."""
    axes = np.eye(3)[:, [along, 1 - along, 2]]  # of the runway, across it, and up

    def place(*parts):
        return tuple(axes @ parts)

    letter, other = "xy"[along], "xy"[1 - along]
    turn, still = ("beta", "alpha") if along == 0 else ("alpha", "beta")
    moments = (1000.0, 120000.0) if along == 0 else (120000.0, 1000.0)
    return Rig(
        name="two_cranes",
        frames=tuple(Frame(n, "sliding", 3000.0, place(1.0, 0.0, 0.0)) for n, _ in SIDES),
        anchors=tuple(Anchor(f"{n}_top", place(0.0, aside, 0.0), n) for n, _ in SIDES)
        + tuple(Anchor(f"{n}_end", place(x, aside, 0.3), "beam") for n, x in SIDES),
        masses=(Platform("beam", 10000.0, (*moments, 120000.0)),),
        ropes=tuple(Rope(f"rope_{n}", (f"{n}_top", f"{n}_end"), 0.3, 20.0) for n, _ in SIDES),
        drives=tuple(Drive(on, on, 3e4) for on in ("a", "b", "rope_a", "rope_b")),
        outputs=(f"beam.{letter}", "beam.z", f"beam.{turn}", "a.position"),
        held=(f"beam.{other}", f"beam.{still}", "beam.gamma"),
        home={"a": -5.0, "b": 5.0, "beam": (0.0, 0.0, -10.0)},
    )


def planar():
    """The same as a planar rig with trolleys on a rail."""
    rig = two_cranes()
    ends = tuple(anchor for anchor in rig.anchors if anchor.frame == "beam")
    return replace(
        rig,
        dimensions=2,
        frames=(),
        anchors=ends,
        rails=(Rail("runway", (1.0, 0.0, 0.0)),),
        masses=(*(models.Trolley(n, 3000.0, "runway") for n, _ in SIDES), *rig.platforms),
        ropes=tuple(replace(r, path=(r.name[-1], r.path[1])) for r in rig.ropes),
        held=(),
    )


def solved(rig, move=MOVE):
    path = feedforward.from_move(move)
    motion = feedforward.solve(rig, path, np.linspace(0.0, path.duration, 31))
    assert feedforward.residuals(motion, path).max() < 1e-9
    return motion


def test_in_space_it_is_the_planar_beam():
    wanted = solved(planar())
    motion = solved(two_cranes())
    assert_allclose(motion.inputs, wanted.inputs, rtol=1e-10, atol=1e-6)
    # About x the angle grows the other way round: seen along y, z turns towards -x.
    mirrored = replace(MOVE, goal=(*MOVE.goal[:2], -MOVE.goal[2], MOVE.goal[3]))
    assert_allclose(solved(two_cranes(along=1), mirrored).inputs, wanted.inputs, rtol=1e-9)


def test_what_holds_it_beside_its_centre_lets_it_roll():
    beside = two_cranes(aside=0.5)
    moment = f"{0.5 * beside.weight:.4g} N m".replace("+", r"\+")
    message = f"beam.alpha is held, but even at rest it would take {moment} to keep it there"
    with pytest.raises(PathError, match=message):
        solved(beside)


def test_one_angle_of_three_says_what_to_hold():
    free = replace(two_cranes(), held=())
    message = r"prescribe all three angles or none, or .* held = \['beam.y', 'beam.alpha', 'beam.g"
    with pytest.raises(RigError, match=message):
        solved(free)
    for held in permutations(("beam.alpha", "beam.gamma")):
        assert solved(replace(free, held=("beam.y", *held))).inputs.shape == (31, 4)
    with pytest.raises(RigError, match="is held, it must be two"):
        replace(free, held=("beam.y", "beam.alpha"))
    with pytest.raises(RigError, match=r"'beam.beta' is held, output 'beam.beta' cannot move it"):
        replace(free, held=("beam.beta", "beam.alpha"))


@pytest.mark.parametrize("dimensions", [2, 3])
def test_one_that_never_turns_is_a_point_mass(dimensions):
    point = Rig(
        name="point",
        dimensions=dimensions,
        rails=(Rail("beam", (1.0, 0.0, 0.0)),),
        masses=(models.Trolley("trolley", 10.0, "beam"), Load("box", 100.0)),
        ropes=(Rope("hoist", ("trolley", "box"), 0.1, 0.1),),
        drives=(Drive("trolley", "trolley", 1e3), Drive("hoist", "hoist", 2e2)),
        outputs=("box.x", "box.z"),
        held=() if dimensions == 2 else ("box.y",),
        home={"box": (0.0, 0.0, -4.0)},
    )
    body = Platform("box", 100.0, (20.0, 30.0, 40.0))
    turns = body.angles if dimensions == 3 else body.angles[1:2]
    box = replace(
        point,
        masses=(*point.trolleys, body),
        anchors=(Anchor("eye", (0.0, 0.0, 0.0), "box"),),
        ropes=(replace(point.ropes[0], path=("trolley", "eye")),),
        held=(*point.held, *turns),
    )
    move = models.Move((0.0, -4.0), (5.0, -1.0), 4.0)
    assert_allclose(solved(box, move).inputs, solved(point, move).inputs, rtol=1e-12)
    above = replace(box, anchors=(Anchor("eye", (0.0, 0.0, 0.5), "box"),),
                    home={"box": (0.0, 0.0, -4.5)})  # fmt: skip
    with pytest.raises(PathError, match=r"box.beta is held, but at t = .* N m to keep it at rest"):
        solved(above, replace(move, start=(0.0, -4.5)))


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_directors_are_those_of_a_rotation(axis):
    one, angle = np.ones(1), np.array([0.4])
    directors = np.array(about_one(axis, one, np.cos(angle), np.sin(angle)))[..., 0]
    assert_allclose(directors.T, Rotation.from_euler("xyz"[axis], 0.4).as_matrix())


def test_programs_and_files_have_it_and_an_environment_runs_it():
    rig = two_cranes()
    assert toml.loads(toml.dumps(rig, MOVE)) == (rig, MOVE)
    motion, path = solved(rig), feedforward.from_move(MOVE)
    stepper = feedforward.Stepper(rig, path.start)
    for i, time in enumerate(motion.times[:8]):
        step = stepper.step(path.derivatives([time], 4)[:, 0], motion.times[1])
        assert_allclose(step.inputs, motion.inputs[i], atol=1e-6)
    env = envs.Feedforward(envs.PD(gym.make(envs.OWN, rig=rig, reference=path)))
    env.reset(seed=0)
    late, worst = False, 0.0
    while not late:
        *_, ended, late, info = env.step(np.zeros(4))
        worst = max(worst, np.linalg.norm(info["load"] - info["reference"]))
        assert not ended
    assert worst < 1e-4
