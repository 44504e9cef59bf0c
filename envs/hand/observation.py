"""What a policy sees of a hand: the entries of `flatrig.envs.sensing`, with its own units.

The unit of slides is the object's radius r, that of turns 1 rad, and the typical time is `TIME`.
With sensors="full" follow, for every way the object can move (planar: x, z and the turn about y):

    object.x.error, object.turn_x.error            plan - measured          over `FINE` r, `FINE`
    object.x.rate_error, object.turn_x.rate_error  the same of its twist

Turns are axis times angle in space.
"""

import numpy as np

from ...models.hand.hand import Hand
from ...models.types import Array
from ..sensing import FINE, Observation, Sensor
from ..signals import Encoders, Rows
from .plan import slide_drives, turn_axes
from .plant import HandPlant

TIME = 0.2
"""Time in which a typical motion goes one unit [s]."""

WAYS = ("x", "y", "z", "turn_x", "turn_y", "turn_z")
"""Ways in which the object can move."""


def observation_of(plant: HandPlant, encoders: Encoders, rows: Rows, full: bool) -> Observation:
    """The observations of n simulations, with the object's pose if `full`."""
    hand, planned = plant.hand, rows.parts
    units = np.where(slide_drives(hand), hand.held.radius, 1.0)
    ways = [0, 2, 4] if hand.planar else list(range(6))
    near = FINE * np.array([hand.held.radius] * 3 + [1.0] * 3)[ways]

    def pose(out: Array) -> None:
        np.negative(pose_error(plant.outputs, planned["outputs"])[:, ways], out)

    def twist(out: Array) -> None:
        np.negative((plant.twist - planned["output_rates"])[:, ways], out)

    sensors = [
        Sensor([f"object.{WAYS[way]}.error" for way in ways], near, pose),
        Sensor([f"object.{WAYS[way]}.rate_error" for way in ways], near / TIME, twist),
    ]
    names = drive_names(hand)
    home = np.zeros(len(names))
    return Observation(encoders, rows, names, units, TIME, home, sensors if full else ())


def drive_names(hand: Hand) -> tuple[str, ...]:
    """Names of a hand's motors, as `rolling.joint_forces` has them."""
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
    # Below 1e-9 rad angle and sine agree to rounding, and their quotient may be 0 / 0.
    stretch = np.where(sine > 1e-9, angle / np.where(sine > 1e-9, sine, 1.0), 1.0)
    return np.hstack((outputs[:, :3] - planned[:, :3], axis * stretch[:, None]))
