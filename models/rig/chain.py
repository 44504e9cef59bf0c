"""Which body hangs from which: the chains of a rig's MuJoCo model.

MuJoCo keeps mass-matrix entries only between a degree of freedom and its ancestors, and drops
the others of a tendon's armature without a word.  So all masses that ropes tie to one another,
directly or through other masses, sit on one chain, below the frame that carries their rails and
anchors: frames from the ground up, then trolleys, then free pulleys, then loads, then the platform.
Each body's joints count from the body above it; `flatrig.models.mjcf.rig_state` converts.

Some rigs have no such chain: two frames that hold one load, trolleys on rails that are not
parallel, two platforms that ropes tie together, a platform below a frame that turns.  Their masses
stand apart, each a tree of its own, and their ropes are constraints.

A platform ends its chain, since whatever is below it would turn with it.  Its three hinges are its
Bryant angles, whose first and last axis fall together at beta = +-90 degrees (gimbal lock); a
platform on ropes does not get there.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

from ..errors import ModelError
from .frames import carriers, inwards
from .link import Link
from .rig import WORLD, Frame, Load, Platform, Rig, Trolley, Vector
from .swings import Swing, Tie, swinging, swings, ties

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


@lru_cache(maxsize=64)
def chain_of(rig: Rig) -> tuple[Body, ...]:
    """The bodies of a rig's model, each after its parent, in the order of MuJoCo's bodies."""
    if apart(rig):
        groups = [[mass] for component in _components(rig) for mass in component]
        carried = [_own_frame(rig, mass) for (mass,) in groups]
        return _bodies(rig, groups, carried)
    components = _components(rig)
    return _bodies(rig, components, [_carrier(rig, members) for members in components])


@lru_cache(maxsize=64)
def apart(rig: Rig) -> str:
    """Why no chain of bodies holds what ropes and links tie together; empty if one does.

    Every mass is then a tree of its own, and ropes are constraints (`flatrig.models.mjcf.spools`).
    """
    components = _components(rig)
    try:
        _bodies(rig, components, [_carrier(rig, members) for members in components])
    except ModelError as error:
        return str(error)
    return ""


def _own_frame(rig: Rig, mass: Mass) -> Frame | None:
    """The frame that carries a mass by itself; None for the world."""
    return rig.frame(rig.rail(mass.rail).frame) if isinstance(mass, Trolley) else None


def _bodies(
    rig: Rig, components: list[list[Mass]], carried_by: list[Frame | None]
) -> tuple[Body, ...]:
    """The bodies of a rig, where these groups of masses hang on these frames.

    Raises
    ------
    ModelError
        Ropes tie together what cannot sit on one chain.
    """
    chain: list[Body] = []

    def hang(frame: Frame | None, above: Body | None) -> None:
        """Add the masses below a frame, and with a frame those on it."""
        for members, carrier in zip(components, carried_by, strict=True):
            if carrier is frame:
                chain.extend(_chain(rig, members, above))
        for other in rig.frames:
            if frame is not None and other.parent == frame.name:
                stand(other, above)

    def stand(frame: Frame, below: Body | None) -> None:
        chain.append(_frame_link(rig, frame, below))
        hang(frame, chain[-1])

    for frame in rig.frames:
        if frame.parent == WORLD:
            stand(frame, None)
    hang(None, None)
    for swing in swings(rig, {body.name: body.frame for body in chain}):
        above = next((body for body in chain if body.name == swing.parent), None)
        zeros = (0.0,) * len(swing.joints)
        chain.append(
            Body(swing.load, above, swing.frame, swing.pivot, swing.joints, zeros, swing=swing)
        )
    return tuple(chain)


def stiff_links(rig: Rig) -> tuple[Link, ...]:
    """The links on which nothing swings: they join bodies that other things move already."""
    swung = [body.swing.link for body in chain_of(rig) if body.swing is not None]
    return tuple(link for link in rig.links if link not in swung)


def joint_names(rig: Rig) -> tuple[str, ...]:
    """Names of the model's joints in the order of qpos and qvel."""
    return tuple(name for link in chain_of(rig) for name in link.joints)


def _tied(rig: Rig, tie: Tie) -> set[str]:
    """Names of what a rope or link touches, a platform in place of its corners."""
    corners = {a.name: a.frame for a in rig.anchors if rig.platform(a.frame) is not None}
    return {corners.get(point, point) for point in tie.points}


