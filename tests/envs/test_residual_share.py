"""How much of the limits a residual may take by default follows from the rig and its plan."""

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig.envs.controllers import USUAL
from flatrig.envs.crane.residual_share import taut_share

TENDER = ["flatrig/NavyCrane3D-v0", "flatrig/CableRobot-v0", "flatrig/BallInCorner-v0"]
OVERHEAD, ROTARY = "flatrig/OverheadCrane-v0", "flatrig/RotaryCrane-v0"


def controlled(name, fraction=None, **options):
    vector = gym.make_vec(name, num_envs=4, disturbances="standard", nthread=1, **options)
    return envs.Residual(envs.Feedforward(envs.PD(vector)), fraction)


def ended_after(vector, steps):
    """The step in which the first episode ends early under random actions, None if none does."""
    rng = np.random.default_rng(1)
    vector.reset(seed=1)
    for step in range(steps):
        if vector.step(rng.uniform(-1, 1, vector.action_space.shape))[2].any():
            return step
    return None


@pytest.mark.parametrize("name", TENDER)
def test_random_actions_hold_where_the_usual_fraction_ends_episodes(name):
    vector = controlled(name)
    fraction = vector.spec.additional_wrappers[-1].kwargs["fraction"]
    assert 1e-3 < fraction < USUAL / 5
    assert ended_after(controlled(name, USUAL), 60) is not None
    assert ended_after(vector, 100) is None


def test_the_usual_fraction_stays_where_ropes_bear_it():
    vector = controlled(ROTARY)
    assert vector.spec.additional_wrappers[-1].kwargs["fraction"] == USUAL
    own = controlled(envs.OWN, rig="rotary_crane", reference="random")
    assert own.spec.additional_wrappers[-1].kwargs["fraction"] == USUAL


def test_the_share_is_a_part_of_what_makes_a_rope_slack_at_once():
    """At rest a winch of inertia J holds a load m: its torque u takes m / (m + J / r^2) u / r off
    the rope, and what the trolley does at once below it nothing.
    """
    task = gym.make(OVERHEAD).unwrapped.task
    load, rope = task.rig.loads[0].mass, task.rig.ropes[0]
    pulled = task.limits[1] / rope.drum_radius * load / (load + rope.inertia_along)
    expected = 0.4 * load * task.rig.gravity / pulled
    assert taut_share(task.plant, None, task.limits) == pytest.approx(expected, rel=1e-6)
