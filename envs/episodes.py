"""What all tasks share: n simulations whose episodes begin, go on step by step, and end.

A task has a plant, a planner whose plans are read row by row, encoders, commands and a reward;
`flatrig.envs.crane.task` puts them together for cranes, `flatrig.envs.hand.task` for hands.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..models.errors import OptionError
from ..models.types import Array, Mask
from .crane.disturbances import Scenario
from .crane.plant import NOT_FINITE, Ids
from .crane.tuning import Gains, Track
from .option_checks import actions_of
from .rewards import NAMES as REWARD_NAMES
from .rewards import Reward
from .signals import Commands, Encoders, Rows

TIME = "time"
"""Why an episode is truncated."""


class Outcome(NamedTuple):
    """What a step did to each of n simulations; arrays are the caller's own."""

    reward: Array
    """(n,), in [0, 1]."""
    terminated: Mask
    """(n,): the physics left the range in which the model is valid."""
    truncated: Mask
    """(n,): the time is over."""
    reasons: list[str]
    """Why, for each simulation; "" while it goes on."""


class Task:
    """n simulations; subclasses make the parts that are declared here, then call `_start`."""

    num: int
    limits: Array
    """Of the inputs, (drives,)."""
    period: float
    """Between two steps [s]."""
    all: Ids
    """Of all simulations."""
    plant: Any
    planner: Any
    disturbances: Any
    undisturbed: Any = Scenario()
    scenarios: list[Any]
    """Of each simulation's episode."""
    plans: list[Any]
    """Of each simulation's episode."""
    rows: Rows
    encoders: Encoders
    _observation: Any
    _reward: Reward

    def _start(self) -> None:
        """Prepare for first episodes."""
        num = self.num
        self.scenarios = [self.undisturbed] * num
        self.plans = [self.planner.fixed] * num
        self._new = set(range(num))
        self._steps = np.zeros(num, dtype=np.int64)
        self._countdown = 0
        self._commands = Commands(self._reward.change)
        self._scale = np.tile(self.limits, (num, 1))
        self._one = np.ones(num, dtype=np.int64)

    @property
    def observation_names(self) -> tuple[str, ...]:
        """Names of the entries of an observation."""
        names: tuple[str, ...] = self._observation.names
        return names

    @property
    def action_names(self) -> tuple[str, ...]:
        """Names of the entries of an action."""
        raise NotImplementedError

    @property
    def steps(self) -> NDArray[np.int64]:
        """Of each simulation's episode so far, (n,), live."""
        return self._steps

    def reset(
        self,
        ids: Ids,
        generators: Sequence[np.random.Generator],
        scenarios: Sequence[Any] | None = None,
        references: Sequence[Any] | None = None,
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
            none; then nothing has changed.
        PathError, SmoothnessError
            A reference cannot be followed.
        """
        nothing: list[Any] = [None] * len(ids)
        scenarios = nothing if scenarios is None else scenarios
        references = nothing if references is None else references
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
        joints = np.array([self.plant.at_rest(plan.start) for plan in plans])
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

    def step(self, actions: ArrayLike, ids: Ids | None = None) -> Outcome:
        """Hold inputs over one control period.

        Parameters
        ----------
        actions
            Inputs over their limits, (n, drives); clipped to [-1, 1].
        ids
            The simulations to step, sorted; None for all.  The others stay as they are.

        Raises
        ------
        OptionError
            Actions have another shape or are not numbers, or an episode has not begun.
        """
        given = actions_of(actions, self._scale.shape)
        if self._new and (ids is None or not self._new.isdisjoint(ids.tolist())):
            raise OptionError("no episode has begun, call reset before step")
        reward = self._advance(given, None) if ids is None else self._advance_some(given, ids)
        return self._judge(reward, ids)

    def observation(self) -> Array:
        """What the sensors say, (n, entries), scaled to order one; the caller's own."""
        seen: Array = self._observation.read(self._commands.last)
        return seen

    def gains(self, track: Track = "moving") -> Gains:
        """Of a PD controller for this task."""
        raise NotImplementedError

    def info(self) -> dict[str, Any]:
        """The truth, for evaluation: arrays (n, ...) that are the caller's own."""
        raise NotImplementedError

    def info_of(self, sim: int) -> dict[str, Any]:
        """The same of one simulation, terms of the reward as plain numbers."""
        raise NotImplementedError

    def _terms(self) -> dict[str, Array]:
        """Terms of the reward by name, (n,) each."""
        terms = self._reward.terms.copy()
        return {name: terms[:, k] for k, name in enumerate(REWARD_NAMES)}

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
        idle = np.ones(self.num, dtype=bool)
        idle[ids] = False
        last = self._commands.last
        memory = (self._steps, last, self._reward.terms, *self.encoders.memory)
        kept = [values[idle] for values in memory]
        reward = self._advance(np.where(idle[:, None], last, actions), ids)
        for values, old in zip(memory, kept, strict=True):
            values[idle] = old
        self.rows.look(self._steps)
        return reward

    def _judge(self, reward: Array, ids: Ids | None) -> Outcome:
        """Which episodes are over, and why."""
        over = Outcome(reward, np.zeros(self.num, bool), np.zeros(self.num, bool), [""] * self.num)
        self._countdown -= 1
        if ids is None and self._countdown > 0 and self.plant.sound:
            return over
        stepped = np.zeros(self.num, bool)
        stepped[self.all if ids is None else ids] = True
        for sim in np.flatnonzero(stepped).tolist():
            over.reasons[sim] = self.plant.why(sim)
            over.terminated[sim] = bool(over.reasons[sim])
            late = self._steps[sim] >= self.rows.length[sim]
            over.truncated[sim] = late and not over.terminated[sim]
            if over.truncated[sim]:
                over.reasons[sim] = TIME
            if over.reasons[sim] == NOT_FINITE:
                self._clear(sim)
        reward[over.terminated | ~stepped] = 0.0
        return over

    def _clear(self, sim: int) -> None:
        """Put a simulation that is lost back to rest, so that nothing it says is not a number."""
        ids, nothing = self.all[sim : sim + 1], [self.undisturbed]
        home = self.plant.home_inputs
        self.plant.reset(ids, self.plant.home[None], home, nothing)
        self.encoders.reset(ids, nothing, self.rows.parts["drives"])
        self._reward.terms[sim] = 0.0
