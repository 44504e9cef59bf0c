"""The motion of a rig along a reference path, with the inputs that produce it."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...models.errors import PathError, RigError, did_you_mean
from ...models.files import replacing
from ...models.rig.open_tensions import TENSION
from ...models.rig.rig import Rig
from ...models.types import Array
from ...models.values import as_number
from ..checks import every
from .branch import Branch
from .state import State


class Slack(NamedTuple):
    """An interval in which a rope or a link would have to push."""

    rope: str
    """Its name."""
    start: float
    """When the tension becomes negative [s]."""
    end: float
    """When it is positive again [s]."""
    lowest: float
    """Lowest tension in it [N]."""
    kind: str = "rope"
    """Whether it is a rope or a link."""

    def __str__(self) -> str:
        return (
            f"{self.kind} {self.rope} would have to push from {self.start:.4g} s "
            f"to {self.end:.4g} s (down to {self.lowest:.4g} N)"
        )


@dataclass(frozen=True, eq=False)
class Motion:
    """Everything about a rig at N instants, in SI units.

    Angles of frames are continuous in time; those of a platform, if nothing prescribes them, lie
    within half a turn of upright.
    """

    rig: Rig
    times: Array
    """Instants [s], shape (N,)."""
    coordinate_names: tuple[str, ...]
    """Columns of `positions`: those of `Rig.coordinate_names`, then auxiliary ones."""
    positions: Array
    """Coordinates [m] or [rad], shape (N, coordinates)."""
    velocities: Array
    """Their rates [m/s] or [rad/s], shape (N, coordinates)."""
    accelerations: Array
    """Their second derivatives [m/s2] or [rad/s2], shape (N, coordinates)."""
    inputs: Array
    """Inputs [N] or [N m], shape (N, inputs), columns `Rig.input_names`; means over the time from
    each instant to `hold` later if that is not 0."""
    tensions: Array
    """Where a rope leaves its winch, and of links [N], shape (N, ropes + links), columns
    `Rig.tension_names`; > 0 but of what pushes, since a rope can only pull."""
    multipliers: Array
    """Of the constraints of `Equations.constraint_names`, shape (N, constraints); a span's is
    the tension of all its falls over its length [N/m]."""
    slack: tuple[Slack, ...]
    """Intervals in which a tension is negative, as far as the samples show them."""
    hold: float = 0.0
    """For how long a controller is to hold each input [s]; 0 if inputs are of the instants."""
    branch: Branch | None = field(default=None, repr=False)
    """The branch of solutions that it lies on, unless it was integrated step by step."""

    def column(self, name: str) -> int:
        """Column of a coordinate.

        Raises
        ------
        RigError
            There is none of that name.
        """
        if name not in self.coordinate_names:
            known = did_you_mean(name, self.coordinate_names)
            raise RigError(f"rig {self.rig.name} has no coordinate {name!r}{known}")
        return self.coordinate_names.index(name)

    @property
    def rope_lengths(self) -> Array:
        """Lengths of the ropes [m], shape (N, ropes), columns `Rig.rope_names`."""
        return self.positions[:, [self.column(rope.coordinate) for rope in self.rig.ropes]]

    @property
    def outputs(self) -> Array:
        """What the reference prescribes, shape (N, outputs)."""
        columns = [
            sum(factor * self._of(name) for factor, name in terms)
            for terms in map(self.rig.terms, self.rig.outputs)
        ]
        return np.stack(columns, axis=1)

    def _of(self, output: str) -> Array:
        """A coordinate or a tension, shape (N,)."""
        if output.endswith(TENSION):
            names = self.rig.tension_names
            return self.tensions[:, names.index(output.removesuffix(TENSION))]
        return self.positions[:, self.column(output)]

    @property
    def drive_positions(self) -> Array:
        """What an encoder on each drive reads: angle, position or rope length, (N, drives)."""
        return self.positions[:, self.driven]

    @property
    def drive_velocities(self) -> Array:
        """Rates of `drive_positions`, shape (N, drives)."""
        return self.velocities[:, self.driven]

    @property
    def driven(self) -> list[int]:
        """Columns of the coordinates that drives act on."""
        return [self.column(name) for name in self.rig.driven_coordinates]

    def at(self, time: float) -> State:
        """The state at any time [s], for a motion that continues this one from there.

        `solve(rig, reference, times, begin=motion.at(2.0))` needs a reference that starts as this
        one's moves at 2 s, such as one that `connected` or `stopped` makes.

        Raises
        ------
        PathError
            The time is not a finite number, or there is no solution at it.
        RigError
            The motion was integrated step by step.
        """
        if self.branch is None:
            raise RigError("a motion that was integrated has no state to begin from; use `solve`")
        instant = as_number(time)
        if not math.isfinite(instant):
            raise PathError(f"time is {time!r}, it must be a finite number of seconds")
        return self.branch.at(instant)

    def to_csv(self, path: str | Path) -> None:
        """Write times, inputs, tensions, positions and their derivatives, one row an instant.

        Inputs that are to be held until the next row stand in columns "DRIVE.held".

        Raises
        ------
        OutputError
            The file cannot be written.
        """
        names = [
            "time",
            *(f"{name}.held" if self.hold else name for name in self.rig.input_names),
            *(f"{rope}.tension" for rope in self.rig.tension_names),
            *self.coordinate_names,
            *(f"{name}_dot" for name in self.coordinate_names),
            *(f"{name}_ddot" for name in self.coordinate_names),
        ]
        kinematics = (self.positions, self.velocities, self.accelerations)
        table = np.column_stack((self.times, self.inputs, self.tensions, *kinematics))
        with replacing(path) as beside:
            np.savetxt(beside, table, "%.17g", ",", header=",".join(names), comments="")


ROUNDING = 1e-12
"""A rope pushes if its tension is below minus this fraction of the largest one: it guards against
reporting an unloaded rope, whose tension is zero but for rounding, as slack."""


def find_slack(rig: Rig, times: Array, tensions: Array) -> tuple[Slack, ...]:
    """Intervals of tensions (N, ropes + links) that are negative, their ends interpolated.

    Those of what can push do not count.
    """
    if every(tensions >= 0.0):
        return ()
    intervals = []
    order = np.argsort(times, kind="stable")
    times, tensions = times[order], tensions[order]
    least = ROUNDING * np.abs(tensions).max(initial=0.0)
    for rope, tension in zip(rig.tension_names, tensions.T, strict=True):
        if rope in rig.pushing:
            continue
        kind = rig.spoken(rope).split()[0]
        loose = np.concatenate(([False], ~(tension >= -least), [False]))
        first = np.flatnonzero(loose[1:] & ~loose[:-1]).tolist()
        last = (np.flatnonzero(~loose[1:] & loose[:-1]) - 1).tolist()
        for i, k in zip(first, last, strict=True):
            start, end = _crossing(times, tension, i, i - 1), _crossing(times, tension, k, k + 1)
            lowest = float(tension[i : k + 1].min())
            intervals.append(Slack(rope, start, end, lowest, kind))
    return tuple(intervals)


def _crossing(times: Array, tension: Array, inside: int, outside: int) -> float:
    """Where the tension passes zero between two neighbouring samples."""
    if not 0 <= outside < len(times):
        return float(times[inside])
    share = tension[inside] / (tension[inside] - tension[outside])
    return float(times[inside] + share * (times[outside] - times[inside]))
