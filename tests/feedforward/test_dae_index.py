"""The 3D Navy crane with a heavy pulley: index 7, and what that means for minimal extension."""

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.feedforward import dae, rest_to_rest, three_phase
from flatrig.models.errors import SmoothnessError

ONCE, TWICE, THREE_TIMES = (
    "minimal extension",
    "minimal extension, twice",
    "minimal extension, three times",
)


@pytest.fixture(scope="module")
def crane():
    rig = models.navy_crane_3d()
    return rig, models.default_move(rig)


def errors(rig, path, **options):
    found = feedforward.integrate(rig, path, **options)
    assert found.failure is None
    truth = feedforward.solve(rig, path, found.motion.times)
    return [
        np.abs(getattr(found.motion, q) - getattr(truth, q)).max() for q in ("positions", "inputs")
    ]


class Shaken:
    """A path with a sawtooth on it and on each of its derivatives, up at one step, down at the
    next.
    """

    def __init__(self, path, step, size):
        self.path, self.step, self.height = path, step, size
        self.order, self.duration, self.size = path.order, path.duration, path.size
        self.start, self.goal = path.start, path.goal

    def derivatives(self, times, order):
        signs = np.where(np.round(np.asarray(times) / self.step) % 2 == 0, 1.0, -1.0)
        return self.path.derivatives(times, order) + self.height * signs[:, None]


def amplification(rig, path, formulation, step, size):
    """Largest change of an input by a disturbance of what is prescribed, over its size."""
    found = [
        feedforward.integrate(rig, one, step=step, formulation=formulation)
        for one in (path, Shaken(path, step, size))
    ]
    assert [one.failure for one in found] == [None, None]
    return np.abs(found[0].motion.inputs - found[1].motion.inputs)[10:].max() / size


SHORT = {
    "overhead_crane": ((0, -4), (0.5, -3.7)),
    "navy_crane_2d": ((-2.5 * 3**0.5, -22.5, -12.5), (-4.4, -22.4, -12.4)),
    "navy_crane_3d": ((5 * 3**0.5, 0, -15, 2.5), (5 * 3**0.5 - 0.05, 0.05, -14.9, 2.5)),
}


@pytest.mark.parametrize("formulation", dae.FORMULATIONS)
@pytest.mark.parametrize("name", SHORT)
def test_index_is_how_disturbances_grow(name, formulation):
    """From index nu the inputs are nu - 1 differentiations away (perturbation index)."""
    rig = getattr(models, name)()
    if dae.why_not(rig, formulation):
        pytest.skip("does not apply")
    index = dae.formulation(rig, formulation).index
    path = rest_to_rest(*SHORT[name], duration=2.0, order=9)
    size = {7: 1e-11, 5: 1e-9}.get(index, 1e-7)
    coarse, fine = (amplification(rig, path, formulation, h, size) for h in (0.04, 0.02))
    assert np.log2(fine / coarse) == pytest.approx(index - 1, abs=0.15)


@pytest.mark.parametrize("formulation", dae.FORMULATIONS)
def test_index_where_nothing_is_left_to_swing(formulation):
    """A load on two winches: the index is 3, and constraints that are left keep it there."""
    rig = models.Rig(
        name="two_winches",
        masses=(models.Load("load", 100.0),),
        ropes=tuple(
            models.Rope(side, (f"{side}_mast", "load"), drum_radius=0.1, winch_inertia=1.0)
            for side in ("left", "right")
        ),
        drives=tuple(models.Drive(f"{side}_winch", side, 1e4) for side in ("left", "right")),
        outputs=("load.x", "load.z"),
        anchors=tuple(
            models.Anchor(f"{side}_mast", (x, 0.0, 0.0)) for side, x in (("left", -5), ("right", 5))
        ),
        home={"load": (0.0, 0.0, -5.0)},
        dimensions=2,
    )
    if dae.why_not(rig, formulation):
        pytest.skip("does not apply")
    path = rest_to_rest((-3, -4), (3, -3), duration=2.0, order=9)
    coarse, fine = (amplification(rig, path, formulation, h, 1e-8) for h in (0.004, 0.002))
    index = dae.formulation(rig, formulation).index
    assert np.log2(fine / coarse) == pytest.approx(index - 1, abs=0.15)


def test_each_application_takes_two_off_the_index(crane):
    rig, _ = crane
    assert [dae.formulation(rig, name).index for name in ("direct", ONCE, TWICE, THREE_TIMES)] == [
        *(7, 5, 3, 1)
    ]


def test_as_printed_the_places_still_depend_on_the_step(crane):
    """Index 5: implicit Euler converges to order 1 in the places, which index 3 has exactly."""
    rig, move = crane
    path = rest_to_rest(move.start, move.goal, move.duration, order=9)
    steps = (0.2, 0.1, 0.05)
    printed = np.array([errors(rig, path, step=h, formulation=ONCE) for h in steps])
    np.testing.assert_allclose(np.log2(printed[:-1] / printed[1:]), 1.0, atol=0.15)
    assert printed[-1, 0] > 1e-6
    mended = np.array([errors(rig, path, step=h, formulation=TWICE) for h in steps])
    assert mended[:, 0].max() < 1e-11
    np.testing.assert_allclose(np.log2(mended[:-1, 1] / mended[1:, 1]), 1.0, atol=0.15)
    algebraic = errors(rig, path, step=0.2, formulation=THREE_TIMES)
    assert max(algebraic) < 1e-8


def test_a_path_of_too_low_order_cannot_be_mended(crane):
    """The printed profile has four continuous derivatives and the boom's torque needs six: at the
    joins of its phases it is not finite, and the shorter the step the higher it gets.
    """
    rig, move = crane
    path = three_phase(move.start, move.goal, move.duration, blend=5.0, order=4)
    with pytest.raises(SmoothnessError):
        feedforward.solve(rig, path, [0.0])
    smooth = rest_to_rest(move.start, move.goal, move.duration, order=9)
    boom = rig.input_names.index("boom")
    for reference, growth in ((path, 2.0), (smooth, 0.5)):
        jumps = []
        for step in (0.025, 0.0125):
            found = feedforward.integrate(rig, reference, step=step, formulation=TWICE)
            assert found.failure is None
            jumps.append(np.abs(np.diff(found.motion.inputs[:, boom])).max())
        assert jumps[1] / jumps[0] == pytest.approx(growth, rel=0.05)
