"""A saved episode goes on with the same bits: back, elsewhere, in a vector, copied and pickled."""

import copy
import pickle

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.training.learned import LearnedResidual

CRANES, HANDS = list(envs.ENVIRONMENTS), list(envs.HAND_ENVIRONMENTS)
OVERHEAD, ROTARY = "flatrig/OverheadCrane-v0", "flatrig/RotaryCrane-v0"
ROUGH = envs.Scenario(
    load_mass=1.2, winch_friction=20.0, trolley_friction=10.0, wind=15.0, gust=10.0,
    gust_frequency=0.3, delay=2, winch_viscous=5.0, static_friction=1.6, encoder_resolution=1e-4,
)  # fmt: skip
SHORT = models.Move(start=(0, -4), goal=(0.3, -4.1), duration=1.2)


def controlled(env):
    return envs.Feedforward(envs.PD(env))


def stretch(env, actions, rows=slice(None)):
    """All that an environment says to actions, one number after the other."""
    said = []
    for action in actions:
        seen, reward, terminated, truncated, info = env.step(action)
        info = [info[name] for name in sorted(info) if not name.startswith("_")]
        for value in (seen, reward, terminated, truncated, *info):
            said.append(np.atleast_1d(value)[rows].astype(float).ravel())
    return np.concatenate(said)


def noise(env, steps, scale=0.02, seed=3):
    shape = (steps, *env.unwrapped.single_action_space.shape) if hasattr(
        env.unwrapped, "num_envs"
    ) else (steps, *env.action_space.shape)  # fmt: skip
    return scale * np.random.default_rng(seed).normal(size=shape)


def goes_on(env, other, before=7, after=6):
    """Save after some steps, and go on: there, back again, and elsewhere from what was pickled."""
    actions = noise(env, before + after)
    for action in actions[:before]:
        env.step(action)
    state = env.get_state()
    expected = stretch(env, actions[before:])
    env.set_state(state)
    assert np.array_equal(stretch(env, actions[before:]), expected)
    seen, _ = env.reset(options={"state": state})
    there, _ = other.reset(options={"state": pickle.loads(pickle.dumps(state))})
    assert np.array_equal(there, seen)
    assert np.array_equal(stretch(other, actions[before:]), expected)
    return state, actions[before:], expected


@pytest.mark.parametrize("name", [*CRANES, *HANDS])
def test_a_branch_of_every_environment_goes_on_with_the_same_bits(name):
    options = {"disturbances": "standard", "sensors": "full"}
    env, other = (controlled(gym.make(name, **options)) for _ in range(2))
    env.reset(seed=1)
    state, actions, expected = goes_on(env, other)
    vector = controlled(gym.make_vec(name, num_envs=2, nthread=1, **options))
    vector.reset(seed=0)
    vector.step(np.zeros((2, *env.action_space.shape)))
    vector.set_state([state], np.array([1], dtype=np.int32))
    both = [np.stack((0 * action, action)) for action in actions]
    assert np.array_equal(stretch(vector, both, slice(1, 2)), expected)


@pytest.mark.parametrize("sensors", ["encoders", "sway"])
def test_friction_delays_and_sensors_go_on(sensors):
    options = {"disturbances": {"winch_friction": (0, 9)}, "sensors": sensors}
    env, other = (controlled(gym.make(OVERHEAD, **options)) for _ in range(2))
    env.reset(seed=1, options={"scenario": ROUGH})
    goes_on(env, other, 20, 20)


CONTROLLERS = {
    "PID": lambda env: envs.Feedforward(envs.PID(env)),
    "MassEstimate": lambda env: envs.MassEstimate(controlled(env)),
    "FrictionCompensation": lambda env: envs.FrictionCompensation(controlled(env)),
    "SwingDamping": lambda env: envs.SwingDamping(controlled(env)),
    "LQR": lambda env: envs.LQR(controlled(envs.TautGuard(env))),
    "Observer": lambda env: envs.Observer(controlled(env)),
    "Shaper": lambda env: envs.Shaper(envs.PD(env, track="set point")),
    "LearnedResidual": lambda env: LearnedResidual(envs.MassEstimate(controlled(env))),
}


@pytest.mark.parametrize("name", CONTROLLERS)
def test_what_controllers_remember_goes_on(name):
    options = {"disturbances": "standard", "sensors": "sway"}
    if name != "LearnedResidual":  # which was trained on other moves
        options |= {"reference": SHORT, "hold": 0.1}
    env, other = (CONTROLLERS[name](gym.make(OVERHEAD, **options)) for _ in range(2))
    env.reset(seed=1)
    state, actions, expected = goes_on(env, other, 12, 8)
    other.reset(seed=9)
    twin = copy.deepcopy(env)
    twin.set_state(state)
    assert np.array_equal(stretch(twin, actions), expected)


