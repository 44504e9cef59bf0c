"""A crane's plan: a reference and its exact feedforward, see `flatrig.envs.plans`."""

import math
from dataclasses import dataclass

import numpy as np

from ... import feedforward
from ...feedforward.paths.reference import Reference
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
    """The path."""
    period: float
    """Of control [s]."""
    course: dict[str, Array]
    """Coordinates at every step until arrival [m, rad], (steps of the move + 1,) each."""


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
    steps = max(1, round((reference.duration + hold) / period))
    instants = period * np.arange(steps + 1 + max(steps_ahead(period)))
    now, middles = instants[: steps + 1], instants[: steps + 1] + 0.5 * period
    motion = feedforward.solve(rig, reference, np.concatenate((instants, middles)))
    if motion.slack:
        raise OptionError(f"an environment needs taut ropes, but {motion.slack[0]}")
    limits = np.array([drive.limit for drive in rig.drives])
    _within_limits(rig, motion.inputs, limits)

    outputs, output_rates = reference.derivatives(now, 1)
    arrived = np.minimum(now / reference.duration, 1.0)[:, None]
    first, last = _at_rest(rig, reference, limits)
    rows = layout_of(rig).table(
        period,
        motion.drive_positions[: len(instants)],
        motion.drive_velocities[: len(instants)],
        outputs=outputs,
        output_rates=output_rates,
        feedforward=motion.inputs[len(instants) :] / limits,
        holding=first + arrived * (last - first),
    )
    moving = motion.positions[: _moving(reference, period, steps)]
    course = dict(zip(motion.coordinate_names, moving.T.copy(), strict=True))
    start = {name: float(values[0]) for name, values in course.items()}
    goal = motion.drive_positions[len(instants) - 1].copy()
    return CranePlan(rows, first * limits, goal, last, start, reference, period, course)


def feedforward_with(rig: Rig, plan: CranePlan, load_mass: float) -> Array:
    """The feedforward of a plan if the rig's payloads had `load_mass` times their mass.

    Returns
    -------
    Array
        Inputs over the rig's limits, shape (steps + 1, drives): for a `load_mass` of 1 the plan's.

    Raises
    ------
    PathError
        The rig with such a load cannot follow the plan's path.
    """
    moving = _moving(plan.reference, plan.period, plan.steps)
    instants = plan.period * (np.arange(moving) + 0.5)
    inputs = feedforward.solve(reloaded(rig, load_mass), plan.reference, instants).inputs
    limits = np.array([drive.limit for drive in rig.drives])
    return np.pad(inputs / limits, ((0, plan.steps + 1 - moving), (0, 0)), mode="edge")


def _moving(reference: Reference, period: float, steps: int) -> int:
    """How many rows of a plan are before arrival, the first at rest included."""
    return min(steps, math.ceil(reference.duration / period)) + 1


def _at_rest(rig: Rig, reference: Reference, limits: Array) -> tuple[Array, Array]:
    """Inputs over their limits that hold the rig at the path's start and at its goal."""
    ends = feedforward.solve(rig, reference, [-1.0, reference.duration + 1.0])
    return ends.inputs[0] / limits, ends.inputs[1] / limits


def _within_limits(rig: Rig, inputs: Array, limits: Array) -> None:
    """Refuse a reference that asks more of a drive than it can give, friction not counted."""
    most = np.abs(inputs).max(axis=0)
    for drive, value, limit in zip(rig.drives, most, limits, strict=True):
        if value > limit:
            unit = feedforward.driven_unit(rig, drive)
            raise OptionError(
                f"drive {drive.name} would have to give {value:.4g} {unit} even without friction, "
                f"its limit is {limit:.4g} {unit}; take a longer duration or a higher limit"
            )
