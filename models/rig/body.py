"""The bodies of a rig's MuJoCo model, where they stand at home, and the joints that move them."""

from collections.abc import Iterable
from dataclasses import dataclass

from ..errors import ModelError
from .frames import inwards
from .rig import Frame, Load, Platform, Rig, Trolley, Vector
from .swings import Swing

Mass = Trolley | Load | Platform
Part = Frame | Mass


@dataclass(frozen=True)
class Body:
    """A body of the model with the joints that move it against its parent."""

    part: Part
    parent: "Body | None"
    """The body that carries this one; None for the world."""
    frame: Frame | None
    """The frame in whose axes this body's joints are; None for the world."""
    position: Vector
    """Position of the body at home, in the parent's axes, from the parent's origin [m]."""
    joints: tuple[str, ...]
    """Names of the joints, in the order of qpos."""
    home: tuple[float, ...]
    """Value of each joint at home [m], [rad]."""
    sums: tuple[tuple[str, float], ...] = ()
    """Joints and coefficients whose sum is the trolley's position on its rail, if not one joint."""
    swing: Swing | None = None
    """How the load swings on a link, if it does; its position is the point that it swings about."""

    @property
    def name(self) -> str:
        """Name of the body."""
        return self.part.name


def frame_body(rig: Rig, frame: Frame, parent: Body | None) -> Body:
    """A frame on what carries it."""
    value = rig.home_of(frame)
    shift = value if frame.kind == "sliding" else 0.0
    pairs = zip(frame.origin, frame.axis, strict=True)
    position = _vector(start + shift * part for start, part in pairs)
    return Body(frame, parent, frame, position, (frame.coordinate,), (value,))


def trolley_body(rig: Rig, trolley: Trolley, parent: Body | None) -> Body:
    """A trolley below what its ropes tie it to.

    Raises
    ------
    ModelError
        That is a trolley on a rail that is not parallel.
    """
    rail = rig.rail(trolley.rail)
    value = rig.home_of(trolley)
    sums: tuple[tuple[str, float], ...] = ()
    if parent is not None and isinstance(parent.part, Trolley):
        other = rig.rail(parent.part.rail)
        along = sum(a * b for a, b in zip(rail.direction, other.direction, strict=True))
        if abs(abs(along) - 1) > 1e-9:
            raise ModelError(
                f"ropes tie trolley {trolley.name} to trolley {parent.name}, whose rail "
                f"{other.name} is not parallel to rail {rail.name}; MuJoCo's mass matrix can "
                "only hold ropes between trolleys on parallel rails of one frame"
            )
        sign = 1.0 if along > 0 else -1.0
        upper = parent.sums or ((parent.joints[0], 1.0),)
        value -= sign * rig.home_of(parent.part)
        sums = (*((name, sign * factor) for name, factor in upper), (trolley.coordinate, 1.0))
    frame = rig.frame(rail.frame)
    position = _minus(_home_point(rig, trolley, frame), _origin(rig, parent))
    return Body(trolley, parent, frame, position, (trolley.coordinate,), (value,), sums)


def free_body(rig: Rig, mass: Load | Platform, parent: Body | None, frame: Frame | None) -> Body:
    """Slides for a load; slides, then hinges for the angles of a platform."""
    position = _minus(_home_point(rig, mass, frame), _origin(rig, parent))
    joints = tuple(f"{mass.name}.{axis}" for axis in rig.axes)
    home = tuple(position["xyz".index(axis)] for axis in rig.axes)
    if isinstance(mass, Platform):
        angles = rig.angles_of(mass)
        joints, home = (*joints, *angles), (*home, *(0.0 for _ in angles))
    return Body(mass, parent, frame, position, joints, home)


def _origin(rig: Rig, link: Body | None) -> Vector:
    """Home position of a body in its frame's axes, from the frame's origin."""
    if link is None or isinstance(link.part, Frame):
        return (0.0, 0.0, 0.0)
    return _home_point(rig, link.part, link.frame)


def _home_point(rig: Rig, mass: Mass, frame: Frame | None) -> Vector:
    """Home position of a mass in its frame's axes, from the frame's origin."""
    return _vector(inwards(rig.frames, frame, rig.home_of, rig.home_point(mass.name)))


def _vector(values: Iterable[float]) -> Vector:
    """Three numbers, rounded so that exported scenes stay readable: 5.2 - 5 is 0.2."""
    x, y, z = (float(f"{value:.14g}") for value in values)
    return (x, y, z)


def _minus(point: Vector, other: Vector) -> Vector:
    return _vector(a - b for a, b in zip(point, other, strict=True))
