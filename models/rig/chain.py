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

from collections.abc import Iterator
from functools import lru_cache

from ..errors import ModelError
from .body import Body, Mass, frame_body, free_body, trolley_body
from .frames import carriers
from .link import Link
from .rig import WORLD, Frame, Load, Platform, Rig, Trolley
from .swings import Tie, body_of, swinging, swings, ties


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
        chain = _bodies(rig, components, [_carrier(rig, members) for members in components])
    except ModelError as error:
        return str(error)
    return _beside(rig, {body.name: body for body in chain})


def _beside(rig: Rig, bodies: dict[str, Body]) -> str:
    """Which rope ties what swings on a beam to what is not on its chain; empty if none does."""
    swung = {body.swing.load.name for body in bodies.values() if body.swing is not None}
    for rope in rig.ropes:
        if swung.isdisjoint(rope.path):
            continue
        tied = [name for point in rope.path if (name := body_of(rig, point)) is not None]
        lines = [_line(bodies[name]) for name in tied]
        longest = max(lines, key=len)
        for name in tied:
            if name not in longest:
                return f"rope {rope.name} ties {name} to {longest[0]}, which is not on its chain"
    return ""


def _line(body: Body) -> list[str]:
    """Names of a body and of all that carry it."""
    return [body.name, *(_line(body.parent) if body.parent else ())]


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
        chain.append(frame_body(rig, frame, below))
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
    return tuple(_depth_first(chain, None))


def _depth_first(bodies: list[Body], above: Body | None) -> Iterator[Body]:
    """Bodies in the order in which MuJoCo numbers them, from what stands on one on."""
    for body in bodies:
        if body.parent is above:
            yield body
            yield from _depth_first(bodies, body)


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


def _chain(rig: Rig, members: list[Mass], above: Body | None) -> list[Body]:
    """Trolleys, then free pulleys, then loads, then a platform, each on the one before."""
    loads = [mass for mass in members if isinstance(mass, Load)]
    platforms = [mass for mass in members if isinstance(mass, Platform)]
    _check_platforms(rig, platforms, above)
    chain: list[Body] = []
    for mass in members:
        if isinstance(mass, Trolley):
            chain.append(trolley_body(rig, mass, chain[-1] if chain else above))
    for load in sorted(loads, key=lambda load: load.name not in rig.pulleys):
        frame = None if above is None else above.frame
        chain.append(free_body(rig, load, chain[-1] if chain else above, frame))
    for platform in platforms:
        frame = None if above is None else above.frame
        chain.append(free_body(rig, platform, chain[-1] if chain else above, frame))
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


def weighed(rig: Rig) -> bool:
    """Whether tensions of links follow from the balance of what they hold alone.

    A load cell tells them only where a load hangs on its link and nothing else holds it.
    """
    swung = {body.name for body in chain_of(rig) if body.swing is not None}
    other = {point for rope in rig.ropes for point in rope.path}
    other |= {load.name for load in rig.loads if load.drag}
    return bool(rig.links) and (bool(apart(rig)) or not swung.isdisjoint(other))
