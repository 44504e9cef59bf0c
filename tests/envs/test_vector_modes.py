"""Native vectors are Gymnasium's own, in every autoreset mode, but for their speed."""

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import DictInfoToList

import flatrig.envs as envs
from flatrig import models

OVERHEAD = "flatrig/OverheadCrane-v0"
PLATE = "flatrig/BallOnPlate-v0"
SHORT = models.Move(start=(0, -4), goal=(0.2, -4.1), duration=0.9)
"""A move whose episode is over within a test."""
ROUGH = {OVERHEAD: (0.1, 50), PLATE: (1.0, 40)}
"""Size of random actions, and steps in which they end some episodes."""


def options_of(name):
    short = {"reference": SHORT, "hold": 0.02} if name == OVERHEAD else {}
    return {"disturbances": "standard", **short}


def same(ours, theirs, where=""):
    """Whether two values of infos are the same, entry by entry."""
    if isinstance(theirs, dict):
        assert set(ours) == set(theirs), (where, set(ours) ^ set(theirs))
        for name in theirs:
            which = theirs.get(f"_{name}", np.ones(1, bool))
            if isinstance(theirs[name], dict) or which.all() or name.startswith("_"):
                same(ours[name], theirs[name], f"{where}.{name}")
            else:  # what is not said of a simulation may be anything
                same(ours[name][which], theirs[name][which], f"{where}.{name}")
    elif theirs.dtype == object:
        assert len(ours) == len(theirs)
        for own, other in zip(ours, theirs, strict=True):
            assert np.array_equal(own, other), where
    else:
        assert np.array_equal(ours, theirs), where


@pytest.mark.parametrize("mode", AutoresetMode)
@pytest.mark.parametrize("name", [OVERHEAD, PLATE])
def test_every_mode_is_that_of_gymnasium_to_the_last_bit(name, mode):
    options, (size, steps) = options_of(name), ROUGH[name]
    ours = gym.make_vec(name, num_envs=3, autoreset_mode=mode, **options)
    vector = {"autoreset_mode": mode}
    theirs = gym.make_vec(
        name, num_envs=3, vectorization_mode="sync", vector_kwargs=vector, **options
    )
    assert ours.metadata["autoreset_mode"] is ours.autoreset_mode is mode
    assert (ours.reset(seed=5)[0] == theirs.reset(seed=5)[0]).all()
    rng = np.random.default_rng(2)
    hold = ours.unwrapped.task.rows.parts["holding"].copy()
    ended = 0
    for _ in range(steps):
        actions = np.clip(hold + size * rng.normal(size=hold.shape), -1, 1)
        mine, other = ours.step(actions), theirs.step(actions)
        for own, their in zip(mine[:4], other[:4], strict=True):
            assert np.array_equal(own, their)
        same(mine[4], other[4])
        over = mine[2] | mine[3]
        ended += over.sum()
        if mode is AutoresetMode.DISABLED and over.any():
            again = [one.reset(options={"reset_mask": over.copy()}) for one in (ours, theirs)]
            assert np.array_equal(again[0][0], again[1][0])
            same(again[0][1], again[1][1])
    assert ended >= 2


def test_infos_fall_apart_into_those_of_single_environments():
    options = options_of(OVERHEAD)
    vector = gym.make_vec(OVERHEAD, num_envs=2, autoreset_mode="SameStep", **options)
    vector = DictInfoToList(vector)
    singles = [gym.make(OVERHEAD, **options) for _ in range(2)]
    infos = vector.reset(seed=1)[1]
    for seed, (single, info) in enumerate(zip(singles, infos, strict=True), start=1):
        told = single.reset(seed=seed)[1]
        assert told.keys() == info.keys()
        scenario = single.unwrapped.task.scenarios[0]
        named = dict(zip(single.unwrapped.scenario_names, info["scenario"], strict=True))
        assert named == vars(scenario)
        same(info, told)
    for _ in range(46):
        infos = vector.step(np.tile([0.0, -0.5], (2, 1)))[4]
        told = [single.step([0.0, -0.5])[4] for single in singles]
    assert [single.unwrapped.reasons[one["reason"]] for one in told] == ["time", "time"]
    assert [one["final_info"]["reason"] for one in infos] == [one["reason"] for one in told]
    assert np.array_equal(infos[1]["final_info"]["load"], told[1]["load"])
    assert [one["reason"] for one in infos] == [0, 0]


