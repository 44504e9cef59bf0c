"""A crane's plan: a reference and its exact feedforward, see `flatrig.envs.plans`."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ... import feedforward
from ...feedforward.exact.drive_limits import uses
from ...feedforward.exact.motion import Motion
from ...feedforward.exact.state import State
from ...feedforward.paths.joined import Joined
from ...feedforward.paths.reference import Reference
from ...feedforward.paths.waves import base_at
from ...models.errors import OptionError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..plans import Layout, Plan, steps_ahead
from .payloads import reloaded


@dataclass(frozen=True, eq=False)
class CranePlan(Plan):
    """A reference at every step of an episode, with what it implies."""

    start: dict[str, float]
    """Coordinates at rest at the start of the path [m, rad]."""
    reference: Reference
    """The path of the whole episode."""
    period: float
    """Of control [s]."""
    course: dict[str, Array]
    """Coordinates at every step from `since` until arrival [m, rad], (steps of the move + 1,)."""
    begin: State | None = None
    """Where the plan took over from another one, and how that moved."""
    part: Reference | None = None
    """What is followed from there on."""
    rates: dict[str, float] = field(default_factory=dict, kw_only=True)
    """Rates of the coordinates at the start [m/s, rad/s], of a base that moves there."""

    def state(self, rig: Rig, step: int) -> State:
        """How the rig moves at a step; its `time` is that of the path followed then.

        Raises
        ------
        PathError
            The rig cannot be there.
        """
        path = self.reference if self.part is None else self.part
        time = self.period * (step - self.since)
        return feedforward.solve(rig, path, time, begin=self.begin).at(time)

    def inputs_with(self, rig: Rig, load_mass: float) -> Array:
        """The feedforward if the rig's payloads had `load_mass` times their mass.

        Returns
        -------
        Array
            Inputs over the rig's limits from step `since` on, shape (rows, drives): for a
            `load_mass` of 1 the plan's.

        Raises
        ------
        PathError
            The rig with such a load cannot follow the plan's path.
        """
        moving = _moving(self.reference, self.period, self.steps) - self.since
        instants = self.period * (self.since + np.arange(moving) + 0.5)
        inputs = feedforward.solve(reloaded(rig, load_mass), self.reference, instants).inputs
        limits = np.array([drive.largest for drive in rig.drives])
        return np.pad(inputs / limits, ((0, len(self.rows) - moving), (0, 0)), mode="edge")


def layout_of(rig: Rig) -> Layout:
    """The columns of a rig's plans."""
    return Layout(len(rig.drives), len(rig.outputs))


def make_plan(rig: Rig, reference: Reference, period: float, hold: float) -> CranePlan:
    """Solve the feedforward along a reference for control periods of `period` seconds.

    The episode lasts until `hold` seconds after arrival.

    Raises
    ------
    OptionError
        Following the reference needs ropes to push, or more than a drive can give.
    PathError, SmoothnessError
        The rig cannot follow the reference.
    """
    return _plan(rig, reference, period, hold, None)


def redirected(
    rig: Rig, plan: CranePlan, step: int, state: State, reference: Reference, hold: float
) -> CranePlan:
    """The plan that leaves another one at a step for a reference, whose time 0 is then.

    Parameters
    ----------
    rig, plan, step
        What is left, and when.
    state
        How the rig moves there, see `CranePlan.state`.
    reference
        A path that starts like this.
    hold
        How long the episode lasts after arrival [s].

    Raises
    ------
    OptionError, PathError, SmoothnessError
        As `make_plan`, or the reference does not continue the plan.
    """
    return _plan(rig, reference, plan.period, hold, Leaving(plan, step, state))


class Leaving(NamedTuple):
    """Where a plan is left."""

    plan: CranePlan
    step: int
    state: State


def _plan(
    rig: Rig, reference: Reference, period: float, hold: float, left: Leaving | None
) -> CranePlan:
    """A plan, from rest or from another one on."""
    limits = np.array([drive.largest for drive in rig.drives])
    begin, since = (None, 0) if left is None else (left.state, left.step)
    steps = max(1, round((reference.duration + hold) / period))
    instants = period * np.arange(steps + 1 + max(steps_ahead(period)))
    now, middles = instants[: steps + 1], instants[: steps + 1] + 0.5 * period
    motion = feedforward.solve(rig, reference, np.concatenate((instants, middles)), begin=begin)
    if motion.slack:
        raise OptionError(f"an environment needs taut ropes, but {motion.slack[0]}")
    _within_limits(motion)

    outputs, output_rates = reference.derivatives(now, 1)
    arrived = np.minimum(now / reference.duration, 1.0)[:, None]
    first, last = _at_rest(rig, reference, limits, left)
    rows = layout_of(rig).table(
        period,
        motion.drive_positions[: len(instants)],
        motion.drive_velocities[: len(instants)],
        since=since,
        outputs=outputs,
        output_rates=output_rates,
        feedforward=motion.inputs[len(instants) :] / limits,
        holding=first + arrived * (last - first),
    )
    moving = motion.positions[: _moving(reference, period, steps)]
    course = dict(zip(motion.coordinate_names, moving.T.copy(), strict=True))
    goal = motion.drive_positions[len(instants) - 1].copy()
    if left is None:
        start = {name: float(values[0]) for name, values in course.items()}
        names = zip(motion.coordinate_names, motion.velocities[0].tolist(), strict=True)
        return CranePlan(
            rows, first * limits, goal, last, start, reference, period, course, rates=dict(names)
        )
    old = left.plan
    whole = Joined(old.reference, since * period, reference)
    return CranePlan(
        rows, old.inputs, goal, last, old.start, whole, period, course, begin, reference,
        since=since,
    )  # fmt: skip


def feedforward_with(rig: Rig, plan: CranePlan, load_mass: float) -> Array:
    """The feedforward of a plan if the rig's payloads had `load_mass` times their mass.

    See `CranePlan.inputs_with`.
    """
    return plan.inputs_with(rig, load_mass)


def _moving(reference: Reference, period: float, steps: int) -> int:
    """How many rows of a plan are before arrival, the first at rest included; all at sea."""
    if base_at(reference, 0.0) is not None:
        return steps + 1
    return min(steps, math.ceil(reference.duration / period)) + 1


def _at_rest(
    rig: Rig, reference: Reference, limits: Array, left: Leaving | None
) -> tuple[Array, Array]:
    """Inputs over their limits that hold the rig at the path's start and at its goal."""
    arrived = reference.duration + 1.0
    if left is None:
        ends = feedforward.solve(rig, reference, [-1.0, arrived])
        return ends.inputs[0] / limits, ends.inputs[1] / limits
    row = min(left.step, left.plan.known) - left.plan.since
    now = left.plan.rows[row, layout_of(rig).columns["holding"]]
    return now, feedforward.solve(rig, reference, arrived, begin=left.state).inputs[0] / limits


def _within_limits(motion: Motion) -> None:
    """Refuse a reference that asks more of a drive than it can give."""
    order = np.argsort(motion.times, kind="stable")
    driven = motion.driven
    inputs, speeds, accelerations = (
        part[order].T
        for part in (
            motion.inputs, motion.velocities[:, driven], motion.accelerations[:, driven],
        )
    )  # fmt: skip
    for use in uses(motion.rig, motion.times[order], inputs, speeds, accelerations):
        if use.spare().min() < 0.0:
            value, limit = use.at(use.tightest())
            raise OptionError(
                f"drive {use.drive.name} would have to give {use.words(value)} even without "
                f"disturbances, its limit is {limit:.4g} {use.unit}; take a longer duration or a "
                "higher limit"
            )
