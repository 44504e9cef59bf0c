"""What holds for every registered environment, single and vector."""

import itertools
import warnings
from dataclasses import replace

import gymnasium as gym
import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.envs.crane.payloads import payloads, reloaded
from flatrig.models.mjcf.rig_state import tensions
from flatrig.models.rig.chain import apart

NAMES = list(envs.ENVIRONMENTS)
LARGE = ("flatrig/LuffingCrane-v0", "flatrig/KnuckleCrane-v0")
LARGE += ("flatrig/DoublePendulumCrane-v0", "flatrig/ContainerCrane-v0", "flatrig/TandemLift-v0")
LARGE += ("flatrig/ShipCrane-v0",)
SENSORS = ("encoders", "full")
OVERHEAD = "flatrig/OverheadCrane-v0"
NAVY = "flatrig/NavyCrane3D-v0", "flatrig/NavyShipCrane-v0"
CABLEV = "flatrig/CableManipulator-v0"
ROPED_TROLLEYS = {"flatrig/RopedOverheadCrane-v0", "flatrig/CantileverCrane-v0"}
ROPED_TROLLEYS |= {"flatrig/GantryCrane-v0"}
TENDON_FRICTION = mujoco.mjtConstraint.mjCNSTR_FRICTION_TENDON
MANIPULATED = models.default_move("cable_manipulator").start


def make(name=OVERHEAD, **options):
    return gym.make(name, **options)


def noise(task, seed, scale=0.02):
    """A random policy that keeps ropes taut for a while: small noise about the equilibrium."""
    rng = np.random.default_rng(seed)
    hold = task.acting.of_actions(task.plant.model.key_ctrl / task.limits)[0]
    return lambda: hold + scale * rng.normal(size=len(hold))


def leaves(data):
    """All arrays in an info."""
    for value in data.values():
        if isinstance(value, dict):
            yield from leaves(value)
        elif isinstance(value, np.ndarray):
            yield value


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("sensors", SENSORS)
def test_gymnasium_finds_nothing_wrong(name, sensors):
    env = make(name, sensors=sensors, disturbances="standard")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped, skip_render_check=True)


@pytest.mark.parametrize("name", NAMES)
def test_stable_baselines_finds_nothing_wrong(name):
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        checker.check_env(make(name).unwrapped, warn=True)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("sensors", SENSORS)
def test_every_entry_is_named_and_none_is_constant(name, sensors):
    env = make(name, sensors=sensors, disturbances="standard")
    assert len(env.unwrapped.observation_names) == env.observation_space.shape[0]
    assert len(set(env.unwrapped.observation_names)) == env.observation_space.shape[0]
    assert env.unwrapped.action_names == env.unwrapped.task.acting.action_names
    seen = []
    for seed in range(2):
        seen.append(env.reset(seed=seed)[0])
        act = noise(env.unwrapped.task, seed)
        seen += [env.step(act())[0] for _ in range(30)]
    spread = np.ptp(seen, axis=0)
    constant = [
        entry
        for entry, width in zip(env.unwrapped.observation_names, spread, strict=True)
        if width == 0
    ]
    assert not constant


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("reference", [None, "random"])
def test_single_and_vector_agree_to_the_last_bit(name, reference):
    """Over episodes that end at different times, restarts included."""
    if name == CABLEV and reference is None:
        reference = feedforward.rest_to_rest(MANIPULATED, MANIPULATED, 0.5)  # it ends in time
    options = {"disturbances": "standard", "sensors": "full", "reference": reference, "hold": 0.0}
    # Navy cranes in space have slack ropes every few steps, and a new plan takes long
    count, steps = 3, 15 if name in NAVY else 60
    vector = gym.make_vec(name, num_envs=count, nthread=2, **options)
    singles = [make(name, **options) for _ in range(count)]
    acts = [noise(single.unwrapped.task, seed, 0.25) for seed, single in enumerate(singles)]
    observations, _ = vector.reset(seed=5)
    for index, single in enumerate(singles):
        assert np.array_equal(single.reset(seed=5 + index)[0], observations[index])
    over = [False] * count
    endings = 0
    for _ in range(steps):
        actions = np.array([act() for act in acts])
        observations, rewards, terminated, truncated, infos = vector.step(actions)
        for index, single in enumerate(singles):
            if over[index]:
                observation, info = single.reset()
                reward, ended, late = 0.0, False, False
            else:
                observation, reward, ended, late, info = single.step(actions[index])
            assert np.array_equal(observation, observations[index])
            assert (reward, ended, late) == (rewards[index], terminated[index], truncated[index])
            assert {"load", "reference", "tension", "input", "scenario", "reason"} < info.keys()
            for key, value in info.items():
                assert np.array_equal(value, infos[key][index])
            over[index] = ended or late
            endings += over[index]
    # what large cranes are pushed to takes longer
    assert endings or name in LARGE or (name == CABLEV and reference == "random")


