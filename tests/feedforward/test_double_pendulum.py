"""A payload on a sling below a hook: tensions, places and inputs by hand, from the top of its path.

The payload's acceleration says which way the sling points and how hard it pulls, and so where the
hook is; the hook's acceleration says the same of the rope, and so where the trolley is; what the
trolley and the rope do then says what the drives give.  Six derivatives of the path are used.
"""

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.testing import assert_allclose

from flatrig import feedforward, models

HALF = np.array([8 / 5, -1 / 5, 8 / 315, -1 / 560])
STENCIL = np.array([*HALF[::-1], -205 / 72, *HALF])
"""Second derivative by central differences of order 8."""
STEP = 0.05
GRAVITY = np.array([0.0, 9.81])
TROLLEY, HOOK, PAYLOAD, SLING, RADIUS, INERTIA = 500.0, 200.0, 2000.0, 3.0, 0.2, 5.0
BEGIN, END, DURATION = np.array([0.0, -11.0]), np.array([10.0, -9.0]), 12.0


def crane():
    return models.Rig(
        name="double_pendulum",
        dimensions=2,
        rails=(models.Rail("beam", (1.0, 0.0, 0.0)),),
        masses=(
            models.Trolley("trolley", TROLLEY, "beam"),
            models.Load("hook", HOOK),
            models.Load("payload", PAYLOAD),
        ),
        ropes=(models.Rope("hoist", ("trolley", "hook"), RADIUS, INERTIA),),
        links=(models.Link("sling", ("payload", "hook"), SLING),),
        drives=(models.Drive("trolley", "trolley", 1e4), models.Drive("winch", "hoist", 1e4)),
        outputs=("payload.x", "payload.z"),
        home={"hook": (0, 0, -8.0), "payload": (0, 0, -11.0)},
    )


def second(motion, times):
    spread = STEP * np.arange(-4, 5)
    values = np.array([motion(times + shift) for shift in spread])
    return np.tensordot(STENCIL, values, 1) / STEP**2


def share(times, order=0):
    """The polynomial of degree 13 that rests at both ends with six derivatives."""
    u = Polynomial([0.0, 1.0])  # from -1 to 1, about whose middle little is lost in rounding
    rise = ((1.0 - u**2) ** 6).integ()
    way = (0.5 + 0.5 * rise / rise(1.0)).deriv(order) * (2.0 / DURATION) ** order
    return way(2.0 * times / DURATION - 1.0)


def payload(times):
    return BEGIN + np.multiply.outer(share(times), END - BEGIN)


def sling_pull(times):
    return PAYLOAD * (np.multiply.outer(share(times, 2), END - BEGIN) + GRAVITY)


def hook(times):
    pull = sling_pull(times)
    return payload(times) + SLING * pull / np.linalg.norm(pull, axis=-1, keepdims=True)


def rope_pull(times):
    return sling_pull(times) + HOOK * (second(hook, times) + GRAVITY)


def trolley(times):
    pull, (x, z) = rope_pull(times), np.moveaxis(hook(times), -1, 0)
    return x - z * pull[..., 0] / pull[..., 1]


def rope(times):
    x, z = np.moveaxis(hook(times), -1, 0)
    return np.hypot(trolley(times) - x, z)


def test_everything_follows_from_the_path_by_hand():
    rig = crane()
    assert feedforward.analyse(rig).reference_order == 6
    path = feedforward.rest_to_rest(BEGIN, END, DURATION, order=6)
    times = np.linspace(0.5, 11.5, 45)
    motion = feedforward.solve(rig, path, times)
    assert_allclose(path(times), payload(times), atol=1e-12)
    places = motion.positions[:, [motion.column("hook.x"), motion.column("hook.z")]]
    assert_allclose(places, hook(times), atol=1e-11)
    assert_allclose(motion.tensions[:, 1], np.linalg.norm(sling_pull(times), axis=1), rtol=1e-12)
    assert_allclose(motion.tensions[:, 0], np.linalg.norm(rope_pull(times), axis=1), rtol=1e-9)
    assert_allclose(
        motion.positions[:, motion.column("trolley.position")], trolley(times), atol=1e-11
    )
    force = TROLLEY * second(trolley, times) + rope_pull(times)[:, 0]
    winch = INERTIA / RADIUS * second(rope, times) - RADIUS * motion.tensions[:, 0]
    assert_allclose(motion.inputs, np.stack((force, winch), axis=1), atol=2e-6)


def test_programs_in_c_say_the_same(tmp_path):
    path = feedforward.rest_to_rest(BEGIN, END, DURATION, order=6)
    motion = feedforward.solve(crane(), path, 0.25 * np.arange(49))
    stepper = feedforward.Stepper(crane(), path.start, in_c=True)
    for i, time in enumerate(motion.times):
        step = stepper.step(path.derivatives([time], 6)[:, 0], 0.25)
        assert_allclose(step.inputs, motion.inputs[i], rtol=1e-10, atol=1e-7)
        assert_allclose(step.tensions, motion.tensions[i], rtol=1e-11)


def test_time_stepping_comes_to_the_same_and_says_where_it_cannot():
    path = feedforward.rest_to_rest(BEGIN, END, DURATION, order=8)
    run = feedforward.integrate(
        crane(), path, step=0.1, formulation="minimal extension, three times"
    )
    exact = feedforward.solve(crane(), path, run.motion.times)
    assert_allclose(run.motion.inputs, exact.inputs, rtol=1e-9, atol=1e-6)
    with pytest.raises(models.RigError, match="no minimal coordinates: of no coordinate"):
        feedforward.integrate(crane(), path, step=0.1, formulation="projection, minimal")
