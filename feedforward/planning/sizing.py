"""What a move asks of each drive, and which of its limits do not suffice."""

import math
from dataclasses import dataclass, replace

import numpy as np

from ..exact.drive_limits import Use, driven_unit, uses
from ..exact.motion import Motion
from ..paths.reference import Reference
from .uncertainty import input_uncertainty


@dataclass(frozen=True)
class Sizing:
    """What a move asks of one drive with the described friction (actuator dimensioning, K 3.3)."""

    drive: str
    unit: str
    """Unit of the input: "N m" on what turns, a winch's drum too, and "N" on what slides."""
    limit: float
    """Largest input of the drive on the side where the move comes closest to it [unit]."""
    largest: float
    """Magnitude of the input closest to its limit, the largest of a drive with a symmetric one
    [unit]."""
    when: float
    """When it is needed [s]."""
    rms: float
    """Root mean square of the input over the move [unit], which heats a motor."""
    speed: float
    """Largest speed of the motor: without a gear of the drum or frame [rad/s], or of what slides
    [m/s]."""
    power: float
    """Largest power that the drive delivers [W]."""
    braking: float
    """Largest power that it takes up [W]."""
    uncertain: float = 0.0
    """How far the input may be off because the path is a sampled one [unit], about."""
    beyond: tuple[str, ...] = ()
    """A sentence for each limit that does not suffice: of the input, speed, power and the like."""

    @property
    def within(self) -> bool:
        """Whether all limits suffice."""
        return not self.beyond

    @property
    def spare(self) -> float:
        """Share of the input's limit that is left; negative if it does not suffice."""
        return 1.0 - self.largest / self.limit if self.limit else -math.inf

    @property
    def rpm(self) -> float | None:
        """The speed of what turns, in revolutions per minute."""
        return self.speed * 30.0 / math.pi if self.unit in ("N m", "rad/s2") else None


def sizings(motion: Motion, reference: Reference) -> tuple[Sizing, ...]:
    """What the move asks of each drive, and how certain that is."""
    uncertain = input_uncertainty(motion, reference)
    sizing = (_sizing(motion, i) for i in range(len(motion.rig.drives)))
    if uncertain is None:
        return tuple(sizing)
    pairs = zip(sizing, uncertain.tolist(), strict=True)
    return tuple(replace(part, uncertain=value) for part, value in pairs)


def drive_uses(motion: Motion) -> tuple[Use, ...]:
    """What a motion asks of drives, see `exact.drive_limits`."""
    driven = motion.driven
    rates = motion.velocities[:, driven].T, motion.accelerations[:, driven].T
    return uses(motion.rig, motion.times, motion.inputs.T, *rates)


def _beyond(motion: Motion, use: Use) -> str:
    """A sentence for a limit that does not suffice."""
    i = use.tightest()
    value, limit = use.at(i)
    return (
        f"drive {use.drive.name} would need {use.words(value)} at {motion.times[i]:.4g} s, "
        f"its limit is {limit:.4g} {use.unit}"
    )


def _sizing(motion: Motion, i: int) -> Sizing:
    drive = motion.rig.drives[i]
    own = [use for use in drive_uses(motion) if use.drive is drive]
    peak = own[0].tightest()
    value, limit = own[0].at(peak)
    arm = motion.rig.arm(drive)
    inputs, speeds = motion.inputs[:, i], motion.drive_velocities[:, i] / arm
    unit = driven_unit(motion.rig, drive)
    power = inputs * speeds * unit.startswith("N") + 0.0  # an acceleration has none
    return Sizing(
        drive=drive.name,
        unit=unit,
        limit=abs(limit),
        largest=abs(value),
        when=float(motion.times[peak]),
        rms=float(np.sqrt(np.mean(inputs**2))),
        speed=float(np.abs(speeds).max()),
        power=float(power.max(initial=0.0)),
        braking=float(-power.min(initial=0.0)),
        beyond=tuple(_beyond(motion, use) for use in own if use.spare().min() < 0.0),
    )