@pytest.mark.parametrize("name", NAMES)
def test_same_seed_same_episode_and_other_seed_another(name):
    def episode(seed):
        env = make(name, disturbances="standard")
        observation, _ = env.reset(seed=seed)
        act = noise(env.unwrapped.task, 0)
        return np.array([observation, *(env.step(act())[0] for _ in range(10))])

    assert np.array_equal(episode(3), episode(3))
    assert not np.array_equal(episode(3), episode(4))


def test_results_do_not_depend_on_threads_or_on_how_many_run_beside():
    def run(count, nthread):
        vector = gym.make_vec(OVERHEAD, num_envs=count, nthread=nthread, disturbances="standard")
        vector.reset(seed=1)
        act = noise(vector.unwrapped.task, 0)
        return [vector.step(np.tile(act(), (count, 1)))[0][:3] for _ in range(20)][-1]

    assert np.array_equal(run(3, 1), run(3, 2))
    assert np.array_equal(run(3, 1), run(37, 2))


@pytest.mark.parametrize("name", NAMES)
def test_what_is_returned_is_the_callers_own(name):
    def run(spoil):
        env = make(name, sensors="full")
        act = noise(env.unwrapped.task, 0)
        results = [env.reset(seed=0)[0].copy()]
        for _ in range(5):
            observation, _, _, _, info = env.step(act())
            results.append(observation.copy())
            if spoil:
                for array in (observation, *leaves(info)):
                    array[...] = np.nan
        return np.array(results)

    assert np.array_equal(run(spoil=False), run(spoil=True))


def test_what_a_vector_returns_is_the_callers_own():
    vector = gym.make_vec(OVERHEAD, num_envs=2, sensors="full")
    kept = []
    vector.reset(seed=0)
    actions = np.tile(noise(vector.unwrapped.task, 0)(), (2, 1))
    for _ in range(2):
        observations, rewards, terminated, truncated, info = vector.step(actions)
        kept.append([observations, rewards, terminated, truncated, *leaves(info)])
    for before, after in itertools.product(*kept):
        assert not np.shares_memory(before, after)


@pytest.mark.parametrize("name", NAMES)
def test_random_actions_never_raise_nor_give_nan(name):
    vector = gym.make_vec(name, num_envs=8, disturbances="standard", sensors="full")
    vector.reset(seed=0)
    vector.action_space.seed(0)
    space = vector.single_observation_space
    reasons = set()
    for _ in range(60):
        observations, rewards, terminated, _, info = vector.step(vector.action_space.sample())
        assert all(space.contains(observation) for observation in observations)
        assert ((rewards >= 0) & (rewards <= 1)).all()
        assert (rewards[terminated] == 0).all()
        reasons |= {vector.unwrapped.reasons[why] for why in info["reason"]}
    assert reasons - {""} <= set(vector.unwrapped.task.plant.reasons)
    assert "slack" in reasons or name == CABLEV  # its winches are too heavy to throw a rope off


def test_a_rope_that_would_push_ends_the_episode():
    env = make()
    env.reset(seed=0)
    _, reward, terminated, truncated, info = env.step([0.0, 1.0])
    assert (reward, terminated, truncated) == (0.0, True, False)
    assert env.unwrapped.reasons[info["reason"]] == "slack"
    assert info["tension"][0] <= 0


def test_a_load_above_its_trolley_ends_the_episode():
    assert last_reason([0.0, -1.0]) == "load above trolley"


def test_a_trolley_beyond_its_rail_ends_the_episode():
    assert last_reason([-0.3, -0.5]) == "off the rail"


def test_what_flies_away_ends_the_episode():
    env = make(rate=10.0, rig=models.overhead_crane(), hold=1e3)
    env.reset(seed=0)
    for _ in range(4000):
        _, _, terminated, _, info = env.step([0.0, -0.49])
        if terminated:
            break
    assert env.unwrapped.reasons[info["reason"]] == "out of reach"


