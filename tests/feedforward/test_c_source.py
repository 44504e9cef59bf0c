"""Generated C: it compiles without a warning, is what `solve` is, and refuses what that refuses."""

import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.envs.crane.references import as_profile, random_ends
from flatrig.feedforward.generated.c_words import identifier
from flatrig.models.errors import OptionError, PathError, RigError

COMPILER = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Wpedantic", "-Werror"]
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")


@pytest.fixture(autouse=True, scope="module")
def _own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


def built(folder, name, text, *more):
    file = folder / f"{name}.c"
    file.write_text(text)
    order = [COMPILER, *STRICT, *more, str(file), "-o", str(folder / name), "-lm"]
    done = subprocess.run(order, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]
    return folder / name


def run(program):
    return subprocess.run([str(program)], capture_output=True, text=True, check=False)


@needs_compiler
@pytest.mark.parametrize("name", models.CATALOGUE)
def test_a_file_tests_itself(name, tmp_path):
    rig = models.make(name)
    text = feedforward.source(rig, "c", feedforward.from_move(models.default_move(rig)))
    done = run(built(tmp_path, name, text, "-DSELF_TEST", "-O1"))
    assert done.returncode == 0, done.stdout
    assert done.stdout.startswith("passed: 65 samples")
    assert "malloc" not in text
    assert text.count("#include <math.h>") == 1


@needs_compiler
def test_a_test_of_itself_can_fail(tmp_path):
    rig = models.make("overhead_crane")
    text = feedforward.source(rig, "c", feedforward.from_move(models.default_move(rig)))
    heavier = text.replace("-200.0*r2_1", "-200.1*r2_1")
    assert heavier != text
    done = run(built(tmp_path, "wrong", heavier, "-DSELF_TEST"))
    assert done.returncode == 1
    assert done.stdout.startswith("FAILED")


@needs_compiler
@pytest.mark.skipif(shutil.which("size") is None, reason="size of binutils is not installed")
def test_the_largest_file_is_small(tmp_path):
    rig = models.make("cable_manipulator")
    compiled = built(tmp_path, "cable", feedforward.source(rig, "c"), "-O2", "-c")
    done = subprocess.run(["size", str(compiled)], capture_output=True, text=True, check=True)
    assert int(done.stdout.splitlines()[1].split()[0]) <= 40_000


@needs_compiler
def test_the_header_is_enough_for_another_file_in_c(tmp_path):
    rig = models.make("rotary_crane")
    (tmp_path / "rotary_crane.h").write_text(feedforward.source(rig, "c header"))
    (tmp_path / "crane.c").write_text(feedforward.source(rig, "c"))
    main = """
#include <stdio.h>
#include "rotary_crane.h"
int main(void)
{
    rotary_crane_state state = {0};
    rotary_crane_motion motion;
    const double at[5*ROTARY_CRANE_COLUMNS] = {4.0, 1.0, -3.0};
    printf("%s\\n", rotary_crane_message(rotary_crane_step(&state, at, 0.0, &motion)));
    printf("%s\\n", rotary_crane_message(rotary_crane_begin(&state, at)));
    printf("%s\\n", rotary_crane_message(rotary_crane_step(&state, at, 1e-3, &motion)));
    printf("%.17g\\n", motion.input[2]);
    return 0;
}
"""
    more = (str(tmp_path / "crane.c"), f"-I{tmp_path}")
    lines = run(built(tmp_path, "main", main, *more)).stdout.splitlines()
    assert lines[0].startswith("begin was not called")
    assert lines[1:3] == ["all ropes pull"] * 2
    load, winch = rig.loads[0], rig.ropes[0]
    assert float(lines[3]) == pytest.approx(-load.mass * rig.gravity * winch.drum_radius)


def random_path(rig, random):
    """A move between places in the box of the rig's own, in the time of that."""
    own = as_profile(models.default_move(rig))
    start, goal, distance = random_ends(rig, own, random)
    duration = 1.2 * own.duration * max(distance, 0.3) ** 0.5
    return feedforward.from_move(replace(own, start=start, goal=goal, duration=duration))


