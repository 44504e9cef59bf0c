"""Controllers that see the load: what they are worth, and that they are the same side by side."""

from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.envs.crane.courses import planned
from flatrig.envs.crane.linearisation import Lineariser
from flatrig.envs.crane.lqr import LQRLaw, usual
from flatrig.models.errors import OptionError

RIG = models.make("overhead_crane")
WEIGHT = RIG.weight
BLOWN = [
    envs.Scenario(wind=0.02 * WEIGHT),
    envs.Scenario(load_mass=1.2, wind=-0.01 * WEIGHT, winch_friction=0.01 * WEIGHT),
    envs.Scenario(load_mass=0.8, gust=0.02 * WEIGHT, gust_frequency=0.3, delay=1),
    envs.Scenario(trolley_friction=0.01 * WEIGHT, wind=0.01 * WEIGHT, delay=2),
]


def base(env):
    return envs.MassEstimate(envs.Feedforward(envs.PD(env)))


def swing_damping(env):
    return envs.SwingDamping(base(env))


def lqr(env):
    return envs.LQR(envs.Feedforward(envs.PD(envs.TautGuard(env))))


def observer(env):
    return envs.Observer(envs.Feedforward(envs.PD(envs.TautGuard(env))))


HOLDING = {"reference": feedforward.hold((0.0, -3.0)), "hold": 14.0}


def run(wrap, scenarios, sensors, steps=300, **options):
    """RMS distance of the load from its reference (n,), and where it was (steps, n, outputs)."""
    env = envs.CraneVectorEnv(
        RIG, num_envs=len(scenarios), sensors=sensors, disturbances="standard", timestep=5e-3,
        nthread=1, **options,
    )  # fmt: skip
    env = wrap(env)
    env.reset(seed=5, options={"scenarios": scenarios})
    still, places = np.zeros(env.action_space.shape), []
    squares = np.zeros(len(scenarios))
    for _ in range(steps):
        _, _, terminated, _, info = env.step(still)
        assert not terminated.any()
        squares += np.square(info["load"] - info["reference"]).sum(axis=1)
        places.append(info["load"])
    return np.sqrt(squares / steps), np.array(places), env


@pytest.mark.parametrize("sensors", ["sway", "full"])
def test_swing_damping_takes_away_much_of_what_wind_and_friction_leave(sensors):
    without, _, _ = run(base, BLOWN, sensors)
    seeing, _, _ = run(swing_damping, BLOWN, sensors)
    assert (seeing < without).all()
    assert seeing.mean() < 0.75 * without.mean()


@pytest.mark.parametrize("sensors", ["sway", "full"])
def test_a_regulator_takes_away_most_of_it(sensors):
    without, _, _ = run(base, BLOWN, sensors)
    seeing, _, _ = run(lqr, BLOWN, sensors)
    assert (seeing < 0.5 * without).all()
    assert seeing.mean() < 0.3 * without.mean()


def aside(places):
    """Largest distance from where a load is to hang, at the end, (n,) [m]."""
    return np.abs(places[-100:] - HOLDING["reference"](0.0)[0]).max((0, 2))


def test_encoders_tell_an_observer_of_swing():
    swinging = [envs.Scenario(swing=0.05, delay=k, load_mass=m) for k in (0, 3) for m in (0.8, 1.2)]
    _, without, _ = run(base, swinging, "encoders", 700, **HOLDING)
    _, seeing, _ = run(observer, swinging, "encoders", 700, **HOLDING)
    assert (aside(seeing) < 0.9 * aside(without)).all()
    assert aside(seeing).mean() < 0.75 * aside(without).mean()


def test_a_steady_wind_leaves_nothing_aside():
    blown = [envs.Scenario(wind=w * WEIGHT, load_mass=m) for w in (0.02, -0.01) for m in (0.8, 1.2)]
    _, places, _ = run(lqr, blown, "full", 700, **HOLDING)
    assert (
        aside(places) < 0.1 * 0.01 * 3.0
    ).all()  # the least wind alone would give ten times that


def test_late_commands_and_other_masses_leave_it_stable():
    late = [envs.Scenario(swing=0.03, delay=3, load_mass=m) for m in (0.7, 1.0, 1.3)]
    _, places, _ = run(lqr, late, "sway", 700, **HOLDING)
    assert (aside(places) < 0.01).all()


def test_nothing_is_added_where_nothing_is_wrong():
    quiet = [envs.Scenario()]
    for wrap, sensors in ((lqr, "full"), (observer, "encoders")):
        assert run(wrap, quiet, sensors)[0] < 4e-4


def test_the_load_is_weighed_at_once():
    heavy = [envs.Scenario(load_mass=m) for m in (0.7, 1.3)]
    for wrap, sensors in ((lqr, "sway"), (observer, "encoders")):
        _, _, env = run(wrap, heavy, sensors, 25)
        law = next(law for law in envs.laws.laws_of(env) if isinstance(law, LQRLaw))
        assert law.estimate == pytest.approx([0.7, 1.3], abs=0.08)