def test_a_hand_with_its_pose_feedback_goes_on():
    options = {"disturbances": "standard", "sensors": "full"}
    make = lambda: envs.PoseFeedback(controlled(gym.make("flatrig/TwoFingerHand-v0", **options)))  # noqa: E731
    env, other = make(), make()
    env.reset(seed=1)
    goes_on(env, other)


def test_what_is_redirected_led_and_disturbed_goes_on():
    env, other = (controlled(gym.make(ROTARY, disturbances="standard")) for _ in range(2))
    env.reset(seed=2)
    for action in noise(env, 10):
        env.step(action)
    env.unwrapped.redirect(lambda state: feedforward.connected(state.derivatives, (4, 1, -4), 6.0))
    env.unwrapped.task.disturb([envs.Scenario(load_mass=0.9, wind=5.0)])
    goes_on(env, other)
    for _ in range(3):
        env.unwrapped.lead([0.2, 0.1, -0.1])
        env.step(np.zeros(3))
    _, actions, expected = goes_on(env, other)  # led no more: it stops
    assert np.array_equal(stretch(copy.deepcopy(env), actions), stretch(env, actions))
    assert expected.size


def test_an_operator_can_be_branched():
    env, other = (gym.make(OVERHEAD, reference="operator") for _ in range(2))
    env.reset(seed=0)
    goes_on(env, other)


def test_later_episodes_are_drawn_as_they_would_have_been():
    options = {"disturbances": "standard", "reference": "random"}
    env, other = (gym.make(OVERHEAD, **options) for _ in range(2))
    env.reset(seed=5)
    env.step([0.0, -0.5])
    state = env.get_state()
    following = env.reset()[0], env.unwrapped.task.scenarios[0]
    other.reset(options={"state": state})
    assert np.array_equal(other.reset()[0], following[0])
    assert other.unwrapped.task.scenarios[0] == following[1]
    other.reset(seed=8, options={"state": state})
    fresh = gym.make(OVERHEAD, **options)
    fresh.unwrapped.np_random = np.random.default_rng(8)
    assert np.array_equal(other.reset()[0], fresh.reset()[0])


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_environments_can_be_copied(copied):
    env = gym.make(ROTARY, disturbances="standard", sensors="sway")
    env = gym.wrappers.TimeLimit(envs.MassEstimate(controlled(env)), 500)
    unbegun = copied(env)
    env.reset(seed=3)
    unbegun.reset(seed=3)
    actions = noise(env, 12)
    assert np.array_equal(stretch(env, actions), stretch(unbegun, actions))
    again = copied(env)
    assert again.spec == env.spec
    assert np.array_equal(stretch(env, actions), stretch(again, actions))
    assert np.array_equal(env.reset()[0], again.reset()[0])


@pytest.mark.parametrize("mode", gym.vector.AutoresetMode)
def test_vectors_go_on_in_every_mode(mode):
    options = {"disturbances": "standard", "num_envs": 3, "autoreset_mode": mode, "nthread": 1}
    vector = controlled(gym.make_vec(OVERHEAD, **options))
    vector.reset(seed=0)
    pushed = np.zeros((3, 2))
    pushed[1, 1] = 2.0  # pays out the rope, which ends the episode
    while not vector.step(pushed)[2][1]:
        pass
    states, twin = vector.get_state(), copy.deepcopy(vector)
    if mode is gym.vector.AutoresetMode.DISABLED:
        with pytest.raises(models.OptionError, match="are over"):
            twin.step(0 * pushed)
        mask = {"reset_mask": np.array([False, True, False])}
        assert np.array_equal(vector.reset(options=mask)[0], twin.reset(options=mask)[0])
    assert np.array_equal(stretch(vector, [0 * pushed] * 6), stretch(twin, [0 * pushed] * 6))
    other = controlled(gym.make_vec(OVERHEAD, **options))
    first, _ = other.reset(options={"states": [states[2], None, states[0]]}, seed=[None, 4, None])
    alone, _ = controlled(gym.make(OVERHEAD, disturbances="standard")).reset(seed=4)
    assert np.array_equal(first[1], alone)
    vector.set_state(states)
    assert np.array_equal(vector.unwrapped.task.observation()[[2, 0]], first[[0, 2]])


def test_model_and_data_can_be_read():
    env = gym.make(OVERHEAD, disturbances="standard")
    env.reset(seed=0, options={"scenario": envs.Scenario(load_mass=1.25)})
    env.step([0.1, -0.5])
    env = env.unwrapped
    assert env.model.body("load").mass == 1.25 * models.overhead_crane().loads[0].mass
    assert np.array_equal(env.data.qpos, env.task.plant.qpos[0])
    assert env.data.time == pytest.approx(0.02)
    env.data.qpos[:] = 7.0
    assert not (env.task.plant.qpos == 7.0).any()
    vector = gym.make_vec(OVERHEAD, num_envs=2)
    vector.reset(seed=0)
    assert np.array_equal(vector.unwrapped.data_of(1).qpos, vector.unwrapped.task.plant.qpos[1])


