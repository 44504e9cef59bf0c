"""What moves a base, as plain data: sinusoids and recordings, added to columns of a path."""

from dataclasses import dataclass

from ..errors import PathError, RigError
from ..values import number, sequence, shown, whole, word


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
class Record:
    """A recording in columns of a path, as a ship's motion sensor makes it.

    It may start and end in motion, and repeats, its end fading into its beginning, so that a base
    moves on however long an episode lasts.

    Raises
    ------
    PathError
        A field has a value that it cannot have.
    """

    samples: str
    """Name of the CSV file: time [s], then a column for each of `columns` [m], [rad]."""
    columns: tuple[int, ...]
    """Columns of the path, counted from 0, in the file's order: of coordinates of frames whose
    motion is given."""
    start: float = 0.0
    """Time after the first sample at which the path starts [s]: a smooth curve through noisy
    samples is least sure at its ends."""
    fade: float = 5.0
    """How long the end takes to fade into the beginning [s]."""
    tolerance: float = 1e-6
    """How far a sample may lie off the spline through them [m], [rad]."""

    def __post_init__(self) -> None:
        try:
            word("record: samples", self.samples)
            given = sequence("record: columns", self.columns)
            columns = tuple(whole("record: columns", column) for column in given)
            object.__setattr__(self, "columns", columns)
            for name in ("start", "fade", "tolerance"):
                object.__setattr__(self, name, number(f"record: {name}", getattr(self, name)))
        except RigError as error:
            raise PathError(str(error)) from None
        if not self.samples:
            raise PathError("record: samples is empty, it must be the name of a CSV file")
        if not columns or len(set(columns)) < len(columns):
            raise PathError(
                f"record: columns is {shown(columns)}, it must be one column or more, each once"
            )
        if not self.start >= 0:
            raise PathError(f"record: start is {self.start:g} s, it must be >= 0")
        if not self.fade > 0:
            raise PathError(f"record: fade is {self.fade:g} s, it must be > 0")
        if not self.tolerance >= 0:
            raise PathError(f"record: tolerance is {self.tolerance:g}, it must be >= 0")
