"""What a policy sees of a hand: named entries, scaled with the object's radius r.

For every slide and turn, in the order of the inputs, with times over `TIME`:

    NAME.position      measured, from home                         over r, a turn's over 1 rad
    NAME.rate          measured
    NAME.error, NAME.rate_error     plan - measured                over `FINE` of these
    NAME.mean_error    running average of the error over about a second
    NAME.command       last command                                in [-1, 1]
    NAME.ahead_T       plan T seconds ahead - plan now
    left               share of the episode that is left

With sensors="full" then, for every way the object can move (planar: x, z and the turn about y):

    object.x.error, object.turn_x.error            plan - measured          over `FINE` r, `FINE`
    object.x.rate_error, object.turn_x.rate_error  the same of its twist

Turns are axis times angle in space.  Values beyond +-`LIMIT` are cut off.
"""

import numpy as np

from ...models.hand.hand import Hand
from ...models.types import Array
from ..crane.observation import LIMIT
from ..crane.plan import AHEAD
from ..signals import Encoders, Rows
from .plan import turn_axes
from .plant import HandPlant

FINE = 0.05
"""Errors are this much finer than positions."""
TIME = 0.2
"""Over which a typical motion goes one unit [s]."""
WAYS = ("x", "y", "z", "turn_x", "turn_y", "turn_z")


class HandObservation:
    """Assembles the observations of n simulations."""

    def __init__(self, plant: HandPlant, encoders: Encoders, rows: Rows, full: bool) -> None:
        self._plant, self._encoders, self._rows, self._full = plant, encoders, rows, full
        self._ways = [0, 2, 4] if plant.hand.planar else list(range(6))
        self.names, self._factors = self._entries(plant.hand)

    def read(self, command: Array) -> Array:
        """Observations (n, entries), a new array."""
        encoders = self._encoders
        parts = [encoders.measured, encoders.errors, encoders.average, command, self._rows.ahead]
        if self._full:
            planned = self._rows.parts
            off = pose_error(self._plant.outputs, planned["outputs"])
            drift = self._plant.twist - planned["output_rates"]
            parts += [-off[:, self._ways], -drift[:, self._ways]]
        return np.clip(np.hstack(parts) * self._factors, -LIMIT, LIMIT)

    def _entries(self, hand: Hand) -> tuple[tuple[str, ...], Array]:
        """Names of all entries, and the factors that scale them."""
        drives, units = drive_names(hand), []
        for finger in hand.fingers:
            units += [hand.held.radius] * len(finger.slides)
            units += [1.0] * len(turn_axes(finger))
        unit = np.array(units)
        fine = FINE * unit
        groups = [
            ("position", unit), ("rate", unit / TIME), ("error", fine),
            ("rate_error", fine / TIME), ("mean_error", fine), ("command", np.ones_like(unit)),
            *((f"ahead_{time:g}", unit) for time in AHEAD),
        ]  # fmt: skip
        names = [f"{drive}.{group}" for group, _ in groups for drive in drives] + ["left"]
        scales = [*(values for _, values in groups), np.ones(1)]
        if self._full:
            near = FINE * np.array([hand.held.radius] * 3 + [1.0] * 3)[self._ways]
            for kind, values in (("error", near), ("rate_error", near / TIME)):
                names += [f"object.{WAYS[k]}.{kind}" for k in self._ways]
                scales.append(values)
        return tuple(names), 1.0 / np.concatenate(scales)


def drive_names(hand: Hand) -> tuple[str, ...]:
    """Of a hand's motors, as `rolling.joint_forces` has them."""
    names = []
    for finger in hand.fingers:
        names += [f"{finger.name}.slide{k + 1}" for k in range(len(finger.slides))]
        names += [f"{finger.name}.turn{k + 1}" for k in range(len(turn_axes(finger)))]
    return tuple(names)


def pose_error(outputs: Array, planned: Array) -> Array:
    """What poses (n, 12) are off planned ones: in place [m], and turned in space [rad], (n, 6)."""
    shape = (len(outputs), 3, 3)
    turn = outputs[:, 3:].reshape(shape) @ planned[:, 3:].reshape(shape).swapaxes(1, 2)
    twice = turn - turn.swapaxes(1, 2)
    axis = 0.5 * np.stack((twice[:, 2, 1], twice[:, 0, 2], twice[:, 1, 0]), axis=1)
    sine = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(sine, 0.5 * (np.trace(turn, axis1=1, axis2=2) - 1.0))
    stretch = np.where(sine > 1e-9, angle / np.where(sine > 1e-9, sine, 1.0), 1.0)
    return np.hstack((outputs[:, :3] - planned[:, :3], axis * stretch[:, None]))
