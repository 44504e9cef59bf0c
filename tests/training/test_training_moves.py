"""Random moves for training and judging: within bounds, plannable, as hard as they are meant."""

from dataclasses import replace

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.envs.crane.plan import layout_of, make_plan
from flatrig.envs.crane.references import SHORTEST, RandomMoves, random_ends
from flatrig.models.errors import OptionError
from flatrig.training.random_moves import PERIOD, random_move


def drawn(name, count, seed=5, **options):
    rig = models.make(name)
    own = models.default_move(rig)
    rng = np.random.default_rng(seed)
    return rig, own, [random_move(rig, own, rng, **options) for _ in range(count)]


@pytest.mark.parametrize("name", ["overhead", "cantilever", "navy-2d"])
def test_moves_are_planned_with_inputs_to_spare(name):
    rig, own, moves = drawn(name, 3)
    low, high = np.sort((own.start, own.goal), axis=0)
    most = 0.0
    for move in moves:
        plan = make_plan(rig, feedforward.from_move(move), PERIOD, 1.0)
        inputs = np.abs(plan.rows[:, layout_of(rig).columns["feedforward"]])
        most = max(most, inputs.max())
        assert plan.steps * PERIOD == pytest.approx(move.duration + 1.0)
        assert (np.array((move.start, move.goal)) >= low - 1e-9).all()
        assert (np.array((move.start, move.goal)) <= high + 1e-9).all()
        assert (move.profile, move.order) == (own.profile, own.order)
        assert move.blend / move.duration == pytest.approx(own.blend / own.duration)
    # Samples of the plan lie between those of the search; the own move may use more than the share.
    assert most < 0.77


def test_the_fastest_use_their_share_and_the_slowest_take_twice_as_long():
    rig, _, (fast,) = drawn("gantry", 1, slow=(1.0, 1.0))
    limits = np.array([drive.limit for drive in rig.drives])

    def used(duration):
        path = feedforward.from_move(
            replace(fast, duration=duration, blend=fast.blend * duration / fast.duration)
        )
        motion = feedforward.solve(rig, path, np.linspace(0.0, duration, 400))
        taut = motion.tensions.min(axis=0) / np.minimum(motion.tensions[0], motion.tensions[-1])
        return np.abs(motion.inputs / limits).max(), taut.min()

    inputs, taut = used(fast.duration)
    assert inputs < 0.66
    assert taut > 0.39
    inputs, taut = used(fast.duration / 1.1)  # the search is good to 8 percent
    assert inputs > 0.65 or taut < 0.4
    _, _, (slow,) = drawn("gantry", 1, slow=(2.0, 2.0))
    assert slow.start == fast.start
    assert slow.duration == pytest.approx(2.0 * fast.duration, abs=2 * PERIOD)


def test_the_same_seed_draws_the_same_moves():
    assert drawn("overhead", 2)[2] == drawn("overhead", 2)[2]
    assert drawn("overhead", 2)[2] != drawn("overhead", 2, seed=6)[2]


def test_ends_lie_on_edges_as_often_as_they_should():
    rig = models.make("rotary")
    own = models.default_move(rig)
    rng = np.random.default_rng(0)
    ends = [random_ends(rig, own, rng, edges=0.5) for _ in range(400)]
    places = np.array([(end.start, end.goal) for end in ends])
    shares = (places - own.start) / np.subtract(own.goal, own.start)
    assert shares.min() >= 0.0
    assert shares.max() <= 1.0
    edge = ((shares == 0.0) | (shares == 1.0)).any(axis=(1, 2))
    assert edge.mean() == pytest.approx(0.5, abs=0.05)  # all but 0.3^6 of those that should
    assert min(end.share for end in ends) >= SHORTEST
    plain = [random_ends(rig, own, np.random.default_rng(9), edges=0.0) for _ in range(2)]
    assert plain[0] == plain[1]


def test_a_free_pulley_keeps_moves_near_the_line():
    rig = models.make("navy-2d")
    own = models.default_move(rig)
    rng = np.random.default_rng(0)
    span = np.subtract(own.goal, own.start)
    for _ in range(50):
        for end in random_ends(rig, own, rng, edges=1.0)[:2]:
            assert np.ptp((np.array(end) - own.start) / span) <= 0.2 + 1e-9


def test_a_sampled_move_lends_its_ends(tmp_path):
    file = tmp_path / "path.csv"
    times = np.linspace(0.0, 4.0, 41)
    way = 0.5 - 0.5 * np.cos(np.pi * times / 4.0)
    rows = [f"{t},{3 * w},{-4 + w}" for t, w in zip(times, way, strict=True)]
    file.write_text("\n".join(["time,load.x,load.z", *rows]) + "\n")
    own = models.Move(profile="sampled", samples=str(file))
    rig = models.make("overhead")
    move = random_move(rig, own, np.random.default_rng(1))
    assert move.profile == "polynomial"
    assert max(move.start[0], move.goal[0]) <= 3.0 + 1e-9
    assert RandomMoves(rig, own)(np.random.default_rng(1)).duration > 0.0


def test_what_cannot_be_drawn_is_said():
    rig = models.make("overhead")
    still = models.Move(start=(0.0, -4.0), goal=(0.0, -4.0), duration=3.0)
    with pytest.raises(OptionError, match="ends where it starts"):
        random_move(rig, still, np.random.default_rng(0))
    far = models.Move(start=(0.0, -4.0), goal=(0.0, 40.0), duration=3.0)
    with pytest.raises(OptionError, match="could follow none of 50 random moves"):
        random_move(rig, far, np.random.default_rng(0), edges=1.0)