@pytest.mark.parametrize(
    ("wrap", "sensors"), [(swing_damping, "full"), (lqr, "full"), (observer, "encoders")]
)
def test_side_by_side_is_alone(wrap, sensors):
    _, together, _ = run(wrap, BLOWN, sensors, steps=60)
    env = gym.make(
        "flatrig/OverheadCrane-v0", sensors=sensors, disturbances="standard", timestep=5e-3
    )
    env = wrap(env)
    env.reset(seed=6, options={"scenario": BLOWN[1]})
    alone = np.array([env.step(np.zeros(2))[4]["load"] for _ in range(60)])
    assert alone == pytest.approx(together[:, 1], abs=1e-9)


def test_a_swing_dies_out_as_the_damping_says():
    """The second road: a pendulum that hangs from a point which moves as the law's shift says."""
    damping, scale = 0.2, envs.CraneTask(RIG).scales
    hold = feedforward.hold((0.0, -scale.length))
    env = envs.CraneVectorEnv(
        RIG, num_envs=1, sensors="full", reference=hold, hold=12.0, timestep=5e-3, nthread=1
    )
    env = envs.SwingDamping(envs.Feedforward(envs.PD(env)), damping=damping, integral=0.0)
    env.reset(seed=0, options={"scenarios": [envs.Scenario(swing=0.02)]})
    period, aside = env.unwrapped.task.period, []
    for _ in range(500):
        info = env.step(np.zeros((1, 2)))[4]
        aside.append(info["load"][0, 0] - info["reference"][0, 0])
    aside = np.array(aside)
    peaks = [k for k in range(1, 499) if aside[k] > max(aside[k - 1], aside[k + 1], 2e-4)]
    rate = np.log(aside[peaks[0]] / aside[peaks[1]]) / (period * (peaks[1] - peaks[0]))
    # The drive is no ideal one: it follows at its own pace, and friction has no part in it.
    assert rate == pytest.approx(damping / scale.time, rel=0.15)


def test_drive_positions_follow_joints():
    task = envs.CraneTask("cantilever_crane")
    lineariser = Lineariser(task.rig, task.period, room=64)
    plan = task.planner.fixed
    course = planned(task.rig, lineariser.model, plan)
    model = lineariser.along([course])
    step = int(model.knots[0, model.knots.shape[1] // 2])
    rates = model.drives[0, model.knots.shape[1] // 2] @ course.states[step][model.states // 2 :]
    assert rates == pytest.approx(plan.rows[step, model.inputs : 2 * model.inputs], abs=1e-5)


@pytest.mark.parametrize(
    ("wrap", "sensors", "message"),
    [
        (lambda env: envs.SwingDamping(envs.Feedforward(env)), "full", "needs PD"),
        (swing_damping, "encoders", "needs load sensors"),
        (lambda env: envs.SwingDamping(base(env), damping=0), "full", "damping"),
        (lambda env: envs.SwingDamping(swing_damping(env)), "full", "once"),
        (lambda env: envs.LQR(envs.Feedforward(env)), "full", "needs feedforward and PD"),
        (lambda env: envs.Observer(envs.PD(env)), "encoders", "needs feedforward and PD"),
        (lqr, "encoders", "take Observer"),
        (lambda env: envs.LQR(envs.Feedforward(envs.PD(env)), change=0), "full", "change"),
        (lambda env: envs.LQR(envs.Feedforward(envs.PD(env)), patience=-1), "full", "patience"),
        (lambda env: envs.LQR(base(env)), "full", "MassEstimate stands below already"),
        (lambda env: envs.LQR(observer(env)), "full", "Observer stands below already, LQR does"),
        (lambda env: envs.MassEstimate(lqr(env)), "full", "LQR stands below already"),
        (lambda env: envs.SwingDamping(observer(env)), "full", "Observer stands below already"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(wrap, sensors, message):
    env = gym.make("flatrig/OverheadCrane-v0", sensors=sensors)
    with pytest.raises(OptionError, match=message):
        wrap(env)


def test_platforms_do_not_swing_as_pendulums() -> None:
    env = envs.Feedforward(envs.PD(envs.CraneEnv("cable_manipulator", sensors="sway")))
    with pytest.raises(OptionError, match="carries the platform platform, which several ropes"):
        envs.SwingDamping(env)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("cantilever_crane", 0.05),
        ("navy_crane_2d", 0.05),
        ("navy_crane_3d", 0.002),
        ("cable_manipulator", 0.05),
    ],
)
def test_regulators_are_softer_where_they_must_be(name, change):
    assert usual(models.make(name))[0] == change


def test_the_gains_go_on_with_the_sea():
    """A crane on a ship is another one in every phase of the sea: held with the gains of the
    instant of its arrival, its free pulley swings up within two seconds."""
    rig, move = models.make("navy_ship_crane"), models.default_move("navy_ship_crane")
    places = (2.65, 5.38, 6.48), (6.5, 3.04, 5.4)
    start, goal = ((*place, *move.start[3:]) for place in places)
    path = feedforward.from_move(replace(move, start=start, goal=goal, duration=13.04), rig)
    env = envs.CraneVectorEnv(
        rig, num_envs=1, sensors="full", reference=path, hold=6.0, timestep=5e-3, nthread=1
    )
    env = lqr(env)
    env.reset(seed=0)
    still = np.zeros(env.action_space.shape)
    infos = [env.step(still)[4] for _ in range(920)]
    far = np.array([np.linalg.norm(info["load"] - info["reference"]) for info in infos])
    assert far.max() < 0.01
