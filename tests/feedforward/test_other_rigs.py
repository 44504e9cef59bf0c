"""The solver on rigs that are not in the catalogue: it knows descriptions, not names.

Numbers: K 3.67, 3.77 (equilibria), Y 6.1.2 (planar Navy crane with heavy pulley), Y 6.2.2 (in
space; index 7, six derivatives, K theorem 3).
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig.feedforward import analyse, residuals, rest_to_rest, solve, three_phase
from flatrig.models import Anchor, Drive, Load, PathError, Rig, Rope, SmoothnessError

ROOT3 = np.sqrt(3.0)


def rope(name, *path):
    return Rope(name, path, drum_radius=0.1, winch_inertia=0.1)


CASES = {
    "cantilever": (three_phase((5, 0, -5), (-2, 2, -2), 20, 5), 5, 4),
    "gantry": (three_phase((5, 0, -5), (-1, 2, -2), 20, 5), 5, 4),
    "planar navy": (rest_to_rest((-2.5 * ROOT3, -22.5, -12.5), (-1, -17.5, -10.5), 3), 5, 4),
    "navy": (rest_to_rest((5 * ROOT3, 0, -15, 2.5), (-2, 4 * ROOT3, -13, 1.5), 20, order=6), 7, 6),
}


@pytest.mark.parametrize("case", list(CASES))
def test_structure_and_residuals(case, other_rigs):
    rig, (reference, index, order) = other_rigs[case], CASES[case]
    analysis = analyse(rig)
    assert (analysis.index, analysis.reference_order) == (index, order)
    assert analysis.flat
    motion = solve(rig, reference, np.linspace(0, reference.duration, 401))
    assert residuals(motion, reference).max() < 1e-9
    assert_allclose(motion.outputs, reference(motion.times), rtol=0, atol=1e-12)


@pytest.mark.parametrize("kind", ["cantilever", "gantry"])
def test_equilibrium_of_the_roped_cranes(kind, other_rigs):
    motion = solve(other_rigs[kind], CASES["gantry"][0], 0.0)
    assert_allclose(motion.inputs, [[-98.1, -98.1, 0]], atol=1e-11)
    assert_allclose(motion.tensions, [[981, 981]])


def test_planar_navy_crane_is_y_6_1_2(other_rigs):
    reference = CASES["planar navy"][0]
    motion = solve(other_rigs["planar navy"], reference, np.linspace(0, 3, 3001))
    assert_allclose(motion.inputs[0], [-49.05, -98.1, -129.77], atol=5e-3)
    one = motion.tensions[:, 0]
    assert one.min() == pytest.approx(-9177, abs=1)
    assert one[-1] == pytest.approx(-231, abs=0.5)
    assert {slack.rope for slack in motion.slack} == {"one"}


def test_massless_pulley_ends_as_in_y_6_1_1():
    """From a regular start; the printed one, straight below the boom's tip, is singular."""
    along = (-5 * ROOT3, 0.0, -5.0)
    rig = Rig(
        name="massless_pulley",
        dimensions=2,
        anchors=(Anchor("A", along), Anchor("P", (0.0, 0.0, 0.0))),
        masses=(Load("pulley", 0.0), Load("load", 100.0)),
        ropes=(rope("one", "A", "pulley"), rope("two", "P", "pulley", "load")),
        drives=(Drive("one", "one", 1.0), Drive("two", "two", 1.0)),
        outputs=("load.x", "load.z"),
        home={"pulley": (-2.5, 0.0, -4.5), "load": (-3.0, 0.0, -13.0)},
    )
    analysis = analyse(rig)
    assert (analysis.index, analysis.reference_order, analysis.degrees_of_freedom) == (5, 4, 0)
    path = rest_to_rest((-3, -13), (-5, -12), 5)
    motion = solve(rig, path, np.linspace(0, 5, 101))
    assert residuals(motion, path).max() < 1e-9
    assert_allclose(motion.inputs[-1], [-64.733, -98.1], atol=5e-4)


def test_navy_crane_refuses_the_printed_profile(other_rigs):
    printed = three_phase((5 * ROOT3, 0, -15, 2.5), (-2, 4 * ROOT3, -13, 1.5), 20, 5)
    with pytest.raises(SmoothnessError, match=r"has 4 continuous derivatives.*needs 6"):
        solve(other_rigs["navy"], printed, 0.0)


def test_a_boom_that_would_have_to_let_go_is_refused(other_rigs):
    """The tower passes under the load: no turn of the boom can follow."""
    path = three_phase((5, 0, -5), (-5, 0, -5), 20, 5)
    with pytest.raises(PathError, match="cannot follow"):
        solve(other_rigs["cantilever"], path, np.linspace(0, 20, 401))
