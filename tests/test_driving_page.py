"""The program of docs/how-to/tick_by_tick.md does what the page says."""

import numpy as np
import pages
from numpy.testing import assert_allclose

PAGE = "docs/how-to/tick_by_tick.md"


def test_page_drives_a_crane():
    blocks = [block for _, block in pages.blocks(PAGE, "python")]
    assert len(blocks) == 5
    names = {"missing": []}
    for block in blocks[:3]:
        pages.execute(PAGE, block, names)
    stream, sample, motion = names["stream"], names["sample"], names["motion"]
    assert stream.resting
    assert_allclose(motion.positions[0], sample.positions, rtol=0, atol=1e-9)
    assert sample.positions[list(sample.coordinate_names).index("load.x")] > 6.0
    for block in blocks[3:]:
        pages.execute(PAGE, block, names)
    moving, stopping = names["motion"], names["stop"]
    before = moving.at(6.0)
    assert_allclose(names["sample"].derivatives, before.derivatives, rtol=0, atol=1e-12)
    at_once = names["solve"](names["rig"], names["move"], 6.0, begin=names["here"])
    largest = np.abs(at_once.inputs).max()
    assert_allclose(stopping.inputs[0], at_once.inputs[0], rtol=0, atol=1e-12 * largest)
    assert 0.1 < names["best"].duration < 5.0
