"""The stress suite judges rightly, and a quick part of it ends as it must."""

import csv
import json
import math
import time
from dataclasses import replace
from functools import partial

import mujoco
import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.models.errors import PathError
from flatrig.training import cli
from flatrig.training.options import Stress
from flatrig.training.stress import (
    episode_cases,
    program_cases,
    random_cases,
    random_limits,
    run_cases,
    solver_cases,
)
from flatrig.training.stress import roads as stress_roads
from flatrig.training.stress import stiff_cases as stiff
from flatrig.training.stress import suite as stress
from flatrig.training.stress.case import (
    CORRECT,
    REFUSED,
    STOPPED,
    WRONG,
    Case,
    Finding,
    Stopped,
    judge,
    worst,
)
from flatrig.training.stress.random_cases import random_case
from flatrig.training.stress.random_frames import boom_crane
from flatrig.training.stress.random_parts import Dice
from flatrig.training.stress.random_rigs import KINDS, random_rig


@pytest.fixture
def quietly():
    """Steps beyond the stability limit, of which MuJoCo warns, without a word or a file."""
    log = mujoco.MjLogConfig.get()
    stress.quiet()
    yield
    log.set()


def refuse():
    raise PathError("cannot")


def stop():
    raise Stopped("slack")


def crash():
    return Finding(1 / 0, 1.0)


def warn():
    return Finding(float(np.array(1.0) / np.array(0.0)), 1.0)


def hang():
    time.sleep(60)
    return Finding(0.0, 1.0)


@pytest.mark.parametrize(
    ("check", "must", "ending"),
    [
        (lambda: Finding(0.5, 1.0), (CORRECT,), CORRECT),
        (lambda: Finding(2.0, 1.0), (CORRECT,), WRONG),
        (lambda: Finding(math.nan, 1.0), (CORRECT,), WRONG),
        (lambda: Finding(0.5, 1.0), (REFUSED,), WRONG),
        (refuse, (CORRECT, REFUSED), REFUSED),
        (refuse, (CORRECT,), WRONG),
        (stop, (STOPPED,), STOPPED),
        (stop, (CORRECT,), WRONG),
        (crash, (CORRECT, REFUSED, STOPPED), WRONG),
        (warn, (CORRECT, REFUSED, STOPPED), WRONG),
        (hang, (CORRECT, REFUSED, STOPPED), WRONG),
    ],
)
def test_every_ending_is_named(check, must, ending):
    outcome = judge(Case("row", "label", check, must), patience=0.2)
    assert outcome.ending == ending
    assert ending == CORRECT or outcome.reason or outcome.error is not None


@pytest.mark.parametrize(
    ("changes", "ending"),
    [
        ({"error": 1e-12}, CORRECT),
        ({"error": 2.0}, WRONG),
        ({"error": math.nan}, WRONG),
        ({"error": None}, WRONG),
        ({"ending": REFUSED}, WRONG),
        ({"ending": STOPPED}, WRONG),
        ({"error": "small"}, "anew"),
        ({"ending": "fine"}, "anew"),
        ({"colour": "red"}, "anew"),
    ],
)
def test_what_was_kept_is_judged_again(changes, ending, tmp_path):
    """A file says that a case was correct, with numbers that are none of a correct case."""
    command = Stress(only="free fall", output=str(tmp_path), resume=True, processes=1)
    chosen = solver_cases.case("row", "label", solver_cases.drop, 0.5, 0.0)
    (honest,) = stress.run([chosen], tmp_path, command)
    assert honest.ending == CORRECT
    head, line = (tmp_path / "progress.jsonl").read_text().splitlines()
    entry = json.loads(line)
    entry["value"] |= {"ending": CORRECT} | changes
    (tmp_path / "progress.jsonl").write_text(f"{head}\n{json.dumps(entry)}\n")
    (again,) = stress.run([chosen], tmp_path, command)
    assert again == honest if ending == "anew" else again.ending == ending
    allowed = replace(chosen, must=(CORRECT, STOPPED))
    (other,) = stress.run([allowed], tmp_path, command)
    assert (other.ending == STOPPED) == (changes == {"ending": STOPPED})


def test_the_worst_is_the_nearest_to_its_tolerance_or_not_a_number():
    near, far, lost = Finding(0.5, 1.0), Finding(1e-3, 1.0), Finding(math.nan, 1.0)
    assert worst(far, near) is near
    assert worst(far, lost, near) is lost


def test_random_rigs_are_of_every_kind_and_the_same_again():
    rigs = [random_rig(np.random.default_rng(seed)) for seed in range(160)]
    assert rigs[:5] == [random_rig(np.random.default_rng(seed)) for seed in range(5)]
    # platforms hang from trolleys or masts; what is held is a box, a beam or a link with a mass
    assert len({rig.name for rig in rigs}) == len(KINDS) + 3
    assert any(link.mass for rig in rigs for link in rig.links)
    assert {frame.kind for rig in rigs for frame in rig.frames} == {"turning", "sliding"}
    assert any(rope.falls > 1 for rig in rigs for rope in rig.ropes)
    assert any(rope.sheaves for rig in rigs for rope in rig.ropes)


def test_a_base_whose_motion_is_given_is_drawn_without_friction_and_gear(monkeypatch):
    monkeypatch.setattr(random_limits, "SHARE", 1.0)
    based = rubbed = 0
    for seed in range(30):
        dice = Dice(np.random.default_rng(seed), 1.0)
        rig = random_limits.limited(boom_crane(dice), dice)
        based += rig.frames[0].given
        rubbed += any(frame.friction.viscous for frame in rig.frames)
    assert based > 2
    assert rubbed > 10


