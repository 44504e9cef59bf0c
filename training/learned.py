"""A trained residual in front of an environment.

    env = base_controller(gym.make("flatrig/OverheadCrane-v0", disturbances="standard"))
    env = LearnedResidual(env)          # the policy that is shipped for the rig and its sensors

A policy acts where it was trained.  Outside, its residual fades: in proportion to how far a move
leaves the box of the moves it was trained on, or is faster than these, down to none, and a warning
says so once an episode.
"""

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..envs import PD, Feedforward, MassEstimate, TautGuard
from ..envs.controllers import FeedforwardLaw, PDLaw
from ..envs.crane.mass_estimate import MassLaw
from ..envs.crane.task import CraneTask
from ..envs.episodes import AnyTask
from ..envs.hand.task import HandTask
from ..envs.laws import AnyEnv, Law, laws_of, refuse_below, task_of, wrap
from ..models import Hand, Rig
from ..models.errors import OptionError
from ..models.types import Array
from .features import Features, crane_features, hand_features
from .gate import Gate
from .policy import Card, Policy, fingerprint_of, shipped

FASTER = 1.5
"""How much faster than in the first moves of training drives may be."""
BEYOND = (0.05, 0.25)
"""How far a move may leave what was trained, as a share of it, before the residual begins to fade,
and from where on there is none."""


class LearnedLaw(Law):
    """Action from above + what the policy adds, over the limits."""

    name = "LearnedResidual"

    def __init__(self, task: AnyTask, policy: Policy, mass: MassLaw | None) -> None:
        check(policy.card, task)
        self._task, self._policy = task, policy
        card = policy.card
        self._units = np.array(card.units)
        self._features = features_of(task, mass, np.array(card.speeds), card.time_constants)
        if self._features.names != card.feature_names:
            odd = sorted(set(self._features.names) ^ set(card.feature_names)) or ["their order"]
            raise OptionError(
                f"the policy for {card.plant} was trained with other features: {', '.join(odd[:5])}"
            )
        self._gate = Gate(np.array(card.usual), *card.gate, task.period)
        self._drives = len(card.units)
        self._trust = np.ones((task.num, 1))
        self.heads = np.zeros((task.num, len(card.heads)))
        """What the policy believes the plant to be like, (n, heads), by `Card.heads`."""

    @property
    def memory(self) -> tuple[Array, ...]:
        """What features and gates remember, how far the policy is trusted, what it believes."""
        num = self._task.num
        own = (self._trust, self.heads)
        return *own, *self._features.memory(num), *self._gate.memory(num)

    def apply(self, actions: Array) -> Array:
        """Add the residual."""
        return np.asarray(actions + self.residual())

    def residual(self) -> Array:
        """What the policy adds, over the limits, (n, drives)."""
        fresh = self._task.steps == 0
        if fresh.any():
            self._trust[fresh, 0] = [self._trusted(i) for i in np.flatnonzero(fresh).tolist()]
        features = self._features.look(fresh)
        share = self._gate.open(self._task.encoders.errors[:, : self._drives], fresh) * self._trust
        wanted, self.heads = self._policy.network(features)
        reach = self._policy.card.reach
        return np.asarray(share * self._units * np.clip(wanted, -reach, reach))

    def _trusted(self, sim: int) -> float:
        """Share of the residual that counts along a simulation's plan."""
        excess = beyond(self._policy.card, self._task, sim)
        share = float(np.clip((BEYOND[1] - excess) / (BEYOND[1] - BEYOND[0]), 0.0, 1.0))
        if share < 1.0:
            warnings.warn(
                f"the policy for {self._policy.card.plant} was not trained on such a move, which "
                f"is {100 * excess:.0f} % beyond its own in place or speed: its residual counts "
                f"{100 * share:.0f} %",
                stacklevel=2,
            )
        return share


