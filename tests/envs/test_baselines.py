"""Input shaping and PID: what they promise, by closed forms and in the plant."""

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.envs.crane.input_shaper import Mode, swing_mode, zvd
from flatrig.envs.laws import task_of
from flatrig.models.rig.chain import apart

NAMES = list(envs.ENVIRONMENTS)
OVERHEAD, ROPED, ROTARY = NAMES[:3]
SIDEWAYS = feedforward.rest_to_rest((0, -4), (0.2, -4), 1.0)
HEAVY = envs.Scenario(load_mass=1.15)


def make(name=OVERHEAD, **options):
    return gym.make(name, timestep=4e-3, **options)


def run(env, scenario=None, seed=0):
    """Observations, and the load over an episode, (steps, outputs)."""
    options = None if scenario is None else {"scenario": scenario}
    observations, loads, over = [env.reset(seed=seed, options=options)[0]], [], False
    while not over:
        observation, _, terminated, over, info = env.step(np.zeros(env.action_space.shape))
        assert not terminated
        observations.append(observation)
        loads.append(info["load"])
    return np.array(observations), np.array(loads)


def left(mode, frequency):
    """Amplitude of a linear oscillator after a shaped step over that after the whole step."""
    times, shares = zvd(mode)
    pole = frequency * (-mode.damping + 1j * np.sqrt(1.0 - mode.damping**2))
    return abs(np.sum(shares * np.exp(pole * (times[-1] - times)))) / np.exp(pole.real * times[-1])


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.3])
def test_a_linear_oscillator_does_not_swing_after_it_and_hardly_if_it_is_another(damping):
    mode = Mode(2.0, damping)
    assert zvd(mode)[1].sum() == pytest.approx(1.0)
    assert left(mode, 2.0) < 1e-12
    for aside in (1e-3, -1e-3):
        assert left(mode, 2.0 + aside) < 1e-5  # flat: with the square of the difference
    assert left(Mode(2.0, 0.0), 2.2) < 0.03  # Singer and Seering: 5 % within 14 %


def test_with_stiff_drives_the_mode_is_the_pendulum_at_the_goal():
    task = task_of(make(reference=feedforward.rest_to_rest((0, -5), (1, -2), 3.0)))
    gains = task.gains("set point")
    stiff = 1e5 * np.concatenate((gains.stiffness / task.limits, gains.damping / task.limits))
    mode = swing_mode(task.plant, task.planner.fixed, stiff)
    assert mode.frequency == pytest.approx(np.sqrt(9.81 / 2.0), rel=1e-3)
    assert mode.damping < 1e-4


def test_a_light_trolley_on_its_spring_gives_the_double_pendulums_mode():
    """Trolley at x, load at x + y: m x'' + d x' + k x = M g y / l, M (x'' + y'') = -M g y / l."""
    task = task_of(make(reference=feedforward.rest_to_rest((0, -5), (1, -2), 3.0)))
    stiffness, damping = 900.0, 30.0
    gains = np.array((stiffness, 1e6, damping, 1e6)) / np.tile(task.limits, 2)
    trolley, load, length = 10.0, 100.0, 2.0
    swing = load * 9.81 / length
    masses = np.array([[trolley, 0.0], [load, load]])
    springs = np.array([[stiffness, -swing], [0.0, swing]])
    below = [np.linalg.solve(masses, -part) for part in (springs, np.diag((damping, 0.0)))]
    poles = np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], below]))
    mode = swing_mode(task.plant, task.planner.fixed, gains)
    pole = mode.frequency * complex(-mode.damping, np.sqrt(1.0 - mode.damping**2))
    assert np.abs(poles - pole).min() < 1e-3


