"""Options that reinforcement learning asks for: subsets of entries, noise, costs."""

import gymnasium as gym
import numpy as np
import pytest

from flatrig import models

OVERHEAD, PLATE = "flatrig/OverheadCrane-v0", "flatrig/BallOnPlate-v0"


def make(name=OVERHEAD, **options):
    return gym.make(name, **options)


def test_entries_are_those_asked_for_and_what_they_were():
    whole = make(sensors="sway", disturbances="standard")
    some = make(
        sensors="sway", disturbances="standard", entries=["left", "*.tension", "load.?.error"]
    )
    names = some.unwrapped.observation_names
    assert set(names) == {"left", "hoist.tension", "load.x.error", "load.z.error"}
    assert some.observation_space.shape == (4,)
    columns = [whole.unwrapped.observation_names.index(name) for name in names]
    for step in range(3):
        all_of_it, part = (
            one.reset(seed=1)[0] if not step else one.step([0.0, -0.5])[0] for one in (whole, some)
        )
        assert np.array_equal(part, all_of_it[columns])
    vector = gym.make_vec(OVERHEAD, num_envs=2, entries=names[:1])
    assert vector.reset(seed=0)[0].shape == (2, 1)


def test_noise_is_white_repeats_with_its_seed_and_leaves_all_else_alone():
    noisy, clean = make(noise=0.02, disturbances="standard"), make(disturbances="standard")
    vector = gym.make_vec(OVERHEAD, num_envs=2, noise=0.02, disturbances="standard", nthread=1)
    runs = []
    for env in (noisy, noisy, clean):
        run = [env.reset(seed=4)[0]]
        run += [env.step([0.0, -0.5])[0] for _ in range(60)]
        runs.append(np.array(run))
    assert np.array_equal(runs[0], runs[1])
    added = runs[0] - runs[2]
    assert 0.018 < added.std() < 0.022
    assert np.abs(np.corrcoef(added[1:].ravel(), added[:-1].ravel())[0, 1]) < 0.1
    assert noisy.unwrapped.task.scenarios == clean.unwrapped.task.scenarios
    seen = [vector.reset(seed=3)[0]]
    seen += [vector.step(np.tile([0.0, -0.5], (2, 1)))[0] for _ in range(60)]
    assert np.array_equal(np.array(seen)[:, 1], runs[0])
    assert np.array_equal(noisy.unwrapped.task.observation(), noisy.unwrapped.task.observation())


def test_noise_goes_on_from_a_state():
    env, other = make(noise=0.02), make(noise=0.02)
    env.reset(seed=0)
    env.step([0.0, -0.5])
    state = env.unwrapped.get_state()
    assert np.array_equal(
        other.reset(options={"state": state})[0], env.unwrapped.task.observation()[0]
    )
    assert np.array_equal(env.step([0.0, -0.5])[0], other.step([0.0, -0.5])[0])


def test_costs_rise_to_one_where_episodes_end():
    env = make(cost=True, hold=1e3)
    assert env.reset(seed=0)[1]["cost"] == 0.0
    rest = env.unwrapped.task.plant.home_inputs / env.unwrapped.task.limits
    assert env.step(rest)[4]["cost"] == 0.0
    assert env.step([0.95, rest[1]])[4]["cost"] == pytest.approx(0.5)  # of the last tenth
    env.reset(seed=0)
    costs, over = [], False
    while not over:  # down the rope, with half of the load's weight taken off it, then all
        *_, over, _, info = env.step([0.0, 0.87 * rest[1] * (1.0 - 0.02 * len(costs))])
        costs.append(info["cost"])
        assert info["tension"][0] > 0.25 * 981 or info["cost"] > 0
    assert costs[-1] == 1.0
    env.reset(seed=0)
    over, costs = False, []
    while not over:
        *_, over, _, info = env.step([-0.1, rest[1]])
        costs.append(info["cost"])
    assert env.unwrapped.reasons[info["reason"]] == "off the rail"
    assert costs[0] == 0.0 < costs[-2] < costs[-1] == 1.0
    hand = make(PLATE, cost=True)
    assert hand.reset(seed=0)[1]["cost"] == 0.0
    assert hand.step(np.ones(hand.action_space.shape))[4]["cost"] == 1.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"entries": ["trolly.error"]},
            "no entry matches 'trolly.error'; did you mean trolley.error",
        ),
        ({"entries": "left"}, "entries is 'left', it must be names of entries"),
        ({"entries": [3]}, r"entries is \[3\]"),
        ({"noise": -1.0}, "noise is -1"),
        ({"cost": 3}, "cost is 3, it must be True or False"),
        ({"costs": True}, "did you mean cost"),
    ],
)
def test_wrong_options_get_one_line(options, message):
    for build in (make, lambda **own: gym.make_vec(OVERHEAD, num_envs=2, **own)):
        with pytest.raises(models.OptionError, match=message) as caught:
            build(**options)
        assert "\n" not in str(caught.value)


def test_states_of_other_entries_are_refused():
    env = make(entries=["left"])
    env.reset(seed=0)
    other = make()
    other.reset(seed=0)
    with pytest.raises(models.OptionError, match="of entries"):
        other.unwrapped.set_state(env.unwrapped.get_state())
