"""Controllers as wrappers: what each adds, and that they add up."""

from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.envs.laws import task_of
from flatrig.feedforward import hold
from flatrig.models.friction import Friction

NAMES = list(envs.ENVIRONMENTS)
OVERHEAD, ROPED, ROTARY, CANTILEVER, GANTRY, NAVY2, NAVY3, CABLEV = NAMES[:8]
SPREAD = models.default_move("cable_manipulator").start[-1]
GENTLE = {
    OVERHEAD: feedforward.rest_to_rest((0, -4), (1, -3), 2.5),
    ROPED: feedforward.rest_to_rest((0, -4), (1, -3), 2.5),
    ROTARY: feedforward.rest_to_rest((5, 0, -5), (4, 1, -4), 4.0),
    CANTILEVER: feedforward.rest_to_rest((5, 0, -5), (4, 1, -4), 4.0),
    GANTRY: feedforward.rest_to_rest((5, 0, -5), (4, 1, -4), 4.0),
    NAVY2: feedforward.rest_to_rest((-4.4, -22.5, -12.5), (-5, -21.5, -12), 3.0),
    NAVY3: feedforward.rest_to_rest((8.7, 0, -15, 2.5), (8.2, 0.5, -14.5, 2.5), 6.0, order=6),
    CABLEV: feedforward.rest_to_rest(
        (1.35, 1.2, -3, 0, 0, 0, SPREAD), (1.6, 1.4, -2.7, 0.1, -0.05, 0.2, SPREAD), 4.0
    ),
    "flatrig/LuffingCrane-v0": feedforward.rest_to_rest((30, 0, 8), (29.8, 0.2, 8.2), 8.0),
    "flatrig/KnuckleCrane-v0": feedforward.rest_to_rest((31, 0, 2, -1.2), (30, 1, 3, -1.1), 5.0),
    "flatrig/DoublePendulumCrane-v0": feedforward.rest_to_rest(
        (3, 2, -7), (4, 2.5, -6.5), 5.0, order=6
    ),
    "flatrig/CableRobot-v0": feedforward.rest_to_rest(
        (0, 0, 1.5, 0, 0, 0), (1, 0.5, 2, 0, 0, 0.1), 4.0
    ),
    "flatrig/TandemLift-v0": feedforward.rest_to_rest(
        (-5, 0, -10, 0, -10, 7), (-5, 0.5, -9.5, 0.5, -9.5, 7), 5.0
    ),
    "flatrig/ContainerCrane-v0": feedforward.rest_to_rest(
        (10, -24, 0, 0, 0), (13, -23, 0, 0, 0), 6.0
    ),
    "flatrig/ShipCrane-v0": replace(
        models.default_move("ship_crane"), goal=(21, 1, 9, 0, 0, 0), duration=6.0
    ),
    "flatrig/NavyShipCrane-v0": replace(
        models.default_move("navy_ship_crane"), goal=(7.8, 0.5, 1, 12.5, 0, 0, 0), duration=6.0
    ),
}


def make(name=OVERHEAD, **options):
    return gym.make(name, **options)


def run(env, actions=None, seed=0):
    """Observations, errors of the load, and the last info of an episode under given actions."""
    observations = [env.reset(seed=seed)[0]]
    errors, over, step = [], False, 0
    still = np.zeros(len(env.unwrapped.action_names))
    while not over:
        action = still if actions is None else actions[step % len(actions)]
        observation, _, terminated, truncated, info = env.step(action)
        observations.append(observation)
        errors.append(float(np.linalg.norm(info["load"] - info["reference"])))
        over, step = terminated or truncated, step + 1
    return np.array(observations), np.array(errors), info


def at_home(name):
    """Outputs of the rig at home."""
    return make(name).reset(seed=0)[1]["load"]


@pytest.mark.parametrize("name", NAMES)
def test_a_residual_of_zero_changes_nothing_to_the_last_bit(name):
    options = {"disturbances": "standard", "reference": GENTLE[name], "hold": 0.5}
    below = run(envs.Feedforward(envs.PD(make(name, **options))))
    above = run(envs.Residual(envs.Feedforward(envs.PD(make(name, **options)))))
    assert np.array_equal(below[0], above[0])


@pytest.mark.parametrize("name", NAMES)
def test_vector_and_single_controllers_agree_to_the_last_bit(name):
    options = {"disturbances": "standard", "reference": GENTLE[name], "hold": 0.5}
    vector = gym.make_vec(name, num_envs=3, **options)
    vector = envs.Residual(envs.Feedforward(envs.PD(vector)))
    actions = np.random.default_rng(0).normal(
        scale=0.1, size=(20, len(vector.unwrapped.action_names))
    )
    singles = [
        run(envs.Residual(envs.Feedforward(envs.PD(make(name, **options)))), actions, seed)[0]
        for seed in (7, 8, 9)
    ]
    seen = [vector.reset(seed=7)[0]]
    seen += [vector.step(np.tile(action, (3, 1)))[0] for action in actions]
    for index, single in enumerate(singles):
        length = min(len(single), len(seen))
        assert np.array_equal(np.array(seen)[:length, index], single[:length])


