"""The solver on rigs that are not in the catalogue: it knows descriptions, not names.

Numbers: K 3.67, 3.77 (equilibria), Y 6.1.2 (planar Navy crane with heavy pulley), Y 6.2.2 (in
space; index 7, six derivatives, K theorem 3).
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig.feedforward import analyse, residuals, rest_to_rest, solve, three_phase
from flatrig.models import (
    Anchor,
    Drive,
    Frame,
    Load,
    PathError,
    Rail,
    Rig,
    Rope,
    SmoothnessError,
    Trolley,
)

ROOT3 = np.sqrt(3.0)


def rope(name, *path):
    return Rope(name, path, drum_radius=0.1, winch_inertia=0.1)


def carried(kind):
    """A rail with winches at both ends, turning (cantilever) or sliding along y (gantry)."""
    axis = (0.0, 0.0, 1.0) if kind == "turning" else (0.0, 1.0, 0.0)
    return Rig(
        name=kind,
        frames=(Frame("boom", kind, 480.0, axis),),
        anchors=(Anchor("outer", (8.0, 0, 0), "boom"), Anchor("inner", (-2.0, 0, 0), "boom")),
        rails=(Rail("rail", (1.0, 0.0, 0.0), frame="boom"),),
        masses=(Trolley("trolley", 10.0, "rail"), Load("load", 100.0)),
        ropes=(rope("pull", "outer", "trolley"), rope("hoist", "inner", "trolley", "load")),
        drives=(Drive("pull", "pull", 1), Drive("hoist", "hoist", 1), Drive("boom", "boom", 1)),
        outputs=("load.x", "load.y", "load.z"),
        home={"trolley": 5.0, "load": (5.0, 0.0, -5.0)},
    )


def planar_navy_crane():
    """Y 6.1.2: origin at winch S, alpha = pi/3, s = 5, l = 10."""
    along = np.array([-ROOT3 / 2, 0.0, -0.5])
    return Rig(
        name="planar_navy_crane",
        dimensions=2,
        anchors=(
            Anchor("A", tuple(15 * along)),
            Anchor("P", tuple(5 * along)),
            Anchor("S", (0.0, 0.0, 0.0)),
        ),
        masses=(Load("pulley", 150.0), Load("load", 100.0)),
        ropes=(
            rope("one", "A", "pulley"),
            rope("two", "P", "pulley", "load"),
            rope("three", "S", "pulley"),
        ),
        drives=tuple(Drive(name, name, 1.0) for name in ("one", "two", "three")),
        outputs=("load.x", "load.z", "pulley.z"),
        home={"pulley": (-2.5 * ROOT3, 0, -12.5), "load": (-2.5 * ROOT3, 0, -22.5)},
    )


def navy_crane():
    """Y 6.2.2: boom tip P = (5 sqrt3, 0, 5), A = P/2, S = 3P/2."""
    tip = np.array([5 * ROOT3, 0.0, 5.0])
    return Rig(
        name="navy_crane",
        frames=(Frame("boom", "turning", 6.4 * 75.0),),
        anchors=tuple(
            Anchor(name, tuple(share * tip), "boom")
            for name, share in zip("APS", (0.5, 1, 1.5), strict=True)
        ),
        masses=(Load("pulley", 5.0), Load("load", 100.0)),
        ropes=(
            rope("one", "A", "pulley"),
            rope("two", "S", "pulley"),
            rope("three", "P", "pulley", "load"),
        ),
        drives=(
            *(Drive(name, name, 1.0) for name in ("one", "two", "three")),
            Drive("b", "boom", 1),
        ),
        outputs=("load.x", "load.y", "load.z", "pulley.z"),
        home={"pulley": (5 * ROOT3, 0.0, 2.5), "load": (5 * ROOT3, 0.0, -15.0)},
    )


CASES = {
    "cantilever": (carried("turning"), three_phase((5, 0, -5), (-2, 2, -2), 20, 5), 5, 4),
    "gantry": (carried("sliding"), three_phase((5, 0, -5), (-1, 2, -2), 20, 5), 5, 4),
    "planar navy": (
        planar_navy_crane(),
        rest_to_rest((-2.5 * ROOT3, -22.5, -12.5), (-1, -17.5, -10.5), 3),
        5,
        4,
    ),
    "navy": (
        navy_crane(),
        rest_to_rest((5 * ROOT3, 0, -15, 2.5), (-2, 4 * ROOT3, -13, 1.5), 20, order=6),
        7,
        6,
    ),
}


@pytest.mark.parametrize("case", list(CASES))
def test_structure_and_residuals(case):
    rig, reference, index, order = CASES[case]
    analysis = analyse(rig)
    assert (analysis.index, analysis.reference_order) == (index, order)
    assert analysis.flat
    motion = solve(rig, reference, np.linspace(0, reference.duration, 401))
    assert residuals(motion, reference).max() < 1e-9
    assert_allclose(motion.outputs, reference(motion.times), rtol=0, atol=1e-12)


@pytest.mark.parametrize("kind", ["turning", "sliding"])
def test_equilibrium_of_the_roped_cranes(kind):
    motion = solve(carried(kind), CASES["gantry"][1], 0.0)
    assert_allclose(motion.inputs, [[-98.1, -98.1, 0]], atol=1e-11)
    assert_allclose(motion.tensions, [[981, 981]])


def test_planar_navy_crane_is_y_6_1_2():
    rig, reference, *_ = CASES["planar navy"]
    motion = solve(rig, reference, np.linspace(0, 3, 3001))
    assert_allclose(motion.inputs[0], [-49.05, -98.1, -129.77], atol=5e-3)
    one = motion.tensions[:, 0]
    assert one.min() == pytest.approx(-9177, abs=1)
    assert one[-1] == pytest.approx(-231, abs=0.5)
    assert {slack.rope for slack in motion.slack} == {"one"}


def test_navy_crane_refuses_the_printed_profile():
    rig, *_ = CASES["navy"]
    printed = three_phase((5 * ROOT3, 0, -15, 2.5), (-2, 4 * ROOT3, -13, 1.5), 20, 5)
    with pytest.raises(SmoothnessError, match=r"has 4 continuous derivatives.*needs 6"):
        solve(rig, printed, 0.0)


def test_a_boom_that_would_have_to_let_go_is_refused():
    """The tower passes under the load: no turn of the boom can follow."""
    rig, *_ = CASES["cantilever"]
    path = three_phase((5, 0, -5), (-5, 0, -5), 20, 5)
    with pytest.raises(PathError, match="cannot follow"):
        solve(rig, path, np.linspace(0, 20, 401))
