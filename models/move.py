"""What a rig is asked to do: a rest-to-rest move, as plain data."""

import math
from dataclasses import dataclass, fields
from typing import Literal

from .errors import PathError

PROFILES = ("polynomial", "three_phase", "sampled")


@dataclass(frozen=True)
class Move:
    """From rest at `start` to rest at `goal`; `feedforward.from_move` makes a reference of it.

    Raises:
        PathError: a value is wrong.
    """

    start: tuple[float, ...] = ()
    """Outputs at the start, in the order of `Rig.outputs`."""
    goal: tuple[float, ...] = ()
    """Outputs at the end."""
    duration: float = math.nan
    """[s]"""
    profile: Literal["polynomial", "three_phase", "sampled"] = "polynomial"
    """`polynomial`: degree 2 order + 1; `three_phase`: constant speed between two blends;
    `sampled`: a spline through the points of the file `samples`, which gives the values above."""
    order: int = 4
    """Number of continuous derivatives."""
    blend: float = 5.0
    """Duration of each blend of a three-phase profile [s]."""
    samples: str = ""
    """CSV file of a sampled path: time [s], then the outputs."""

    def __post_init__(self) -> None:
        for end in ("start", "goal"):
            object.__setattr__(self, end, tuple(float(value) for value in getattr(self, end)))
        if self.profile not in PROFILES:
            raise PathError(f"profile is {self.profile!r}, it must be one of {', '.join(PROFILES)}")
        if self.profile == "sampled":
            if not self.samples:
                raise PathError("a sampled move needs `samples`, the name of its CSV file")
            return
        if not self.start or len(self.start) != len(self.goal):
            raise PathError(
                f"start has {len(self.start)} values and goal {len(self.goal)}, "
                "both need one for each output"
            )
        for item in fields(self):
            value = getattr(self, item.name)
            for number in value if isinstance(value, tuple) else (value,):
                if isinstance(number, float) and not math.isfinite(number):
                    raise PathError(f"{item.name} is {value}, it must be finite")
        if not self.duration > 0:
            raise PathError(f"duration is {self.duration:g} s, it must be > 0")