def walked(stepper, motion, reference):
    times = motion.times
    derivatives = reference.derivatives(times, stepper.order).transpose(1, 0, 2)
    gaps = np.diff(times, prepend=times[0])
    return [stepper.step(sample, h) for sample, h in zip(derivatives, gaps, strict=True)]


def assert_alike(steps, motion, tolerance):
    for group in ("inputs", "tensions", "positions", "velocities"):
        found = np.array([getattr(step, group) for step in steps])
        true = getattr(motion, group)
        assert np.abs(found - true).max() <= tolerance * np.abs(true).max(), group


@needs_compiler
@pytest.mark.parametrize("name", models.CATALOGUE)
def test_steps_in_c_and_in_python_are_those_of_solve(name):
    rig = models.make(name)
    random = np.random.default_rng(5)
    paths = [random_path(rig, random) for _ in range(2)]
    own = feedforward.from_move(models.default_move(rig))
    for number, reference in enumerate([own, *paths]):
        try:
            times = np.linspace(0.0, reference.duration, 65)
            motion = feedforward.solve(rig, reference, times)
        except PathError:
            continue
        in_c = feedforward.Stepper(rig, motion.at(0.0), in_c=True)
        tolerance = 1e-12 if number == 0 else 1e-10
        assert_alike(walked(in_c, motion, reference), motion, tolerance)
        if number == 0:
            stepper = feedforward.Stepper(rig, reference.start)
            assert stepper.coordinate_names == motion.coordinate_names
            assert_alike(walked(stepper, motion, reference), motion, tolerance)


@needs_compiler
def test_winding_is_carried_and_a_jump_is_refused():
    rig = models.make("rotary_crane")
    angles = np.linspace(0.0, 1.5 * np.pi, 9)
    points = [(5 * np.cos(a), 5 * np.sin(a), -5.0) for a in angles]
    path = feedforward.along(points, 60.0, order=4)
    motion = feedforward.solve(rig, path, [40.0])
    opposite = path.derivatives([40.0], 4)[:, 0] * [-1, -1, 1]
    for in_c in (False, True):
        stepper = feedforward.Stepper(rig, motion.at(40.0), in_c=in_c)
        now = stepper.step(path.derivatives([40.0], 4)[:, 0], 0.0)
        later = stepper.step(path.derivatives([40.1], 4)[:, 0], 0.1)
        bridge = motion.column("bridge.angle")
        assert now.positions[bridge] == pytest.approx(motion.positions[0, bridge], abs=1e-12)
        assert later.positions[bridge] > np.pi
        with pytest.raises(PathError, match=r"rig rotary_crane cannot go on at load\.x = "):
            stepper.step(opposite, 0.1)
        again = stepper.step(path.derivatives([40.2], 4)[:, 0], 0.2)
        assert again.positions[bridge] > later.positions[bridge]


@needs_compiler
def test_what_solve_refuses_is_refused():
    """A load that falls faster than gravity, and a trolley off its rail."""
    overhead = models.make("overhead_crane")
    gantry = models.make("gantry_crane")
    start = np.array(models.default_move(gantry).start)
    gantry = replace(gantry, rails=(replace(gantry.rails[0], end=start[0] + 0.1),))
    for in_c in (False, True):
        stepper = feedforward.Stepper(overhead, (0.0, -4.0), in_c=in_c)
        at_rest = np.zeros((5, 2))
        at_rest[0] = 0.0, -4.0
        assert not stepper.step(at_rest, 0.0).slack
        falling = at_rest.copy()
        falling[2, 1] = -20.0
        with pytest.raises(PathError, match="a place that the rig cannot pass"):
            stepper.step(falling, 0.001)
        assert not stepper.step(at_rest, 0.001).slack
        stepper = feedforward.Stepper(gantry, start, in_c=in_c)
        beyond = np.zeros((stepper.order + 1, 3))
        beyond[0] = np.add(start, (0.2, 0.0, 0.0))
        with pytest.raises(PathError, match="a trolley would leave its rail"):
            stepper.step(beyond, 0.01)