def test_a_state_that_is_not_a_number_ends_the_episode(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    env = make(sensors="full")
    env.reset(seed=0)
    env.unwrapped.task.plant.qvel[0, 1] = np.nan
    observation, reward, terminated, _, info = env.step([0.0, -0.5])
    assert terminated
    assert env.unwrapped.reasons[info["reason"]] == "not finite"
    assert reward == 0.0
    assert np.isfinite(observation).all()
    assert all(np.isfinite(array).all() for array in leaves(info))
    assert not list(tmp_path.iterdir())  # MuJoCo would leave a log


def last_reason(action):
    env = make()
    env.reset(seed=0)
    while True:
        _, _, terminated, truncated, info = env.step(action)
        if terminated or truncated:
            return env.unwrapped.reasons[info["reason"]]


def test_time_truncates():
    env = envs.Feedforward(make(hold=0.5))
    env.reset(seed=0)
    count, truncated = 0, False
    while not truncated:
        _, _, terminated, truncated, info = env.step(np.zeros(2))
        assert not terminated
        count += 1
    assert count == round(3.5 * 50)
    assert env.unwrapped.reasons[info["reason"]] == "time"


@pytest.mark.parametrize("name", NAMES)
def test_tension_is_the_exact_one(name):
    """As in a model of its own with the scenario's masses and friction, after `mj_forward`."""
    env = make(name, disturbances="standard")
    env.reset(seed=1)
    scenario = env.unwrapped.task.scenarios[0]
    rubbing = (scenario.winch_friction, scenario.trolley_friction)
    shared = 2.0 * np.prod(rubbing) / np.sum(rubbing)  # by a rope and a trolley on one joint
    bound = 1e-6 + (shared if name in ROPED_TROLLEYS else 0.0)
    act = noise(env.unwrapped.task, 1, 0.02)
    most = 0.0
    for step in range(40):
        *_, info = env.step(act() * (1.0 + 0.15 * np.sin(0.2 * step)))
        exact, friction = mujoco_tensions(env.unwrapped.task.plant, scenario)
        assert np.abs(info["tension"] - exact).max() <= bound
        most = max(most, np.abs(friction).max())
    assert most > 0.9 * rubbing[0]  # it slips


def mujoco_tensions(plant, scenario):
    """Tensions of the ropes, and the friction along them that MuJoCo's solver found."""
    rig = plant.rig
    timestep = plant.model.opt.timestep
    model = models.compile(rig, visuals=False, friction=True, timestep=timestep)
    for load in payloads(rig):
        model.body(load.name).mass *= scenario.load_mass
        model.body(load.name).inertia *= scenario.load_mass
    tendons = {model.tendon(index).name: index for index in range(model.ntendon)}
    for drive in rig.drives:
        if drive.on in {rope.name for rope in rig.ropes}:
            model.tendon_frictionloss[tendons[drive.on]] = scenario.winch_friction
    for trolley in rig.trolleys:
        if trolley.coordinate in tendons:
            model.tendon_frictionloss[tendons[trolley.coordinate]] = scenario.trolley_friction
        else:
            model.joint(trolley.coordinate).frictionloss = scenario.trolley_friction
    data = mujoco.MjData(model)
    mujoco.mj_setConst(model, data)
    for name in ("qpos", "qvel", "ctrl", "xfrc_applied"):
        getattr(data, name)[:] = plant.batch.bind(name)[0]
    data.qacc_warmstart[:] = plant.batch.bind("qacc")[0]
    mujoco.mj_forward(model, data)
    friction = np.zeros(len(rig.ropes))
    for kind, index, force in zip(data.efc_type, data.efc_id, data.efc_force, strict=True):
        name = model.tendon(index).name if kind == TENDON_FRICTION else ""
        if name in rig.rope_names:
            friction[rig.rope_names.index(name)] += force
    # Where ropes are constraints, a link's tension is by the description's masses.
    carried = rig if apart(rig) else reloaded(rig, scenario.load_mass)
    found = tensions(carried, data.qpos, data.qvel, data.qacc, data.ctrl, friction)
    for column, link in enumerate(rig.links, start=len(rig.ropes)):
        above, below = (data.site(end).xpos for end in link.ends)
        first, second = (data.xfrc_applied[model.body(end).id, :3] for end in link.ends)
        wind = second - first
        # Least squares ask both ends alike, of which a hook has no wind.
        found[column] += 0.5 * wind @ (below - above) / np.linalg.norm(below - above)
    return found, friction


def test_references_fixed_drawn_and_prescribed():
    path = feedforward.rest_to_rest((0, -4), (2, -3), 4.0)
    move = models.Move(start=(0, -4), goal=(2, -3), duration=4.0)
    for option in (path, move, lambda rng: path):
        env = make(reference=option, hold=2.0)
        _, info = env.reset(seed=0)
        assert np.allclose(info["reference"], (0, -4))
        assert env.unwrapped.task.rows.length[0] == 300
    env = make(hold=2.0)
    env.reset(seed=0, options={"reference": path})
    assert env.unwrapped.task.rows.length[0] == 300
    env.reset()
    assert env.unwrapped.task.rows.length[0] == 250


@pytest.mark.parametrize("name", NAMES)
def test_random_references_differ_and_can_be_followed(name):
    env = envs.Feedforward(make(name, reference="random", rate=100.0))
    starts = []
    for seed in range(3):
        _, info = env.reset(seed=seed)
        starts.append(info["reference"])
        assert np.allclose(info["load"], info["reference"], atol=1e-12)
    move = models.default_move(envs.ENVIRONMENTS[name])
    changing = np.array(move.start) != move.goal
    assert (np.ptp(starts, axis=0)[changing] > 0).all()
    for _ in range(50):
        *_, terminated, _, info = env.step(np.zeros(len(env.unwrapped.action_names)))
    assert not terminated
    assert np.linalg.norm(info["load"] - info["reference"]) < 1e-3


def test_the_action_of_a_crane_that_begins_anew_does_not_matter():
    vector = gym.make_vec(OVERHEAD, num_envs=2)
    vector.reset(seed=0)
    assert vector.step([[0.0, 1.0], [0.0, -0.5]])[2].tolist() == [True, False]
    vector.step([[np.nan, np.nan], [0.0, -0.5]])
    assert vector.unwrapped.task.scenarios == [envs.Scenario()] * 2
    with pytest.raises(models.OptionError, match=r"row 0, action 0 \(trolley\) is nan"):
        vector.step([[np.nan, np.nan], [0.0, -0.5]])


def test_reward_terms_begin_at_one_and_rest_with_a_simulation_that_rests():
    task = envs.CraneTask("overhead_crane", num=2)
    generators = [np.random.default_rng(seed) for seed in range(2)]
    task.reset(task.all, generators)
    task.step([[0.3, -0.6], [0.3, -0.6]])
    names = ("reward_tracking", "reward_smoothness")
    before = task.info()
    task.step([[0.1, -0.4], [np.nan, np.nan]], task.all[:1])
    after = task.info()
    assert all(after[name][1] == before[name][1] < 1.0 for name in names)
    assert after["reward_smoothness"][0] != before["reward_smoothness"][0]
    task.reset(task.all[:1], generators[:1])
    assert all(task.info()[name][0] == 1.0 for name in names)


def test_a_move_may_lead_to_the_very_end_of_a_rail():
    rig = models.overhead_crane()
    rig = replace(rig, rails=(replace(rig.rails[0], start=0.0, end=5.0),))
    env = envs.Feedforward(envs.PD(make(rig=rig, hold=1.0)))
    env.reset(seed=0)
    over = False
    while not over:
        *_, terminated, over, info = env.step(np.zeros(2))
        assert not terminated
    assert env.unwrapped.reasons[info["reason"]] == "time"


def test_task_of_a_rig_of_ones_own():
    rig = models.overhead_crane(load_mass=20.0)
    env = envs.Feedforward(make(rig=rig, rate=100.0))
    env.reset(seed=0)
    for _ in range(50):
        *_, info = env.step(np.zeros(2))
    assert np.linalg.norm(info["load"] - info["reference"]) < 1e-4


def test_pictures():
    env = make(render_mode="rgb_array")
    env.reset(seed=0)
    try:
        first = env.render()
    except models.ModelError as error:
        pytest.skip(str(error))
    assert first.dtype == np.uint8
    assert first.ndim == 3
    assert np.ptp(first) > 0
    for _ in range(20):
        env.step([0.3, -0.7])
    assert not np.array_equal(env.render(), first)
    env.close()
    env.close()


def test_pictures_of_a_size_and_from_the_side():
    env = make(render_mode="rgb_array", width=64, height=48, camera="side")
    vector = gym.make_vec(OVERHEAD, num_envs=2, render_mode="rgb_array", width=64, height=48)
    for one in (env, vector):
        one.reset(seed=0)
    try:
        aside = env.render()
    except models.ModelError as error:
        pytest.skip(str(error))
    ahead = vector.render()
    assert aside.shape == ahead[1].shape == (48, 64, 3)
    assert not np.array_equal(aside, ahead[0])
    unknown = make(render_mode="rgb_array", camera="above")
    unknown.reset(seed=0)
    with pytest.raises(models.ModelError, match="no camera 'above', it has overview, side"):
        unknown.render()
    for wrong, message in (
        ({"width": 0}, "width is 0"), ({"height": 1.5}, "height is 1.5"),
        ({"camera": 3}, "camera is 3"), ({"heigth": 5}, "did you mean height"),
    ):  # fmt: skip
        with pytest.raises(models.OptionError, match=message):
            make(**wrong)


def test_without_a_render_mode_there_is_no_picture():
    env = make()
    env.reset(seed=0)
    assert env.render() is None