@pytest.mark.parametrize("name", NAMES)
def test_feedforward_alone_tracks(name):
    """To what holding inputs over 10 ms leaves; a shorter hold leaves less, by its square."""
    errors = {}
    for rate in (100.0, 200.0):
        env = envs.Feedforward(
            make(name, reference=GENTLE[name], rate=rate, timestep=1e-3, hold=0.0)
        )
        errors[rate] = run(env)[1].max()
    assert errors[100.0] < 1e-3
    assert errors[200.0] < 0.3 * errors[100.0]


@pytest.mark.parametrize("name", [OVERHEAD, ROTARY])
def test_feedforward_alone_makes_the_sources_move(name):
    env = envs.Feedforward(make(name, rate=100.0, hold=0.0))
    assert run(env)[1].max() < 1e-3


@pytest.mark.parametrize("name", NAMES)
def test_feedforward_and_pd_track(name):
    env = envs.Feedforward(envs.PD(make(name)))
    assert run(env)[1].max() < 1e-3


@pytest.mark.parametrize("name", NAMES)
def test_holding_inputs_stand_only_once(name):
    """However PD and feedforward are stacked, at rest they ask for the equilibrium's inputs."""
    rest = hold(at_home(name))
    expected = feedforward.solve(make(name).unwrapped.task.rig, rest, 0.0).inputs[0]
    for stack in (
        lambda env: envs.Feedforward(envs.PD(env)),
        lambda env: envs.PD(envs.Feedforward(env)),
        lambda env: envs.PD(env),
        lambda env: envs.Feedforward(env),
    ):
        env = stack(make(name, reference=rest))
        env.reset(seed=0)
        *_, info = env.step(np.zeros(env.action_space.shape))
        assert np.allclose(info["input"], expected, atol=1e-9)


def test_order_of_composition_does_not_matter():
    one = run(envs.Feedforward(envs.PD(make(disturbances="standard"))))
    other = run(envs.PD(envs.Feedforward(make(disturbances="standard"))))
    assert np.allclose(one[0], other[0], atol=1e-9)


@pytest.mark.parametrize("name", [OVERHEAD, ROTARY])
def test_pd_towards_a_set_point_gets_there(name):
    env = envs.PD(make(name, reference=GENTLE[name], hold=25.0), track="set point")
    _, errors, info = run(env)
    assert env.unwrapped.reasons[info["reason"]] == "time"
    assert errors[-1] < 1e-3
    assert errors.max() > 0.1  # it does not follow the path


def test_pd_on_the_moving_reference_follows_better_than_towards_a_set_point():
    moving = run(envs.PD(make()))[1]
    fixed = run(envs.PD(make(), track="set point"))[1]
    assert moving.max() < 0.5 * fixed.max()


def test_pd_sees_encoders_only():
    """The law asks for the same inputs wherever the load is, as long as encoders read the same."""
    env = envs.PD(make())
    env.reset(seed=0)
    before = env.law.apply(np.zeros((1, 2)))
    plant = task_of(env).plant
    for truth in (plant.outputs, plant.qpos, plant.qvel):
        truth[...] += 1.0
    assert np.array_equal(env.law.apply(np.zeros((1, 2))), before)


def test_pd_gains_have_the_units_they_state():
    """A metre of error at the trolley asks for `stiffness` newtons more, at rest."""
    env = envs.PD(make(), stiffness=(30.0, 4.0), damping=(0.0, 0.0))
    env.reset(seed=0)
    task = task_of(env)
    rest = env.law.apply(np.zeros((1, 2)))
    task.encoders.errors[0, :2] += (1.0, 1.0)
    moved = env.law.apply(np.zeros((1, 2)))
    assert np.allclose((moved - rest)[0] * task.limits, (30.0, 4.0))


def test_a_residual_is_clipped_and_scaled():
    env = envs.Residual(make(), fraction=0.25)
    assert np.allclose(env.law.apply(np.array([[2.0, -0.5]])), [[0.25, -0.125]])


