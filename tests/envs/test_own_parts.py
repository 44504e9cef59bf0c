"""What a user adds from outside the package: a controller, and a disturbance."""

import json
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec

from flatrig import envs, models

OVERHEAD = "flatrig/OverheadCrane-v0"


class Damping(envs.Law):
    """Pull back in proportion to the measured rates."""

    name = "damped"

    def __init__(self, task: Any, share: float) -> None:
        self.task, self.share = task, share

    def apply(self, actions: Any) -> Any:
        """Add the pull."""
        return actions - self.share * self.task.encoders.rates


def damped(env: Any, share: float = 0.1) -> Any:
    """Put it in front of an environment."""
    return envs.wrap(env, Damping(envs.task_of(env), share), share=share)


def test_a_controller_of_ones_own_is_added_single_and_vector() -> None:
    vector = damped(envs.Feedforward(gym.make_vec(OVERHEAD, num_envs=3)), share=0.2)
    single = damped(envs.Feedforward(gym.make(OVERHEAD)), share=0.2)
    plain = envs.Feedforward(gym.make(OVERHEAD))
    for env in (vector, single):
        env.reset(seed=5)
    for _ in range(20):
        together = vector.step(np.full((3, 2), 0.01))[0]
        assert np.array_equal(together[0], single.step(np.full(2, 0.01))[0])
    assert plain.spec.additional_wrappers == single.spec.additional_wrappers[:1]
    assert vector.spec.additional_wrappers[-1].kwargs == {"share": 0.2}


def test_a_controller_of_ones_own_adds_what_it_says() -> None:
    env = damped(gym.make(OVERHEAD), share=0.2)
    env.reset(seed=0)
    envs.task_of(env).encoders.rates[0] = (1.0, -0.5)
    assert np.allclose(env.law.apply(np.zeros((1, 2))), (-0.2, 0.1))


def test_a_controller_of_ones_own_is_made_again_from_its_spec() -> None:
    text = damped(gym.make(OVERHEAD), share=0.3).spec.to_json()
    wrapper = json.loads(text)["additional_wrappers"][-1]
    assert wrapper == {
        "name": "damped",
        "entry_point": f"{__name__}:damped",
        "kwargs": {"share": 0.3},
    }
    assert EnvSpec.from_json(text).additional_wrappers[-1].kwargs == {"share": 0.3}


@dataclass(frozen=True)
class Sticky(envs.Scenario):
    """A plant whose joints are damped."""

    damping: float = envs.quantity(0.0, least=0)
    """Viscous friction of every joint [N s/m, N m s]."""

    def disturb(self, plant: Any, sim: int) -> None:
        """Damp one simulation."""
        plant.batch.expand("dof_damping")[sim] = self.damping


@dataclass(frozen=True)
class StickyRanges(envs.Disturbances):
    """Its range."""

    scenario_type = Sticky
    damping: envs.Range = (0.0, 0.0)


def test_a_disturbance_of_ones_own_acts_and_leaves_the_other_draws_alone() -> None:
    standard = envs.Disturbances.standard(models.overhead_crane())
    sticky = StickyRanges.standard(models.overhead_crane())
    sticky = StickyRanges(**{**vars(sticky), "damping": (5.0, 9.0)})
    for ours, theirs in zip(sticky.design(6, 2), standard.design(6, 2), strict=True):
        assert 5.0 <= ours.damping <= 9.0
        assert all(getattr(ours, name) == value for name, value in vars(theirs).items())
    ours, theirs = (gym.make(OVERHEAD, disturbances=own) for own in (sticky, "standard"))
    for env in (ours, theirs):
        env.reset(seed=4)
    drawn, other = (env.unwrapped.task.scenarios[0] for env in (ours, theirs))
    assert isinstance(drawn, Sticky)
    assert drawn.winch_friction == other.winch_friction
    env = gym.make(OVERHEAD, disturbances=StickyRanges(damping=(0.0, 50.0)))
    moved = []
    for damping in (0.0, 50.0):
        env.reset(seed=0, options={"scenario": Sticky(damping=damping)})
        for _ in range(20):
            env.step(np.array([0.05, -0.5]))
        moved.append(float(envs.task_of(env).plant.drive_positions[0, 0]))
    assert 0.0 < moved[1] < 0.9 * moved[0]


def test_a_disturbance_of_ones_own_is_checked() -> None:
    with pytest.raises(models.OptionError, match="must be a finite number >= 0"):
        Sticky(damping=-1.0)
    with pytest.raises(models.OptionError, match="low must not exceed high"):
        StickyRanges(damping=(2.0, 1.0))
    with pytest.raises(models.OptionError, match="must be a Sticky"):
        gym.make(OVERHEAD, disturbances=StickyRanges()).reset(options={"scenario": envs.Scenario()})
