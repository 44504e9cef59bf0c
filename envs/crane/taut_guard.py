"""Commands that keep ropes taut, since a rope cannot push.

    band = TautBand(task)
    actions = band.keep(actions)            # or TautGuard(env), below all other controllers

A winch with drum radius r whose rope pulls with T needs the input u = (J/r) L'' - r T.  Around the
planned input the guard leaves what changes the planned pull r T to between `LEAST` and `MOST` of
it.  Where the winch hardly accelerates that is between `LEAST` and `MOST` of the planned input;
counted in pull it holds for a winch whose own inertia takes its input through zero, too.
Other drives are free within their limits.

The load's own motion changes tension as well, which no limit on a command prevents: the guard
makes slack ropes rare, not impossible.
"""

from typing import Any

import numpy as np

from ...feedforward.exact.losses import losses_of
from ...models.errors import OptionError
from ...models.rig.rig import Rope
from ...models.types import Array
from ..laws import AnyEnv, Law, laws_of, task_of, wrap
from .along_plans import AlongPlans
from .plan import CranePlan, layout_of
from .task import CraneTask

LEAST, MOST = 0.35, 1.9
"""Share of the planned pull that commands may leave, and make of it."""


class TautBand:
    """Keeps the commands of n simulations within the band of the plans' pulls."""

    def __init__(self, task: CraneTask) -> None:
        self._task = task
        self._room = AlongPlans(task, self._rooms)

    def keep(self, actions: Array) -> Array:
        """Actions within the band and the limits, (n, drives)."""
        lowest, highest = self.band()
        return np.asarray(np.clip(actions, lowest, highest))

    def band(self) -> tuple[Array, Array]:
        """Lowest and highest action that keep ropes taut, over the limits, (n, drives) each."""
        now, pulls = self._task.rows.parts["feedforward"], self._room.now()
        lowest, highest = now - (MOST - 1.0) * pulls, now + (1.0 - LEAST) * pulls
        # Where a plan itself goes to a limit, something is left still.
        band = self._task.band
        lowest, highest = (np.clip(edge, band.lowest, band.highest) for edge in (lowest, highest))
        return lowest, highest

    def _rooms(self, plan: CranePlan) -> Array:
        return pulls_of(self._task, plan)


def pulls_of(task: CraneTask, plan: CranePlan) -> Array:
    """What ropes pull at their winches along a plan, r T over the limits, (steps + 1, drives).

    Infinite for drives that are no winches.
    """
    drives, columns = len(task.limits), layout_of(task.rig).columns
    inputs = plan.rows[:, columns["feedforward"]]
    rates = plan.rows[:, columns["drives"]][:, drives:]
    pulls = np.full_like(inputs, np.inf)
    losses = losses_of(task.rig)
    if losses is not None:  # what friction takes does not pull
        inputs = losses.delivered(inputs * task.limits, rates) / task.limits
    for column, drive in enumerate(task.rig.drives):
        rope = task.rig.driven(drive)
        if isinstance(rope, Rope):
            change = np.diff(rates[:, column], append=rates[-1, column]) / plan.period
            inertia = rope.inertia_along * task.rig.arm(drive) / task.limits[column]
            pulls[:, column] = np.maximum(inertia * change - inputs[:, column], 0.0)
    return pulls


class GuardLaw(Law):
    """The action, within the band."""

    name = "TautGuard"

    def __init__(self, task: CraneTask) -> None:
        self._band = TautBand(task)
        self.band = self._band.band
        """Lowest and highest action that passes, (n, drives) each."""

    def apply(self, actions: Array) -> Array:
        """Keep the action within the band."""
        return self._band.keep(actions)


def TautGuard(env: AnyEnv) -> Any:
    """Keep what all controllers together ask of winches where their ropes pull.

    Raises
    ------
    OptionError
        `env` is no crane, or another controller stands below, which this one could not see.
    """
    task = task_of(env)
    if not isinstance(task, CraneTask):
        raise OptionError(f"{env} is no crane, TautGuard is for ropes of cranes")
    below = next(laws_of(env), None)
    if below is not None:
        raise OptionError(
            f"TautGuard above {below.name} would not see what that adds; put TautGuard first"
        )
    return wrap(env, GuardLaw(task))
