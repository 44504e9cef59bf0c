"""Which body hangs from which: the chains of a rig's MuJoCo model.

MuJoCo keeps mass-matrix entries only between a degree of freedom and its ancestors, and drops
the others of a tendon's armature without a word.  So all masses that ropes tie to one another,
directly or through other masses, sit on one chain, below the frame that carries their rails and
anchors: frame, then trolleys, then free pulleys, then loads, then the platform.  Each body's joints
count from the body above it; `flatrig.models.mjcf.rig_state` converts.

A platform ends its chain, since whatever is below it would turn with it.  Its three hinges are its
Bryant angles, whose first and last axis fall together at beta = +-90 degrees (gimbal lock); a
platform on ropes does not get there.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from math import cos, sin
from typing import cast

from ..errors import ModelError
from .frames import refuse_nested
from .rig import WORLD, Frame, Load, Platform, Rig, Rope, Trolley, Vector

Mass = Trolley | Load | Platform
Part = Frame | Mass


@dataclass(frozen=True)
class Link:
    """A body of the model with the joints that move it against its parent."""

    part: Part
    parent: "Link | None"
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

    @property
    def name(self) -> str:
        """Name of the body."""
        return self.part.name


@lru_cache(maxsize=64)
def links(rig: Rig) -> tuple[Link, ...]:
    """The bodies of a rig's model, each after its parent, in the order of MuJoCo's bodies.

    Raises
    ------
    ModelError
        Ropes tie together what cannot sit on one chain.
    """
    refuse_nested(rig.name, rig.frames)
    if rig.links or (rig.platforms and rig.dimensions == 2):
        part = "links" if rig.links else "platforms in a plane"
        raise ModelError(f"rig {rig.name} has {part}, of which there is no MuJoCo model yet")
    components = _components(rig)
    carriers = [_carrier(rig, members) for members in components]
    chain: list[Link] = []
    for frame in (*rig.frames, None):
        above = None if frame is None else _frame_link(rig, frame)
        chain += [] if above is None else [above]
        for members, carrier in zip(components, carriers, strict=True):
            if carrier is frame:
                chain += _chain(rig, members, above)
    return tuple(chain)


def joint_names(rig: Rig) -> tuple[str, ...]:
    """Names of the model's joints in the order of qpos and qvel."""
    return tuple(name for link in links(rig) for name in link.joints)


def _tied(rig: Rig, rope: Rope) -> set[str]:
    """Names of what a rope's path touches, a platform in place of its corners."""
    corners = {a.name: a.frame for a in rig.anchors if rig.platform(a.frame) is not None}
    return {corners.get(point, point) for point in rope.path}


def _components(rig: Rig) -> list[list[Mass]]:
    """Trolleys, loads and platforms, grouped by the ropes that tie them together."""
    groups: list[set[str]] = [{mass.name} for mass in rig.masses]
    for rope in rig.ropes:
        tied = [group for group in groups if group & _tied(rig, rope)]
        if tied:
            groups = [group for group in groups if group not in tied] + [set().union(*tied)]
    components = [[mass for mass in rig.masses if mass.name in group] for group in groups]
    return sorted(components, key=lambda members: rig.masses.index(members[0]))


def _carrier(rig: Rig, members: list[Mass]) -> Frame | None:
    """The frame below which a group of masses hangs; None for the world."""
    names = {mass.name for mass in members}
    ropes = [rope for rope in rig.ropes if names & _tied(rig, rope)]
    carried = {
        mass.name: rig.rail(mass.rail).frame for mass in members if isinstance(mass, Trolley)
    }
    carried |= {
        anchor.name: anchor.frame
        for anchor in rig.anchors
        if anchor.frame not in names and any(anchor.name in rope.path for rope in ropes)
    }
    moving = {name: frame for name, frame in carried.items() if frame != WORLD}
    frames = sorted(set(moving.values()))
    if len(frames) > 1:
        raise ModelError(
            f"{_ropes(ropes)} tie frames {' and '.join(frames)} together, "
            "MuJoCo's mass matrix can only hold ropes on one chain of bodies; use one frame"
        )
    for mass in members:
        if frames and isinstance(mass, Trolley) and carried[mass.name] == WORLD:
            raise ModelError(
                f"{_ropes(ropes)} tie trolley {mass.name}, whose rail is fixed, to frame "
                f"{frames[0]}; put its rail in frame {frames[0]} or the anchors in the world"
            )
    return rig.frame(frames[0]) if frames else None


