"""The program of docs/how-to/tick_by_tick.md does what the page says."""

import re
from pathlib import Path

import numpy as np
from numpy.testing import assert_allclose

PAGE = Path(__file__).resolve().parents[1] / "docs" / "how-to" / "tick_by_tick.md"


def test_page_drives_a_crane():
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) == 5
    names = {}
    for block in blocks[:3]:
        exec(compile(block, PAGE.name, "exec"), names)
    stream, sample, motion = names["stream"], names["sample"], names["motion"]
    assert stream.resting
    assert_allclose(motion.positions[0], sample.positions, rtol=0, atol=1e-9)
    assert sample.positions[list(sample.coordinate_names).index("load.x")] > 6.0
    for block in blocks[3:]:
        exec(compile(block, PAGE.name, "exec"), names)
    moving, stopping = names["motion"], names["stop"]
    before = moving.at(6.0)
    assert_allclose(names["sample"].derivatives, before.derivatives, rtol=0, atol=1e-12)
    at_once = names["solve"](names["rig"], names["move"], 6.0, begin=names["here"])
    largest = np.abs(at_once.inputs).max()
    assert_allclose(stopping.inputs[0], at_once.inputs[0], rtol=0, atol=1e-12 * largest)
    assert 0.1 < names["best"].duration < 5.0