def test_only_the_environment_clips():
    """What a wrapper adds beyond the limits, another may take back."""
    env = make(hold=0.1)
    env.reset(seed=0)
    *_, info = envs.Residual(env, fraction=1.0).step(np.array([0.0, -0.5]))
    assert np.allclose(info["input"], (0.0, -98.1))
    env.reset(seed=0)
    law = envs.Feedforward(env).law
    assert law.apply(np.array([[0.0, -5.0]]))[0, 1] < -1.0


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda env: envs.PD(env, track="goal"), "track is 'goal'"),
        (lambda env: envs.PD(env, stiffness=(1.0, 2.0, 3.0)), "2 numbers >= 0"),
        (lambda env: envs.PD(env, damping=-1.0), "one for each of trolley, winch"),
        (lambda env: envs.PD(env, stiffness="abc"), "stiffness is 'abc'"),
        (lambda env: envs.Residual(env, fraction=0.0), "fraction is 0.0"),
        (lambda env: envs.Residual(env, fraction="a"), "fraction is 'a'"),
        (lambda env: envs.PD(None), "None is not an environment"),
        (lambda env: envs.PD(envs.Residual(env)), "PD above Residual .*put Residual on top"),
        (lambda env: envs.Feedforward(envs.Residual(envs.PD(env))), "put Residual on top"),
        (lambda env: envs.Residual(envs.Residual(env)), "Residual stands below already"),
        (lambda env: envs.PD(envs.PD(env)), "PD stands below already"),
        (lambda env: envs.PD(envs.Feedforward(envs.PD(env))), "PD stands below already"),
        (lambda env: envs.Feedforward(envs.Feedforward(env)), "Feedforward stands below"),
        (lambda env: envs.Feedforward(envs.PD(envs.Feedforward(env))), "Feedforward stands below"),
        (lambda env: envs.PD(gym.make("CartPole-v1")), "not an environment of flatrig"),
    ],
)
def test_wrong_options_get_one_line(build, message):
    for env in (make(), gym.make_vec(OVERHEAD, num_envs=2)):
        with pytest.raises(models.OptionError, match=message):
            build(env)


@pytest.mark.parametrize("name", NAMES)
def test_feedback_stands_three_periods_of_delay(name):
    env = envs.Feedforward(envs.PD(make(name, hold=0.0)))
    env.reset(seed=0, options={"scenario": envs.Scenario(delay=3, wind=1.0)})
    over = False
    while not over:
        *_, terminated, over, info = env.step(np.zeros(len(env.unwrapped.action_names)))
        assert not terminated, env.unwrapped.reasons[info["reason"]]
    assert np.linalg.norm(info["load"] - info["reference"]) < 0.15


RUBBING = {
    "winch_friction": (0.0, 40.0),
    "trolley_friction": (0.0, 40.0),
    "winch_viscous": (0.0, 40.0),
    "trolley_viscous": (0.0, 40.0),
}


@pytest.mark.parametrize("speed", ["reference", "measured"])
def test_compensation_takes_away_the_friction_it_knows(speed):
    """By default it expects the middle of the ranges, which is what this scenario has."""
    scenario = envs.Scenario(
        winch_friction=20.0, trolley_friction=20.0, winch_viscous=20.0, trolley_viscous=20.0
    )
    errors = []
    for build in (lambda env: env, lambda env: envs.FrictionCompensation(env, speed=speed)):
        env = build(envs.Feedforward(envs.PD(make(disturbances=RUBBING, hold=0.0))))
        env.reset(seed=0, options={"scenario": scenario})
        over = False
        while not over:
            *_, over, info = env.step(np.zeros(2))
            errors.append(float(np.linalg.norm(info["load"] - info["reference"])))
    half = len(errors) // 2
    assert max(errors[half:]) < 0.2 * max(errors[:half])


def test_compensation_of_no_friction_changes_nothing_and_refuses_what_it_cannot_do():
    plain = run(envs.Feedforward(make(reference=GENTLE[OVERHEAD])))
    with_it = run(envs.FrictionCompensation(envs.Feedforward(make(reference=GENTLE[OVERHEAD]))))
    assert np.array_equal(plain[0], with_it[0])
    friction = Friction(10.0)
    for options, message in (
        ({"speed": "mean"}, "speed is 'mean'"),
        ({"friction": {"wench": friction}}, "no such drive; did you mean winch"),
        ({"friction": {"winch": 3.0}}, "must be a Friction"),
    ):
        with pytest.raises(models.OptionError, match=message):
            envs.FrictionCompensation(make(), **options)
    with pytest.raises(models.OptionError, match="stands below already"):
        envs.FrictionCompensation(envs.FrictionCompensation(make()))


def test_compensation_is_a_force_along_the_rope():
    """A winch's torque is the force times its drum's radius."""
    env = envs.FrictionCompensation(
        make(), {"winch": Friction(10.0, viscous=2.0)}, speed="measured"
    )
    env.reset(seed=0)
    task = task_of(env)
    task.encoders.rates[0] = (1.0, 0.5)
    assert np.allclose(env.law.apply(np.zeros((1, 2)))[0] * task.limits, (0.0, 11.0 * 0.1))


def test_gymnasium_makes_the_same_controllers_again():
    env = envs.PD(make(hold=0.5, disturbances="standard"), stiffness=(900.0, 300.0))
    env = envs.Residual(envs.FrictionCompensation(envs.Feedforward(env)), fraction=0.3)
    again = gym.make(env.spec)
    assert [layer.name for layer in again.spec.additional_wrappers][-1] == "Residual"
    from_text = gym.make(gym.envs.registration.EnvSpec.from_json(env.spec.to_json()))
    actions = np.random.default_rng(0).normal(size=(30, 2))
    first = run(env, actions)[0]
    assert np.array_equal(run(again, actions)[0], first)
    assert np.array_equal(run(from_text, actions)[0], first)
