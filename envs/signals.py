"""Between controller and plant: encoders that count, inputs that come late, plans read by row."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..models.types import Array
from .common import LONGEST_DELAY, AnyScenario, Ids, Steps
from .formulas import Formulas
from .plans import Layout, Plan
from .simulations import Simulations

MEMORY = 1.0
"""Time constant of the running average of the tracking error [s]."""


class Encoders:
    """What a controller knows of n plants: drive positions and rates, errors, their average.

    An encoder with a resolution reads the nearest multiple of it, and its rate is the difference
    of two readings over the control period.

    Attributes
    ----------
    measured, errors
        Positions, then rates: what is measured, and what is missing to the plan, (n, 2 drives).
    average
        Running average of the position errors, (n, drives).
    """

    def __init__(self, plant: Simulations[Any, Any], period: float) -> None:
        self._plant, self._period = plant, period
        self._drives = drives = plant.drive_positions.shape[1]
        self._share = 1.0 - np.exp(-period / MEMORY)
        self._resolution = np.zeros((plant.num, 1))
        self._counting = False
        self._counted = np.zeros((plant.num, 2 * drives))
        self.measured = plant.encoders
        self.errors = np.zeros((plant.num, 2 * drives))
        self.average = np.zeros((plant.num, drives))
        self._average = self._averaging()

    @property
    def positions(self) -> Array:
        """Measured drive positions, (n, drives) [m, rad]."""
        return self.measured[:, : self._drives]

    @property
    def rates(self) -> Array:
        """Measured drive rates, (n, drives) [m/s, rad/s]."""
        return self.measured[:, self._drives :]

    @property
    def memory(self) -> tuple[Array, ...]:
        """What a simulation that rests must keep."""
        return self.errors, self.average, self._counted

    def resolution(self, sim: int) -> float:
        """Step of what the encoders of a simulation read [m, rad], 0 for none."""
        return float(self._resolution[sim, 0])

    def equip(self, ids: Ids, resolutions: Sequence[float]) -> None:
        """Give simulations encoders of such resolutions."""
        self._resolution[ids, 0] = resolutions
        if self._resolution.any() and not self._counting:
            self._counting, self.measured = True, self._counted
            self._counted[...] = self._plant.encoders

    def reset(self, ids: Ids, scenarios: Sequence[AnyScenario], planned: Array) -> None:
        """Read plants that were put at rest; `planned` are all plants' (n, 2 drives)."""
        self.equip(ids, [scenario.encoder_resolution for scenario in scenarios])
        self._counted[ids] = np.hstack((self._rounded(), self._plant.drive_rates))[ids]
        self.errors[ids] = planned[ids] - self.measured[ids]
        self.average[ids] = 0.0

    def step(self, planned: Array) -> None:
        """Read the plants after a step."""
        if self._counting:
            self._count()
        np.subtract(planned, self.measured, self.errors)
        self._average()

    def _averaging(self) -> Callable[[], None]:
        """Formulas of the running average."""
        step = Formulas(len(self.errors))
        errors, average = step.see(self.errors, slice(self._drives)), step.see(self.average)
        step.keep(self.average, average + (errors - average) * step.constant(self._share))
        return step.made()

    def _count(self) -> None:
        now = self._rounded()
        counted = (now - self.positions) / self._period
        self.rates[...] = np.where(self._resolution > 0, counted, self._plant.drive_rates)
        self.positions[...] = now

    def _rounded(self) -> Array:
        """Positions rounded to each encoder's resolution."""
        true = self._plant.drive_positions
        grain = np.where(self._resolution > 0, self._resolution, 1.0)
        return np.where(self._resolution > 0, np.round(true / grain) * grain, true)


class Band(NamedTuple):
    """What commands are kept in, inputs over the limits, shape (drives,) each."""

    lowest: Array
    highest: Array
    step: Array
    """By how much they may change in a period; infinite where they may by any."""


def whole_band(drives: int) -> Band:
    """The band of drives with symmetric limits that take any change."""
    ones = np.ones(drives)
    return Band(-ones, ones, np.inf * ones)


