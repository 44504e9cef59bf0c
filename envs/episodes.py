"""What all tasks share: n simulations whose episodes begin, go on step by step, and end.

What a task has is in `flatrig.envs.task_parts`; `flatrig.envs.crane.task` puts it together for
cranes, `flatrig.envs.hand.task` for hands.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..models.errors import OptionError
from ..models.types import Array
from .common import NOT_FINITE, TIME, Ids, Outcome, none_of
from .option_checks import actions_of
from .plans import PlanT
from .ranges import ScenarioT
from .states import Saving


class Task(Saving[PlanT, ScenarioT]):
    """n simulations whose episodes begin, go on and end."""

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
        drawn = self._scripted(ids, generators, drawn)
        for sim, scenario, plan in zip(ids.tolist(), drawn, plans, strict=True):
            self.scenarios[sim], self.plans[sim] = scenario, plan
        inputs = np.array([plan.inputs for plan in plans])
        joints = np.array([self.plant.at_rest(plan) for plan in plans])
        self.plant.reset(ids, joints, inputs, drawn)
        self._new.difference_update(ids.tolist())
        self._told.begin(ids, drawn)
        self.over[ids], self._steps[ids] = False, 0
        self._reward.terms[ids] = 1.0
        self._commands.reset(ids, drawn, inputs / self.limits)
        self.rows.follow(ids, plans)
        self.rows.look(self._steps)
        self.encoders.reset(ids, drawn, self.rows.parts["drives"])
        if self._noise is not None:
            self._noise.reset(ids, generators)
        # No episode can be over before so many steps: spares looking at each of them.
        self._countdown = int((self.lengths - self._steps).min())

    def step(self, actions: ArrayLike, ids: Ids | None = None) -> Outcome:
        """Hold inputs over one control period.

        Parameters
        ----------
        actions
            Inputs over their limits, (n, actions); clipped to `band`, mostly [-1, 1].
        ids
            The simulations to step, sorted; None for all.  The others stay as they are.

        Raises
        ------
        OptionError
            Actions have another shape or are not finite numbers, an episode has not begun, or the
            process was forked from the task's, whose threads it lacks.
        """
        names = self.action_names
        wanted = actions_of(actions, (self.num, len(names)), names, lambda: none_of(ids, self.num))
        return self.hold(wanted, ids)

    def hold(self, actions: Array, ids: Ids | None = None) -> Outcome:
        """The same, of actions that are known to be finite and of the right shape."""
        return self._hold(self.acting.of_drives(actions), ids)

    def _hold(self, wanted: Array, ids: Ids | None) -> Outcome:
        """The same with inputs of all drives, (n, drives)."""
        self.plant.require_threads()
        self._require_begun(ids)
        reward = self._advance(wanted, None) if ids is None else self._advance_some(wanted, ids)
        if self._noise is not None:
            self._noise.step(self.all if ids is None else ids)
        return self._judge(reward, ids)

    def _scripted(
        self, ids: Ids, generators: Sequence[np.random.Generator], drawn: list[ScenarioT]
    ) -> list[ScenarioT]:
        """Scenarios that episodes begin with, where something else says so."""
        return drawn

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
        self._countdown = int((self.lengths - self._steps).min())

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
        lengths = self.lengths
        for sim in np.flatnonzero(stepped).tolist():
            reason = self.plant.why(sim)
            outcome.terminated[sim] = bool(reason)
            if not reason and self._steps[sim] >= lengths[sim]:
                outcome.truncated[sim], reason = True, TIME
            if reason == NOT_FINITE:
                self._clear(sim)
            outcome.reasons[sim] = reason
            self._told.end(sim, reason)
        self.over |= outcome.terminated | outcome.truncated
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
