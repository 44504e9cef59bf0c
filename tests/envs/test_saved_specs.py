"""Specs of environments that earlier versions saved still make the same environments."""

import importlib
import json
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec, load_env_creator

import flatrig.envs as envs

SAVED: dict[str, dict[str, Any]] = json.loads(
    Path(__file__).with_name("saved_specs.json").read_text(encoding="utf-8")
)
OLD_PLACES = {
    "flatrig.envs.single": ["CraneEnv"],
    "flatrig.envs.vector": ["CraneVectorEnv"],
    "flatrig.envs.hand_env": ["HandEnv", "HandVectorEnv"],
    "flatrig.envs.controllers": ["PD", "Feedforward", "Residual"],
    "flatrig.envs.compensation": ["FrictionCompensation"],
    "flatrig.envs.pose_feedback": ["PoseFeedback"],
}


@pytest.mark.parametrize("name", SAVED)
def test_a_saved_spec_is_loaded(name: str) -> None:
    spec = EnvSpec.from_json(json.dumps(SAVED[name]))
    if "num_envs" in spec.kwargs:
        vector = gym.make_vec(spec)
        assert vector.reset(seed=0)[0].shape == vector.observation_space.shape
        return
    env = gym.make(spec)
    assert [wrapper.name for wrapper in env.spec.additional_wrappers] == [
        wrapper["name"] for wrapper in SAVED[name]["additional_wrappers"]
    ]
    again = gym.make(EnvSpec.from_json(env.spec.to_json()))
    for made in (env, again):
        made.reset(seed=3)
    action = np.full(env.action_space.shape, 0.01)
    assert np.array_equal(env.step(action)[0], again.step(action)[0])


@pytest.mark.parametrize("module", OLD_PLACES)
def test_old_places_hand_out_what_now_stands_in_the_package(module: str) -> None:
    for name in OLD_PLACES[module]:
        assert getattr(importlib.import_module(module), name) is getattr(envs, name)


def test_the_spec_of_a_vector_keeps_its_controllers() -> None:
    vector = gym.make_vec("flatrig/OverheadCrane-v0", num_envs=2, disturbances="standard")
    vector = envs.PD(vector, stiffness=(900.0, 300.0))
    vector = envs.Residual(envs.Feedforward(vector), fraction=0.3)
    spec = EnvSpec.from_json(vector.spec.to_json())
    assert [wrapper.name for wrapper in spec.additional_wrappers] == [
        "PD",
        "Feedforward",
        "Residual",
    ]
    wrappers, spec.additional_wrappers = spec.additional_wrappers, ()
    again = gym.make_vec(spec)
    for wrapper in wrappers:
        again = load_env_creator(wrapper.entry_point)(again, **wrapper.kwargs)
    actions = np.full((2, 2), 0.1)
    for made in (vector, again):
        made.reset(seed=1)
    assert np.array_equal(vector.step(actions)[0], again.step(actions)[0])
