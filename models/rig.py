"""What a rig is: frames, rails, masses and ropes, and what drives and describes them.

A `Rig` is plain data in the words of the field.  The planar overhead crane is

    Rig(
        name="overhead_crane",
        dimensions=2,
        rails=(Rail("beam", direction=(1, 0, 0)),),
        masses=(Trolley("trolley", mass=10.0, rail="beam"), Load("load", mass=100.0)),
        ropes=(Rope("hoist", path=("trolley", "load"), drum_radius=0.1, winch_inertia=0.1),),
        drives=(Drive("trolley", on="trolley", limit=1e3), Drive("winch", on="hoist", limit=2e2)),
        outputs=("load.x", "load.z"),
        home={"trolley": 0.0, "load": (0.0, 0.0, -4.0)},
    )

Everything is checked on construction; a `RigError` says in one line what is wrong.
Units are SI, z points up, a rope's length grows when its winch pays out, and a winch's
torque is positive when it pays out.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

from .errors import RigError
from .parts import WORLD, Anchor, Drive, Frame, Load, Rail, Rope, Sheave, Trolley, Vector
from .validation import validate

__all__ = [
    "WORLD",
    "Anchor",
    "Drive",
    "Frame",
    "Home",
    "Load",
    "Rail",
    "Rig",
    "Rope",
    "Sheave",
    "Trolley",
    "Vector",
]

Home = Mapping[str, float | Vector]


@dataclass(frozen=True)
class Rig:
    """A crane: its parts, its inputs, and the coordinates that a reference path prescribes.

    Parameters are checked on construction.

    Raises:
        RigError: a value or a name is wrong; the message says which and what would be right.
    """

    name: str
    masses: tuple[Trolley | Load, ...]
    ropes: tuple[Rope, ...]
    drives: tuple[Drive, ...]
    outputs: tuple[str, ...]
    """Coordinates that a reference prescribes, in the order of its columns."""
    frames: tuple[Frame, ...] = ()
    anchors: tuple[Anchor, ...] = ()
    rails: tuple[Rail, ...] = ()
    home: Home = field(default_factory=dict, hash=False)
    """A configuration at rest: angle [rad] or position [m] of each frame and trolley (0 if
    left out), (x, y, z) [m] of each load.  It fixes the branch of the equations' solutions."""
    dimensions: Literal[2, 3] = 3
    """2: everything stays in the plane y = 0."""
    gravity: float = 9.81
    """[m/s2], along -z."""

    def __post_init__(self) -> None:
        _normalise(self)
        validate(self)

    @cached_property
    def input_names(self) -> tuple[str, ...]:
        """Names of the inputs, in the order of `drives`."""
        return tuple(drive.name for drive in self.drives)

    @cached_property
    def rope_names(self) -> tuple[str, ...]:
        """Names of the ropes."""
        return tuple(rope.name for rope in self.ropes)

    @property
    def axes(self) -> str:
        """Letters of the axes in which loads move: "xz" or "xyz"."""
        return "xz" if self.dimensions == 2 else "xyz"

    @cached_property
    def coordinate_names(self) -> tuple[str, ...]:
        """Names of the coordinates that may be prescribed: frames, trolleys, ropes, loads."""
        names = [frame.coordinate for frame in self.frames]
        names += [mass.coordinate for mass in self.trolleys]
        names += [rope.coordinate for rope in self.ropes]
        names += [f"{load.name}.{axis}" for load in self.loads for axis in self.axes]
        return tuple(names)

    @property
    def trolleys(self) -> tuple[Trolley, ...]:
        """The masses on rails."""
        return tuple(mass for mass in self.masses if isinstance(mass, Trolley))

    @property
    def loads(self) -> tuple[Load, ...]:
        """The free masses."""
        return tuple(mass for mass in self.masses if isinstance(mass, Load))

    def frame(self, name: str) -> Frame | None:
        """The frame of that name; None for the world."""
        return next((frame for frame in self.frames if frame.name == name), None)

    def rail(self, name: str) -> Rail:
        """The rail of that name."""
        return next(rail for rail in self.rails if rail.name == name)

    def driven(self, drive: Drive) -> Frame | Trolley | Rope:
        """What a drive acts on."""
        parts: tuple[Frame | Trolley | Rope, ...] = (*self.frames, *self.trolleys, *self.ropes)
        return next(part for part in parts if part.name == drive.on)

    def home_of(self, part: Frame | Trolley | Load) -> float | Vector:
        """Home value of a frame, trolley or load."""
        return self.home.get(part.name, (0.0, 0.0, 0.0) if isinstance(part, Load) else 0.0)


def _normalise(rig: Rig) -> None:
    """Make tuples of lists, so that a rig is hashable whatever it was built from."""
    for name in ("masses", "ropes", "drives", "outputs", "frames", "anchors", "rails"):
        _freeze(rig, name)
    object.__setattr__(rig, "masses", (*rig.trolleys, *rig.loads))
    for part in (*rig.frames, *rig.anchors, *rig.rails, *rig.ropes):
        for name in ("axis", "position", "direction", "origin", "path", "sheaves"):
            if hasattr(part, name):
                _freeze(part, name)
    if not isinstance(rig.home, Mapping):
        raise RigError(f"home is {rig.home!r}, it must map names to positions")
    home = {
        key: tuple(value) if isinstance(value, list) else value for key, value in rig.home.items()
    }
    object.__setattr__(rig, "home", home)


def _freeze(owner: object, name: str) -> None:
    value = getattr(owner, name)
    if not isinstance(value, list | tuple):
        label = f"{type(owner).__name__.lower()} {getattr(owner, 'name', '')}"
        raise RigError(f"{label}: {name} is {value!r}, it must be a list")
    object.__setattr__(owner, name, tuple(value))
