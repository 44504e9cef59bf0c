"""Descriptions that are nearly right: the refusal says what to write, and that runs."""

from dataclasses import replace

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.models import (
    Anchor,
    Drive,
    Frame,
    Link,
    Load,
    PathError,
    Rail,
    Rig,
    RigError,
    Rope,
    Trolley,
)


def boom_crane(parent, angle, load):
    """A boom on a slewing tower, luffed by a torque."""
    return Rig(
        name="boom_crane",
        frames=(
            Frame("slew", "turning", 1e5),
            Frame("boom", "turning", 2e5, (0.0, -1.0, 0.0), parent=parent),
        ),
        anchors=(Anchor("tip", (20.0, 0.0, 0.0), "boom"),),
        masses=(Load("load", 5000.0),),
        ropes=(Rope("hoist", ("tip", "load"), 0.3, 10.0),),
        drives=tuple(Drive(name, name, 1e6) for name in ("slew", "boom", "hoist")),
        outputs=("load.x", "load.y", "load.z"),
        home={"boom": angle, "load": load},
    )


def test_a_boom_that_stands_in_the_world_and_a_home_that_is_not_at_rest():
    start = (20.0 * np.cos(0.8), 0.0, 4.0)
    path = feedforward.rest_to_rest(start, (10.0, 6.0, 6.0), duration=15.0)
    with pytest.raises(RigError, match='such as parent = "slew" in frame boom'):
        feedforward.solve(boom_crane("world", 0.8, start), path, 0.0)
    with pytest.raises(PathError, match=r"its home is not at rest, where nothing balances .* N"):
        feedforward.solve(boom_crane("slew", 0.0, (14.0, 0.0, 4.0)), path, 0.0)
    motion = feedforward.solve(boom_crane("slew", 0.8, start), path, [0.0, 7.5, 15.0])
    assert motion.inputs[0, 1] == pytest.approx(5000.0 * 9.81 * start[0])


def test_a_rope_without_a_drive_that_is_a_sling():
    sling = Rope("sling", ("hook", "load"), 1.0, 1.0)
    hoist = Rope("hoist", ("trolley", "hook"), 0.2, 5.0)
    crane = Rig(
        name="crane",
        dimensions=2,
        rails=(Rail("beam", (1.0, 0.0, 0.0)),),
        masses=(Trolley("trolley", 500.0, "beam"), Load("hook", 200.0), Load("load", 2000.0)),
        ropes=(hoist, sling),
        drives=(Drive("trolley", "trolley", 8e3), Drive("hoist", "hoist", 8e3)),
        outputs=("load.x", "load.z"),
        home={"hook": (0.0, 0.0, -8.0), "load": (0.0, 0.0, -11.0)},
    )
    move = models.Move((0.0, -11.0), (10.0, -9.0), 12.0, order=6)
    path = feedforward.from_move(move)
    with pytest.raises(RigError, match=r"it is a link with ends = \['hook', 'load'\]"):
        feedforward.solve(crane, path, 0.0)
    link = Link("sling", ("hook", "load"))
    assert feedforward.check(replace(crane, ropes=(hoist,), links=(link,)), path).feasible