def test_a_shaped_set_point_leaves_the_load_at_rest():
    stiff = {"stiffness": (1e4, 1e3), "damping": (1e3, 1e2)}
    aside = feedforward.rest_to_rest((0, -4), (0.02, -4), 1.0)
    swings = []
    for shape in (lambda env: env, envs.Shaper):
        fast = make(reference=aside, hold=7.0, rate=250.0)
        _, loads = run(shape(envs.PD(fast, track="set point", **stiff)))
        swings.append(np.ptp(loads[-1000:, 0]))
    assert swings[0] > 0.02
    assert swings[1] < 0.05 * swings[0]
    assert loads[-1] == pytest.approx((0.02, -4.0), abs=1e-3)


def test_pid_leaves_no_error_at_rest_where_pd_does():
    reference = feedforward.rest_to_rest((0, -4), (1, -3), 2.5)
    errors = []
    for feedback in (envs.PD, lambda env: envs.PID(env, integral_time=1.0)):
        env = envs.Feedforward(feedback(make(reference=reference, hold=12.0)))
        run(env, HEAVY)
        errors.append(abs(task_of(env).encoders.errors[0, 1]))
    assert errors[0] == pytest.approx(0.15 * 9.81 * 100.0 / 110.0 / 8.6**2, rel=0.05)
    assert errors[1] < 0.02 * errors[0]


def test_the_integral_waits_while_a_drive_is_at_its_limit():
    env = envs.PID(make(), integral_time=1.0)
    env.reset(seed=0)
    task = task_of(env)
    task.commands[:] = (0.0, -1.0)
    task.encoders.errors[0, :2] = 0.1
    task.steps[:] = 1
    before = env.law.apply(np.zeros((1, 2)))
    after = env.law.apply(np.zeros((1, 2)))
    change = (after - before)[0] * task.limits
    assert change == pytest.approx((0.02 * 0.1 * 8.6**2 * 10.0, 0.0), abs=1e-3)


@pytest.mark.parametrize(
    "build",
    [
        lambda env: envs.Shaper(envs.PD(env, track="set point")),
        lambda env: envs.MassEstimate(envs.Feedforward(envs.PID(env))),
    ],
)
def test_single_and_vector_agree_to_the_last_bit_and_episodes_start_anew(build):
    options = {"disturbances": "standard", "reference": SIDEWAYS, "hold": 0.2}
    vector = build(gym.make_vec(OVERHEAD, num_envs=2, timestep=4e-3, **options))
    single = build(make(**options))
    alone = [run(single, seed=seed)[0] for seed in (3, 4)]
    assert np.array_equal(run(single, seed=3)[0], alone[0])
    seen = [vector.reset(seed=3)[0]]
    seen += [vector.step(np.zeros((2, 2)))[0] for _ in range(len(alone[0]) - 1)]
    assert np.array_equal(np.array(seen).swapaxes(0, 1), alone)


@pytest.mark.parametrize("name", NAMES)
def test_they_work_on_every_rig(name):
    env = make(name, disturbances="standard")
    stacks = [envs.Feedforward(envs.PID(env))]
    if apart(env.unwrapped.task.rig):
        with pytest.raises(models.OptionError, match="whose ropes are constraints in MuJoCo"):
            envs.Shaper(envs.PD(env, track="set point"))
    else:
        stacks.append(envs.Shaper(envs.PD(env, track="set point")))
    for stack in stacks:
        stack.reset(seed=0)
        for _ in range(3):
            observation, *_ = stack.step(np.zeros(stack.action_space.shape))
        assert np.isfinite(observation).all()


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda env: envs.Shaper(envs.PD(env)), "needs a PD towards the set point"),
        (lambda env: envs.Shaper(env), "needs a PD towards the set point"),
        (lambda env: envs.PID(envs.PD(env)), "PD stands below already"),
        (lambda env: envs.PD(envs.PID(env)), "PID stands below"),
        (lambda env: envs.PID(env, integral_time=0.0), "integral_time is 0.0"),
        (lambda env: envs.PID(env, integral_time="long"), "integral_time is 'long'"),
        (lambda env: envs.PID(gym.make("flatrig/TwoFingerHand-v0")), "is no crane"),
    ],
)
def test_what_cannot_be_gets_one_line(build, message):
    with pytest.raises(models.OptionError, match=message):
        build(make())
