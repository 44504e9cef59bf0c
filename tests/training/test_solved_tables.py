"""Tables of `flatrig solve`: their rows are one step apart, and their inputs may be held."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from flatrig import feedforward, models
from flatrig.feedforward import rolling
from flatrig.models.errors import OptionError
from flatrig.models.mjcf import rig_model, simulate
from flatrig.models.mjcf.rig_state import points
from flatrig.models.types import Array
from flatrig.training.cli import main
from flatrig.training.describe.summary import sample_times

QUAY = """
name = "quay"
dimensions = 2
outputs = ["load.x", "load.z"]
home = {trolley = 0.0, load = [0.0, 0.0, -25.0]}
rails = [{name = "beam", direction = [1.0, 0.0, 0.0], start = -30.0, end = 50.0}]
trolleys = [{name = "trolley", mass = 6e4, rail = "beam"}]
loads = [{name = "load", mass = 5e4}]
ropes = [{name = "hoist", path = ["trolley", "load"], drum_radius = 0.75, winch_inertia = 2.7e4}]
drives = [
    {name = "trolley", on = "trolley", limit = 4e5},
    {name = "hoist", on = "hoist", limit = 9e5},
]
move = {start = [0.0, -30.0], goal = [45.0, -20.0], duration = 30.0}
"""
"""A container crane: heavy, slow, and driven by a controller with a hundred values a second."""
STEP = 1e-3
"""Of the simulation [s]."""


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("quay.toml").write_text(QUAY)


def read(name: str) -> tuple[list[str], Array]:
    with Path(name).open(newline="") as file:
        rows = list(csv.reader(file))
    return rows[0], np.array(rows[1:], dtype=float)


def error_when_held(rig: models.Rig, path: Any, inputs: Array, hold: float) -> float:
    """Largest distance of the load from its path in MuJoCo under held inputs, open loop [m]."""
    model = rig_model.compile(rig, timestep=STEP, visuals=False)
    held = np.repeat(inputs, round(hold / STEP), axis=0)
    first = feedforward.solve(rig, path, [0.0])
    start = dict(zip(first.coordinate_names, first.positions[0].tolist(), strict=True))
    at_rest = rig_model.joint_state(rig, model, start)
    run = simulate.run(model, at_rest.qpos, at_rest.qvel, held)
    load = points(rig, run.qpos, run.qvel)["load"][0][:, [0, 2]]
    return float(np.linalg.norm(load - path(STEP * np.arange(len(load))), axis=1).max())


@pytest.mark.parametrize("duration", [30.0, 29.9973])
def test_held_inputs_land_within_micrometres(duration: float) -> None:
    """At 100 Hz, half a hold late is 19 mm off.  The second road is MuJoCo, also past the end."""
    argv = ["solve", "quay.toml", "--rate", "100", "--duration", str(duration), "-o"]
    assert main([*argv, "late.csv"]) == 0
    assert main([*argv, "held.csv", "--hold"]) == 0
    (names, late), (held_names, held) = read("late.csv"), read("held.csv")
    assert names[:3] == ["time", "trolley", "hoist"]
    assert held_names[:3] == ["time", "trolley.held", "hoist.held"]
    assert held_names[3:] == names[3:]
    np.testing.assert_array_equal(np.delete(held, (1, 2), 1), np.delete(late, (1, 2), 1))
    rig, move = models.load("quay.toml")
    path = feedforward.from_move(models.Move(move.start, move.goal, duration))
    rest = np.repeat(held[-1:, 1:3], 200, axis=0)  # the last row goes on holding
    assert error_when_held(rig, path, late[:, 1:3], 0.01) > 15e-3
    assert error_when_held(rig, path, np.vstack((held[:, 1:3], rest)), 0.01) < 10e-6


def test_held_inputs_are_the_means_over_their_holds() -> None:
    rig = models.rotary_crane()
    path = feedforward.from_move(models.default_move(rig))
    hold, times = 0.02, np.array([0.0, 3.3, 11.7, 19.99, 25.0])
    motion = feedforward.solve(rig, path, times, hold=hold)
    exact = feedforward.solve(rig, path, times)
    np.testing.assert_array_equal(motion.positions, exact.positions)

    def mean(time: float, i: int) -> float:
        def at(t: float) -> float:
            return float(feedforward.solve(rig, path, t).inputs[0, i])

        # In the fourth hold the path arrives, and inputs have a kink.
        return quad(at, time, time + hold, epsabs=1e-9, points=(20.0,))[0] / hold

    for i in range(3):
        means = [mean(time, i) for time in times[:4].tolist()]
        np.testing.assert_allclose(motion.inputs[:3, i], means[:3], rtol=1e-7, atol=1e-7)
        assert abs(motion.inputs[3, i] - means[3]) < 0.1 * abs(exact.inputs[3, i] - means[3])
    np.testing.assert_array_equal(motion.inputs[4], exact.inputs[4])  # at rest


def test_what_a_hold_cannot_be_and_what_held_inputs_are_not() -> None:
    rig = models.overhead_crane()
    path = feedforward.from_move(models.default_move(rig))
    for hold in (-0.1, np.nan, np.inf, "long"):
        with pytest.raises(OptionError, match=r"hold is .* s, it must be a finite number >= 0"):
            feedforward.solve(rig, path, [0.0], hold=hold)
    with pytest.raises(OptionError, match=r"means over holds of 0.1 s.*; solve without hold"):
        feedforward.residuals(feedforward.solve(rig, path, [0.0], hold=0.1), path)


@pytest.mark.parametrize(
    ("duration", "rate", "last"),
    [
        (15.0013, 500.0, 7501),
        (3.0, 100.0, 300),
        (0.3, 10.0, 3),
        (0.7, 1 / 0.07, 10),
        (1.1, 1e5, 110_000),
        (2.0, 0.4, 1),
    ],
)
def test_rows_are_one_step_apart_to_the_goal(duration: float, rate: float, last: int) -> None:
    times = sample_times(duration, rate, 10**6)
    np.testing.assert_array_equal(times, np.arange(last + 1) / rate)
    assert times[-2] < duration <= times[-1] * (1 + 1e-12)


@pytest.mark.parametrize("rig", ["overhead", "two-finger"])
def test_a_table_at_a_rate_has_one_step_and_ends_at_the_goal(rig: str) -> None:
    assert main(["solve", rig, "--rate", "50", "--duration", "3.0013", "-o", "a.csv"]) == 0
    names, table = read("a.csv")
    np.testing.assert_allclose(np.diff(table[:, 0]), 0.02, rtol=1e-12)
    assert table[-1, 0] == pytest.approx(3.02)
    rates = [i for i, name in enumerate(names) if name.endswith(("_dot", ".velocity.x"))]
    assert rates
    np.testing.assert_allclose(table[-1, rates], 0.0, atol=1e-12)
    if rig == "overhead":
        place = [names.index(name) for name in ("load.x", "load.z")]
        np.testing.assert_allclose(table[-1, place], (5.0, -1.0), rtol=1e-12)


def test_motors_of_a_hand_are_held_too() -> None:
    pytest.importorskip("clarabel")
    assert main(["solve", "two-finger", "--rate", "4", "--hold", "-o", "held.csv"]) == 0
    names, table = read("held.csv")
    hand, move = models.two_finger_hand(), models.default_hand_move("two_finger_hand")
    times = np.linspace(0.25, 0.5, 41)  # of the second row's hold
    motion = rolling.plan_hand(hand, move)(times)
    inputs = rolling.joint_forces(motion, rolling.in_cones(motion, 0.2, 0.05))
    for name, values in zip(inputs.names, inputs.values.T, strict=True):
        mean = np.trapezoid(values, times) / 0.25
        assert table[1, names.index(f"{name}.held")] == pytest.approx(mean, rel=1e-4)
    assert "left.force.z.held" in names
