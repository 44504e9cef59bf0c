"""What a hand is asked to do with its object: bring it from one pose to another.

HandMove(goal=(pi / 4, 0, pi / 3), start=(pi / 3, pi / 4, 0), duration=10, turning="rolling")
"""

from dataclasses import dataclass
from typing import Literal

from ..errors import RigError, did_you_mean
from ..values import Vector, number, sequence, vector, word

TURNINGS = {
    "rpy": "RPY angles from rest to rest, everything else integrated",
    "axis": "about one fixed axis, the shortest way",
    "rolling": "without spin: psi a cubic in theta (K 2.105 to 2.108)",
    "spinning": "by the flat output of K's proposition 5, contact points prescribed too",
}


def _pairs(label: str, values: object) -> tuple[tuple[float, float], ...]:
    pairs = []
    for value in sequence(label, values):
        pair = sequence(label, value)
        if len(pair) != 2:
            raise RigError(f"{label} has {len(pair)} numbers for one contact, it needs 2")
        pairs.append((number(label, pair[0]), number(label, pair[1])))
    return tuple(pairs)


@dataclass(frozen=True)
class HandMove:
    """From rest in one pose to rest in another.

    Orientations are RPY angles (phi, theta, psi), Rz(phi) Ry(theta) Rx(psi) (K 2.15), or the one
    angle of a planar hand, positive from x to z.

    Raises
    ------
    RigError
        A field has a value that it cannot have.
    """

    goal: tuple[float, ...]
    """Orientation at the end [rad]."""
    start: tuple[float, ...] = ()
    """Orientation at the start [rad]; upright if left out."""
    duration: float = 1.0
    """Time from rest to rest [s]."""
    turning: Literal["rpy", "axis", "rolling", "spinning"] = "rpy"
    """How the orientation goes from one to the other; `TURNINGS` says what each means."""
    order: int = 4
    """Number of continuous derivatives of the path; forces need two."""
    shift: Vector = (0.0, 0.0, 0.0)
    """Displacement of the object's centre [m], but for what rolling decides by itself."""
    touch: tuple[float, float] | None = None
    """Place (x, y) on the first finger's plate where its contact is to end [m], for "spinning"
    only; it begins in the plate's middle."""
    contacts: tuple[tuple[float, float], ...] = ()
    """Azimuth and latitude of the contact of each turning tip on the object at the end [rad], in
    the object's axes (K 2.109)."""
    start_contacts: tuple[tuple[float, float], ...] = ()
    """Azimuth and latitude of these contacts at the start [rad]; the hand's contacts at home if
    left out."""

    def __post_init__(self) -> None:
        for name in ("goal", "start"):
            values = sequence(f"move: {name}", getattr(self, name))
            angles = tuple(number(f"move: {name}", value) for value in values)
            if len(angles) not in ((1, 3) if name == "goal" else (0, 1, 3)):
                raise RigError(f"move: {name} has {len(angles)} angles, it needs 3, or 1 in plane")
            object.__setattr__(self, name, angles)
        if not self.start:
            object.__setattr__(self, "start", (0.0,) * len(self.goal))
        if len(self.start) != len(self.goal):
            raise RigError(f"move: start has {len(self.start)} angles and goal {len(self.goal)}")
        if word("move: turning", self.turning) not in TURNINGS:
            known = did_you_mean(self.turning, TURNINGS)
            raise RigError(f"move: turning is {self.turning!r}{known}")
        object.__setattr__(self, "duration", number("move: duration", self.duration))
        object.__setattr__(self, "shift", vector("move: shift", self.shift))
        if self.touch is not None:
            object.__setattr__(self, "touch", _pairs("move: touch", (self.touch,))[0])
        for name in ("contacts", "start_contacts"):
            object.__setattr__(self, name, _pairs(f"move: {name}", getattr(self, name)))
