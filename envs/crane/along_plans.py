"""Numbers that belong to a plan, looked up at the present steps of n simulations."""

from collections.abc import Callable
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from ...models.types import Array
from ..episodes import Task
from .plan import CranePlan


class AlongPlans:
    """What a function makes of plans, made once for each and read step by step.

    Parameters
    ----------
    task
        The simulations.
    table
        Gives the numbers of a plan, shape (steps, ...); the last ones hold on.
    every
        Steps from one row of the table to the next.
    """

    def __init__(
        self, task: Task[CranePlan, Any], table: Callable[[CranePlan], Array], every: int = 1
    ) -> None:
        self._task, self._table, self._every = task, table, every
        self._known: WeakKeyDictionary[CranePlan, Array] = WeakKeyDictionary()
        self._plans: list[CranePlan] = []
        self._rows = np.zeros(0)
        self._first = self._last = self._since = np.zeros(task.num, dtype=np.int64)

    def now(self, ahead: int = 0) -> Array:
        """The numbers at the present steps, or some steps ahead, shape (n, ...)."""
        task = self._task
        if len(self._plans) != task.num or any(
            plan is not old for plan, old in zip(task.plans, self._plans, strict=True)
        ):
            self._follow()
        row = (task.steps + ahead - self._since) // self._every
        return np.asarray(self._rows[self._first + np.minimum(row, self._last)])

    def of(self, plan: CranePlan) -> Array:
        """The numbers of one plan."""
        if plan not in self._known:
            self._known[plan] = self._table(plan)
        return self._known[plan]

    def _follow(self) -> None:
        """Lay the tables of the present plans one after the other, each once."""
        self._plans = list(self._task.plans)
        different = list({id(plan): plan for plan in self._plans}.values())
        tables = [self.of(plan) for plan in different]
        starts = np.cumsum([0, *(len(table) for table in tables)]).tolist()
        where = {id(plan): place for plan, place in zip(different, starts, strict=False)}
        self._rows = np.concatenate(tables)
        self._first = np.array([where[id(plan)] for plan in self._plans])
        self._last = np.array([len(self.of(plan)) - 1 for plan in self._plans])
        self._since = np.array([plan.since for plan in self._plans])
