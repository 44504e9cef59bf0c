"""What `flatrig bench` times of programs: every road comes to the same, by hand or generated."""

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.feedforward.solving.compiling import compiler
from flatrig.models.errors import PathError
from flatrig.training.bench import program_speed
from flatrig.training.bench.closed_forms_in_c import FORMS, ClosedForm
from flatrig.training.bench.compiled_steps import CompiledSteps

needs_compiler = pytest.mark.skipif(compiler() is None, reason="there is no C compiler")


@pytest.fixture(autouse=True)
def _own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@needs_compiler
@pytest.mark.parametrize("name", FORMS)
def test_closed_forms_and_compiled_steps_are_solve(name):
    rig = models.make(name, load_mass=77.0)
    path = feedforward.from_move(models.default_move(name))
    times = np.linspace(0.0, path.duration, 301)
    solved = feedforward.solve(rig, path, times)
    steps = CompiledSteps(rig, path)
    by_hand = ClosedForm(rig)(steps.derivatives(times))
    assert np.abs(by_hand - solved.inputs).max() <= 1e-13 * np.abs(solved.inputs).max()
    motion = steps.motion(times)
    for group in ("inputs", "tensions", "positions", "velocities", "accelerations"):
        true = getattr(solved, group)
        assert np.abs(getattr(motion, group) - true).max() <= 1e-12 * np.abs(true).max()


@needs_compiler
def test_a_refused_sample_is_named():
    rig = models.make("overhead_crane")
    steps = CompiledSteps(rig, feedforward.from_move(models.default_move(rig)))
    derivatives = steps.derivatives(np.linspace(0.0, 1.0, 5))
    derivatives[3, 2, 1] = -20.0
    with pytest.raises(PathError, match="rig overhead_crane cannot go on at sample 3"):
        steps.results(derivatives, np.full(5, 0.25))


def test_tables_have_a_line_for_each_crane(monkeypatch):
    monkeypatch.setattr(program_speed, "SAMPLES", 33)
    monkeypatch.setattr(program_speed, "IN_A_ROW", 1)
    monkeypatch.setattr(models, "CATALOGUE", ["overhead_crane", "gantry_crane"])
    single, many = program_speed.program_tables(1)
    for lines in (single, many):
        assert list(lines.columns[0].cells) == ["overhead_crane", "gantry_crane"]
        assert all(float(cell) > 0.0 for cell in lines.columns[1].cells)
    if compiler() is not None:
        closed = list(single.columns[8].cells)
        assert float(closed[0]) > 0.0
        assert closed[1] == ""
