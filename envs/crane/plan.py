"""What an episode asks for, step by step: the reference and its exact feedforward in one table.

A `Plan` is made once for a reference and read row by row.  Row k belongs to the instant k dt:

    drives             where encoders ought to be, then how fast                 (2 drives)
    outputs, output_rates     where the outputs ought to be                (outputs) each
    feedforward        inputs over their limits, for the middle of the hold that begins (drives)
    holding            inputs over their limits that hold the rig at rest thereabouts   (drives)
    preview            positions ahead, relative to those now              (drives * len(AHEAD))
    left               share of the episode that is left                                     (1)
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import feedforward
from ...feedforward.paths.reference import Reference
from ...models.errors import OptionError
from ...models.rig.rig import Rig
from ...models.types import Array

AHEAD = (0.1, 0.2, 0.4)
"""How far ahead the preview looks [s]."""


@dataclass(frozen=True)
class Layout:
    """Columns of a plan's rows."""

    drives: int
    outputs: int
    rates: int = 0
    """Output rates, where they are not as many as outputs."""

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


@dataclass(frozen=True, eq=False)
class Plan:
    """A reference at every step of an episode, with what it implies."""

    rows: Array
    """Shape (steps + 1, columns); see the module."""
    start: dict[str, float]
    """Coordinates at rest at the start of the path [m, rad]."""
    inputs: Array
    """Inputs that hold it there, shape (drives,) [N, N m]."""
    goal: Array
    """Drive positions at rest at the goal, shape (drives,) [m, rad]."""
    goal_inputs: Array
    """Inputs over their limits that hold the rig there, shape (drives,)."""

    @property
    def steps(self) -> int:
        """Length of an episode in control periods."""
        return len(self.rows) - 1


def layout_of(rig: Rig) -> Layout:
    """The columns of a rig's plans."""
    return Layout(len(rig.drives), len(rig.outputs))


def make_plan(rig: Rig, reference: Reference, period: float, hold: float) -> Plan:
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
    ahead = [round(time / period) for time in AHEAD]
    instants = period * np.arange(steps + 1 + max(ahead))
    middles = instants[: steps + 1] + 0.5 * period
    motion = feedforward.solve(rig, reference, np.concatenate((instants, middles)))
    if motion.slack:
        raise OptionError(f"an environment needs taut ropes, but {motion.slack[0]}")
    limits = np.array([drive.limit for drive in rig.drives])
    inputs = motion.inputs / limits
    _within_limits(rig, motion.inputs, limits)

    columns = layout_of(rig).columns
    rows = np.zeros((steps + 1, layout_of(rig).width))
    position, now = motion.drive_positions, slice(0, steps + 1)
    path = reference.derivatives(instants[now], 1)
    arrived = np.minimum(instants[now] / reference.duration, 1.0)[:, None]
    first, last = _at_rest(rig, reference, limits)
    rows[:, columns["drives"]] = np.hstack((position, motion.drive_velocities))[now]
    rows[:, columns["outputs"]] = path[0]
    rows[:, columns["output_rates"]] = path[1]
    rows[:, columns["feedforward"]] = inputs[len(instants) :]
    rows[:, columns["holding"]] = first + arrived * (last - first)
    rows[:, columns["preview"]] = np.hstack(
        [position[step : step + steps + 1] - position[now] for step in ahead]
    )
    rows[:, columns["left"]] = 1.0 - np.arange(steps + 1)[:, None] / steps
    rows.flags.writeable = False
    start = dict(zip(motion.coordinate_names, motion.positions[0].tolist(), strict=True))
    return Plan(rows, start, first * limits, position[len(instants) - 1].copy(), last)


def _at_rest(rig: Rig, reference: Reference, limits: Array) -> tuple[Array, Array]:
    """Inputs over their limits that hold the rig at the path's start and at its goal."""
    ends = feedforward.solve(rig, reference, [-1.0, reference.duration + 1.0])
    return ends.inputs[0] / limits, ends.inputs[1] / limits


def _within_limits(rig: Rig, inputs: Array, limits: Array) -> None:
    """Refuse a reference that asks more of a drive than it can give."""
    most = np.abs(inputs).max(axis=0)
    for drive, value, limit in zip(rig.drives, most, limits, strict=True):
        if value > limit:
            raise OptionError(
                f"drive {drive.name} would have to give {value:.4g}, its limit is {limit:.4g}; "
                "take a longer duration or a higher limit"
            )
