"""What all tasks share: n simulations whose episodes begin, go on step by step, and end.

A task has a plant, a planner whose plans are read row by row, encoders, commands and a reward;
`flatrig.envs.crane.task` puts them together for cranes, `flatrig.envs.hand.task` for hands.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar, Generic, cast

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..models.errors import OptionError
from ..models.types import Array
from ..models.values import bounded
from .common import NOT_FINITE, Ids, Outcome, Steps, none_of
from .gains import Gains, Track
from .option_checks import actions_of, sensors_of, substeps_of
from .plans import Layout, Planner, PlanT
from .ranges import Ranges, ScenarioT
from .rewards import Reward
from .sensing import Observation
from .signals import Band, Commands, Encoders, Rows
from .simulations import Simulations

TIME = "time"
"""Why an episode is truncated."""


class Task(ABC, Generic[PlanT, ScenarioT]):
    """n simulations; a subclass calls `_prepare`, makes its parts, and calls `_start`."""

    num: int
    """Number of simulations n."""
    all: Ids
    """Indices of all simulations, shape (n,)."""
    sensor_sets: ClassVar[tuple[str, ...]] = ("encoders", "full")
    """What can be observed."""
    sensors: str
    """What is observed, one of these."""
    takes_inputs: ClassVar[bool] = True
    """Whether actions are inputs over their limits."""
    period: float
    """Time between two steps [s]."""
    limits: Array
    """Largest magnitudes of the inputs, shape (drives,) [N, N m]."""
    band: Band
    """What actions are clipped to."""
    plant: Simulations[PlanT, ScenarioT]
    """The simulations."""
    planner: Planner[PlanT]
    """Makes the plans of episodes."""
    disturbances: Ranges[ScenarioT]
    """What scenarios are drawn from."""
    scenarios: list[ScenarioT]
    """Scenario of each simulation's episode."""
    plans: list[PlanT]
    """Plan of each simulation's episode, once it has begun."""
    rows: Rows
    """The plans' rows at the present steps."""
    encoders: Encoders
    """What is measured."""

    def _prepare(
        self, num: int, sensors: str, rate: float, timestep: float, hold: float,
        nthread: int | None,
    ) -> int:  # fmt: skip
        """Check and keep the options that all tasks share; the substeps of a control period."""
        bounded("number of simulations", num, least=1, whole=True)
        bounded("hold", hold, least=0, unit="s")
        if nthread is not None:
            bounded("nthread", nthread, least=1, whole=True)
        self.num, self.sensors = int(num), sensors_of(sensors, self.sensor_sets)
        self.all = np.arange(self.num, dtype=np.int32)
        substeps = substeps_of(rate, timestep)
        self.period = substeps * timestep
        return substeps

    def _start(self, layout: Layout, levers: Array, length: float, band: Band) -> None:
        """Prepare for first episodes; levers of outputs and a length [m] are the reward's."""
        num = self.num
        self.rows = Rows(layout, num, self.planner.fixed)
        self.encoders = Encoders(self.plant, self.period)
        self._observation = self._make_observation()
        self._reward = Reward(num, levers, layout.drives, length)
        self._undisturbed: ScenarioT = self.disturbances.scenario_type()
        self.scenarios = [self._undisturbed] * num
        self.plans = cast("list[PlanT]", [self.planner.fixed] * num)
        self._new = set(range(num))
        self._steps, self._countdown = np.zeros(num, dtype=np.int64), 0
        self.band, self._commands = band, Commands(self._reward.change, band)
        self._scale, self._one = np.tile(self.limits, (num, 1)), np.ones(num, dtype=np.int64)
        self._names = self.action_names

    @property
    def observation_names(self) -> tuple[str, ...]:
        """Names of the entries of an observation."""
        return self._observation.names

    @property
    @abstractmethod
    def action_names(self) -> tuple[str, ...]:
        """Names of the entries of an action."""

    @property
    def steps(self) -> Steps:
        """Steps of each simulation's episode so far, shape (n,), live."""
        return self._steps

    def reset(
        self,
        ids: Ids,
        generators: Sequence[np.random.Generator],
        scenarios: Sequence[ScenarioT | None] | None = None,
        references: Sequence[object] | None = None,
    ) -> None:
        """Begin new episodes in some simulations.

        Parameters
        ----------
        ids
            Of the simulations, sorted.
        generators
            One for each of them; draws what is not given.
        scenarios, references
            For each of them a scenario and a reference, or None to draw it.

        Raises
        ------
        OptionError
            A scenario is none or has friction that the task was made without, or a reference is
            none; then nothing has changed.  Or the process was forked from the task's, whose
            threads it lacks.
        PathError, SmoothnessError
            A reference cannot be followed.
        """
        self.plant.require_threads()
        scenarios = [None] * len(ids) if scenarios is None else scenarios
        references = [None] * len(ids) if references is None else references
        for scenario in scenarios:
            self.disturbances.check(scenario)
        plans = [
            self.planner.draw(generator) if reference is None else self.planner.plan(reference)
            for generator, reference in zip(generators, references, strict=True)
        ]
        drawn = [
            self.disturbances.draw(generator) if scenario is None else scenario
            for generator, scenario in zip(generators, scenarios, strict=True)
        ]
        for sim, scenario, plan in zip(ids.tolist(), drawn, plans, strict=True):
            self.scenarios[sim], self.plans[sim] = scenario, plan
        inputs = np.array([plan.inputs for plan in plans])
        joints = np.array([self.plant.at_rest(plan) for plan in plans])
        self.plant.reset(ids, joints, inputs, drawn)
        self._new.difference_update(ids.tolist())
        self._steps[ids] = 0
        self._reward.terms[ids] = 1.0
        self._commands.reset(ids, drawn, inputs / self.limits)
        self.rows.follow(ids, plans)
        self.rows.look(self._steps)
        self.encoders.reset(ids, drawn, self.rows.parts["drives"])
        # No episode can be over before so many steps: spares looking at each of them.
        self._countdown = int((self.rows.length - self._steps).min())

    @property
    def commands(self) -> Array:
        """What was asked of the drives in the last step, over their limits, (n, drives), live."""
        return self._commands.last

    def step(self, actions: ArrayLike, ids: Ids | None = None) -> Outcome:
        """Hold inputs over one control period.

        Parameters
        ----------
        actions
            Inputs over their limits, (n, drives); clipped to `band`, mostly [-1, 1].
        ids
            The simulations to step, sorted; None for all.  The others stay as they are.

        Raises
        ------
        OptionError
            Actions have another shape or are not finite numbers, an episode has not begun, or the
            process was forked from the task's, whose threads it lacks.
        """
        self.plant.require_threads()
        wanted = actions_of(actions, self._scale.shape, self._names, lambda: none_of(ids, self.num))
        self._require_begun(ids)
        reward = self._advance(wanted, None) if ids is None else self._advance_some(wanted, ids)
        return self._judge(reward, ids)

    def _require_begun(self, ids: Ids | None) -> None:
        """Refuse to go on with what has not begun."""
        if self._new and (ids is None or not self._new.isdisjoint(ids.tolist())):
            raise OptionError("no episode has begun, call reset before step")

    def _take_over(self, ids: Ids, plans: Sequence[PlanT]) -> None:
        """Go on with other plans from the present steps on."""
        for sim, plan in zip(ids.tolist(), plans, strict=True):
            self.plans[sim] = plan
        self.rows.follow(ids, plans)
        self.rows.look(self._steps)
        self._countdown = int((self.rows.length - self._steps).min())

    def observation(self) -> Array:
        """What the sensors say, (n, entries), scaled to order one; the caller's own."""
        return self._observation.read(self._commands.last)

    @abstractmethod
    def gains(self, track: Track = "moving") -> Gains:
        """Gains of a PD controller for this task."""

    @abstractmethod
    def looks(self) -> mujoco.MjModel:
        """The model with everything that is drawn."""

    def info(self) -> dict[str, Any]:
        """The truth, for evaluation: arrays (n, ...) that are the caller's own."""
        info: dict[str, Any] = {name: values.copy() for name, values in self._truth().items()}
        tracking, smoothness = self._reward.terms.T.copy()
        info["reward_terms"] = {"tracking": tracking, "smoothness": smoothness}
        return info

    def info_of(self, sim: int) -> dict[str, Any]:
        """The same of one simulation; what is one number in each is a plain number."""
        info: dict[str, Any] = self._truth()
        for name, values in info.items():
            info[name] = values[sim].copy() if values.ndim > 1 else float(values[sim])
        tracking, smoothness = self._reward.terms[sim].tolist()
        info["reward_terms"] = {"tracking": tracking, "smoothness": smoothness}
        return info

    @abstractmethod
    def _truth(self) -> dict[str, NDArray[Any]]:
        """What `info` tells beside the terms of the reward, (n, ...) each, live or new."""

    @abstractmethod
    def _make_observation(self) -> Observation:
        """What a policy sees; plant, rows and encoders are ready."""

    def _advance(self, actions: Array, ids: Ids | None) -> Array:
        """One control period of all simulations, or in the plant of some; the rewards."""
        inputs = self._commands.send(actions, self._steps)
        if ids is None:
            np.multiply(inputs, self._scale, self.plant.ctrl)
        else:
            self.plant.ctrl[ids] = (inputs * self.limits)[ids]
        self.plant.step(ids)
        np.add(self._steps, self._one, self._steps)
        self.rows.look(self._steps)
        self.encoders.step(self.rows.parts["drives"])
        return self._reward.of(self.plant.outputs, self.rows.parts["outputs"])

    def _advance_some(self, actions: Array, ids: Ids) -> Array:
        """One control period of some simulations; the memory of the others is put back."""
        idle = none_of(ids, self.num)
        last = self._commands.last
        memory = (self._steps, last, self._reward.terms, *self.encoders.memory)
        before = [values[idle] for values in memory]
        reward = self._advance(np.where(idle[:, None], last, actions), ids)
        for values, old in zip(memory, before, strict=True):
            values[idle] = old
        self.rows.look(self._steps)
        return reward

    def _judge(self, reward: Array, ids: Ids | None) -> Outcome:
        """Which episodes are over, and why."""
        outcome = Outcome(
            reward, np.zeros(self.num, bool), np.zeros(self.num, bool), [""] * self.num
        )
        self._countdown -= 1
        if ids is None and self._countdown > 0 and self.plant.sound:
            return outcome
        stepped = np.zeros(self.num, bool)
        stepped[self.all if ids is None else ids] = True
        for sim in np.flatnonzero(stepped).tolist():
            reason = self.plant.why(sim)
            outcome.terminated[sim] = bool(reason)
            if not reason and self._steps[sim] >= self.rows.length[sim]:
                outcome.truncated[sim], reason = True, TIME
            if reason == NOT_FINITE:
                self._clear(sim)
            outcome.reasons[sim] = reason
        reward[outcome.terminated | ~stepped] = 0.0
        return outcome

    def _clear(self, sim: int) -> None:
        """Put a simulation that is lost back to rest, so that nothing it says is not a number."""
        ids, undisturbed = self.all[sim : sim + 1], [self._undisturbed]
        home = self.plant.home_inputs
        self.plant.reset(ids, self.plant.home[None], home, undisturbed)
        self.encoders.reset(ids, undisturbed, self.rows.parts["drives"])
        self._reward.terms[sim] = 0.0


AnyTask = Task[Any, Any]
"""A task of cranes or of hands."""
