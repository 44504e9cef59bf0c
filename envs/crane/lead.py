"""Cranes that are led while their episodes run: an operator's velocities in place of a plan.

Each simulation that is led has a `Line`, which makes of every velocity the exact inputs of the next
control period, as `flatrig.feedforward.Stream` lets them through, and a plan that reaches `FILLED`
rows ahead: the velocity is held for the period, and then the crane comes to rest.  Where nobody
says otherwise that is what it does.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ... import feedforward
from ...feedforward.exact.state import State
from ...feedforward.paths.base_motion import BaseMotion
from ...feedforward.paths.joined import Joined
from ...feedforward.paths.reference import Reference, ReferencePath
from ...feedforward.paths.waves import base_at, still
from ...models.errors import PathError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..plans import steps_ahead
from .payloads import reloaded
from .plan import CranePlan, layout_of

FILLED = 3
"""Rows of a plan beyond the present one: what sees further ahead is the preview."""


@dataclass(frozen=True, eq=False)
class LedPlan(CranePlan):
    """What is planned of a simulation that is led, a few steps at a time."""

    line: "Line | None" = None
    """What leads it."""
    length: int = 0
    """Of the episode in control periods."""
    live = True

    @property
    def steps(self) -> int:
        """Length of the episode in control periods."""
        return self.length

    def state(self, rig: Rig, step: int) -> State:
        """How the rig moves as the period that is planned is over."""
        assert self.line is not None
        return self.line.state()

    def inputs_with(self, rig: Rig, load_mass: float) -> Array:
        """The same of one row, and of the instant as its period begins."""
        assert self.line is not None
        return self.line.inputs_with(load_mass)[None]


class Loaded(NamedTuple):
    """A rig with another load, along what was commanded so far."""

    stepper: feedforward.Stepper
    time: float
    """Of its last sample, since the line began [s]."""


@dataclass(frozen=True, eq=False)
class SoFar(ReferencePath):
    """The path of a line when it is first asked for: to make it takes time at every tick."""

    line: "Line"

    @cached_property
    def _path(self) -> Reference:
        return self.line.path()

    @property
    def order(self) -> int:
        """Number of continuous derivatives."""
        return self._path.order

    @property
    def size(self) -> int:
        """Number of columns."""
        return self._path.size

    @property
    def duration(self) -> float:
        """When the crane rests [s]."""
        return self._path.duration

    @property
    def still(self) -> Reference:
        """Without a base's motion."""
        inner = still(self._path)
        return self if inner is self._path else inner

    def base_at(self, time: float) -> BaseMotion | None:
        """How a base moves from some time on."""
        return base_at(self._path, time)

    def _derivatives(self, times: Array, order: int) -> Array:
        return self._path.derivatives(times, order)


class Line:
    """Leads one simulation by velocities, from a plan that it leaves.

    Parameters
    ----------
    rig
        The crane.
    plan
        What is left, at a step of its episode.
    step
        Of the episode.

    Raises
    ------
    PathError
        The rig cannot come to rest from there.
    """

    def __init__(self, rig: Rig, plan: CranePlan, step: int) -> None:
        self.rig, self.step, self._left, self._since = rig, step, plan, step
        period = plan.period
        self._limits = np.array([drive.largest for drive in rig.drives])
        begin = plan.state(rig, step)
        self.stream = feedforward.Stream(rig, begin, rate=1.0 / period)
        self._now = begin.derivatives
        self._still = feedforward.Stepper(rig, begin)
        self._loaded: dict[float, Loaded] = {}
        row = min(step, plan.known) - plan.since
        self._holding = plan.rows[row, layout_of(rig).columns["holding"]]

    def state(self) -> State:
        """How the crane moves at the next step."""
        return self.stream.state

    def path(self) -> Reference:
        """The path of the episode so far, and the stop that would follow."""
        at = self._since * self._left.period
        return Joined(self._left.reference, at, self.stream.reference)

    def tick(self, velocity: Array) -> LedPlan:
        """The plan for one period of a velocity of the outputs (outputs,) and a stop."""
        old, period, step = self._left, self._left.period, self.step
        sample = self.stream.tick(velocity)
        self.step, self._now = step + 1, sample.derivatives
        # From the next step on; only rows need the middles of their periods.
        whole = FILLED + max(steps_ahead(period))
        periods = np.concatenate((np.arange(whole), np.arange(FILLED) + 0.5))
        stop = self.stream.ahead(period * periods)
        self._holding = self._resting(stop.derivatives[:, 0])
        names = sample.coordinate_names
        drives = [names.index(self.rig.driven(drive).coordinate) for drive in self.rig.drives]
        positions = np.vstack((sample.positions, stop.positions[:whole]))
        rates = np.vstack((sample.velocities, stop.velocities[:whole]))
        inputs = np.vstack((sample.inputs, stop.inputs[whole:])) / self._limits
        first = np.stack((sample.derivatives[:2], *stop.derivatives[:2, :FILLED].swapaxes(0, 1)))
        rows = layout_of(self.rig).table(
            period,
            positions[:, drives],
            rates[:, drives],
            since=step,
            steps=old.steps,
            outputs=first[:, 0],
            output_rates=first[:, 1],
            feedforward=inputs,
            holding=np.tile(self._holding, (len(inputs), 1)),
        )
        course = dict(zip(names, positions[: FILLED + 1].T.copy(), strict=True))
        return LedPlan(
            rows[: old.steps + 1 - step], old.inputs, positions[-1, drives], self._holding,
            old.start, SoFar(self), period, course, since=step, line=self, length=old.steps,
        )  # fmt: skip

    def inputs_with(self, load_mass: float) -> Array:
        """Inputs over the limits as the last tick began, with another load, (drives,)."""
        time = self._left.period * (self.step - 1)
        known = self._loaded.get(load_mass)
        if known is None:
            rig = self.rig if load_mass == 1.0 else reloaded(self.rig, load_mass)
            begin = feedforward.solve(rig, self.path(), time).at(time)
            known = Loaded(feedforward.Stepper(rig, begin), time)
        step = known.stepper.step(self._now, time - known.time)
        self._loaded[load_mass] = Loaded(known.stepper, time)
        return np.asarray(step.inputs / self._limits)

    def _resting(self, derivatives: Array) -> Array:
        """Inputs over the limits that would hold the crane where its outputs are, (drives,)."""
        still = np.zeros_like(derivatives)
        still[0] = derivatives[0]
        try:
            return np.asarray(self._still.step(still, self._left.period).inputs / self._limits)
        except PathError:  # it can only be there in motion
            return self._holding
