"""What a crane carries, which wind pushes and whose mass nobody knows exactly."""

from dataclasses import replace

from ...models.rig.rig import Link, Load, Platform, Rig


def payloads(rig: Rig) -> list[Load | Platform]:
    """Loads that no rope runs over or starts at, and platforms.

    Free pulleys, hooks, and what a winch stands on belong to the crane.
    """
    fittings = rig.pulleys | hooks(rig) | {rope.path[0] for rope in rig.ropes}
    return [*(load for load in rig.loads if load.name not in fittings), *rig.platforms]


def payload_beams(rig: Rig) -> list[Link]:
    """Beams at an end of which a payload is."""
    names = {part.name for part in payloads(rig)}
    return [link for link in rig.links if link.mass and not names.isdisjoint(link.ends)]


def payload_weight(rig: Rig) -> float:
    """Weight of payloads and beams between them [N]."""
    parts = (*payloads(rig), *payload_beams(rig))
    return rig.gravity * sum(part.mass for part in parts)


def payload_bodies(rig: Rig) -> list[str]:
    """Names of the bodies in MuJoCo that make up this weight."""
    return [part.name for part in (*payloads(rig), *payload_beams(rig))]


def turns(rig: Rig) -> bool:
    """Whether some of these bodies have an inertia besides their mass."""
    return bool(rig.platforms or payload_beams(rig))


def hooks(rig: Rig) -> frozenset[str]:
    """Names of the loads from which others hang on links."""
    return frozenset(above for _, above in hung(rig)) & {load.name for load in rig.loads}


def hung(rig: Rig) -> list[tuple[str, str]]:
    """What hangs on each link at home: its lower end and its upper one, from the top down.

    On a beam nothing hangs that ropes or other links hold from above, however it leans.
    """
    height = {end: rig.home_point(end)[2] for link in rig.links for end in link.ends}
    pairs = {link: sorted(link.ends, key=lambda end: height[end]) for link in rig.links}
    held = {point for rope in rig.ropes for point in rope.path} | {a.name for a in rig.anchors}
    slanted = []
    for link, (low, high) in pairs.items():
        others = {lower for other, (lower, _) in pairs.items() if other is not link}
        if height[low] < height[high] and not (link.mass and low in held | others):
            slanted.append((low, high))
    return sorted(slanted, key=lambda pair: -height[pair[1]])


def reloaded(rig: Rig, load_mass: float) -> Rig:
    """The rig with `load_mass` times the mass of its payloads and their beams, and inertia."""
    carried = payloads(rig)
    others = [part for part in rig.masses if part not in carried]
    masses = (*others, *(_times(load_mass, part) for part in carried))
    beams = payload_beams(rig)
    links = tuple(_beam(load_mass, link) if link in beams else link for link in rig.links)
    return replace(rig, masses=masses, links=links)


def _beam(factor: float, link: Link) -> Link:
    inertia = None if link.inertia is None else factor * link.inertia
    return replace(link, mass=factor * link.mass, inertia=inertia)


def _times(factor: float, part: Load | Platform) -> Load | Platform:
    if isinstance(part, Load):
        return replace(part, mass=factor * part.mass)
    inertia = tuple(factor * moment for moment in part.inertia)
    return replace(part, mass=factor * part.mass, inertia=inertia)