def _ropes(ropes: list[Rope]) -> str:
    plural = "s" if len(ropes) > 1 else ""
    return f"rope{plural} {', '.join(rope.name for rope in ropes)}"


def _frame_link(rig: Rig, frame: Frame) -> Link:
    value = rig.home_of(frame)
    shift = value if frame.kind == "sliding" else 0.0
    position = _vector(shift * part for part in frame.axis)
    return Link(frame, None, frame, position, (frame.coordinate,), (value,))


def _chain(rig: Rig, members: list[Mass], above: Link | None) -> list[Link]:
    """Trolleys, then free pulleys, then loads, then a platform, each on the one before."""
    loads = [mass for mass in members if isinstance(mass, Load)]
    platforms = [mass for mass in members if isinstance(mass, Platform)]
    _check_platforms(platforms, above)
    chain: list[Link] = []
    for mass in members:
        if isinstance(mass, Trolley):
            chain.append(_trolley_link(rig, mass, chain[-1] if chain else above))
    for load in sorted(loads, key=lambda load: load.name not in rig.pulleys):
        frame = None if above is None else above.frame
        chain.append(_free_link(rig, load, chain[-1] if chain else above, frame))
    for platform in platforms:
        frame = None if above is None else above.frame
        chain.append(_free_link(rig, platform, chain[-1] if chain else above, frame))
    return chain


def _check_platforms(platforms: list[Platform], above: Link | None) -> None:
    if len(platforms) > 1:
        names = " and ".join(platform.name for platform in platforms)
        raise ModelError(
            f"ropes tie platforms {names} together, of which the lower would turn with the upper "
            "in MuJoCo's chain of bodies; tie each to trolleys, loads or anchors only"
        )
    if platforms and above is not None and cast(Frame, above.part).kind == "turning":
        raise ModelError(
            f"platform {platforms[0].name} hangs from turning frame {above.name}, but its angles "
            "count from fixed axes; hang it from a sliding frame or from the world"
        )


def _trolley_link(rig: Rig, trolley: Trolley, parent: Link | None) -> Link:
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
    return Link(trolley, parent, frame, position, (trolley.coordinate,), (value,), sums)


def _free_link(rig: Rig, mass: Load | Platform, parent: Link | None, frame: Frame | None) -> Link:
    """Slides for a load; slides, then hinges for the angles of a platform."""
    position = _minus(_home_point(rig, mass, frame), _origin(rig, parent))
    joints = tuple(f"{mass.name}.{axis}" for axis in rig.axes)
    home = tuple(position["xyz".index(axis)] for axis in rig.axes)
    if isinstance(mass, Platform):
        joints, home = (*joints, *mass.angles), (*home, 0.0, 0.0, 0.0)
    return Link(mass, parent, frame, position, joints, home)


def _origin(rig: Rig, link: Link | None) -> Vector:
    """Home position of a body in its frame's axes, from the frame's origin."""
    if link is None or isinstance(link.part, Frame):
        return (0.0, 0.0, 0.0)
    return _home_point(rig, link.part, link.frame)


def _home_point(rig: Rig, mass: Mass, frame: Frame | None) -> Vector:
    """Home position of a mass in its frame's axes, from the frame's origin."""
    x, y, z = point = rig.home_point(mass.name)
    if frame is None:
        return point
    value = rig.home_of(frame)
    if frame.kind == "sliding":
        return _minus(point, _vector(value * part for part in frame.axis))
    return _vector((x * cos(value) + y * sin(value), y * cos(value) - x * sin(value), z))


def _vector(values: Iterable[float]) -> Vector:
    """Three numbers, rounded so that exported scenes stay readable: 5.2 - 5 is 0.2."""
    x, y, z = (float(f"{value:.14g}") for value in values)
    return (x, y, z)


def _minus(point: Vector, other: Vector) -> Vector:
    return _vector(a - b for a, b in zip(point, other, strict=True))