def _components(rig: Rig) -> list[list[Mass]]:
    """Trolleys, loads and platforms, grouped by what ties them together, but what swings."""
    loose = {name for group in swinging(rig) for name in group}
    groups: list[set[str]] = [{mass.name} for mass in rig.masses if mass.name not in loose]
    for tie in ties(rig):
        tied = [group for group in groups if group & _tied(rig, tie)]
        if tied:
            groups = [group for group in groups if group not in tied] + [set().union(*tied)]
    components = [[mass for mass in rig.masses if mass.name in group] for group in groups]
    return sorted(components, key=lambda members: rig.masses.index(members[0]))


def _carrier(rig: Rig, members: list[Mass]) -> Frame | None:
    """The frame below which a group of masses hangs; None for the world."""
    names = {mass.name for mass in members}
    tied = [tie for tie in ties(rig) if names & _tied(rig, tie)]
    carried = {
        mass.name: rig.rail(mass.rail).frame for mass in members if isinstance(mass, Trolley)
    }
    carried |= {
        anchor.name: anchor.frame
        for anchor in rig.anchors
        if anchor.frame not in names and any(anchor.name in tie.points for tie in tied)
    }
    frames = [frame for frame in rig.frames if frame.name in carried.values()]
    chains = [list(carriers(rig.frames, frame)) for frame in frames]
    longest = max(chains, key=len, default=[])
    for frame in frames:
        if frame not in longest:
            both = " and ".join(sorted((frame.name, longest[0].name)))
            raise ModelError(
                f"{_spoken(tied)} tie frames {both} together, MuJoCo's mass matrix can only hold "
                "ropes on one chain of bodies; use one frame, or let one carry the other"
            )
    carrier = longest[0] if longest else None
    for mass in members:
        if carrier and isinstance(mass, Trolley) and carried[mass.name] != carrier.name:
            where = carried[mass.name]
            rail = "rail is fixed" if where == WORLD else f"rail is in frame {where}"
            raise ModelError(
                f"{_spoken(tied)} tie trolley {mass.name}, whose {rail}, to frame "
                f"{carrier.name}; put its rail in frame {carrier.name} or the anchors in "
                f"{'the world' if where == WORLD else f'frame {where}'}"
            )
    return carrier


def _spoken(tied: list[Tie]) -> str:
    """The ropes and links, in words."""
    parts = []
    for kind in ("rope", "link"):
        names = [tie.label.split()[1] for tie in tied if tie.label.startswith(kind)]
        if names:
            parts.append(f"{kind}{'s' if len(names) > 1 else ''} {', '.join(names)}")
    return " and ".join(parts)


def _frame_link(rig: Rig, frame: Frame, parent: Body | None) -> Body:
    value = rig.home_of(frame)
    shift = value if frame.kind == "sliding" else 0.0
    pairs = zip(frame.origin, frame.axis, strict=True)
    position = _vector(start + shift * part for start, part in pairs)
    return Body(frame, parent, frame, position, (frame.coordinate,), (value,))


def _chain(rig: Rig, members: list[Mass], above: Body | None) -> list[Body]:
    """Trolleys, then free pulleys, then loads, then a platform, each on the one before."""
    loads = [mass for mass in members if isinstance(mass, Load)]
    platforms = [mass for mass in members if isinstance(mass, Platform)]
    _check_platforms(rig, platforms, above)
    chain: list[Body] = []
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


def _check_platforms(rig: Rig, platforms: list[Platform], above: Body | None) -> None:
    if len(platforms) > 1:
        names = " and ".join(platform.name for platform in platforms)
        raise ModelError(
            f"ropes tie platforms {names} together, of which the lower would turn with the upper "
            "in MuJoCo's chain of bodies; tie each to trolleys, loads or anchors only"
        )
    turning = [] if above is None else carriers(rig.frames, above.frame)
    name = next((frame.name for frame in turning if frame.kind == "turning"), None)
    if platforms and name is not None:
        raise ModelError(
            f"platform {platforms[0].name} hangs from turning frame {name}, but its angles "
            "count from fixed axes; hang it from a sliding frame or from the world"
        )


def _trolley_link(rig: Rig, trolley: Trolley, parent: Body | None) -> Body:
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


def _free_link(rig: Rig, mass: Load | Platform, parent: Body | None, frame: Frame | None) -> Body:
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