def test_a_reset_of_some_tells_of_these_only():
    vector = gym.make_vec(OVERHEAD, num_envs=3)
    vector.reset(seed=0)
    mask = np.array([True, False, True])
    info = vector.reset(options={"reset_mask": mask})[1]
    assert (info["_load"] == mask).all()
    assert (info["_reason"] == mask).all()


def test_without_autoreset_an_episode_that_is_over_must_be_reset():
    vector = gym.make_vec(OVERHEAD, num_envs=3, autoreset_mode="Disabled")
    vector.reset(seed=0)
    actions = np.tile([0.0, -0.5], (3, 1))
    actions[1, 1] = 1.0  # pays out the rope
    while not vector.step(actions)[2].any():
        pass
    line = r"episodes of cranes \[1\] are over; without autoreset call reset"
    with pytest.raises(models.OptionError, match=line):
        vector.step(actions)
    vector.reset(options={"reset_mask": np.array([False, True, False])})
    vector.step(actions)
    with pytest.raises(models.OptionError, match="did you mean SameStep"):
        gym.make_vec(OVERHEAD, num_envs=2, autoreset_mode="samestep")


@pytest.mark.parametrize("mode", ["sync", "async", "vector_entry_point", None])
def test_wrappers_stand_around_vectors_of_every_kind(mode):
    wrappers = [envs.PD, envs.Feedforward]
    vector = envs.make_vec(
        OVERHEAD, 2, mode, {"autoreset_mode": AutoresetMode.SAME_STEP}, wrappers,
        disturbances="standard",
    )  # fmt: skip
    assert vector.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    single = envs.Feedforward(envs.PD(gym.make(OVERHEAD, disturbances="standard")))
    vector.reset(seed=4)
    single.reset(seed=5)
    for _ in range(4):
        seen = vector.step(np.full((2, 2), 0.01, np.float32))[0]
        alone = single.step(np.full(2, 0.01, np.float32))[0]
    assert np.array_equal(seen[1], alone)
    again = envs.make_vec(vector.spec)
    again.reset(seed=4)
    for _ in range(4):
        twice = again.step(np.full((2, 2), 0.01, np.float32))[0]
    assert np.array_equal(seen, twice)
    vector.close()
    again.close()


def test_a_saved_spec_makes_a_native_vector_with_its_controllers():
    vector = envs.PD(gym.make_vec(OVERHEAD, num_envs=2, autoreset_mode="SameStep"), damping=50.0)
    vector = envs.Residual(envs.Feedforward(vector), fraction=0.1)
    again = envs.make_vec(EnvSpec.from_json(vector.spec.to_json()))
    assert (again.num_envs, again.autoreset_mode) == (2, AutoresetMode.SAME_STEP)
    assert [law.name for law in envs.laws.laws_of(again)] == ["Residual", "Feedforward", "PD"]
    for one in (vector, again):
        one.reset(seed=1)
    actions = np.full((2, 2), 0.1)
    assert np.array_equal(vector.step(actions)[0], again.step(actions)[0])


def test_a_controller_around_a_vector_of_gymnasium_says_where_it_belongs():
    vector = gym.make_vec(OVERHEAD, num_envs=1, vectorization_mode="sync")
    with pytest.raises(models.OptionError, match=r"make_vec\(..., wrappers=\[PD\]\)"):
        envs.PD(vector)