@needs_compiler
def test_a_rope_that_ran_the_other_way_is_refused():
    """As after a step through its winch with all determinants' signs kept, which is rare."""
    rig = models.make("overhead_crane")
    at_rest = np.zeros((5, 2))
    at_rest[0] = 0.0, -4.0
    in_python = feedforward.Stepper(rig, (0.0, -4.0))
    in_c = feedforward.Stepper(rig, (0.0, -4.0), in_c=True)
    for stepper in (in_python, in_c):
        stepper.step(at_rest, 0.0)
    in_python._kernel.spans = [[4.0, 0.0, 4.0]]
    span = in_c._kernel.library.state.span
    assert list(span) == [0.0, -4.0]
    span[1] = 4.0
    for stepper in (in_python, in_c):
        with pytest.raises(PathError, match="has passed through a point or through infinity"):
            stepper.step(at_rest, 0.001)


def test_a_stepper_without_a_compiler_knows_straight_pulleys():
    rig = models.make("navy_crane_2d", pulley_mass=0)
    reference = feedforward.from_move(models.default_move(rig))
    times = np.linspace(0.0, reference.duration, 101)
    motion = feedforward.solve(rig, reference, times)
    steps = walked(feedforward.Stepper(rig, motion.at(0.0)), motion, reference)
    found = np.array([step.inputs for step in steps])
    assert np.abs(found - motion.inputs).max() <= 1e-9 * np.abs(motion.inputs).max()
    with pytest.raises(PathError, match=r"no program at load\.x = 0, load\.z = -15, as where"):
        feedforward.source(rig, "c", reference)


def test_wrong_input_has_one_line(monkeypatch):
    rig = models.make("overhead_crane")
    stepper = feedforward.Stepper(rig, (0.0, -4.0))
    with pytest.raises(
        PathError, match=r"derivatives have shape \(4, 2\), they must have \(5, 2\)"
    ):
        stepper.step(np.zeros((4, 2)), 0.0)
    with pytest.raises(PathError, match="they must be finite"):
        stepper.step(np.full((5, 2), np.nan), 0.0)
    with pytest.raises(PathError, match="h is -1"):
        stepper.step(np.zeros((5, 2)), -1)
    state = feedforward.solve(rig, feedforward.hold((0.0, -4.0)), [0.0]).at(0.0)
    with pytest.raises(RigError, match="state of rig overhead_crane, not of this rotary_crane"):
        feedforward.Stepper(models.make("rotary_crane"), state)
    with pytest.raises(OptionError, match="there is no language 'rust'"):
        feedforward.source(rig, "rust")
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(OptionError, match="there is no C compiler"):
        feedforward.Stepper(rig, (0.0, -4.0), in_c=True)


def test_python_source_stands_alone():
    """The step that it defines gives, from Taylor coefficients, what `solve` does."""
    rig = models.make("overhead_crane")
    space = {}
    exec(feedforward.source(rig, "python"), space)
    taylor = [0.0] * 10
    taylor[1] = -4.0
    motion, carried, spans = space["step"](taylor, [], [-1.0, -1.0, -1.0])
    solved = feedforward.solve(rig, feedforward.hold((0.0, -4.0)), [0.0])
    assert np.allclose(motion[: len(solved.coordinate_names)], solved.positions[0])
    assert carried == ()
    assert spans == ((4.0, 0.0, -4.0),)


@pytest.mark.parametrize(
    ("name", "expected"), [("a crane", "a_crane"), ("3d", "rig_3d"), ("kran-ü", "kran__")]
)
def test_names_are_those_of_c(name, expected):
    assert identifier(name) == expected
