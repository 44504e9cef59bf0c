"""What a crane carries, which wind pushes and whose mass nobody knows exactly."""

from dataclasses import replace

from ...models.rig.rig import Load, Platform, Rig


def payloads(rig: Rig) -> list[Load | Platform]:
    """Loads that no rope runs over, and platforms; free pulleys belong to the crane."""
    return [*(load for load in rig.loads if load.name not in rig.pulleys), *rig.platforms]


def reloaded(rig: Rig, load_mass: float) -> Rig:
    """The rig with `load_mass` times the mass of its payloads, and their inertia."""
    carried = payloads(rig)
    others = [part for part in rig.masses if part not in carried]
    return replace(rig, masses=(*others, *(_times(load_mass, part) for part in carried)))


def _times(factor: float, part: Load | Platform) -> Load | Platform:
    if isinstance(part, Load):
        return replace(part, mass=factor * part.mass)
    first, second, third = part.inertia
    inertia = factor * first, factor * second, factor * third
    return replace(part, mass=factor * part.mass, inertia=inertia)