def LearnedResidual(env: AnyEnv, policy: Policy | str | None = None) -> Any:
    """Add what a trained policy says to what comes from above.

    Parameters
    ----------
    env
        A crane with `MassEstimate(Feedforward(PD(...)))`, or a hand with `Feedforward(PD(...))`,
        single or vector, of the sensors and the control rate of the policy.
    policy
        The policy, the path of one, or None for the one shipped for the rig and its sensors.

    Raises
    ------
    OptionError
        There is no such policy, it is for another rig, hand, control rate, or set of sensors, or
        the controllers that it was trained on do not stand below.
    """
    task = task_of(env)
    refuse_below(env, "LearnedResidual")
    if isinstance(policy, str | Path):
        path, policy = str(policy), Policy.load(policy)
        options: dict[str, Any] = {"policy": path}
    elif policy is None:
        policy, options = _shipped_for(task), {}
    else:
        options = {"policy": policy}
    laws = list(laws_of(env))
    masses = [law for law in laws if isinstance(law, MassLaw)]
    if isinstance(task, HandTask) and not all(
        any(isinstance(law, kind) for law in laws) for kind in (PDLaw, FeedforwardLaw)
    ):
        raise OptionError(
            "LearnedResidual was trained on top of Feedforward(PD(env)), which does not stand below"
        )
    if isinstance(task, CraneTask) and not masses:
        raise OptionError(
            "LearnedResidual was trained on top of MassEstimate(Feedforward(PD(env))), there is no "
            "MassEstimate below it"
        )
    law = LearnedLaw(task, policy, masses[0] if masses else None)
    _check_feedback(policy.card, laws)
    return wrap(env, law, **options)


def _check_feedback(card: Card, laws: Sequence[Law]) -> None:
    """The PD below is the one that the policy was trained on."""
    for law in laws:
        if isinstance(law, PDLaw) and not np.allclose(law.gains, card.gains, rtol=1e-4):
            raise OptionError(
                f"the policy for {card.plant} was trained on a PD with other gains than the one "
                "below it; take PD(env) with its own, or train one for these"
            )


def base_controller(env: AnyEnv) -> Any:
    """What a residual is learned on top of, around an environment."""
    if isinstance(task_of(env), HandTask):
        return Feedforward(PD(env))
    return MassEstimate(Feedforward(PD(TautGuard(env))))


def _shipped_for(task: AnyTask) -> Policy:
    policy = shipped(plant_of(task), task.sensors)
    if policy is None:
        raise OptionError(
            f"no policy is shipped for {plant_name(task)} with sensors={task.sensors!r}; train one "
            "with `flatrig train` and give its path"
        )
    return policy


def plant_of(task: AnyTask) -> Rig | Hand:
    """A task's rig or hand."""
    assert isinstance(task, CraneTask | HandTask)
    return task.hand if isinstance(task, HandTask) else task.rig


def plant_name(task: AnyTask) -> str:
    """Name of a task's rig or hand."""
    return plant_of(task).name


def features_of(
    task: AnyTask, mass: MassLaw | None, speeds: Array, time_constants: tuple[float, ...]
) -> Features:
    """The features of a task's simulations."""
    if isinstance(task, HandTask):
        return hand_features(task, time_constants)
    assert isinstance(task, CraneTask)
    assert mass is not None
    return crane_features(task, mass, speeds, time_constants)


def beyond(card: Card, task: AnyTask, sim: int) -> float:
    """How far a simulation's plan goes beyond what a policy was trained on, as a share of it."""
    plan, drives = task.plans[sim], len(task.limits)
    outputs = task.rows.parts["outputs"].shape[1]
    along = plan.rows[:, 2 * drives :][:, :outputs]
    low, high = np.array(card.box)
    span = np.maximum(high - low, 0.1 * np.max(high - low))
    outside = np.maximum(low - along.min(axis=0), along.max(axis=0) - high) / span
    fast = np.abs(plan.rows[:, drives : 2 * drives]).max(axis=0) / (FASTER * np.array(card.speeds))
    return float(max(0.0, outside.max(), fast.max() - 1.0))


def check(card: Card, task: AnyTask) -> None:
    """Make sure that a task's plant is what a policy was trained on.

    Raises
    ------
    OptionError
        It is another rig or hand, control rate, or set of sensors or drives.  A rig with other
        parts or numbers is another one, whatever its name; disturbances make no other rig.
    """
    name = plant_name(task)
    if name != card.plant:
        raise OptionError(f"the policy is for {card.plant}, the environment's is {name}")
    if card.fingerprint != fingerprint_of(plant_of(task)):
        raise OptionError(
            f"the policy is for {card.plant} with other parts or numbers than the environment's; "
            "train one for these with `flatrig train`"
        )
    if abs(task.period * card.rate - 1.0) > 1e-6:
        raise OptionError(
            f"the policy for {name} acts at {card.rate:g} Hz, the environment at "
            f"{1.0 / task.period:g} Hz"
        )
    if task.sensors != card.sensors:
        raise OptionError(
            f"the policy for {name} needs sensors={card.sensors!r}, the environment has "
            f"{task.sensors!r}"
        )
    if task.acting.names != card.action_names:
        raise OptionError(
            f"the policy for {name} acts on {', '.join(card.action_names)}, the environment on "
            f"{', '.join(task.acting.names)}"
        )
