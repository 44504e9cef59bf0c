"""What exact inputs leave in MuJoCo, open loop, is what holding them for a step leaves.

The middle of a step's inputs, held for all of it, is off by u' h / 2 at its ends: an error of
second order, so that the distance from the goal falls to a quarter with half the step, and not with
a finer integration of the same inputs.
"""

from dataclasses import replace

import numpy as np
import pytest

from flatrig.feedforward import rest_to_rest
from flatrig.models import Anchor, Drive, Frame, Load, Platform, Rail, Rig, Rope, Trolley
from flatrig.models.mjcf import rig_model
from flatrig.training.simulate.open_loop import prepare

STEP = 1e-3


def boom(*, knuckle):
    """A boom of 30 m that two torques slew and raise, or one of 18 m with a jib of 12 m."""
    frames = [
        Frame("tower", "turning", (4e5, 5e5, 6e5), mass=4e4, centre=(-1.5, 0.2, 10.0)),
        Frame("boom", "turning", (1e3, 9e5, 9e5), (0.0, -1.0, 0.0), (2.0, 0.0, 20.0), "tower", 8e3,
              (15.0, 0.0, 0.5)),
        Frame("jib", "turning", (500.0, 8e4, 8e4), (0.0, -1.0, 0.0), (18.0, 0.0, 0.0), "boom", 3e3,
              (6.0, 0.0, 0.2)),
    ][: 3 if knuckle else 2]  # fmt: skip
    last, reach = (frames[-1].name, 12.0) if knuckle else ("boom", 30.0)
    bent = [18.0 * np.exp(0.6j) + 12.0 * np.exp(-0.3j), 30.0 * np.exp(0.6j)][not knuckle]
    out = 2.0 + bent.real
    start = (out * np.cos(0.2), out * np.sin(0.2), 5.0 + bent.imag)
    rig = Rig(
        name="knuckle" if knuckle else "boom",
        frames=tuple(frames),
        anchors=(Anchor("tip", (reach, 0.0, 0.0), last),),
        masses=(Load("load", 5e3),),
        ropes=(Rope("hoist", ("tip", "load"), 0.3, 36.0),),
        drives=tuple(Drive(name, name, 1e9) for name in (*(f.name for f in frames), "hoist")),
        outputs=("load.x", "load.y", "load.z", *(["jib.angle"] if knuckle else [])),
        home={"tower": 0.2, "boom": 0.6, "load": start, **({"jib": -0.9} if knuckle else {})},
    )
    goal = 20.0 * np.cos(1.4), 20.0 * np.sin(1.4), 12.0
    angles = ([-0.9], [-0.6]) if knuckle else ([], [])
    return rig, rest_to_rest((*start, *angles[0]), (*goal, *angles[1]), 8.0)


def beam():
    """A beam of thirty tons in a plane, on two ropes from two trolleys."""
    rig = Rig(
        name="beam",
        dimensions=2,
        rails=(Rail("rail", (1.0, 0.0, 0.0)),),
        anchors=tuple(Anchor(f"eye_{k}", (x, 0.0, 1.2), "beam") for k, x in ((1, -1.5), (2, 1.5))),
        masses=(
            *(Trolley(f"t{k}", 2e3, "rail") for k in (1, 2)),
            Platform("beam", 3e4, (1e5,) * 3),
        ),
        ropes=tuple(Rope(f"r{k}", (f"t{k}", f"eye_{k}"), 1.0, 500.0) for k in (1, 2)),
        drives=tuple(Drive(name, name, 1e9) for name in ("t1", "t2", "r1", "r2")),
        outputs=("beam.x", "beam.z", "beam.beta", "t1.position"),
        home={"t1": -2.0, "t2": 2.0, "beam": (0.0, 0.0, -10.0)},
    )
    return rig, rest_to_rest((0.0, -10.0, 0.0, -2.0), (12.0, -8.0, 0.05, 10.0), 20.0)


@pytest.mark.parametrize(
    ("scene", "distance"),
    [
        pytest.param(lambda: boom(knuckle=False), 5.80e-5, id="boom"),
        pytest.param(lambda: boom(knuckle=True), 1.28e-4, id="knuckle"),
        pytest.param(beam, 6.9e-9, id="beam"),
    ],
)
def test_the_distance_from_the_goal_is_of_holding_inputs_and_not_of_integration(scene, distance):
    rig, path = scene()
    prepared, halved = prepare(rig, path, STEP), prepare(rig, path, STEP / 2)
    coarse, fine = (
        rig_model.compile(rig, timestep=step, visuals=False) for step in (STEP, STEP / 2)
    )
    found = prepared.run(coarse).distance[-1]
    assert found == pytest.approx(distance, rel=0.01)
    assert halved.run(fine).distance[-1] == pytest.approx(found / 4.0, rel=0.01)
    # The same inputs, each held for two steps that are half as long.
    held = replace(halved, inputs=np.repeat(prepared.inputs, 2, axis=0))
    assert held.run(fine).distance[-1] == pytest.approx(found, rel=0.01)
