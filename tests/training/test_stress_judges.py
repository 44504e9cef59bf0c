"""The judges of random rigs see what is planted, and closed forms know what can be followed."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.feedforward.exact import assembly, between, branch, home, problem, taylor
from flatrig.feedforward.generated import results
from flatrig.feedforward.paths import reference as paths
from flatrig.feedforward.planning import feasibility
from flatrig.feedforward.solving import inverse, programs
from flatrig.models.friction import Friction
from flatrig.models.rig.parts import Rope
from flatrig.training.simulate.open_loop import open_loop
from flatrig.training.stress import rates
from flatrig.training.stress.case import CORRECT, EITHER, REFUSED, WRONG, Case, judge
from flatrig.training.stress.closed_forms import order_needed
from flatrig.training.stress.forces import Seen, model_of
from flatrig.training.stress.random_cases import followed_or_refused, random_case
from flatrig.training.stress.random_parts import Dice
from flatrig.training.stress.random_rigs import KINDS, pulley_crane, random_rig
from flatrig.training.stress.wild_moves import random_move

MOST = 24
"""Random rigs of the kind that has it in which a planted fault has to show."""


def forget():
    """Nothing that was computed before a fault was planted, or with it, is used."""
    for kept in (problem.kept_problem, branch.branch_of, home.approach, model_of):
        kept.cache_clear()


def outcomes(has):
    """Of the first random rigs that have something."""
    numbers = (k for k in range(1000) if has(random_rig(np.random.default_rng([13, k]))))
    for number in islice(numbers, MOST):
        yield judge(Case("", str(number), random_case, EITHER, (13, number)))


def wrong_factorials(orders):
    found = feedforward.series.products.factorials(orders)
    found[3:4] *= 4.0
    return found


def heavier(self, mass, place):
    self.force -= 1.001 * mass * self.rig.gravity * place[2, :-1]


def none_said(*_):
    return None


FAULTS = {
    "a factorial": [(room, "factorials", wrong_factorials) for room in (paths, programs)],
    "a winch's inertia": [
        (
            Rope,
            "inertia_along",
            property(lambda rope: 1.01 * rope.winch_inertia / rope.drum_radius**2),
        )
    ],
    "weights": [(assembly._Builder, "add_weight", heavier)],
    "tensions": [
        (
            results.Results,
            "tensions",
            lambda self, right=results.Results.tensions: right(self)[::-1],
        )
    ],
    "slack": [(inverse, "find_slack", lambda *_: ())],
    "where a sheave turns": [
        (Rope, "after", lambda rope, sheave: rope.path.index(sheave.at, 1) - 1)
    ],
    "rail ends": [(room, "stay_on_rails", none_said) for room in (inverse, branch, between)],
    "rail ends in check": [(feasibility, "_off_rails", lambda motion: [])],
    "friction": [(results, "losses_of", none_said)],
    "products of inertia": [(assembly._Builder, "add_coupling", none_said)],
    "refusals": [(taylor, "SINGULAR", 0.9)],
}


HAS = {
    "where a sheave turns": lambda rig: any(rope.sheaves for rope in rig.ropes),
    "rail ends": lambda rig: any(np.isfinite(rail.end) for rail in rig.rails),
    "rail ends in check": lambda rig: any(np.isfinite(rail.end) for rail in rig.rails),
    "friction": lambda rig: any(rig.driven(d).friction != Friction() for d in rig.drives),
    "products of inertia": lambda rig: any(len(part.inertia) == 6 for part in rig.platforms),
    "refusals": lambda rig: rig.name == "rope_robot",
}
"""What a rig must have for a fault to show; else any will do."""


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_seen(name, monkeypatch):
    forget()
    for owner, attribute, wrong in FAULTS[name]:
        monkeypatch.setattr(owner, attribute, wrong)
    found = outcomes(HAS.get(name, lambda rig: True))
    assert any(outcome.ending == WRONG for outcome in found)
    forget()


@pytest.mark.parametrize("shift", ["velocities", "accelerations"])
def test_rates_are_compared_with_places(shift, monkeypatch):
    rig = models.rotary_crane()
    path = feedforward.from_move(models.default_move(rig))
    motion = feedforward.solve(rig, path, np.linspace(0, path.duration, 101))
    assert rates.drift(rig, path, motion) < 1e-9

    def off(*arguments):
        found = feedforward.solve(*arguments)
        return replace(found, **{shift: 1.001 * getattr(found, shift)})

    monkeypatch.setattr(rates, "solve", off)
    assert rates.drift(rig, path, motion) > 1e-4


def test_every_force_is_compared():
    rig = models.cantilever_crane()
    path = feedforward.from_move(models.default_move(rig))
    motion = feedforward.solve(rig, path, np.linspace(0, path.duration, 101))
    seen = Seen(motion)
    assert max(seen.inputs(), seen.winches(), seen.bodies(), seen.slack()) < 1e-11
    stronger = Seen(replace(motion, inputs=1.001 * motion.inputs))
    assert min(stronger.inputs(), stronger.winches(), stronger.bodies()) > 1e-6
    tighter = Seen(replace(motion, tensions=1.001 * motion.tensions))
    assert min(tighter.winches(), tighter.bodies()) > 1e-5
    pushing = feedforward.exact.motion.Slack("hoist", 0.0, path.duration, -1.0)
    assert Seen(replace(motion, slack=(pushing,))).slack() > 0.01


def test_a_load_on_a_free_pulley_with_a_heavy_sheave_is_flat():
    """The sheave's torque follows from the rope beyond it, before the boom's angle is known."""
    rng = np.random.default_rng(27)
    rig = next(
        found
        for found in (pulley_crane(Dice(rng, 10.0)) for _ in range(200))
        if found.frames and found.ropes[1].sheaves and found.ropes[1].falls == 1
    )
    sheave = models.Sheave("pulley", 2.0, 0.2)
    rig = replace(rig, ropes=(rig.ropes[0], replace(rig.ropes[1], sheaves=(sheave,)), rig.ropes[2]))
    home = rig.home_coordinates
    start = [home[name] for name in rig.outputs]
    path = feedforward.rest_to_rest(start, np.add(start, (0.5, 1.0, 0.8, 0.3)), 8.0, order=6)
    assert feedforward.analyse(rig).reference_order == 6
    assert followed_or_refused(rig, path).share <= 1
    assert open_loop(rig, path).distance.max() < 1e-4


def test_what_is_not_smooth_enough_has_a_closed_form():
    assert order_needed(pulley_crane(Dice(np.random.default_rng(1), 1.0))) in (4, 6)
    for number in range(40):
        rig = random_rig(np.random.default_rng([3, number]))
        assert feedforward.analyse(rig).reference_order <= order_needed(rig)


@pytest.mark.parametrize(("number", "ending"), [(4319, CORRECT), (7395, REFUSED)])
def test_rigs_that_were_wrong_once(number, ending):
    """A platform whose Newton steps stall above rounding; a span that passes through infinity."""
    rng = np.random.default_rng([0, number])
    dice = Dice(rng, float(10.0 ** rng.uniform(-2, 2)))
    rig = KINDS[int(rng.integers(8))](dice)  # of the eight kinds that there were
    reference = feedforward.from_move(random_move(rig, rng))
    assert judge(Case("", "", followed_or_refused, EITHER, (rig, reference))).ending == ending


def test_forces_through_the_axis_of_a_boom_turn_it_by_rounding_alone():
    """A load hangs from a point on the axis: what was told wrong was 1e-16 of force times arm."""
    assert judge(Case("", "", random_case, EITHER, (1, 557))).ending == CORRECT


def test_a_turning_body_is_measured_by_its_spin_where_its_acceleration_passes_zero():
    """That comes from directors, which its rate's square accelerates there: 9e-12 N m of 8e7 kg m2
    are rounding, and a hundred-millionth of what turns the directors is not."""
    number = 1369
    assert judge(Case("", "", random_case, EITHER, (1, number))).ending == CORRECT
    rng = np.random.default_rng([1, number])
    rig = random_rig(rng)
    path = feedforward.from_move(random_move(rig, rng))
    motion = feedforward.solve(rig, path, np.linspace(0.0, path.duration, 151))
    heavy = int(np.argmax([frame.along for frame in rig.frames]))
    spin = motion.velocities[75, motion.column(rig.frames[heavy].coordinate)]
    torque = rig.frames[heavy].along * spin**2
    motion.inputs[75, heavy] += 1e-8 * torque
    assert 5e-9 < Seen(motion).bodies() < 1.1e-8
