"""A refusal at a rope that goes slack names the rope, the time and what falls too fast."""

import re

import numpy as np
import pytest

from flatrig import models
from flatrig.feedforward import check, rest_to_rest, solve
from flatrig.models import PathError


def lowering(name, **values):
    """A rig and its load lowered by 6 m in a second, with when that is too fast and how fast."""
    rig = models.make(name, **values)
    start = np.array(models.default_move(rig).start, dtype=float)
    down = [i for i, output in enumerate(rig.outputs) if output.endswith(".z")]
    if values:
        start[0] -= 1.0  # off the plumb line, where the pulley has a place
    goal = start.copy()
    goal[down] -= 6.0
    reference = rest_to_rest(start, goal, 1.0, order=6)
    times = np.linspace(0.0, 1.0, 100001)
    fall = -reference.derivatives(times, 2)[2][:, down[0]]
    return rig, reference, times[(fall > rig.gravity).argmax()], fall.max()


@pytest.mark.parametrize(
    ("name", "ropes", "load"),
    [
        ("overhead_crane", ["hoist"], "load"),
        ("gantry_crane", ["pull", "hoist"], "load"),
        ("navy_crane_2d", ["tagline", "hoist", "suspension"], "load"),
        ("cable_manipulator", ["hoist_1", "hoist_2", "hoist_3"], "platform"),
    ],
)
def test_a_lowering_faster_than_fall_names_its_ropes(name, ropes, load):
    rig, reference, since, fastest = lowering(name)
    with pytest.raises(PathError) as refused:
        solve(rig, reference, 0.0)
    said = str(refused.value)
    assert " and ".join(f"rope {rope}" for rope in ropes) + " go" in said
    assert "slack there" in said
    (when,) = re.findall(r"at t = ([\d.]+) s \(", said)
    assert float(when) == pytest.approx(since, abs=1e-3)
    assert f"{load} would have to fall at up to {fastest:.4g} m/s2" in said
    assert f"gravity lets it fall at {rig.gravity:.4g} m/s2" in said
    assert check(rig, reference, 100.0).problems == (said,)


def test_a_sheave_s_inertia_lets_the_rope_go_before_the_load_falls():
    rig, reference, since, _ = lowering("extended_rotary_crane")
    with pytest.raises(PathError, match="rope hoist would have to push from") as refused:
        solve(rig, reference, 0.0)
    (pushes,) = re.findall(r"rope hoist would have to push from ([\d.]+) s", str(refused.value))
    assert since - 0.01 < float(pushes) < since
    assert "load would have to fall" in str(refused.value)


def test_a_motion_that_goes_on_with_slack_ropes_says_why_in_the_check():
    rig, reference, since, fastest = lowering("navy_crane_2d", pulley_mass=0)
    hoist, *_ = (part for part in check(rig, reference).problems if part.startswith("rope hoist"))
    assert f"from {since:.3f}" in hoist
    (named,) = re.findall(r"load would have to fall at up to ([\d.]+) m/s2", hoist)
    assert float(named) == pytest.approx(fastest, rel=1e-4)


def test_a_rope_that_is_slack_for_another_reason_names_no_fall():
    rig = models.roped_overhead_crane(load_mass=5.0, trolley_mass=50.0)
    report = check(rig, rest_to_rest((0, -4), (5, -4), 4.0))
    slack = [part for part in report.problems if part.startswith("rope pull")]
    assert slack
    assert not any("fall" in part for part in slack)


def test_a_pulley_that_reaches_its_winch_is_refused_without_a_warning():
    rig = models.navy_crane_2d()
    x, _, z = next(anchor.position for anchor in rig.anchors if anchor.name == "P")
    reference = rest_to_rest((x, z - 20.0, z - 10.0), (x, z - 20.0, z), 10.0, order=6)
    with pytest.raises(PathError, match="rope hoist"):
        solve(rig, reference, np.linspace(0.0, 10.0, 2001))
