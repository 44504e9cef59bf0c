"""Actions last for several control periods, the same in single and vector environments."""

import copy

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import models

OVERHEAD = "flatrig/OverheadCrane-v0"
SHORT = models.Move(start=(0, -4), goal=(0.2, -4.1), duration=0.9)
SOON = {"reference": SHORT, "hold": 0.02, "disturbances": "standard"}  # 46 periods


def controlled(env):
    return envs.Residual(envs.PID(envs.Feedforward(env)), 0.1)


def test_an_action_is_that_of_every_period_until_the_next():
    slow, fast = (
        envs.ActionRate(controlled(gym.make(OVERHEAD)), 10.0),
        controlled(gym.make(OVERHEAD)),
    )
    assert slow.metadata["render_fps"] == 10
    for env in (slow, fast):
        env.reset(seed=0)
    rng = np.random.default_rng(0)
    for _ in range(4):
        action = rng.uniform(-1, 1, 2)
        seen, reward, *_, info = slow.step(action)
        periods = [fast.step(action) for _ in range(5)]
        assert np.array_equal(seen, periods[-1][0])
        assert reward == pytest.approx(np.mean([period[1] for period in periods]))
        assert np.array_equal(info["load"], periods[-1][4]["load"])
    again = gym.make(slow.spec)
    twin = copy.deepcopy(slow)
    again.reset(options={"state": slow.get_state()})
    expected = slow.step(action)[0]
    assert np.array_equal(again.step(action)[0], expected)
    assert np.array_equal(twin.step(action)[0], expected)


@pytest.mark.parametrize("mode", gym.vector.AutoresetMode)
def test_vectors_are_single_environments_side_by_side(mode):
    vector = gym.make_vec(OVERHEAD, num_envs=3, autoreset_mode=mode, nthread=1, **SOON)
    vector = envs.ActionRate(controlled(vector), 25.0)
    singles = [envs.ActionRate(controlled(gym.make(OVERHEAD, **SOON)), 25.0) for _ in range(3)]
    seen = vector.reset(seed=5)[0]
    alone = [single.reset(seed=5 + sim)[0] for sim, single in enumerate(singles)]
    rng, over, ended = np.random.default_rng(1), np.zeros(3, bool), 0
    for _ in range(30):
        actions = rng.uniform(-1, 1, (3, 2))
        actions[0] *= 9.0  # ends early now and then
        seen, rewards, terminated, truncated, info = vector.step(actions)
        for sim, single in enumerate(singles):
            if over[sim] and mode is gym.vector.AutoresetMode.NEXT_STEP:
                alone[sim] = single.reset()[0]
                assert rewards[sim] == 0.0
                over[sim] = False
                continue
            alone[sim], reward, end, late, told = single.step(actions[sim])
            assert (rewards[sim], terminated[sim], truncated[sim]) == (reward, end, late)
            over[sim] = end or late
            ended += over[sim]
            if over[sim] and mode is gym.vector.AutoresetMode.SAME_STEP:
                assert np.array_equal(info["final_obs"][sim], alone[sim])
                assert info["final_info"]["reason"][sim] == told["reason"]
                alone[sim] = single.reset()[0]
        if over.any() and mode is gym.vector.AutoresetMode.DISABLED:
            seen = vector.reset(options={"reset_mask": over.copy()})[0]
            for sim in np.flatnonzero(over):
                alone[sim] = singles[sim].reset()[0]
        assert np.array_equal(seen, alone)
    assert ended >= 3


def test_wrong_rates_and_controllers_on_top_are_refused_in_one_line():
    env = gym.make(OVERHEAD)
    for rate, message in ((30.0, "it must be 50 Hz, that of control, over"), (0, "rate is 0")):
        with pytest.raises(models.OptionError, match=message):
            envs.ActionRate(env, rate)
    with pytest.raises(models.OptionError, match="PD would act at the rate of ActionRate"):
        envs.PD(envs.ActionRate(env, 10.0))