def test_a_rig_that_cannot_be_drawn_is_a_fault(monkeypatch):
    def none(rng):
        raise models.RigError("there is no such rig")

    monkeypatch.setattr(random_cases, "random_rig", none)
    found = random_case(0, 0)
    assert found.error == math.inf
    assert found.road == "drew no valid rig: there is no such rig"


def test_random_rigs_end_as_they_must():
    outcomes = [
        judge(Case("", str(number), partial(random_case, 5, number), (CORRECT, REFUSED)))
        for number in range(30)
    ]
    assert [one for one in outcomes if one.ending == WRONG] == []
    assert sum(one.ending == CORRECT for one in outcomes) > 10


def test_the_roads_see_a_wrong_input_and_a_hop():
    rig = models.overhead_crane()
    reference = feedforward.from_move(models.default_move(rig))
    motion = feedforward.solve(rig, reference, np.linspace(0, 3, 151))
    assert stress_roads.from_mujoco(motion) < 1e-9
    assert stress_roads.from_equations(motion) < 1e-9
    assert stress_roads.jump(rig, reference, motion) < 1e-6
    motion.inputs[75] *= 1.001
    assert stress_roads.worst_residual(motion, reference) > 1e-5
    motion.inputs[:] *= 1.001
    assert stress_roads.from_mujoco(motion) > 1e-5
    assert stress_roads.from_equations(motion) > 1e-5
    motion.positions[75:] += 0.1
    assert stress_roads._unexplained(motion).max() == pytest.approx(0.1, rel=0.01)


def test_energy_is_the_closed_form():
    rig = models.overhead_crane()
    values = {"trolley.position": 1.0, "load.x": 1.0, "load.z": -4.0}
    rates = {"trolley.position": 2.0, "load.x": 2.0, "load.z": -3.0}
    kinetic = 0.5 * (10 * 4 + 100 * 13 + 10 * 9)  # the winch's J/r^2 is 10 kg
    expected = kinetic - 100 * 9.81 * 4
    assert stress_roads.energy(rig, values, rates) == pytest.approx(expected)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("name", ["navy_crane_3d", "rotary_crane"])
def test_feedforward_does_not_depend_on_the_unit_of_length(name, size):
    found = solver_cases.resized_crane(name, size)
    assert found.share <= 1


@pytest.mark.parametrize(("share", "ending"), [(0.999, CORRECT), (1.001, REFUSED)])
def test_free_fall_is_the_limit(share, ending):
    check = partial(solver_cases.drop, share, 1.0)
    assert judge(Case("", "", check, (ending,))).ending == ending


@pytest.mark.usefixtures("quietly")
@pytest.mark.parametrize("integrator", stiff.LIMITS)
def test_the_step_limit_of_a_stiff_rope_is_the_theoretical_one(integrator):
    found = stiff.rope(1e8, integrator)
    omega = math.sqrt(1e8 * (1 / 100 + 1 / 10))
    assert found.theory == pytest.approx(stiff.LIMITS[integrator] / omega)
    assert found.limit == pytest.approx(found.theory, rel=0.01)


@pytest.mark.usefixtures("quietly")
@pytest.mark.parametrize(
    "check",
    [
        partial(stiff.pulley, "navy_crane_3d", 1e-3),
        partial(stiff.elastic_move, 1e6),
        partial(run_cases.linear_swing, 4.0, 0.5),
        partial(run_cases.period, 120.0),
        partial(run_cases.let_go, 120.0),
        partial(run_cases.bounce, 0.1, 1e6),
        partial(run_cases.caught, 0.1),
        partial(run_cases.spike, "cantilever_crane", 0.01, 0),
    ],
    ids=lambda check: check.func.__name__,
)
def test_runs_are_what_theory_says(check):
    found = check()
    assert 0 < found.share <= 1


@pytest.mark.usefixtures("quietly")
def test_the_command_counts_keeps_and_tells(monkeypatch, capsys, tmp_path):
    ran = []

    def found(error):
        ran.append(error)
        return Finding(error, 1.0, "guess", 0.1, 0.2)

    some = [
        Case("good", "one", partial(found, 0.5)),
        Case("good", "two", stop, (STOPPED,)),
        Case("bad", "three", partial(found, 2.0)),
    ]
    monkeypatch.setattr(stress, "cases", lambda rigs, seed: some)
    command = ["stress", "-o", str(tmp_path), "--processes", "1"]
    assert cli.main([*command, "--only", "goo"]) == 0
    assert cli.main([*command, "--resume"]) == 1
    assert ran == [0.5, 2.0]
    out = capsys.readouterr().out
    assert "bad, three: guess: 2, must be at most 1" in out
    with (tmp_path / "stress.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["ending"] for row in rows] == [CORRECT, STOPPED, WRONG]
    assert cli.main([*command, "--only", "nothing"]) == 2
    for option in ("--seed=-1", "--rigs=0", "--processes=0"):
        assert cli.main([*command, option]) == 2


def test_environments_follow_exact_inputs_and_the_wind():
    late = episode_cases.exact("overhead_crane", feedback=False)
    assert 0.0 < late.error < late.tolerance
    blown = episode_cases.windy()
    assert 0.0 < blown.error < blown.tolerance


def test_steps_of_compiled_programs_are_judged(monkeypatch, tmp_path):
    """Of one crane; a difference of refusals is as wrong as one of inputs."""
    if program_cases.compiler() is None:
        pytest.skip("there is no C compiler")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(program_cases, "TOGETHER", 4)
    first = next(iter(program_cases.cases()))
    assert judge(first).ending == CORRECT
    monkeypatch.setattr(program_cases, "_solved", lambda *_: None)
    assert judge(first).ending == WRONG
