"""A crane that somebody drives: what the page asks for, what the crane does, step by step.

    session = Session(rig, start)
    session.wishes = replace(session.wishes, velocity=(0.3, 0.0, 0.1))
    session.step()                          # one control period
    session.state()                         # numbers for the page

Every velocity goes through `CraneTask.lead`: what can be stopped is let through, and the exact
inputs of it, feedback and what is learned add up as in the environments.
"""

import warnings
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np

from ... import envs, feedforward
from ...envs.controllers import FeedforwardLaw, PDLaw
from ...envs.crane.mass_estimate import MassLaw
from ...envs.crane.taut_guard import GuardLaw
from ...envs.laws import Law, laws_of
from ...models.errors import FlatrigError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..learned import LearnedLaw, LearnedResidual, base_controller
from ..policy import Policy, shipped
from ..simulate.open_loop import stand_in

SHIFT = 600.0
"""How long an episode lasts; the next one begins where all began [s]."""
RATE = 50.0
"""Control periods per second [Hz], as policies are trained."""
SENSORS = ("encoders", "sway", "full")
"""Sets of sensors, in the order in which a shipped policy is looked for."""


@dataclass(frozen=True)
class Wishes:
    """What the page asks for."""

    velocity: tuple[float, ...]
    """Of the outputs [m/s, rad/s]."""
    feedforward: bool = True
    feedback: bool = True
    estimate: bool = False
    """Whether the load's mass is estimated; needs both."""
    residual: bool = False
    """Whether the policy adds its share; needs the estimate."""
    wind: float = 0.0
    """Force on the load [N]."""
    wind_direction: float = 0.0
    """From the x axis about z [rad]."""
    load_mass: float = 1.0
    """Mass of the load over the one that is reckoned with."""


class Session:
    """A crane with an operator.

    Parameters
    ----------
    rig
        The crane.
    start
        Outputs at which it rests at first, shape (outputs,).
    policy
        For the residual; by default the shipped one, if there is one.
    base
        How its base moves, if one does.

    Raises
    ------
    FlatrigError
        The crane cannot be driven, or not from there, or the policy is not for it.
    """

    def __init__(
        self,
        rig: Rig,
        start: Array,
        policy: Policy | None = None,
        base: feedforward.BaseMotion | None = None,
    ) -> None:
        self.rig = rig
        found = (shipped(rig, sensors) for sensors in SENSORS)
        policy = policy or next((entry for entry in found if entry is not None), None)
        sensors = "encoders" if policy is None else policy.card.sensors
        rate = RATE if policy is None else policy.card.rate
        env = gym.make(
            envs.OWN, rig=rig, reference=feedforward.at_sea(feedforward.hold(start, SHIFT), base),
            sensors=sensors, rate=rate, hold=0.0, nthread=1, massless=stand_in(rig),
        )  # fmt: skip
        self.task: envs.CraneTask = env.unwrapped.task  # type: ignore[attr-defined]
        whole = base_controller(env)
        self.learned = policy is not None
        """Whether there is a policy."""
        if policy is not None:
            whole = LearnedResidual(whole, policy)
        self._laws: dict[type, Law] = {type(law): law for law in laws_of(whole)}
        self._alone = FeedforwardLaw(self.task, None)
        self.wishes = Wishes((0.0,) * len(rig.outputs))
        self.message = ""
        """What the page should say."""
        self.passed = np.zeros(len(rig.outputs))
        """What was let through of the velocity, shape (outputs,)."""
        self._ended = 0.0
        self.begin()

    @property
    def period(self) -> float:
        """Of control [s]."""
        return self.task.period

    @property
    def time(self) -> float:
        """Since the session began [s]."""
        return self._ended + self.period * int(self.task.steps[0])

    def begin(self) -> None:
        """Rest at the start, with the present wind and load."""
        self._ended = self.time
        task = self.task
        self._scenario = self._wanted_scenario()
        task.reset(task.all, [np.random.default_rng(0)], [self._scenario])

    def step(self) -> None:
        """One control period of what the wishes are now."""
        task, wishes = self.task, self.wishes
        if self._wanted_scenario() != self._scenario:
            self._scenario = self._wanted_scenario()
            task.disturb([self._scenario])
        try:
            task.lead([wishes.velocity])
            outcome = task.step(task.acting.of_actions(self._inputs(wishes)))
        except FlatrigError as error:
            self._anew(str(error))
            return
        self.passed = task.rows.parts["output_rates"][0].copy()
        if outcome.reasons[0]:
            self._anew(outcome.reasons[0])

    def state(self) -> dict[str, Any]:
        """The present numbers, by name."""
        task = self.task
        return {
            "time": self.time,
            "load": task.plant.outputs[0].copy(),
            "reference": task.rows.parts["outputs"][0].copy(),
            "wanted": np.array(self.wishes.velocity),
            "velocity": self.passed,
            "tension": task.plant.tensions[0].copy(),
            "input": task.plant.ctrl[0].copy(),
            "drive": task.encoders.positions[0].copy(),
        }

    @property
    def joints(self) -> Array:
        """Where the crane is, shape (nq,)."""
        return np.array(self.task.plant.qpos[0])

    @property
    def planned(self) -> dict[str, float]:
        """Coordinates that the reference asks for now."""
        plan = self.task.plans[0]
        row = int(self.task.steps[0]) - plan.since
        return {name: float(v[min(row, len(v) - 1)]) for name, v in plan.course.items()}

    def _anew(self, reason: str) -> None:
        self.begin()
        self.message = f"{reason}: started anew"

    def _wanted_scenario(self) -> envs.Scenario:
        wishes = self.wishes
        return envs.Scenario(
            load_mass=wishes.load_mass, wind=wishes.wind, wind_direction=wishes.wind_direction
        )

    def _inputs(self, wishes: Wishes) -> Array:
        """Inputs over their limits, (1, drives), of the controllers that are switched on."""
        order: list[type] = []
        both = wishes.feedforward and wishes.feedback
        if both and wishes.residual and self.learned:
            order += [LearnedLaw]
        if both and (wishes.estimate or wishes.residual):
            order += [MassLaw]
        order += [FeedforwardLaw] * wishes.feedforward + [PDLaw] * wishes.feedback
        order += [GuardLaw] * wishes.residual
        actions = np.zeros((1, len(self.task.limits)))
        if not (wishes.feedforward or wishes.feedback):
            return actions + self.task.rows.parts["holding"]
        for kind in order:
            law = self._laws[kind]
            if kind is FeedforwardLaw and not wishes.feedback:
                law = self._alone
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # a residual that fades says so in the shares
                actions = law.apply(actions)
        return actions