class Commands:
    """What controllers ask of the drives of n plants: clipped, and handed on after a delay.

    Attributes
    ----------
    last
        Commands of the last step, inputs over the drives' limits, (n, drives).
    change
        By how much they differ from those of the step before, (n, drives).
    """

    def __init__(self, change: Array, band: Band) -> None:
        num, drives = change.shape
        self.last, self.change = np.zeros((num, drives)), change
        self._asked = np.zeros((num, drives))
        self._take = self._taking(band)
        self._periods = np.zeros(num, dtype=np.int64)
        self._sent = np.zeros((LONGEST_DELAY + 1, num, drives))
        self.sent = self._sent.swapaxes(0, 1)
        """What was sent in the last periods, by turns, (n, periods, drives)."""
        self._every = np.arange(num)
        self._late = False

    def reset(self, ids: Ids, scenarios: Sequence[AnyScenario], commands: Array) -> None:
        """Start anew: until the first command arrives, `commands` (len(ids), drives) act."""
        self.last[ids], self.change[ids] = commands, 0.0
        self._sent[:, ids] = commands
        self.equip(ids, [scenario.delay for scenario in scenarios])

    def delay(self, sim: int) -> int:
        """Whole control periods between a command of a simulation and its input."""
        return int(self._periods[sim])

    def equip(self, ids: Ids, delays: Sequence[int]) -> None:
        """Let commands of simulations come so many control periods late."""
        self._periods[ids] = delays
        self._late = bool(self._periods.any())

    def send(self, actions: Array, step: Steps) -> Array:
        """Take the finite actions of a step, return the commands that act in it, (n, drives)."""
        self._asked[...] = actions
        self._take()
        if not self._late:
            return self.last
        now, then = self._turns(step)
        self._sent[now] = self.last
        return np.asarray(self._sent[then])

    def _turns(self, step: Steps) -> tuple[Any, Any]:
        """Where in `_sent` the commands of each simulation's step are, and those that act in it."""
        size = len(self._sent)
        if len(step) == 1:  # whole numbers are faster than NumPy
            turn = step.item()
            return turn % size, (turn - self._periods.item()) % size
        return (step % size, self._every), ((step - self._periods) % size, self._every)

    def _taking(self, band: Band) -> Callable[[], None]:
        """Formulas that clip what was asked to the band, and say by how much it changed."""
        take = Formulas(len(self.last))
        last, step = take.see(self.last), take.constant(band.step)
        clipped = take.see(self._asked).largest(take.constant(band.lowest))
        clipped = clipped.least(take.constant(band.highest))
        if not np.isinf(band.step).all():
            clipped = clipped.largest(last - step).least(last + step)
        take.keep(self.change, clipped - last)
        take.keep(self.last, clipped)
        return take.made()


class Rows:
    """The rows of n simulations' plans at their present steps.

    Plans lie one after another in one table, shared if all episodes have the same one, so that a
    step of any number of simulations is one lookup.
    """

    def __init__(self, layout: Layout, num: int, shared: Plan | None) -> None:
        self._shared = shared
        self._room = 0 if shared is None else len(shared.rows)
        self._first = np.zeros(num, dtype=np.int64)
        self._index = np.zeros(num, dtype=np.int64)
        self._table = np.zeros((0, layout.width)) if shared is None else shared.rows
        self._row = np.zeros((num, layout.width))
        self.length = np.full(num, 0 if shared is None else shared.steps)
        self._known = self.length.copy()
        self.goal = np.zeros((num, layout.drives))
        self.goal_inputs = np.zeros((num, layout.drives))
        self.columns = columns = layout.columns
        self.parts = {name: self._row[:, part] for name, part in columns.items()}
        self.ahead = self._row[:, columns["preview"].start : columns["left"].stop]

    def follow(self, ids: Ids, plans: Sequence[Plan]) -> None:
        """Give simulations their plans."""
        if any(plan is not self._shared for plan in plans):
            self._store(ids, plans)
        for sim, plan in zip(ids.tolist(), plans, strict=True):
            self.length[sim], self._known[sim] = plan.steps, plan.known
            self.goal[sim], self.goal_inputs[sim] = plan.goal, plan.goal_inputs

    def look(self, step: Steps) -> None:
        """Bring `parts` up to date."""
        np.add(self._first, step, self._index)
        self._table.take(self._index, 0, self._row, "clip")

    def later(self, name: str, steps: int) -> Array:
        """One of `parts` some steps later, or at the end of what is known, (n, its entries)."""
        rows = np.minimum(self._index + steps, self._first + self._known)
        return np.asarray(self._table[:, self.columns[name]][rows])

    def before(self, sim: int, step: int) -> Array:
        """The rows of a simulation before a step, a copy."""
        first = int(self._first[sim])
        return self._table[first : first + step].copy()

    def put_before(self, sim: int, rows: Array) -> None:
        """Write the first rows of a simulation, whose plan does not begin before they end."""
        if len(rows):  # else the table may be everybody's
            first = int(self._first[sim])
            self._table[first : first + len(rows)] = rows

    def _store(self, ids: Ids, plans: Sequence[Plan]) -> None:
        """Write plans into slots of their simulations' own; what is before them stays."""
        room = max(self._room, *(plan.steps + 1 for plan in plans))
        num = len(self._first)
        if self._shared is not None or room > self._room:
            table = np.zeros((num, room, self._table.shape[1]))
            for sim, first in enumerate(self._first.tolist()):
                old = self._table[first : first + self.length[sim] + 1]
                table[sim, : len(old)] = old
            self._first = room * np.arange(num)
            self._table = table.reshape(num * room, -1)
            self._room, self._shared = room, None
        for sim, plan in zip(ids.tolist(), plans, strict=True):
            first = self._first[sim] + plan.since
            self._table[first : first + len(plan.rows)] = plan.rows
