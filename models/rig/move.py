"""What a rig is asked to do: a rest-to-rest move, as plain data."""

from dataclasses import dataclass
from typing import Literal

from ..errors import PathError, RigError, did_you_mean
from ..values import number, sequence, shown, whole, word

PROFILES = ("polynomial", "three_phase", "sampled")


@dataclass(frozen=True)
class Wave:
    """A sinusoid in one column of a path: a base that heaves, rolls or pitches.

    Raises
    ------
    PathError
        A field has a value that it cannot have.
    """

    column: int
    """Column, counted from 0: of the coordinate of a frame whose motion is given."""
    amplitude: float
    """Amplitude [m] or [rad]."""
    period: float
    """Period [s]."""
    phase: float = 0.0
    """Phase at t = 0 [rad]: amplitude sin(2 pi t / period + phase)."""

    def __post_init__(self) -> None:
        try:
            object.__setattr__(self, "column", whole("wave: column", self.column))
            for name in ("amplitude", "period", "phase"):
                object.__setattr__(self, name, number(f"wave: {name}", getattr(self, name)))
        except RigError as error:
            raise PathError(str(error)) from None
        if not self.period > 0:
            raise PathError(f"wave: period is {self.period:g} s, it must be > 0")


@dataclass(frozen=True)
class Move:
    """From rest at `start` to rest at `goal`; `feedforward.from_move` makes a reference of it.

    Raises
    ------
    PathError
        A field has a value that it cannot have.
    """

    start: tuple[float, ...] = ()
    """Values of the outputs at the start [m], [rad], in the order of `Rig.outputs`."""
    goal: tuple[float, ...] = ()
    """Values of the outputs at the end [m], [rad], in the same order."""
    duration: float = 0.0
    """Time from rest to rest [s]."""
    profile: Literal["polynomial", "three_phase", "sampled"] = "polynomial"
    """Shape of the way in time: `polynomial` of degree 2 order + 1; `three_phase`, a constant
    speed between two blends; `sampled`, a spline through the points of the file `samples`, which
    then gives the values above."""
    order: int = 4
    """Number of continuous derivatives of the path."""
    blend: float = 5.0
    """Duration of each blend of a three-phase profile [s]."""
    turning: tuple[int, ...] = ()
    """Columns, counted from 0, of the three Bryant angles of a platform that is to turn about one
    fixed axis; without them each angle goes its own straight way."""
    samples: str = ""
    """Name of the CSV file of a sampled path, with the columns time [s] and the outputs."""

    waves: tuple[Wave, ...] = ()
    """Sinusoids of a base that moves, added to columns of the path, before it and after it, too."""

    def __post_init__(self) -> None:
        try:
            self._clean()
        except RigError as error:
            raise PathError(f"move: {error}") from None
        if self.profile not in PROFILES:
            known = did_you_mean(self.profile, PROFILES)
            raise PathError(f"there is no profile {self.profile!r}{known}")
        if isinstance(self.order, bool) or not isinstance(self.order, int) or self.order < 0:
            raise PathError(f"move: order is {self.order!r}, it must be a whole number >= 0")
        for wave in self.waves:
            if self.start and not 0 <= wave.column < len(self.start):
                raise PathError(
                    f"wave: column is {wave.column}, it must be 0 to {len(self.start) - 1}"
                )
        if self.profile == "sampled":
            if self.turning:
                raise PathError("a sampled move's file says how it turns; leave `turning` out")
            if not self.samples:
                raise PathError("a sampled move needs `samples`, the name of its CSV file")
            return
        if not self.start or len(self.start) != len(self.goal):
            raise PathError(
                f"start has {len(self.start)} values and goal {len(self.goal)}, "
                "both need one for each output"
            )
        three = len(set(self.turning)) == len(self.turning) == 3
        if self.turning and not (three and set(self.turning) <= set(range(len(self.start)))):
            raise PathError(
                f"move: turning is {self.turning}, it must be three columns of 0 to "
                f"{len(self.start) - 1}"
            )
        if not self.duration > 0:
            raise PathError(f"duration is {self.duration:g} s, it must be > 0")

    def _clean(self) -> None:
        """Make plain numbers and names of the fields."""
        turning = tuple(whole("turning", column) for column in sequence("turning", self.turning))
        object.__setattr__(self, "turning", turning)
        waves = sequence("waves", self.waves)
        for wave in waves:
            if not isinstance(wave, Wave):
                raise RigError(f"waves holds {shown(wave)}, it must be a Wave")
        object.__setattr__(self, "waves", waves)
        for end in ("start", "goal"):
            values = tuple(number(end, value) for value in sequence(end, getattr(self, end)))
            object.__setattr__(self, end, values)
        for name in ("duration", "blend"):
            object.__setattr__(self, name, number(name, getattr(self, name)))
        for name in ("profile", "samples"):
            word(name, getattr(self, name))
