"""What a rig is asked to do: a rest-to-rest move, as plain data."""

from dataclasses import dataclass
from typing import Any, Literal

from ..errors import PathError, RigError, did_you_mean
from ..values import number, sequence, shown, whole, word
from .obstacles import Box, Sphere, check_radius
from .sea import Record, Wave

PROFILES = ("polynomial", "three_phase", "sampled")
PARTS: dict[str, tuple[type, ...]] = {
    "waves": (Wave,),
    "records": (Record,),
    "obstacles": (Sphere, Box),
}
"""Fields of a move that hold parts, and of which classes."""


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
    records: tuple[Record, ...] = ()
    """Recordings of its motion, added likewise."""
    frame: str = ""
    """Name of the frame whose motion is given on which the loads' places are given, as on a deck:
    they are those that loads would have with all such frames at 0.  In the world without it."""

    rise: tuple[float, ...] = ()
    """How far the middle of the way lies from that of the straight one, for each output: a
    parabola over what stands in between."""
    waypoints: tuple[tuple[float, ...], ...] = ()
    """Values of the outputs through which a smooth curve leads from start to goal."""
    obstacles: tuple[Sphere | Box, ...] = ()
    """What stands around; `feedforward.clearance` says how near the move comes."""
    load_radius: float = 0.0
    """Radius that loads and platforms have among obstacles [m]."""

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
        columns = [("wave: column", wave.column) for wave in self.waves]
        columns += [("record: columns", c) for record in self.records for c in record.columns]
        for label, column in columns:
            if self.start and not 0 <= column < len(self.start):
                raise PathError(f"{label} is {column}, it must be 0 to {len(self.start) - 1}")
        if self.profile == "sampled":
            if self.turning or self.rise or self.waypoints:
                raise PathError(
                    "a sampled move's file says how it goes; leave `turning`, `rise` and "
                    "`waypoints` out"
                )
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
        self._check_curve()

    def _check_curve(self) -> None:
        """Refuse curves that cannot be, or not with the rest of the move."""
        if self.rise and self.waypoints:
            raise PathError("a move has a rise or waypoints, not both")
        if self.turning and (self.rise or self.waypoints):
            raise PathError(
                "a move whose platform turns about one axis is straight: no rise or waypoints"
            )
        for name, values in [("rise", self.rise)] + [("a waypoint", w) for w in self.waypoints]:
            if values and len(values) != len(self.start):
                raise PathError(
                    f"{name} is {values}, it needs {len(self.start)} numbers, one for each output"
                )

    def _clean(self) -> None:
        """Make plain numbers and names of the fields."""
        turning = tuple(whole("turning", column) for column in sequence("turning", self.turning))
        object.__setattr__(self, "turning", turning)
        for kind, parts in PARTS.items():
            held = sequence(kind, getattr(self, kind))
            for item in held:
                if not isinstance(item, parts):
                    wanted = " or a ".join(part.__name__ for part in parts)
                    raise RigError(f"{kind} holds {shown(item)}, it must be a {wanted}")
            object.__setattr__(self, kind, held)
        for end in ("start", "goal", "rise"):
            object.__setattr__(self, end, _numbers(end, getattr(self, end)))
        points = sequence("waypoints", self.waypoints)
        points = tuple(_numbers("a waypoint", point) for point in points)
        object.__setattr__(self, "waypoints", points)
        for name in ("duration", "blend", "load_radius"):
            object.__setattr__(self, name, number(name, getattr(self, name)))
        check_radius("load_radius", self.load_radius)
        for name in ("profile", "samples", "frame"):
            word(name, getattr(self, name))


def _numbers(label: str, values: Any) -> tuple[float, ...]:
    return tuple(number(label, value) for value in sequence(label, values))
