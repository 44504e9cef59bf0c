"""What gears lose in a simulation: friction of what a drive moves, as large as its input makes it.

A gear of efficiency e passes e u of an input u where the motor drives, and u / e where it is driven
(`flatrig.feedforward.exact.losses`).  MuJoCo's motors lose nothing.  To what they drive is added
dry friction that is bound to what is missing,

    (1 - e) |u| / arm  where u moves with the part,    (1 / e - 1) |u| / arm  against it,

substep by substep: while the part moves, that is the gear's law exactly, and where it stands still
the gear helps to hold it, up to the first of the two.
"""

from typing import NamedTuple

import mujoco
import numpy as np

from ...models.rig.idealised import with_ideal_gears
from ...models.rig.rig import Frame, Rig, Rope, Trolley
from ...models.types import Array


class Gear(NamedTuple):
    """A gear that loses power, and where that rubs."""

    drive: int
    """Column of its drive."""
    tendon: int | None
    """What it drives, if that is a tendon."""
    freedom: int
    """If it is a joint."""
    arm: float
    """See `Rig.arm` [m] or [1]."""
    efficiency: float

    def lost(self, inputs: Array, speeds: Array) -> Array:
        """Largest force of its friction (N,), from inputs and speeds of what it drives (N,)."""
        driven = inputs * speeds < 0
        share = np.where(driven, 1.0 / self.efficiency - 1.0, 1.0 - self.efficiency)
        return np.asarray(share * np.abs(inputs) / self.arm)


def loses(rig: Rig) -> bool:
    """Whether some gear of a rig loses power."""
    return with_ideal_gears(rig) is not rig


def driven_name(part: Frame | Trolley | Rope) -> str:
    """Name of the tendon or joint that a drive moves."""
    return part.name if isinstance(part, Rope) else part.coordinate


def gears_of(rig: Rig, model: mujoco.MjModel) -> tuple[Gear, ...]:
    """The gears of a rig that lose power."""
    tendons = {model.tendon(index).name: index for index in range(model.ntendon)}
    found = []
    for column, drive in enumerate(rig.drives):
        if drive.efficiency != 1.0:
            part = rig.driven(drive)
            name = driven_name(part)
            tendon = tendons.get(name)
            freedom = -1 if tendon is not None else int(model.joint(name).dofadr[0])
            found.append(Gear(column, tendon, freedom, rig.arm(drive), drive.efficiency))
    return tuple(found)
