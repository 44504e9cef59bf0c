"""What an episode asks for, step by step: the reference and its exact feedforward in one table.

A `Plan` is made once for a reference and read row by row.  Row k belongs to the instant k dt:

    drives             where encoders ought to be, then how fast                 (2 drives)
    outputs, output_rates     where the outputs ought to be, and how fast
    feedforward        inputs over their limits, for the middle of the hold that begins (drives)
    holding            inputs over their limits that hold the plant at rest thereabouts (drives)
    preview            positions ahead, relative to those now              (drives * len(AHEAD))
    left               share of the episode that is left                                     (1)
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, Generic, TypeVar, cast

import numpy as np

from ..models.errors import FlatrigError, OptionError
from ..models.types import Array
from ..models.values import shown

AHEAD = (0.1, 0.2, 0.4)
"""How far ahead the preview looks [s]."""

TRIES = 50
"""Draws of a random reference after which one that cannot be followed is an error."""


@dataclass(frozen=True)
class Layout:
    """Columns of a plan's rows."""

    drives: int
    """Number of drives."""
    outputs: int
    """Number of outputs."""
    rates: int = 0
    """Number of output rates, where they are not as many as outputs."""

    @cached_property
    def columns(self) -> dict[str, slice]:
        """The slice of each part of a row, by name."""
        widths = {
            "drives": 2 * self.drives,
            "outputs": self.outputs,
            "output_rates": self.rates or self.outputs,
            "feedforward": self.drives,
            "holding": self.drives,
            "preview": self.drives * len(AHEAD),
            "left": 1,
        }
        ends = np.cumsum(list(widths.values())).tolist()
        return {
            name: slice(end - width, end)
            for (name, width), end in zip(widths.items(), ends, strict=True)
        }

    @property
    def width(self) -> int:
        """Number of columns."""
        return int(self.columns["left"].stop)

    def table(
        self,
        period: float,
        positions: Array,
        rates: Array,
        *,
        since: int = 0,
        steps: int = 0,
        **parts: Array,
    ) -> Array:
        """The rows of a plan, all or from some step on, shape (rows, width), read-only.

        Parameters
        ----------
        period
            Of control [s].
        positions, rates
            Of the drives, at least as far ahead as the preview looks.
        since
            Step of the first row.
        steps
            Length of the episode in control periods; by default it ends with the last row.
        **parts
            The outputs, their rates, the feedforward and the holding inputs, (rows, ...) each.
        """
        count = len(parts["outputs"])
        rows = np.zeros((count, self.width))
        parts["drives"] = np.hstack((positions, rates))[:count]
        parts["preview"] = np.hstack(
            [positions[step : step + count] - positions[:count] for step in steps_ahead(period)]
        )
        left = np.arange(since, since + count)[:, None] / (steps or since + count - 1)
        parts["left"] = 1.0 - left
        for name, columns in self.columns.items():
            rows[:, columns] = parts[name]
        rows.flags.writeable = False
        return rows


def steps_ahead(period: float) -> list[int]:
    """How many control periods ahead each entry of the preview looks."""
    return [round(time / period) for time in AHEAD]


@dataclass(frozen=True, eq=False)
class Plan:
    """A reference at every step of an episode, with what it implies."""

    rows: Array
    """All rows from step `since` on, shape (steps + 1 - since, columns); see the module."""
    inputs: Array
    """Inputs that hold the plant at the start of the path, shape (drives,) [N, N m]."""
    goal: Array
    """Drive positions at rest at the goal, shape (drives,) [m, rad]."""
    goal_inputs: Array
    """Inputs over their limits that hold the plant there, shape (drives,)."""
    since: int = field(default=0, kw_only=True)
    """Step of the episode from which on the plan is followed."""
    live: ClassVar[bool] = False
    """Whether it changes as the episode goes on."""

    @property
    def known(self) -> int:
        """Step of the last row."""
        return self.since + len(self.rows) - 1

    @property
    def steps(self) -> int:
        """Length of an episode in control periods."""
        return self.known


PlanT = TypeVar("PlanT", bound=Plan)

Sampler = Callable[[np.random.Generator], object]
"""Draws a reference from a random generator."""


class Planner(ABC, Generic[PlanT]):
    """Makes the plan of each episode; one for all where the reference is fixed.

    Parameters
    ----------
    option
        A reference for all episodes, a function that draws one from a random generator, "random",
        or None for the default.
    period
        Of control [s].
    hold
        How long an episode lasts after arrival [s].

    Raises
    ------
    OptionError
        The reference is none.
    PathError, SmoothnessError
        It cannot be followed.
    """

    kinds: str
    """What a reference can be, in messages."""

    def __init__(self, option: object, period: float, hold: float) -> None:
        self.period, self.hold = period, hold
        self.fixed: PlanT | None = None
        """The plan of all episodes, if it is the same for all."""
        self._sampler: Sampler | None = None
        if option is None:
            option = self.default()
        if isinstance(option, str) and option == "random":
            self._sampler = self.random()
        elif self.is_reference(option):
            self.fixed = self.plan(option)
        elif callable(option):
            self._sampler = cast("Sampler", option)
        else:
            raise OptionError(
                f"reference is {shown(option)}, it must be {self.kinds}, a function of a random "
                'generator, "random" or None'
            )

    @abstractmethod
    def default(self) -> object:
        """The reference where none is given."""

    @abstractmethod
    def random(self) -> Sampler:
        """What "random" stands for."""

    @abstractmethod
    def is_reference(self, option: object) -> bool:
        """Whether a plan can be tried for it."""

    @abstractmethod
    def plan(self, reference: object) -> PlanT:
        """The plan for a given reference."""

    def draws_anew(self, sampler: Sampler) -> bool:
        """Whether another reference is drawn where one cannot be followed."""
        return True

    def draw(self, generator: np.random.Generator) -> PlanT:
        """The plan of one episode."""
        if self.fixed is not None:
            return self.fixed
        assert self._sampler is not None
        for _ in range(TRIES if self.draws_anew(self._sampler) else 0):
            with suppress(FlatrigError):
                return self.plan(self._sampler(generator))
        return self.plan(self._sampler(generator))