def saved(name=OVERHEAD, wrap=lambda env: env, **options):
    env = wrap(gym.make(name, **options))
    env.reset(seed=0)
    return env.get_state() if hasattr(env, "get_state") else env.unwrapped.get_state()


@pytest.mark.parametrize(
    ("state", "message"),
    [
        (lambda: saved(ROTARY), "of rig rotary_crane, this environment has overhead_crane"),
        (lambda: saved(rig=models.overhead_crane(load_mass=90.0)), "another overhead_crane, with"),
        (lambda: saved(rate=100.0), r"of rate 100.0, this environment has 50.0"),
        (lambda: saved(timestep=4e-3), "of timestep 0.004, this"),
        (lambda: saved(sensors="sway"), "of sensors 'sway', this environment has 'encoders'"),
        (lambda: saved(disturbances="standard"), "friction"),
        (lambda: saved(reference="operator"), "of task 'OperatedTask', this"),
        (lambda: saved("flatrig/BallOnPlate-v0"), "of rig None"),
        (lambda: 3, "state is 3, it must be one that get_state gave"),
    ],
)  # fmt: skip
def test_states_of_others_are_refused_in_one_line_and_change_nothing(state, message):
    env, other = gym.make(OVERHEAD), gym.make(OVERHEAD)
    for one in (env, other):
        one.reset(seed=0)
    foreign = state()
    for attempt in (
        lambda: env.unwrapped.set_state(foreign),
        lambda: env.reset(seed=4, options={"state": foreign}),
    ):
        with pytest.raises(models.OptionError, match=message) as caught:
            attempt()
        assert "\n" not in str(caught.value)
    assert np.array_equal(env.step([0.1, -0.5])[0], other.step([0.1, -0.5])[0])
    assert env.unwrapped.np_random.random() == other.unwrapped.np_random.random()


def test_a_state_must_know_the_controllers_and_stand_alone():
    env = envs.PID(gym.make(OVERHEAD))
    with pytest.raises(models.OptionError, match="no episode has begun"):
        env.get_state()
    env.reset(seed=0)
    for other in (saved(), saved(wrap=envs.PD)):
        for attempt in (env.set_state, lambda state: env.reset(options={"state": state})):
            with pytest.raises(models.OptionError, match="no memory of PID as controller 1"):
                attempt(other)
    state = saved(wrap=envs.PID)
    env.set_state(state)
    with pytest.raises(models.OptionError, match="its own scenario; give one of them"):
        env.reset(options={"state": state, "scenario": envs.Scenario()})
    vector = gym.make_vec(OVERHEAD, num_envs=2)
    vector.reset(seed=0)
    with pytest.raises(models.OptionError, match="state has 1 entries for 2 cranes"):
        vector.unwrapped.set_state([state])


@pytest.mark.parametrize("wrap", [lambda vector: vector, controlled])
def test_states_of_some_simulations_and_wrong_ones(wrap):
    vector = wrap(gym.make_vec(OVERHEAD, num_envs=3, nthread=1))
    vector.reset(seed=0)
    vector.step(np.tile(noise(vector, 1), (3, 1)))
    two = vector.get_state([0, 2])
    vector.set_state(two[::-1], [1, 2])
    third, fourth = (vector.get_state([sim])[0] for sim in (1, 2))
    np.testing.assert_array_equal(third.physics, two[1].physics)
    np.testing.assert_array_equal(fourth.physics, two[0].physics)
    for wrong in ([3], [-1], [0, 0], 0, "ab", [0.5], [[0]], [[0], [1, 2]]):
        with pytest.raises(models.OptionError, match="it must be different numbers of"):
            vector.get_state(wrong)
    for wrong in (3, two[0], None):
        with pytest.raises(models.OptionError, match="it must be a list of what get_state gave"):
            vector.set_state(wrong)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"vectorization_mode": "sinc"}, "there is no such mode; did you mean sync or async?"),
        ({"wrappers": envs.PD}, "it must be a list of functions, such as [PD]"),
        ({"wrappers": [3]}, "wrappers is [3], it must be a list of functions"),
        ({"num_envs": 0, "vectorization_mode": "sync"}, "num_envs is 0, it must be a whole number"),
    ],
)
def test_wrong_vectors_get_one_line(options, message):
    with pytest.raises(models.OptionError) as caught:
        envs.make_vec(OVERHEAD, **options)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
