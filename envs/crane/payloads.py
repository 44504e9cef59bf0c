"""What a crane carries, which wind pushes and whose mass nobody knows exactly."""

from dataclasses import replace

from ...models.rig.rig import Load, Platform, Rig


def payloads(rig: Rig) -> list[Load | Platform]:
    """Loads that no rope runs over, and platforms; free pulleys and hooks belong to the crane."""
    fittings = rig.pulleys | hooks(rig)
    return [*(load for load in rig.loads if load.name not in fittings), *rig.platforms]


def hooks(rig: Rig) -> frozenset[str]:
    """Names of the loads from which others hang on links."""
    return frozenset(above for _, above in hung(rig)) & {load.name for load in rig.loads}


def hung(rig: Rig) -> list[tuple[str, str]]:
    """What hangs on each link at home: its lower end and its upper one, from the top down."""
    height = {end: rig.home_point(end)[2] for link in rig.links for end in link.ends}
    pairs = [sorted(link.ends, key=lambda end: height[end]) for link in rig.links]
    slanted = [(low, high) for low, high in pairs if height[low] < height[high]]
    return sorted(slanted, key=lambda pair: -height[pair[1]])


def reloaded(rig: Rig, load_mass: float) -> Rig:
    """The rig with `load_mass` times the mass of its payloads, and their inertia."""
    carried = payloads(rig)
    others = [part for part in rig.masses if part not in carried]
    return replace(rig, masses=(*others, *(_times(load_mass, part) for part in carried)))


def _times(factor: float, part: Load | Platform) -> Load | Platform:
    if isinstance(part, Load):
        return replace(part, mass=factor * part.mass)
    inertia = tuple(factor * moment for moment in part.inertia)
    return replace(part, mass=factor * part.mass, inertia=inertia)
