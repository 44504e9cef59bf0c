"""What a motion asks of drives beside what they can give: inputs, speeds, power and the like.

    for use in uses(rig, times, inputs, speeds, accelerations):
        use.drive.name, use.quantity, use.spare()           # "hoist", "speed", 1 - |v| / limit

All are those of the motor, before its gear.  The rate at which an input changes leaves out what
jumps, Coulomb friction and the loss of a gear, and is a mean from one sample to the next.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...models.rig.rig import Drive, Frame, Rig, Rope
from ...models.types import Array
from .losses import losses_of

Quantity = Literal["input", "speed", "acceleration", "power", "rate"]


@dataclass(frozen=True, eq=False)
class Use:
    """What one quantity of one drive is along a motion."""

    drive: Drive
    quantity: Quantity
    values: Array
    """Shape (..., N)."""
    unit: str

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest value."""
        if self.quantity == "input":
            return self.drive.lowest, self.drive.limit
        limit = getattr(self.drive, self.quantity)
        return -limit, limit

    def spare(self, share: float = 1.0) -> Array:
        """Share of a bound that is left, on the side where least is; 1 where nothing is asked.

        Inputs may use so much of their bounds.  Up to a bound beyond which an input has to stay, it
        is the way there over the drive's largest input.
        """
        return np.asarray(np.minimum(*self._sides(self.values, share)))

    def _sides(self, values: Array, share: float = 1.0) -> tuple[Array, Array]:
        """What is left below, and above."""
        low, high = self.bounds
        size = self.drive.largest
        below = 1.0 - values / (share * low) if low < 0 else (values - low) / size
        above = 1.0 - values / (share * high) if high > 0 else (high - values) / size
        return below, above

    def tightest(self) -> int:
        """The sample (of N alone) at which least is left."""
        low, high = self.bounds
        return int(np.abs(self.values).argmax() if low == -high else self.spare().argmin())

    def at(self, sample: int) -> tuple[float, float]:
        """Value at a sample and the bound on its side; magnitudes where both bounds are one."""
        value, (low, high) = float(self.values[sample]), self.bounds
        if low == -high:
            return abs(value), high
        below, above = self._sides(self.values[sample])
        return value, low if below < above else high

    def words(self, value: float) -> str:
        """A value with its unit, such as "27 N" or "a speed of 4.5 m/s"."""
        number = f"{value:.4g} {self.unit}"
        if self.quantity == "input":
            return number
        article = "an" if self.quantity == "acceleration" else "a"
        return f"{article} {self.quantity} of {number}"


def driven_unit(rig: Rig, drive: Drive) -> str:
    """Unit of an input: of a force, a torque, or the acceleration of what is given."""
    part = rig.driven(drive)
    if isinstance(part, Frame) and part.given:
        return "rad/s2" if part.kind == "turning" else "m/s2"
    turns = isinstance(part, Rope) or (isinstance(part, Frame) and part.kind == "turning")
    return "N m" if turns else "N"


def uses(
    rig: Rig, times: Array, inputs: Array, speeds: Array, accelerations: Array
) -> tuple[Use, ...]:
    """The inputs of all drives, and what else of them is limited.

    Parameters
    ----------
    rig
        The description.
    times
        Instants, ascending [s], shape (N,).
    inputs
        Shape (drives, ..., N).
    speeds, accelerations
        Of the driven coordinates, of the same shape.
    """
    found = []
    for i, drive in enumerate(rig.drives):
        unit, arm = driven_unit(rig, drive), rig.arm(drive)
        way = "rad" if unit in ("N m", "rad/s2") else "m"
        quantities: tuple[tuple[Quantity, Array, str], ...] = (
            ("input", inputs[i], unit),
            ("speed", speeds[i] / arm, f"{way}/s"),
            ("acceleration", accelerations[i] / arm, f"{way}/s2"),
            ("power", inputs[i] * speeds[i] / arm, "W"),
        )
        for quantity, values, measured in quantities:
            if quantity == "input" or math.isfinite(getattr(drive, quantity)):
                found.append(Use(drive, quantity, values, measured))
        if math.isfinite(drive.rate):
            found.append(Use(drive, "rate", _rates(rig, i, times, inputs, speeds), f"{unit}/s"))
    return tuple(found)


def _rates(rig: Rig, i: int, times: Array, inputs: Array, speeds: Array) -> Array:
    """Rates of change of one input from each sample to the next, shape (..., N); 0 at the last."""
    losses = losses_of(rig)
    smooth = inputs[i]
    if losses is not None:
        smooth = losses.smooth(np.moveaxis(inputs, 0, -1), np.moveaxis(speeds, 0, -1))[..., i]
    if len(times) < 2:
        return np.zeros_like(smooth)
    return np.asarray(np.diff(smooth, append=smooth[..., -1:]) / np.diff(times, append=np.inf))
