"""Cranes whose episodes run: redirected, led by an operator, disturbed, saved, and gone on with."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import OptionError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..common import Ids, none_of
from ..episodes import Task
from .changes import Changes
from .disturbances import Disturbances, Scenario
from .drive_band import PowerLimits
from .lead import Line
from .load_sensors import LoadSensors
from .plan import CranePlan, redirected
from .plant import Plant
from .references import continuing


class LiveTask(Task[CranePlan, Scenario]):
    """n simulations of a rig; `CraneTask` makes their parts."""

    rig: Rig
    plant: Plant
    disturbances: Disturbances
    loads: LoadSensors | None
    """What is measured of the loads, None with encoders only."""
    _lines: dict[int, Line]
    _power: PowerLimits
    _changes: Changes

    def reset(
        self,
        ids: Ids,
        generators: Sequence[np.random.Generator],
        scenarios: Sequence[Scenario | None] | None = None,
        references: Sequence[object] | None = None,
    ) -> None:
        """Begin new episodes in some simulations, see `flatrig.envs.episodes.Task.reset`."""
        super().reset(ids, generators, scenarios, references)
        if self.plant.base is not None:
            self.plant.set_off(ids, self.plans)
            drawn = [self.scenarios[sim] for sim in ids.tolist()]
            self.encoders.reset(ids, drawn, self.rows.parts["drives"])
        for sim in ids.tolist():
            self._lines.pop(sim, None)
        if self.loads is not None:
            self.loads.reset(ids, generators, self.rows.length)

    def redirect(self, references: Sequence[object], ids: Ids | None = None) -> None:
        """Give simulations whose episodes run another reference, from the present step on.

        The episode then lasts until the `hold` after the new arrival.  An observation from before
        does not know of it, `observation` does.

        Parameters
        ----------
        references
            For each a path whose time 0 is now and which continues how the plan moves, or a
            function that makes one of the `State` in which that is::

                lambda state: feedforward.connected(state.derivatives, goal, duration)

        ids
            Of the simulations, sorted; None for all.

        Raises
        ------
        OptionError
            No episode has begun, a reference is none, or it asks for more than drives or ropes can
            give; then nothing has changed.
        PathError, SmoothnessError
            A reference cannot be followed, or does not continue the plan.
        """
        ids = self.all if ids is None else ids
        self._require_begun(ids)
        plans = []
        for sim, reference in zip(ids.tolist(), references, strict=True):
            plan, step = self.plans[sim], int(self.steps[sim])
            state = plan.state(self.rig, step)
            path = continuing(reference, state)
            plans.append(redirected(self.rig, plan, step, state, path, self.planner.hold))
        for sim in ids.tolist():
            self._lines.pop(sim, None)
        self._take_over(ids, plans)
        if self.loads is not None:
            self.loads.last(ids, self.rows.length)

    def lead(self, velocities: ArrayLike, ids: Ids | None = None) -> None:
        """Lead simulations whose episodes run by velocities of their outputs, in the next step.

        The first time a simulation leaves its plan.  A step in which it is not led stops it, and
        the episode ends when it would have.  Controllers that need a whole plan (`SwingDamping`,
        `LQR`, `Observer`) make theirs anew in each step, which takes 50 ms to a second.

        Parameters
        ----------
        velocities
            What the outputs are to do, (len(ids), outputs) [m/s, rad/s]; as much of it is let
            through as the crane can be stopped from, see `flatrig.feedforward.Stream`.
        ids
            Of the simulations, sorted; None for all.

        Raises
        ------
        OptionError
            No episode has begun, or one was led already in this step.
        PathError
            Velocities are not as many finite numbers, or a crane cannot come to rest from where
            its plan is.
        """
        ids = self.all if ids is None else ids
        self._require_begun(ids)
        plans: list[CranePlan] = []
        for sim, velocity in zip(ids.tolist(), np.asarray(velocities, float), strict=True):
            step = int(self.steps[sim])
            line = self._lines.get(sim) or Line(self.rig, self.plans[sim], step)
            if line.step != step:
                raise OptionError(f"simulation {sim} was led in this step already; call step first")
            plans.append(line.tick(velocity))
            self._lines[sim] = line
        self._take_over(ids, plans)

    def disturb(self, scenarios: Sequence[Scenario], ids: Ids | None = None) -> None:
        """Let simulations whose episodes run go on as other plants.

        Parameters
        ----------
        scenarios
            For each, of which masses, friction and wind count: what else is drawn at the start of
            an episode stays.
        ids
            Of the simulations, sorted; None for all.

        Raises
        ------
        OptionError
            No episode has begun, or a scenario is none, or has friction that the task was made
            without; then nothing has changed.
        """
        ids = self.all if ids is None else ids
        self._require_begun(ids)
        for scenario in scenarios:
            self.disturbances.check(scenario)
        for sim, scenario in zip(ids.tolist(), scenarios, strict=True):
            self.scenarios[sim] = scenario
        self._told.begin(ids, scenarios)
        self.plant.change(ids, scenarios)

    def _scripted(
        self, ids: Ids, generators: Sequence[np.random.Generator], drawn: list[Scenario]
    ) -> list[Scenario]:
        each = zip(ids.tolist(), generators, drawn, strict=True)
        return [self._changes.begin(*episode) for episode in each]

    def _change(self, ids: Ids) -> None:
        """Let plants change whose time has come."""
        for sim in ids.tolist():
            # Times are decimal numbers, as periods are: a rounding error must not make one late.
            time = self.period * (float(self.steps[sim]) + 1e-6)
            scenario = self._changes.due(sim, time)
            if scenario is not None:
                self.disturb([scenario], self.all[sim : sim + 1])

    def _advance(self, actions: Array, ids: Ids | None) -> Array:
        if self._changes.any:
            self._change(self.all if ids is None else ids)
        for sim in (self.all if ids is None else ids).tolist() if self._lines else ():
            if sim in self._lines and self._lines[sim].step == self.steps[sim]:
                self.lead(np.zeros((1, len(self.rig.outputs))), self.all[sim : sim + 1])
        reward = super()._advance(self._power.keep(actions), ids)
        if self.loads is not None:
            self.loads.step(self.steps)
        return reward

    def _advance_some(self, actions: Array, ids: Ids) -> Array:
        idle = none_of(ids, self.num)
        memory = () if self.loads is None else self.loads.memory
        before = [values[idle] for values in memory]
        reward = super()._advance_some(actions, ids)
        for values, old in zip(memory, before, strict=True):
            values[idle] = old
        return reward

    def _clear(self, sim: int) -> None:
        super()._clear(sim)
        if self.loads is not None:
            self.loads.rest(sim)

    def _memory(self) -> tuple[Array, ...]:
        return (*super()._memory(), *(() if self.loads is None else self.loads.memory))

    def _more(self, sim: int) -> dict[str, Any]:
        more = super()._more(sim)
        if self.loads is not None:
            more["noise"] = self.loads.noise_of(sim)
        more["changes"] = self._changes.coming(sim)
        if sim in self._lines:
            more["line"] = self._lines[sim]
        return more

    def _take_more(self, sim: int, more: Mapping[str, Any]) -> None:
        super()._take_more(sim, more)
        self._changes.take(sim, more["changes"])
        self._lines.pop(sim, None)
        if "line" in more:
            self._lines[sim] = more["line"]
        if self.loads is not None:
            self.loads.take_noise(sim, more["noise"])
